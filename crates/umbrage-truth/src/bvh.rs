//! A bounding volume hierarchy over triangles, for rays in f64.
//!
//! Takes corners (f32, world space) and the triangles to hold; gives nodes, and an order in which
//! every leaf is a contiguous run of slots. Invariant: each node's box is the exact box of its
//! corners, and every triangle lies in one leaf (`validate`, run by debug builds).
//! Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".

use glam::{DVec3, Vec3};
use rayon::prelude::*;

#[cfg(any(test, debug_assertions))]
mod validate;
mod visit;

const LEAF_SIZE: usize = 4;
const BINS: usize = 16;
/// Below this depth splits halve the triangle count, which bounds the traversal stack:
/// 48 + log2(2^32 / 4) < 80.
const HALVING_DEPTH: u32 = 48;
#[derive(Clone, Copy, Debug)]
struct Box3 {
    min: Vec3,
    max: Vec3,
}

impl Box3 {
    const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest in f32 that holds the corners.
    fn around(low: DVec3, high: DVec3) -> Self {
        let (mut min, mut max) = (low.as_vec3(), high.as_vec3());
        for axis in 0..3 {
            if f64::from(min[axis]) > low[axis] {
                min[axis] = min[axis].next_down();
            }
            if f64::from(max[axis]) < high[axis] {
                max[axis] = max[axis].next_up();
            }
        }
        Self { min, max }
    }

    fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    fn half_area(&self) -> f32 {
        let e = self.max - self.min;
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

/// A leaf of `count` slots from `first`; with `count` 0, an inner node with children `first` and
/// `first + 1`.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Box3,
    first: u32,
    count: u32,
}

/// The hierarchy. Slots count the triangles in leaf order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
}

struct Primitive {
    bounds: Box3,
    centre: Vec3,
}

/// A range of the order that still needs a subtree under `node`.
struct Pending {
    node: u32,
    start: usize,
    end: usize,
    depth: u32,
}

