//! Clusters: runs of 64 triangles in BVH order, with what the counter needs to know inside them.
//!
//! Takes sides grouped by edge; gives for every side of every triangle one of three answers: the edge has
//! this one triangle only; it has exactly one other, wound the other way, in the same cluster (its
//! *partner*, named by lane); or it is *shared* and needs a real counter. Inside a cluster the
//! boundary is then bit arithmetic on 64-bit masks. No edge knows a face; the partner lane is one
//! byte a side.

use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::half_edges::{Grouped, SHARED};
use crate::mesh::Casting;

/// Triangles a cluster.
pub const LANES: usize = 64;

/// What the counter needs to know about 64 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Cluster {
    /// Triangles that cast where their front faces the light.
    pub casts_front: u64,
    /// Triangles that cast where their back faces the light.
    pub casts_back: u64,
    /// Sides (0,1), (1,2), (2,0).
    pub sides: [ClusterSide; 3],
}

/// One side of 64 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ClusterSide {
    /// Lane of the partner, where there is one.
    pub partner: [u8; LANES],
    /// Triangles that have a partner.
    pub paired: u64,
    /// Triangles whose edge needs a counter.
    pub shared: u64,
}

/// Clusters of all triangles; the last may be partly empty.
pub(super) fn clusters(casting: &[Casting], grouped: &Grouped) -> Vec<Cluster> {
    let casting = casting.par_chunks(LANES);
    let company = grouped.company.par_chunks(3 * LANES);
    let cluster = |(casting, company): (&[Casting], &[AtomicU8])| Cluster {
        casts_front: mask(casting, |c| matches!(c, Casting::Front | Casting::Both)),
        casts_back: mask(casting, |c| matches!(c, Casting::Back | Casting::Both)),
        sides: [0, 1, 2].map(|k| side(company.iter().skip(k).step_by(3))),
    };
    casting.zip(company).map(cluster).collect()
}

fn side<'a>(company: impl Iterator<Item = &'a AtomicU8>) -> ClusterSide {
    let mut side = ClusterSide {
        partner: [0; LANES],
        paired: 0,
        shared: 0,
    };
    for (lane, company) in company.enumerate() {
        let company = company.load(Relaxed);
        let paired = usize::from(company) < LANES;
        side.partner[lane] = if paired { company } else { 0 };
        side.paired |= u64::from(paired) << lane;
        side.shared |= u64::from(company == SHARED) << lane;
    }
    side
}

fn mask(chunk: &[Casting], is: impl Fn(Casting) -> bool) -> u64 {
    chunk
        .iter()
        .enumerate()
        .map(|(lane, &c)| u64::from(is(c)) << lane)
        .sum()
}
