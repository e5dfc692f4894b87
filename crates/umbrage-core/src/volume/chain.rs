//! The chain of a light: which triangles cast, and with which sign.
//!
//! Give every triangle of a subset a coefficient: +1 taken as wound, -1 taken with reversed
//! winding, 0 left out. A [`Chain`] holds them as two masks a cluster.

use bytemuck::{Pod, Zeroable};

use crate::world::{EdgeUse, Edges, LANES};

/// A triangle of the chain: its number and whether it is taken with reversed winding, packed so
/// that the renderer can draw it as a cap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct ChainTriangle(pub u32);

impl ChainTriangle {
    /// `coefficient` is +1 or -1.
    #[inline]
    pub fn new(triangle: u32, coefficient: i8) -> Self {
        Self(triangle << 1 | u32::from(coefficient < 0))
    }

    /// Number of the triangle.
    #[inline]
    pub fn triangle(self) -> u32 {
        self.0 >> 1
    }

    /// +1 taken as wound, -1 reversed.
    #[inline]
    pub fn coefficient(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

/// The triangles of one cluster that are in a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Chain {
    /// Number of the cluster.
    pub cluster: u32,
    /// Bit i: triangle 64 * cluster + i has coefficient +1.
    pub wound: u64,
    /// Bit i: it has coefficient -1.
    pub reversed: u64,
}

impl Chain {
    /// The triangles, ascending.
    pub fn triangles(&self) -> impl Iterator<Item = ChainTriangle> {
        let first = self.cluster * LANES as u32;
        let reversed = self.reversed;
        crate::world::lanes(self.wound | self.reversed).map(move |lane| {
            ChainTriangle::new(first + lane, if reversed >> lane & 1 == 1 { -1 } else { 1 })
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        (self.wound | self.reversed).count_ones() as usize
    }

    /// Whether none is in.
    pub fn is_empty(&self) -> bool {
        self.wound | self.reversed == 0
    }
}

/// One silhouette quad: an edge extruded away from the light, in four bytes.
///
/// The edge runs the way the chain's triangles run along it, so that seen from the light the
/// casting side is on its left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct Quad(pub EdgeUse);

impl Quad {
    /// Start and end vertex.
    #[inline]
    pub fn ends(self, edges: &Edges) -> [u32; 2] {
        let [low, high] = edges.vertices[self.0.edge() as usize];
        if self.0.sign() > 0 {
            [low, high]
        } else {
            [high, low]
        }
    }
}
