//! The signed edge counter: a chain to its boundary, as silhouette quads.
//!
//! Takes a chain and a zeroed counter an edge; gives one [`Quad`] per unit of each counter and
//! leaves the counters zeroed. Source: Aldridge and Woods 2004, section 2.5, with the edges of the
//! chain's own triangles visited instead of all edges.

use bytemuck::{Pod, Zeroable};

use super::ChainTriangle;
use crate::world::{Edges, EdgeUse};

/// One silhouette quad: an edge extruded away from the light, in four bytes.
///
/// The edge runs the way the chain's triangles run along it, so that seen from the light the
/// casting side is on its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct Quad(pub EdgeUse);

impl Quad {
    /// Start and end vertex.
    #[inline]
    pub fn ends(self, edges: &Edges) -> [u32; 2] {
        let [low, high] = edges.vertices[self.0.edge() as usize];
        if self.0.sign() > 0 { [low, high] } else { [high, low] }
    }
}

/// Appends the boundary of `chain` to `quads`. `counters` has one entry an edge, all zero, and is
/// all zero again afterwards.
pub fn counter(
    edges: &Edges,
    chain: &[ChainTriangle],
    counters: &mut [i32],
    quads: &mut Vec<Quad>,
) {
    for t in chain {
        for u in edges.of_triangle[t.triangle() as usize] {
            counters[u.edge() as usize] += u.sign() * t.coefficient();
        }
    }
    for t in chain {
        for u in edges.of_triangle[t.triangle() as usize] {
            let count = std::mem::take(&mut counters[u.edge() as usize]);
            let quad = Quad(EdgeUse::new(u.edge(), count < 0));
            for _ in 0..count.unsigned_abs() {
                quads.push(quad);
            }
        }
    }
}
