//! What the arrays of a [`World`] take.

use super::World;

/// Bytes of each array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct WorldMemory {
    /// Positions of vertices.
    pub positions: usize,
    /// What f32 leaves of them.
    pub residuals: usize,
    /// Vertices of triangles.
    pub triangles: usize,
    /// Numbers of triangles in the mesh.
    pub source: usize,
    /// Casting rules.
    pub casting: usize,
    /// Vertices of edges.
    pub edges: usize,
    /// Edges of triangles.
    pub sides: usize,
    /// Partners and masks of clusters.
    pub clusters: usize,
    /// Plane equations.
    pub planes: usize,
    /// Boxes of triangles.
    pub boxes: usize,
    /// Nodes of the tree.
    pub bvh: usize,
}

impl WorldMemory {
    /// All arrays.
    pub fn total(&self) -> usize {
        self.by_array().iter().map(|(_, bytes)| bytes).sum()
    }

    /// Name and bytes of each array.
    pub fn by_array(&self) -> [(&'static str, usize); 11] {
        [
            ("positions", self.positions),
            ("residuals", self.residuals),
            ("triangles", self.triangles),
            ("source", self.source),
            ("casting", self.casting),
            ("edges", self.edges),
            ("sides", self.sides),
            ("clusters", self.clusters),
            ("planes", self.planes),
            ("boxes", self.boxes),
            ("bvh", self.bvh),
        ]
    }
}

impl World {
    /// Bytes of each array, mapped ones included.
    pub fn memory(&self) -> WorldMemory {
        WorldMemory {
            positions: size_of_val(&self.positions[..]),
            residuals: size_of_val(&self.residuals[..]),
            triangles: size_of_val(&self.triangles[..]),
            source: size_of_val(&self.source[..]),
            casting: size_of_val(&self.casting[..]),
            edges: size_of_val(&self.edges.vertices[..]),
            sides: size_of_val(&self.edges.sides[..]),
            clusters: size_of_val(&self.clusters[..]),
            planes: size_of_val(&self.planes.clusters[..]),
            boxes: size_of_val(&self.boxes[..]),
            bvh: size_of_val(&self.bvh.nodes[..]),
        }
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        self.memory().total()
    }
}
