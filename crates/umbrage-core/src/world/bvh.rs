//! The obvhs tree, flattened so that every node is a contiguous range of triangles.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

use super::array::Array;
use crate::mesh::Mesh;

/// A box over the triangles `first .. first + count`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// Lower corner.
    pub min: Vec3,
    /// First triangle below this node.
    pub first: u32,
    /// Upper corner.
    pub max: Vec3,
    /// Triangles below this node.
    pub count: u32,
    /// Index of the second child; the first is the next node. 0 in a leaf.
    pub second: u32,
}

impl Node {
    /// Whether the node has no children.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.second == 0
    }

    /// The triangles below it.
    #[inline]
    pub fn range(&self) -> std::ops::Range<u32> {
        self.first..self.first + self.count
    }
}

/// Nodes in depth-first order, the root first. Empty for an empty world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    /// Depth-first.
    pub nodes: Array<Node>,
}

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// More triangles than this in the very same box are one item to the tree's builder, which takes
/// time quadratic in their number.
const MANY_IN_ONE_BOX: usize = 64;

/// What to build a tree over, and the triangles of each item unless each is one.
fn items(bounds: Vec<Bounds>) -> (Vec<Bounds>, Option<Vec<Vec<u32>>>) {
    let bits =
        |Bounds(b): &Bounds| [b.min.to_array(), b.max.to_array()].map(|p| p.map(f32::to_bits));
    let hash = |b: &Bounds| {
        let mix = |h: u64, &x: &u32| {
            (h ^ u64::from(x))
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29)
        };
        bits(b).as_flattened().iter().fold(0, mix)
    };
    let mut sorted: Vec<(u64, u32)> = bounds
        .par_iter()
        .map(hash)
        .zip(0..bounds.len() as u32)
        .collect();
    sorted.par_sort_unstable();
    let runs = || sorted.chunk_by(|a, b| a.0 == b.0);
    if runs().all(|run| run.len() <= MANY_IN_ONE_BOX) {
        return (bounds, None);
    }
    let (mut items, mut members) = (Vec::new(), Vec::new());
    for run in runs() {
        let same = |pair: &[(u64, u32)]| {
            bits(&bounds[pair[0].1 as usize]) == bits(&bounds[pair[1].1 as usize])
        };
        let as_one = run.len() > MANY_IN_ONE_BOX && run.windows(2).all(same);
        for part in run.chunks(if as_one { run.len() } else { 1 }) {
            items.push(Bounds(bounds[part[0].1 as usize].0));
            members.push(part.iter().map(|&(_, triangle)| triangle).collect());
        }
    }
    (items, Some(members))
}

/// Builds over the triangles `kept` of `mesh`; gives the tree and, in leaf order, indices into
/// `kept`.
pub(super) fn build(mesh: &Mesh, kept: &[u32]) -> (Bvh, Vec<u32>) {
    if kept.is_empty() {
        return (Bvh::default(), Vec::new());
    }
    let bounds: Vec<Bounds> = kept
        .par_iter()
        .map(|&t| {
            let corners = mesh.places().bounds(mesh.triangles[t as usize]);
            Bounds(Aabb::from_points(&corners.map(Vec3A::from)))
        })
        .collect();
    let (items, members) = items(bounds);
    let tree = build_bvh2(
        &items,
        BvhBuildParams::medium_build(),
        &mut std::time::Duration::default(),
    );

    let mut nodes: Vec<Node> = Vec::with_capacity(tree.nodes.len());
    let mut order = Vec::with_capacity(kept.len());
    // (node of obvhs, parent that waits to hear where its second child stands)
    let mut stack = vec![(0usize, None)];
    while let Some((index, waiting)) = stack.pop() {
        let node = &tree.nodes[index];
        let at = nodes.len();
        if let Some(parent) = waiting {
            let parent: &mut Node = &mut nodes[parent];
            parent.second = at as u32;
        }
        nodes.push(Node {
            min: node.min,
            max: node.max,
            first: order.len() as u32,
            count: node.prim_count,
            second: 0,
        });
        let first = node.first_index as usize;
        if node.is_leaf() {
            let items = &tree.primitive_indices[first..first + node.prim_count as usize];
            match &members {
                None => order.extend_from_slice(items),
                Some(members) => {
                    order.extend(items.iter().flat_map(|&item| &members[item as usize]));
                }
            }
            nodes[at].count = order.len() as u32 - nodes[at].first;
        } else {
            stack.push((first + 1, Some(at)));
            stack.push((first, None));
        }
    }
    // Depth-first order: a child's counts are known before its parent's.
    for i in (0..nodes.len()).rev() {
        if !nodes[i].is_leaf() {
            nodes[i].count = nodes[i + 1].count + nodes[nodes[i].second as usize].count;
        }
    }
    let nodes = nodes.into();
    (Bvh { nodes }, order)
}
