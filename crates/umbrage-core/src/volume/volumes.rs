//! The volumes of all lights, as plain data.

use std::ops::Range;

use rayon::prelude::*;

use super::cache::Key;
use super::store::{Store, Version};
use super::{
    Chain, ChainTriangle, ClosureFault, Construction, LayerLimit, Quad, RangePrefix, check_closed,
};
use crate::cull::Culls;
use crate::world::{Seen, World};

/// A part of a light whose layers are too many for the mask in one go: a closed volume of its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Part {
    /// Its silhouette quads, in [`Volumes::quads`].
    pub quads: Range<u32>,
    /// Its chain, in [`Volumes::chains`].
    pub chain: Range<u32>,
}

/// One light's share of [`Volumes`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LightVolume {
    /// Triangles its query returned.
    pub subset_triangles: u32,
    /// Triangles of the chain: those that cast. Both caps together have twice as many.
    pub facing_triangles: u32,
    /// Its silhouette quads, in [`Volumes::quads`]; those of its parts, one after the other, if it
    /// has any.
    pub quads: Range<u32>,
    /// How many of them an eye in its range has to draw: all, if it has parts.
    pub in_range: RangePrefix,
    /// Its chain, in [`Volumes::chains`]; objects' triangles come last.
    pub chain: Range<u32>,
    /// No point is behind more of its casters than this: proven, and only as tight as it takes to
    /// stay within [`VolumeBuilder::layers`](super::VolumeBuilder::layers).
    pub layers_bound: u32,
    /// Two or more if that is beyond what the mask holds in one go; else empty, and the light is
    /// drawn as a whole.
    pub parts: Vec<Part>,
    /// When it was built, 0 if it was not: the same stamp under the same light's number means the
    /// same volume.
    pub stamp: u64,
    /// Whether the last build kept it.
    pub cached: bool,
    /// Time spent on it when it was built, in microseconds.
    pub build_us: f32,
}

/// The volumes of all lights, and what they were built from.
///
/// What is built is kept: whoever changes quads or chains by hand starts the next build from a new
/// one.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Volumes {
    /// One entry a light.
    pub lights: Vec<LightVolume>,
    /// Silhouette quads; each light's are contiguous, with unused ones in between.
    pub quads: Vec<Quad>,
    /// Chains: the triangles that caps are made of; each light's are contiguous.
    pub chains: Vec<Chain>,
    pub(super) keys: Vec<Key>,
    pub(super) quad_store: Store,
    pub(super) chain_store: Store,
    pub(super) world: Seen,
    pub(super) culls: Culls,
    pub(super) construction: Construction,
    pub(super) layers: LayerLimit,
}

impl LightVolume {
    /// Where all its chains lie: the whole one, then those of its parts.
    pub(super) fn chains(&self) -> Range<u32> {
        let last = self.parts.last().map_or(&self.chain, |part| &part.chain);
        self.chain.start..last.end
    }

    /// Moves all ranges, so that quads and chains begin here.
    pub(super) fn move_to(&mut self, quads: u32, chains: u32) {
        let (old_quads, old_chains) = (self.quads.start, self.chain.start);
        let moved =
            |range: &Range<u32>, old: u32, new: u32| range.start - old + new..range.end - old + new;
        for part in &mut self.parts {
            part.quads = moved(&part.quads, old_quads, quads);
            part.chain = moved(&part.chain, old_chains, chains);
        }
        self.quads = moved(&self.quads, old_quads, quads);
        self.chain = moved(&self.chain, old_chains, chains);
    }
}

impl Volumes {
    /// No volume at all for each of `lights` lights.
    pub fn empty(lights: usize) -> Self {
        Self {
            lights: vec![LightVolume::default(); lights],
            ..Self::default()
        }
    }

    /// The quads of one light.
    pub fn quads_of(&self, light: usize) -> &[Quad] {
        let range = &self.lights[light].quads;
        &self.quads[range.start as usize..range.end as usize]
    }

    /// The chain of one light.
    pub fn chain_of(&self, light: usize) -> &[Chain] {
        let range = &self.lights[light].chain;
        &self.chains[range.start as usize..range.end as usize]
    }

    /// The triangles of one light's chain, ascending.
    pub fn chain_triangles(&self, light: usize) -> impl Iterator<Item = ChainTriangle> {
        self.chain_of(light).iter().flat_map(Chain::triangles)
    }

    /// The quads of a part.
    pub fn quads_of_part(&self, part: &Part) -> &[Quad] {
        &self.quads[part.quads.start as usize..part.quads.end as usize]
    }

    /// The chain of a part.
    pub fn chain_of_part(&self, part: &Part) -> &[Chain] {
        &self.chains[part.chain.start as usize..part.chain.end as usize]
    }

    /// Whether every light's volume is closed, and each of its parts is.
    pub fn check_closed(&self, world: &World) -> Result<(), ClosureFault> {
        (0..self.lights.len())
            .into_par_iter()
            .try_for_each(|light| {
                check_closed(world, self.chain_triangles(light), self.quads_of(light))?;
                self.lights[light].parts.iter().try_for_each(|part| {
                    let chain = self.chain_of_part(part).iter().flat_map(Chain::triangles);
                    check_closed(world, chain, self.quads_of_part(part))
                })
            })
    }

    /// The parts of [`Volumes::quads`] that were written since a copy of this version was made.
    pub fn quads_since(&self, copied: Version) -> impl Iterator<Item = Range<usize>> {
        self.quad_store.since(copied, self.quads.len())
    }

    /// The version of [`Volumes::quads`] as they are.
    pub fn quads_version(&self) -> Version {
        self.quad_store.version()
    }
}
