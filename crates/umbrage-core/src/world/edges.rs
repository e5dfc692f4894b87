//! The table of unique edges.
//!
//! Takes triangles and their sides grouped by edge; gives each edge a number, by first use, its
//! vertices, and each triangle's use of it.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::array::Array;
use super::clusters::LANES;
use super::half_edges::Grouped;
use super::lanes;

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

/// The edge table of grouped sides.
pub(super) fn edges(triangles: &[[u32; 3]], grouped: &Grouped) -> Edges {
    let numbers = Numbers::new(&grouped.first);
    let mut vertices = vec![[0; 2]; grouped.counts.edges];
    numbers.place(&mut vertices, |side| {
        let (from, to) = ends(triangles, side);
        [from.min(to), from.max(to)]
    });
    let cluster = |(number, triangles): (usize, &[[u32; 3]])| {
        let mut sides = [[EdgeUse::default(); LANES]; 3];
        let first = &grouped.first[3 * LANES * number..];
        for (lane, (&[a, b, c], first)) in triangles.iter().zip(first.chunks_exact(3)).enumerate() {
            for (k, reversed) in [b < a, c < b, a < c].into_iter().enumerate() {
                let edge = numbers.of_first_side(first[k].load(Relaxed));
                sides[k][lane] = EdgeUse::new(edge, reversed);
            }
        }
        sides
    };
    let sides: Vec<_> = triangles
        .par_chunks(LANES)
        .enumerate()
        .map(cluster)
        .collect();
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

/// Numbers edges by first use: an edge's number is how many first sides stand before its own.
/// Kept as bits with a count each 64, which stay in the cache where numbers would not.
struct Numbers {
    /// Bit i of word w: side 64 w + i is the first on its edge.
    first: Vec<u64>,
    /// First sides before each word.
    before: Vec<u32>,
}

impl Numbers {
    fn new(first_side: &[AtomicU32]) -> Self {
        let word = |(number, sides): (usize, &[AtomicU32])| {
            let is_first = |(bit, side): (usize, &AtomicU32)| {
                u64::from(side.load(Relaxed) as usize == 64 * number + bit) << bit
            };
            sides.iter().enumerate().map(is_first).sum()
        };
        let words = first_side.par_chunks(64).enumerate().with_min_len(256);
        let first: Vec<u64> = words.map(word).collect();
        let mut sum = 0;
        let before = first.iter().map(|word| {
            sum += word.count_ones();
            sum - word.count_ones()
        });
        Self {
            before: before.collect(),
            first,
        }
    }

    #[inline]
    fn of_first_side(&self, side: u32) -> u32 {
        let (word, bit) = (side as usize / 64, side % 64);
        let below = self.first[word] & ((1 << bit) - 1);
        self.before[word] + below.count_ones()
    }

    /// Fills `list`, one item an edge, with what `of` says of the edge's first side.
    fn place<T: Send>(&self, mut list: &mut [T], of: impl Fn(u32) -> T + Sync) {
        const CHUNK: usize = 1 << 8;
        let mut chunks = Vec::new();
        for (number, words) in self.first.chunks(CHUNK).enumerate() {
            let edges: u32 = words.iter().map(|word| word.count_ones()).sum();
            let (items, rest) = list.split_at_mut(edges as usize);
            chunks.push((number, words, items));
            list = rest;
        }
        chunks.into_par_iter().for_each(|(number, words, items)| {
            let first_sides = (number * CHUNK..)
                .zip(words)
                .flat_map(|(at, &word)| lanes(word).map(move |bit| 64 * at as u32 + bit));
            for (item, side) in items.iter_mut().zip(first_sides) {
                *item = of(side);
            }
        });
    }
}
