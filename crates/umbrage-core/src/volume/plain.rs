//! The readable reference: a chain to its boundary, triangle by triangle.
//!
//! Takes a chain and a zeroed counter an edge; gives one [`Quad`] per unit of each counter and
//! leaves the counters zeroed. Source: Aldridge and Woods 2004, section 2.5, with the edges of the
//! chain's own triangles visited instead of all edges. The fast version in `counter` must give
//! the same quads, in whatever order.

use super::{Chain, Quad};
use crate::world::{EdgeUse, World};

/// Appends the boundary of `chain` to `quads`. `counters` has one entry an edge, all zero, and is
/// all zero again afterwards.
pub fn plain_counter(world: &World, chain: &[Chain], counters: &mut [i32], quads: &mut Vec<Quad>) {
    for t in chain.iter().flat_map(Chain::triangles) {
        for u in world.edges.of_triangle(t.triangle()) {
            counters[u.edge() as usize] += u.sign() * t.coefficient();
        }
    }
    for t in chain.iter().flat_map(Chain::triangles) {
        for u in world.edges.of_triangle(t.triangle()) {
            let count = std::mem::take(&mut counters[u.edge() as usize]);
            let quad = Quad(EdgeUse::new(u.edge(), count < 0));
            for _ in 0..count.unsigned_abs() {
                quads.push(quad);
            }
        }
    }
}
