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
    let tree = build_bvh2(
        &bounds,
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
            order.extend_from_slice(
                &tree.primitive_indices[first..first + node.prim_count as usize],
            );
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
