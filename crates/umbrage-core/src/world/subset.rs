//! A subset of the world's triangles, as bits in clusters.

use std::ops::Range;

use super::clusters::LANES;

/// The triangles of one cluster that are in a subset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Members {
    /// Number of the cluster.
    pub cluster: u32,
    /// Bit i: triangle 64 * cluster + i.
    pub mask: u64,
}

/// Triangles that a light's query returned.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Subset {
    /// Ascending; a cluster occurs at most once, and not without a triangle.
    pub members: Vec<Members>,
}

impl Subset {
    /// Makes it empty.
    pub fn clear(&mut self) {
        self.members.clear();
    }

    /// Adds triangle `t`, not below any that is in already.
    #[inline]
    pub fn push(&mut self, t: u32) {
        self.push_mask(t / LANES as u32, 1 << (t % LANES as u32));
    }

    #[inline]
    pub(super) fn push_mask(&mut self, cluster: u32, mask: u64) {
        match self.members.last_mut() {
            Some(last) if last.cluster == cluster => last.mask |= mask,
            _ => self.members.push(Members { cluster, mask }),
        }
    }

    /// Adds consecutive triangles, none below any that is in already.
    #[inline]
    pub fn push_range(&mut self, range: Range<u32>) {
        let lanes = LANES as u32;
        let mut first = range.start;
        while first < range.end {
            let cluster = first / lanes;
            let end = range.end.min((cluster + 1) * lanes);
            let mask = (u64::MAX >> (lanes - (end - first))) << (first % lanes);
            self.push_mask(cluster, mask);
            first = end;
        }
    }

    /// How many triangles are in.
    pub fn len(&self) -> usize {
        self.members
            .iter()
            .map(|m| m.mask.count_ones() as usize)
            .sum()
    }

    /// Whether none is in.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// The triangles, ascending.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.members
            .iter()
            .flat_map(|m| lanes(m.mask).map(|lane| m.cluster * LANES as u32 + lane))
    }
}

/// The set bits of a mask, ascending.
pub(crate) fn lanes(mut mask: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (lane < LANES as u32).then_some(lane)
    })
}
