//! The stages of [`World::build`](super::World::build), each on its own: for benches, and for who
//! needs one without the rest.
//!
//! [`weld`] -> [`tree`] -> [`order`] -> [`edges`]; each takes what the ones before it gave. They
//! panic on a mesh that `World::build` refuses.

use glam::Vec3;
use rayon::prelude::*;

use super::half_edges::{Counts, group};
use super::{BoxCluster, Bvh, Cluster, Edges, Planes, boxes, bvh, clusters, weld as welding};
use crate::mesh::{Casting, Mesh};
use crate::place::Places;

/// Equal positions found.
#[derive(Clone, Debug)]
pub struct Welded {
    /// For each position the number of the first one that equals it.
    pub vertex: Vec<u32>,
    /// How many distinct ones there are.
    pub count: usize,
    /// Triangles with three distinct corners, ascending.
    pub kept: Vec<u32>,
}

/// A tree, and the order of triangles that it asks for.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Over triangles in the order of `source`.
    pub bvh: Bvh,
    /// Numbers of triangles in the mesh.
    pub source: Vec<u32>,
}

/// Triangles in the tree's order.
#[derive(Clone, Debug)]
pub struct Ordered {
    /// Distinct positions, numbered by first use.
    pub positions: Vec<Vec3>,
    /// What f32 leaves of them; empty if the mesh has none.
    pub residuals: Vec<Vec3>,
    /// Three vertices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// One rule a triangle.
    pub casting: Vec<Casting>,
    /// Plane equations.
    pub planes: Planes,
    /// Boxes of triangles.
    pub boxes: Vec<BoxCluster>,
}

/// Who shares an edge with whom.
#[derive(Clone, Debug)]
pub struct Joined {
    /// Unique edges and each triangle's use of them.
    pub edges: Edges,
    /// What the counter needs to know inside each 64 triangles.
    pub clusters: Vec<Cluster>,
    pub(super) counts: Counts,
}

/// Finds equal positions, and the triangles that have three distinct ones.
pub fn weld(mesh: &Mesh) -> Welded {
    let (vertex, count) = welding::weld(mesh.places());
    Welded {
        kept: kept(mesh, &vertex),
        vertex,
        count,
    }
}

/// The triangles with three distinct corners, where `vertex` says which are one.
pub(super) fn kept(mesh: &Mesh, vertex: &[u32]) -> Vec<u32> {
    let triangles = (0..mesh.triangles.len() as u32).into_par_iter();
    let kept = triangles.filter(|&t| {
        let [a, b, c] = mesh.triangles[t as usize].map(|v| vertex[v as usize]);
        a != b && b != c && c != a
    });
    kept.collect()
}

/// Builds the tree by obvhs.
pub fn tree(mesh: &Mesh, welded: &Welded) -> Tree {
    let (bvh, order) = bvh::build(mesh, &welded.kept);
    let source = order.par_iter().map(|&i| welded.kept[i as usize]);
    Tree {
        source: source.collect(),
        bvh,
    }
}

/// Brings triangles into the order `source`, numbers vertices by first use, and computes what is
/// known of single triangles.
pub fn order(mesh: &Mesh, welded: &Welded, source: &[u32]) -> Ordered {
    let rule = |&t: &u32| mesh.casting[t as usize];
    let (positions, residuals, triangles) = welding::renumber(mesh, welded, source);
    let places = Places {
        positions: &positions,
        residuals: &residuals,
    };
    Ordered {
        casting: source.par_iter().map(rule).collect(),
        planes: Planes::new(places, &triangles),
        boxes: boxes::boxes(places, &triangles),
        positions,
        residuals,
        triangles,
    }
}

/// Finds unique edges.
pub fn edges(ordered: &Ordered) -> Joined {
    let grouped = group(&ordered.triangles, ordered.positions.len());
    Joined {
        edges: super::edges::edges(&ordered.triangles, &grouped),
        clusters: clusters::clusters(&ordered.casting, &grouped),
        counts: grouped.counts,
    }
}
