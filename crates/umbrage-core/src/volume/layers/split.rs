//! A chain to parts with few layers each.
//!
//! Takes a chain and the most layers a part may have; gives chains that together are the given one.
//! Wherever more casters than that may lie over each other, each goes into the first part that has
//! room for it there. In the order of the chain, so that parts depend on nothing else.

use super::clusters::see;
use super::projection::Projection;
use super::refine::{Item, Refining, Window};
use super::{LEVELS, Layers};
use crate::light::Light;
use crate::volume::{Chain, ChainTriangle};
use crate::world::{LANES, World};

/// Scratch.
#[derive(Debug, Default)]
pub(super) struct Split {
    /// Casters and the crowded places that they touch.
    places: Vec<(u32, u32)>,
    /// Of each part, how many of its casters touch each place.
    counts: Vec<Vec<u32>>,
}

impl Layers {
    /// The parts of `chain`, each with at most `most` layers.
    pub(in crate::volume) fn split(
        &mut self,
        world: &World,
        light: &Light,
        chain: &[Chain],
        most: u32,
    ) -> Vec<Vec<Chain>> {
        let most = most.max(1);
        see(world, light, chain, &mut self.seen);
        let projection = Projection::new(world, light, chain, &self.seen);
        let Split { places, counts } = &mut self.split;
        places.clear();
        counts.clear();
        let mut crowded = 0;
        for face in projection.faces() {
            projection.triangles(face, &mut self.casters, &mut self.items);
            let touches = |item: &Item, window: &Window| {
                projection.touches(face, self.casters[item.number as usize], window)
            };
            let leaf = |items: &[Item]| {
                places.extend(items.iter().map(|item| (item.number, crowded)));
                crowded += 1;
            };
            Refining::new(most, LEVELS, touches, leaf).bound(&self.items);
        }
        places.sort_unstable();
        let mut parts: Vec<Vec<Chain>> = Vec::new();
        let mut rest = &places[..];
        for (caster, t) in (0..).zip(&self.casters) {
            let own = rest.partition_point(|place| place.0 == caster);
            let (touched, others) = rest.split_at(own);
            rest = others;
            let has_room = |counts: &Vec<u32>| {
                let full = |place: &(u32, u32)| counts[place.1 as usize] >= most;
                !touched.iter().any(full)
            };
            let part = counts.iter().position(has_room).unwrap_or_else(|| {
                counts.push(vec![0; crowded as usize]);
                parts.push(Vec::new());
                parts.len() - 1
            });
            for place in touched {
                counts[part][place.1 as usize] += 1;
            }
            push(&mut parts[part], *t);
        }
        parts
    }
}

/// Adds a caster, above all that are in.
fn push(chain: &mut Vec<Chain>, t: ChainTriangle) {
    let cluster = t.triangle() / LANES as u32;
    let bit = 1 << (t.triangle() % LANES as u32);
    let mut part = match chain.pop_if(|last| last.cluster == cluster) {
        Some(last) => last,
        None => Chain {
            cluster,
            ..Chain::default()
        },
    };
    match t.coefficient() > 0 {
        true => part.wound |= bit,
        false => part.reversed |= bit,
    }
    chain.push(part);
}
