//! Brute force: every triangle of the chain its own volume, three quads each. A baseline; correct,
//! and what signed counters are measured against in the 2004 paper (section 2.6).

use super::{ChainTriangle, Quad};
use crate::world::{EdgeUse, Edges};

/// Appends three quads for each triangle of the chain.
pub fn brute(edges: &Edges, chain: impl Iterator<Item = ChainTriangle>, quads: &mut Vec<Quad>) {
    for t in chain {
        let flip = u32::from(t.coefficient() < 0);
        quads.extend(
            edges
                .of_triangle(t.triangle())
                .map(|u| Quad(EdgeUse(u.0 ^ flip))),
        );
    }
}
