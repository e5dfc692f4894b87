//! What volumes were built from, and so which of them are still right.
//!
//! Takes a world and lights; says which volumes to build, and stores what was built. A light is
//! stale if it changed, or if the fixed triangles did; where only objects in its range moved, the
//! chain of its fixed triangles stays. Boxes of what moved, before and after, decide that.

use std::ops::Range;

use super::build::Built;
use super::store::Block;
use super::{Chain, Construction, LayerLimit, LightVolume, Volumes};
use crate::cull::{Cull, Culls};
use crate::light::Light;
use crate::world::{Reach, World};

/// What one light was built from, and where it lies.
#[derive(Clone, Debug, Default)]
pub(super) struct Key {
    light: Option<Light>,
    fixed: Fixed,
    /// What objects cast is right.
    objects: bool,
    kept: Kept,
    quads: Block,
    chain: Block,
}

/// What is known of what a light's fixed triangles cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Fixed {
    /// Nothing.
    #[default]
    Stale,
    /// It is right, with hidden casters in it.
    Plain,
    /// It is right, and final.
    Settled,
}

/// The fixed triangles' part of a light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kept {
    /// Length of its chain, in clusters.
    pub(super) chain: u32,
    /// Triangles in that.
    pub(super) casters: u32,
    /// Triangles in the subset.
    pub(super) subset: u32,
}

/// One light to build.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job {
    pub(super) number: usize,
    /// Look for hidden casters.
    pub(super) hide: bool,
}

impl Key {
    fn is_stale(&self) -> bool {
        self.fixed == Fixed::Stale || !self.objects
    }
}

impl Volumes {
    /// Marks as stale what is not of these lights in this world.
    pub(super) fn forget_changes(
        &mut self,
        world: &World,
        lights: &[Light],
        culls: Culls,
        construction: Construction,
        layers: LayerLimit,
    ) {
        for key in self.keys.iter_mut().skip(lights.len()) {
            self.quad_store.free(&mut key.quads);
            self.chain_store.free(&mut key.chain);
        }
        self.keys.resize_with(lights.len(), Key::default);
        self.lights.resize_with(lights.len(), LightVolume::default);
        let changes = self.world.update(world);
        let all = !culls.has(Cull::Cache)
            || culls.has(Cull::Hidden) != self.culls.has(Cull::Hidden)
            || self.construction != construction
            || self.layers != layers
            || changes.fixed;
        (self.culls, self.construction, self.layers) = (culls, construction, layers);
        let moved = changes.boxes;
        for ((key, volume), light) in self.keys.iter_mut().zip(&mut self.lights).zip(lights) {
            if all || key.light != Some(*light) {
                (key.fixed, key.objects) = (Fixed::Stale, false);
            } else if !moved.is_empty() {
                let reach = Reach::new(light);
                key.objects &= !moved.iter().any(|at| reach.touches_box(*at));
            }
            if key.is_stale() {
                *volume = LightVolume::default();
            } else {
                volume.cached = true;
            }
        }
    }

    /// The chain of a light's fixed triangles and the size of their subset, if still right.
    pub(super) fn kept_fixed(&self, number: usize) -> Option<(&[Chain], u32)> {
        let key = &self.keys[number];
        let first = key.chain.first as usize;
        (key.fixed != Fixed::Stale).then(|| {
            let chain = &self.chains[first..first + key.kept.chain as usize];
            (chain, key.kept.subset)
        })
    }

    /// The usable, wanted lights that are stale, and of those that are merely not settled as many as
    /// `budget` casters make up; without a budget all of them, to be settled at once.
    pub(super) fn jobs(
        &self,
        lights: &[Light],
        wanted: impl Fn(&Light) -> bool,
        budget: Option<u32>,
    ) -> Vec<Job> {
        let mut left = budget;
        let mut jobs = Vec::new();
        for (number, (key, light)) in self.keys.iter().zip(lights).enumerate() {
            let after = left.map(|left| left.checked_sub(key.kept.casters));
            let hide = match key.fixed {
                Fixed::Settled => false,
                Fixed::Plain => after != Some(None),
                Fixed::Stale => budget.is_none(),
            };
            if (key.is_stale() || hide) && light.is_usable() && wanted(light) {
                if let (true, Some(after)) = (hide, after) {
                    left = after;
                }
                jobs.push(Job { number, hide });
            }
        }
        jobs
    }

    /// Stores the light of a job, the `i`th of a chunk.
    pub(super) fn put(&mut self, job: Job, light: &Light, built: &Built, i: usize, stamp: u64) {
        let number = job.number;
        let volume = &built.lights[i];
        let of = |r: &Range<u32>| r.start as usize..r.end as usize;
        let (quads, chain) = (
            &built.quads[of(&volume.quads)],
            &built.chains[of(&volume.chains())],
        );
        let key = &mut self.keys[number];
        self.quad_store
            .put(&mut self.quads, &mut key.quads, quads, stamp);
        self.chain_store
            .put(&mut self.chains, &mut key.chain, chain, stamp);
        key.kept = built.kept[i];
        (key.light, key.objects) = (Some(*light), true);
        key.fixed = match job.hide || !self.culls.has(Cull::Hidden) || key.fixed == Fixed::Settled {
            true => Fixed::Settled,
            false => Fixed::Plain,
        };
        let mut stored = LightVolume {
            stamp,
            ..volume.clone()
        };
        stored.move_to(key.quads.first, key.chain.first);
        self.lights[number] = stored;
    }

    /// Closes the gaps once they make up half of the arrays.
    pub(super) fn compact(&mut self, stamp: u64) {
        let quads = self.keys.iter_mut().map(|key| &mut key.quads);
        let moved = self.quad_store.compact(&mut self.quads, quads, stamp);
        let chains = self.keys.iter_mut().map(|key| &mut key.chain);
        let moved = moved | self.chain_store.compact(&mut self.chains, chains, stamp);
        if moved {
            for (volume, key) in self.lights.iter_mut().zip(&self.keys) {
                if !key.is_stale() {
                    volume.move_to(key.quads.first, key.chain.first);
                }
            }
        }
    }
}
