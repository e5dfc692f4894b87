//! Hidden casters: triangles of a chain that no light ray reaches first, left out where that
//! saves quads.
//!
//! Takes a world, a light and its chain; gives the chain without some of the triangles of which
//! every part within the light's reach lies behind other triangles of the chain. **Why it is
//! exact:** along a light ray the nearest caster has none in front of it, so it is never hidden,
//! and what it shades is all that the ray shades. The volume stays closed because its quads are
//! the boundary of whatever chain is left. Slivers of f64 rounding (`SLIVER` in `cover`) count as
//! covered; cracks of f32 rounding do not. Does not depend on the view, nor on the number of
//! threads. Not for counting how many casters shade a point: the count changes, its being zero
//! does not.

mod choice;
mod cover;
mod cut;
mod grid;
mod reach;
mod sight;

use rayon::prelude::*;

use self::choice::Choice;
use self::cover::{Cover, Scene, Verdict};
use self::grid::Grid;
use self::reach::ReachPlanes;
use self::sight::{Caster, Sight};
use super::{Chain, ChainTriangle, QuadReach};
use crate::light::Light;
use crate::world::{LANES, World};

/// Scratch of [`drop_hidden`]; keep it between calls.
#[derive(Debug, Default)]
pub struct HiddenScratch {
    found: Vec<Found>,
    casters: Vec<Caster>,
    grid: Grid,
    reach: ReachPlanes,
    cover: Cover,
    choice: Choice,
}

/// A triangle of the chain.
#[derive(Clone, Copy, Debug)]
struct Found {
    triangle: ChainTriangle,
    hidden: bool,
}

/// Chains longer than this are worked on by all threads.
const MANY: usize = 1 << 14;
/// Triangles that one thread takes at a time.
const CHUNK: usize = 1 << 10;

/// Takes hidden triangles out of `chain`; gives how many. `chain` may be any part of what casts
/// for the light, as long as the part is used as one volume.
pub fn drop_hidden(
    world: &World,
    light: &Light,
    chain: &mut Vec<Chain>,
    scratch: &mut HiddenScratch,
) -> u32 {
    let sight = Sight::new(world, light);
    let s = scratch;
    s.found.clear();
    let triangles = chain.iter().flat_map(Chain::triangles);
    s.found.extend(triangles.map(|triangle| Found {
        triangle,
        hidden: false,
    }));
    let caster = |found: &Found| sight.caster(world, found.triangle.triangle());
    s.casters.clear();
    s.casters.extend(s.found.iter().map(caster));
    s.grid.fill(&sight, &s.casters);
    s.reach.set(light);
    let scene = Scene {
        sight: &sight,
        casters: &s.casters,
        grid: &s.grid,
        reach: &s.reach,
    };
    // Chunks of fixed length: the same verdicts whatever the number of threads.
    let decide = |cover: &mut Cover, (chunk, found): (usize, &mut [Found])| {
        cover.forget();
        for (i, found) in found.iter_mut().enumerate() {
            found.hidden = cover.decide(&scene, CHUNK * chunk + i) == Verdict::Hidden;
        }
    };
    if s.found.len() < MANY {
        let chunks = s.found.chunks_mut(CHUNK).enumerate();
        chunks.for_each(|chunk| decide(&mut s.cover, chunk));
    } else {
        let chunks = s.found.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each_init(Cover::default, decide);
    }
    if s.found.iter().all(|found| !found.hidden) {
        return 0;
    }
    s.choice.choose(world, &QuadReach::new(light), &mut s.found);
    let mut dropped = 0;
    let mut rest = s.found.iter();
    for part in &mut *chain {
        for found in rest.by_ref().take(part.len()).filter(|found| found.hidden) {
            let bit = 1 << (found.triangle.triangle() % LANES as u32);
            part.wound &= !bit;
            part.reversed &= !bit;
            dropped += 1;
        }
    }
    chain.retain(|part| !part.is_empty());
    dropped
}