impl Bvh {
    /// Builds over `triangles` (indices into `corners`) and reorders them into slots.
    pub(crate) fn build(corners: &[[DVec3; 3]], triangles: &mut [u32]) -> Self {
        if triangles.is_empty() {
            return Self::default();
        }
        let primitives: Vec<Primitive> = corners
            .par_iter()
            .map(|c| {
                let bounds = Box3::around(c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
                Primitive {
                    centre: bounds.min * 0.5 + bounds.max * 0.5,
                    bounds,
                }
            })
            .collect();
        let subtree = (triangles.len() / 64).max(1024);
        let (mut nodes, mut pending) = grow(&primitives, triangles, 0, 0, subtree);
        pending.sort_by_key(|p| p.start);
        let mut slices = Vec::with_capacity(pending.len());
        let (mut rest, mut taken) = (&mut *triangles, 0);
        for range in pending {
            // Pending ranges are disjoint and, with the leaves of the top, cover the order.
            let (_, tail) = rest.split_at_mut(range.start - taken);
            let (slice, tail) = tail.split_at_mut(range.end - range.start);
            (rest, taken) = (tail, range.end);
            slices.push((range, slice));
        }
        let subtrees: Vec<_> = slices
            .into_par_iter()
            .map(|(range, slice)| {
                let (nodes, _) = grow(&primitives, slice, range.start, range.depth, LEAF_SIZE);
                (range.node, nodes)
            })
            .collect();
        for (root, subtree) in subtrees {
            // Node 0 of the subtree takes the root's place, the others follow in a block.
            let shift = nodes.len() as u32 - 1;
            let moved = |mut node: Node| {
                if node.count == 0 {
                    node.first += shift;
                }
                node
            };
            nodes[root as usize] = moved(subtree[0]);
            nodes.extend(subtree[1..].iter().map(|&node| moved(node)));
        }
        let built = Self { nodes };
        #[cfg(debug_assertions)]
        built
            .validate(corners, triangles)
            .expect("the hierarchy holds every triangle once");
        built
    }
}

/// Splits `order` until ranges hold at most `stop` primitives. Slots start at `base`. Ranges above
/// the leaf size are given back as pending.
fn grow(
    primitives: &[Primitive],
    order: &mut [u32],
    base: usize,
    depth: u32,
    stop: usize,
) -> (Vec<Node>, Vec<Pending>) {
    let placeholder = Node {
        bounds: Box3::EMPTY,
        first: 0,
        count: 0,
    };
    let mut nodes = vec![placeholder];
    let mut pending = Vec::new();
    let mut open = vec![Pending {
        node: 0,
        start: 0,
        end: order.len(),
        depth,
    }];
    while let Some(range) = open.pop() {
        let slice = &mut order[range.start..range.end];
        let mut bounds = Box3::EMPTY;
        slice
            .iter()
            .for_each(|&p| bounds.grow(&primitives[p as usize].bounds));
        let node = range.node as usize;
        if slice.len() <= LEAF_SIZE {
            let first = (base + range.start) as u32;
            nodes[node] = Node {
                bounds,
                first,
                count: slice.len() as u32,
            };
        } else if slice.len() <= stop {
            pending.push(Pending {
                start: base + range.start,
                end: base + range.end,
                ..range
            });
        } else {
            let middle = range.start + split(primitives, slice, range.depth);
            let first = nodes.len() as u32;
            nodes[node] = Node {
                bounds,
                first,
                count: 0,
            };
            nodes.extend([placeholder; 2]);
            let depth = range.depth + 1;
            open.push(Pending {
                node: first,
                start: range.start,
                end: middle,
                depth,
            });
            open.push(Pending {
                node: first + 1,
                start: middle,
                end: range.end,
                depth,
            });
        }
    }
    (nodes, pending)
}

/// Partitions `order` at the cheapest of the bin borders of all three axes; gives the size of the
/// first part, never 0 nor all.
fn split(primitives: &[Primitive], order: &mut [u32], depth: u32) -> usize {
    let mut centres = Box3::EMPTY;
    for &p in order.iter() {
        let c = primitives[p as usize].centre;
        centres.grow(&Box3 { min: c, max: c });
    }
    let extent = centres.max - centres.min;
    let half = order.len() / 2;
    if depth >= HALVING_DEPTH {
        let axis = extent.max_position();
        order.select_nth_unstable_by(half, |&a, &b| {
            let key = |p: u32| primitives[p as usize].centre[axis];
            key(a).total_cmp(&key(b)).then(a.cmp(&b))
        });
        return half;
    }
    let bin_of = |p: u32, axis: usize| {
        let from_start = primitives[p as usize].centre[axis] - centres.min[axis];
        ((from_start / extent[axis] * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut bins = [(Box3::EMPTY, 0usize); BINS];
        for &p in order.iter() {
            let bin = &mut bins[bin_of(p, axis)];
            bin.0.grow(&primitives[p as usize].bounds);
            bin.1 += 1;
        }
        let mut above = [0f32; BINS];
        let (mut bounds, mut count) = (Box3::EMPTY, 0);
        for border in (1..BINS).rev() {
            bounds.grow(&bins[border].0);
            count += bins[border].1;
            above[border] = if count > 0 {
                bounds.half_area() * count as f32
            } else {
                f32::NAN
            };
        }
        let (mut bounds, mut count) = (Box3::EMPTY, 0);
        for border in 1..BINS {
            bounds.grow(&bins[border - 1].0);
            count += bins[border - 1].1;
            let cost = bounds.half_area() * count as f32 + above[border];
            // A side without triangles costs NaN and is never less.
            if count > 0 && best.is_none_or(|(least, ..)| cost < least) && !cost.is_nan() {
                best = Some((cost, axis, border));
            }
        }
    }
    let Some((_, axis, border)) = best else {
        return half;
    };
    let mut first = 0;
    for k in 0..order.len() {
        if bin_of(order[k], axis) < border {
            order.swap(first, k);
            first += 1;
        }
    }
    first
}
