//! Unique edges by radix sort of packed vertex pairs.
//!
//! Takes triangles over welded vertices; gives the edge table and each triangle's use of it.
//! The 2004 paper left this step as future work (Aldridge and Woods, section 2.7).

use bytemuck::{Pod, Zeroable};
use rdst::{RadixKey, RadixSort};

use super::WorldReport;
use super::array::Array;
use super::clusters::LANES;

/// One side of a triangle: which edge it is, and whether the triangle runs along it or against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct EdgeUse(pub u32);

impl EdgeUse {
    /// `reversed`: the triangle runs from the edge's second vertex to its first.
    #[inline]
    pub fn new(edge: u32, reversed: bool) -> Self {
        Self(edge << 1 | u32::from(reversed))
    }

    /// Index into [`Edges::vertices`].
    #[inline]
    pub fn edge(self) -> u32 {
        self.0 >> 1
    }

    /// The same use of an edge whose number is higher by `by`.
    #[inline]
    pub(super) fn renumbered(self, by: u32) -> Self {
        Self(self.0 + (by << 1))
    }

    /// +1 if the triangle runs along the edge, -1 if against it.
    #[inline]
    pub fn sign(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

/// The edge table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edges {
    /// Two vertices an edge, lower number first; edges are numbered by first use.
    pub vertices: Array<[u32; 2]>,
    /// Edge uses, cluster after cluster: side (0,1) of its 64 triangles, then (1,2), then (2,0).
    pub sides: Array<[[EdgeUse; LANES]; 3]>,
}

impl Edges {
    /// Sides (0,1), (1,2), (2,0) of triangle `t`.
    #[inline]
    pub fn of_triangle(&self, t: u32) -> [EdgeUse; 3] {
        let lane = t as usize % LANES;
        {
            let [a, b, c] = &self.sides[t as usize / LANES];
            [a[lane], b[lane], c[lane]]
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct HalfEdge {
    /// Lower vertex in the high half, so that the order is lexicographic.
    pair: u64,
    /// 3 * triangle + side.
    side: u32,
}

impl RadixKey for HalfEdge {
    const LEVELS: usize = 8;

    #[inline]
    fn get_level(&self, level: usize) -> u8 {
        (self.pair >> (8 * level)) as u8
    }
}

pub(super) fn unique_edges(triangles: &[[u32; 3]], report: &mut WorldReport) -> Edges {
    let mut halves: Vec<HalfEdge> = triangles
        .iter()
        .enumerate()
        .flat_map(|(t, &[a, b, c])| {
            [(a, b), (b, c), (c, a)]
                .into_iter()
                .zip(0u32..)
                .map(move |((from, to), k)| HalfEdge {
                    pair: u64::from(from.min(to)) << 32 | u64::from(from.max(to)),
                    side: 3 * t as u32 + k,
                })
        })
        .collect();
    halves.radix_sort_unstable();

    // Each run of equal pairs is one edge. Let every side know the first side of its run, so that
    // one pass in triangle order can number the edges by first use.
    let mut first_side = vec![0u32; halves.len()];
    for run in halves.chunk_by(|a, b| a.pair == b.pair) {
        let first = run.iter().map(|h| h.side).min().unwrap_or_default();
        let along = run.iter().filter(|h| runs_along(triangles, h.side)).count();
        for half in run {
            first_side[half.side as usize] = first;
        }
        report.unique_edges += 1;
        report.edges_by_triangles[run.len().min(4) - 1] += 1;
        report.opposite_wound_pairs += usize::from(run.len() == 2 && along != 1);
    }
    drop(halves);

    let mut vertices = Vec::with_capacity(report.unique_edges);
    let mut edge_of_side = vec![0u32; first_side.len()];
    for (side, &first) in first_side.iter().enumerate() {
        edge_of_side[side] = if first as usize == side {
            let (from, to) = ends(triangles, side as u32);
            vertices.push([from.min(to), from.max(to)]);
            vertices.len() as u32 - 1
        } else {
            edge_of_side[first as usize]
        };
    }
    let mut sides = vec![[[EdgeUse::default(); LANES]; 3]; triangles.len().div_ceil(LANES)];
    for t in 0..triangles.len() {
        let lanes = sides[t / LANES].iter_mut().map(|side| &mut side[t % LANES]);
        for (side, lane) in (3 * t as u32..).zip(lanes) {
            *lane = EdgeUse::new(edge_of_side[side as usize], !runs_along(triangles, side));
        }
    }
    report.duplicate_triangles = count_duplicates(triangles);
    Edges {
        vertices: vertices.into(),
        sides: sides.into(),
    }
}

fn ends(triangles: &[[u32; 3]], side: u32) -> (u32, u32) {
    let corners = triangles[side as usize / 3];
    let k = side as usize % 3;
    (corners[k], corners[(k + 1) % 3])
}

fn runs_along(triangles: &[[u32; 3]], side: u32) -> bool {
    let (from, to) = ends(triangles, side);
    from < to
}

#[derive(Clone, Copy, Debug)]
struct Corners([u32; 3]);

impl RadixKey for Corners {
    const LEVELS: usize = 12;

    #[inline]
    fn get_level(&self, level: usize) -> u8 {
        (self.0[level / 4] >> (8 * (level % 4))) as u8
    }
}

fn count_duplicates(triangles: &[[u32; 3]]) -> usize {
    let mut corners: Vec<Corners> = triangles
        .iter()
        .map(|&t| {
            let mut t = t;
            t.sort_unstable();
            Corners(t)
        })
        .collect();
    corners.radix_sort_unstable();
    corners.windows(2).filter(|w| w[0].0 == w[1].0).count()
}
