//! Half edges to groups that share an edge.
//!
//! Takes triangles over vertices that are numbered by first use; gives each side the first side on
//! its edge and what company it has there. A counting sort by the lower vertex is one pass with
//! good locality, since neighbours in triangle order are neighbours in vertex order; what is left
//! to sort are the few sides at one vertex. The 2004 paper left this step as future work
//! (Aldridge and Woods, section 2.7).

use std::ops::Range;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::clusters::LANES;

/// The only triangle on its edge.
pub(super) const ALONE: u8 = 0xff;
/// Neither alone nor with one partner: the edge needs a counter.
pub(super) const SHARED: u8 = 0xfe;

/// Sides are numbered 3 * triangle + k, for the side from corner k to the next.
pub(super) struct Grouped {
    /// The first side on the same edge.
    pub(super) first: Vec<AtomicU32>,
    /// [`ALONE`], [`SHARED`], or the lane of the partner: the edge's only other triangle, wound
    /// the other way, in the same cluster.
    pub(super) company: Vec<AtomicU8>,
    pub(super) counts: Counts,
}

/// See [`WorldReport`](super::WorldReport).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) edges: usize,
    pub(super) by_triangles: [usize; 4],
    pub(super) opposite_wound_pairs: usize,
    pub(super) duplicate_triangles: usize,
}

/// A half edge at its lower vertex, ordered by upper vertex, then by side.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Half(u64);

impl Half {
    fn new(upper: u32, side: u32, reversed: bool) -> Self {
        Self(u64::from(upper) << 32 | u64::from(side << 1 | u32::from(reversed)))
    }

    fn upper(self) -> u32 {
        (self.0 >> 32) as u32
    }

    fn side(self) -> u32 {
        self.0 as u32 >> 1
    }

    fn reversed(self) -> bool {
        self.0 & 1 != 0
    }
}

pub(super) fn group(triangles: &[[u32; 3]], vertices: usize) -> Grouped {
    let sides = 3 * triangles.len();
    let first = (0..sides as u32).into_par_iter().map(AtomicU32::new);
    let company = (0..sides).into_par_iter().map(|_| AtomicU8::new(ALONE));
    let mut grouped = Grouped {
        first: first.collect(),
        company: company.collect(),
        counts: Counts::default(),
    };
    // Every thread looks at all triangles and takes the sides at its own vertices.
    let threads = rayon::current_num_threads().min(16);
    let share = vertices.div_ceil(threads).max(1 << 12);
    let ranges: Vec<Range<u32>> = (0..vertices)
        .step_by(share)
        .map(|start| start as u32..vertices.min(start + share) as u32)
        .collect();
    grouped.counts = ranges
        .into_par_iter()
        .map(|range| group_at(triangles, range, &grouped))
        .reduce(Counts::default, Counts::plus);
    grouped
}

/// Groups the edges whose lower vertex is in the range.
fn group_at(triangles: &[[u32; 3]], range: Range<u32>, grouped: &Grouped) -> Counts {
    let count = range.len();
    let mut end = vec![0u32; count + 1];
    each_half(triangles, &range, |at, _| end[at + 1] += 1);
    for at in 0..count {
        end[at + 1] += end[at];
    }
    let mut halves = vec![Half::default(); end[count] as usize];
    // Filling moves each start to its end.
    each_half(triangles, &range, |at, half| {
        halves[end[at] as usize] = half;
        end[at] += 1;
    });
    let mut counts = Counts::default();
    let mut thirds = Vec::new();
    let mut start = 0;
    for (lower, &end) in range.zip(&end) {
        let at_vertex = &mut halves[start..end as usize];
        start = end as usize;
        at_vertex.sort_unstable();
        for run in at_vertex.chunk_by(|a, b| a.upper() == b.upper()) {
            counts.edges += 1;
            counts.by_triangles[run.len().min(4) - 1] += 1;
            if run.len() > 1 {
                join(run, grouped, &mut counts);
                counts.duplicate_triangles += duplicates(triangles, lower, run, &mut thirds);
            }
        }
    }
    counts
}

#[inline(always)]
fn each_half(triangles: &[[u32; 3]], range: &Range<u32>, mut found: impl FnMut(usize, Half)) {
    for (side, &[a, b, c]) in (0u32..).step_by(3).zip(triangles) {
        for (k, from, to) in [(0, a, b), (1, b, c), (2, c, a)] {
            let lower = from.min(to);
            if range.contains(&lower) {
                let half = Half::new(from.max(to), side + k, to < from);
                found((lower - range.start) as usize, half);
            }
        }
    }
}

/// Notes who is on one edge with two or more triangles.
#[inline]
fn join(run: &[Half], grouped: &Grouped, counts: &mut Counts) {
    let first = run[0].side();
    for half in &run[1..] {
        grouped.first[half.side() as usize].store(first, Relaxed);
    }
    let company = |half: &Half, is: u8| grouped.company[half.side() as usize].store(is, Relaxed);
    if let [a, b] = run {
        let [ta, tb] = [a, b].map(|half| half.side() as usize / 3);
        if a.reversed() == b.reversed() {
            counts.opposite_wound_pairs += 1;
        } else if ta / LANES == tb / LANES {
            company(a, (tb % LANES) as u8);
            company(b, (ta % LANES) as u8);
            return;
        }
    }
    run.iter().for_each(|half| company(half, SHARED));
}

/// Triangles on an edge with the same third vertex as another one there, counted where the edge
/// joins their two lowest vertices: once each.
fn duplicates(triangles: &[[u32; 3]], lower: u32, run: &[Half], thirds: &mut Vec<u32>) -> usize {
    let upper = run[0].upper();
    let third = |half: &Half| {
        let [a, b, c] = triangles[half.side() as usize / 3];
        a ^ b ^ c ^ lower ^ upper
    };
    if let [a, b] = run {
        let third_of_a = third(a);
        return usize::from(third_of_a > upper && third_of_a == third(b));
    }
    thirds.clear();
    thirds.extend(run.iter().map(third).filter(|&v| v > upper));
    thirds.sort_unstable();
    thirds.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

impl Counts {
    fn plus(self, other: Self) -> Self {
        let mut by_triangles = self.by_triangles;
        for (sum, more) in by_triangles.iter_mut().zip(other.by_triangles) {
            *sum += more;
        }
        Self {
            edges: self.edges + other.edges,
            by_triangles,
            opposite_wound_pairs: self.opposite_wound_pairs + other.opposite_wound_pairs,
            duplicate_triangles: self.duplicate_triangles + other.duplicate_triangles,
        }
    }
}
