//! Closedness as an integer identity, recomputed from vertices without the edge table.

use std::collections::HashMap;

use thiserror::Error;

use super::{ChainTriangle, Quad};
use crate::world::World;

/// A directed vertex pair on which caps and quads do not cancel.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the volume is open along vertices {from} and {to}: caps and quads sum to {sum}")]
pub struct ClosureFault {
    /// Lower vertex.
    pub from: u32,
    /// Upper vertex.
    pub to: u32,
    /// What should be zero.
    pub sum: i32,
}

/// Whether light caps (the chain), dark caps (the chain, reversed, at infinity) and quads form a
/// closed surface: on every vertex pair the chain's sides and the quads must cancel, and at every
/// vertex as many quads must start as end (the extruded sides, shared by neighbouring quads).
pub fn check_closed(
    world: &World,
    chain: impl IntoIterator<Item = ChainTriangle>,
    quads: &[Quad],
) -> Result<(), ClosureFault> {
    let mut sums: HashMap<[u32; 2], i32> = HashMap::new();
    let mut add = |from: u32, to: u32, count: i32| {
        let (pair, count) = if from < to {
            ([from, to], count)
        } else {
            ([to, from], -count)
        };
        *sums.entry(pair).or_default() += count;
    };
    for t in chain {
        let [a, b, c] = world.triangles[t.triangle() as usize];
        for (from, to) in [(a, b), (b, c), (c, a)] {
            add(from, to, t.coefficient());
        }
    }
    for quad in quads {
        let [from, to] = quad.ends(&world.edges);
        add(from, to, -1);
    }
    if let Some((&[from, to], &sum)) = sums.iter().find(|(_, sum)| **sum != 0) {
        return Err(ClosureFault { from, to, sum });
    }
    let mut degree: HashMap<u32, i32> = HashMap::new();
    for quad in quads {
        let [from, to] = quad.ends(&world.edges);
        *degree.entry(from).or_default() += 1;
        *degree.entry(to).or_default() -= 1;
    }
    match degree.iter().find(|(_, sum)| **sum != 0) {
        Some((&v, &sum)) => Err(ClosureFault {
            from: v,
            to: v,
            sum,
        }),
        None => Ok(()),
    }
}
