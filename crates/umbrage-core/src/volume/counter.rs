//! The signed edge counter, cluster by cluster: a chain to its boundary.
//!
//! Takes a chain and a zeroed counter an edge; gives one [`Quad`] per unit of each counter and
//! leaves the counters zeroed. Source: Aldridge and Woods 2004, section 2.4. Counting is additive,
//! so inside a cluster it is done in masks: a side emits its quad unless its partner's side
//! cancels it. Only sides that share their edge beyond that touch a real counter.

use super::{Chain, Quad};
use crate::lanes64::{Lanes64, with_lanes};
use crate::world::{EdgeUse, World};

/// Appends the boundary of `chain` to `quads`. `counters` has one entry an edge, all zero, and is
/// all zero again afterwards; `touched` is scratch.
pub fn counter(
    world: &World,
    chain: &[Chain],
    counters: &mut [i32],
    touched: &mut Vec<Quad>,
    quads: &mut Vec<Quad>,
) {
    with_lanes!(counter_with(world, chain, counters, touched, quads));
}

#[inline(always)]
fn counter_with<L: Lanes64>(
    l: L,
    world: &World,
    chain: &[Chain],
    counters: &mut [i32],
    touched: &mut Vec<Quad>,
    quads: &mut Vec<Quad>,
) {
    touched.clear();
    for part in chain {
        let cluster = &world.clusters[part.cluster as usize];
        let uses = &world.edges.sides[part.cluster as usize];
        for (side, uses) in cluster.sides.iter().zip(uses) {
            let cancelled = side.paired & l.permute(part.wound, &side.partner);
            let alone = part.wound & !side.shared & !cancelled;
            l.append(uses, alone, 0, quads);
            l.append(uses, part.wound & side.shared, 0, touched);
            if part.reversed != 0 {
                let cancelled = side.paired & l.permute(part.reversed, &side.partner);
                let alone = part.reversed & !side.shared & !cancelled;
                l.append(uses, alone, 1, quads);
                l.append(uses, part.reversed & side.shared, 1, touched);
            }
        }
    }
    for quad in &*touched {
        counters[quad.0.edge() as usize] += quad.0.sign();
    }
    // Nearly every count is -1, 0 or 1: written without a branch, kept if it is not 0.
    let mut len = quads.len();
    quads.resize(len + touched.len(), Quad::default());
    let mut more = Vec::new();
    for quad in &*touched {
        let edge = quad.0.edge();
        let count = std::mem::take(&mut counters[edge as usize]);
        quads[len] = Quad(EdgeUse::new(edge, count < 0));
        if count.unsigned_abs() > 1 {
            more.extend(std::iter::repeat_n(
                quads[len],
                count.unsigned_abs() as usize - 1,
            ));
        }
        len += usize::from(count != 0);
    }
    quads.truncate(len);
    quads.append(&mut more);
}
