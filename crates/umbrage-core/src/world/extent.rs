//! Which part of a world's arrays belongs together.

use std::ops::Range;

/// The share of a world's arrays that belongs together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Extent {
    /// In [`World::positions`](super::World::positions).
    pub vertices: Range<u32>,
    /// In [`World::triangles`](super::World::triangles); an object's begin with a cluster.
    pub triangles: Range<u32>,
    /// In [`World::edges`](super::World::edges).
    pub edges: Range<u32>,
    /// In [`Bvh::nodes`](super::Bvh::nodes); the first is the root.
    pub nodes: Range<u32>,
}

impl Extent {
    pub(super) fn lengths(&self) -> [usize; 4] {
        [
            self.vertices.len(),
            self.triangles.len(),
            self.edges.len(),
            self.nodes.len(),
        ]
    }

    /// The first `lengths` of it.
    pub(super) fn begin(&self, lengths: [usize; 4]) -> Self {
        let [v, t, e, n] = self.starts();
        let part = |start: u32, length: usize| start..start + length as u32;
        Self {
            vertices: part(v, lengths[0]),
            triangles: part(t, lengths[1]),
            edges: part(e, lengths[2]),
            nodes: part(n, lengths[3]),
        }
    }

    pub(super) fn starts(&self) -> [u32; 4] {
        [
            self.vertices.start,
            self.triangles.start,
            self.edges.start,
            self.nodes.start,
        ]
    }
}
