//! Volumes of many lights: built in parallel, kept as long as they are right.
//!
//! Takes a world and lights; brings [`Volumes`] up to date. They do not depend on the eye, so that
//! several views share them. A light is built again only if it changed, or if the geometry in its
//! range did; where only objects moved, what its fixed triangles cast is kept. Casters hidden behind
//! others are looked for once a light stands still, as many at a time as the host allows. Lights are
//! built in chunks whose results are stored in the order of the lights, so the outcome is the same
//! whatever the number of threads.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use super::cache::{Job, Kept};
#[cfg(debug_assertions)]
use super::check_closed;
use super::clock::{BuildStage, Clock, StageClock};
use super::construction::{Makes, Marks};
use super::layers::Layers;
use super::{
    BuildTimes, Chain, Construction, Crow, HiddenScratch, LayerLimit, LightVolume, Part, Quad,
    RangePrefix, Volumes, drop_hidden, facing, range_first,
};
use crate::cull::{Cull, Culls};
use crate::light::Light;
use crate::stamp;
use crate::world::{Layer, Subset, World, query};

/// Builds volumes; keeps the scratch memory between builds.
#[derive(Debug)]
pub struct VolumeBuilder {
    /// Which steps skip work. Changing them rebuilds what they change.
    pub culls: Culls,
    /// What makes quads of chains. Changing it rebuilds everything.
    pub construction: Construction,
    /// Casters among which one [`VolumeBuilder::build`] looks for hidden ones: what it may spend on
    /// lights that came to rest. Some 0.3 microseconds each.
    pub hidden_budget: u32,
    /// What the mask can hold that volumes are counted in: lights that may have more layers are
    /// built in parts. Changing it rebuilds everything.
    pub layers: LayerLimit,
    scratch: Mutex<Vec<Scratch>>,
    chunks: Vec<Built>,
    /// Of the last world that was built by [`Construction::Crow`].
    crow: Crow,
}

/// What one thread needs while it builds.
#[derive(Debug, Default)]
struct Scratch {
    subset: Subset,
    chain: Vec<Chain>,
    marks: Marks,
    sorting: Vec<Quad>,
    hidden: HiddenScratch,
    layers: Layers,
}

/// What one chunk of lights became.
#[derive(Debug, Default)]
pub(super) struct Built {
    pub(super) lights: Vec<LightVolume>,
    /// Of each light.
    pub(super) kept: Vec<Kept>,
    pub(super) quads: Vec<Quad>,
    pub(super) chains: Vec<Chain>,
}

impl Default for VolumeBuilder {
    fn default() -> Self {
        Self::new(Culls::EVERY)
    }
}

impl VolumeBuilder {
    /// Skips what `culls` say.
    pub fn new(culls: Culls) -> Self {
        Self {
            culls,
            construction: Construction::Counter,
            hidden_budget: 1 << 14,
            layers: LayerLimit::STENCIL,
            scratch: Mutex::default(),
            chunks: Vec::new(),
            crow: Crow::default(),
        }
    }

    /// Brings `volumes` up to date with the world and the lights. A light is known by its place in
    /// the list. Lights for which `wanted` is false and whose volume is not there already get an
    /// empty one, until they are wanted. Gives the number of lights built.
    ///
    /// A light that came to rest is built once more, without its hidden casters, by one of the next
    /// calls; one with more casters than [`VolumeBuilder::hidden_budget`] waits for
    /// [`VolumeBuilder::settle`].
    pub fn build(
        &mut self,
        world: &World,
        lights: &[Light],
        wanted: impl Fn(&Light) -> bool,
        volumes: &mut Volumes,
    ) -> usize {
        let budget = Some(self.hidden_budget);
        self.update(world, lights, wanted, budget, volumes)
    }

    /// As [`VolumeBuilder::build`], and finishes what further calls would do: for loading screens,
    /// tools, and lights that will not move.
    pub fn settle(
        &mut self,
        world: &World,
        lights: &[Light],
        wanted: impl Fn(&Light) -> bool,
        volumes: &mut Volumes,
    ) -> usize {
        self.update(world, lights, wanted, None, volumes)
    }

    /// Builds one light from nothing, as [`VolumeBuilder::settle`] does, on the calling thread and
    /// for the times alone: the volume is dropped. Nothing is built of a light that is not usable.
    pub fn time_light(&mut self, world: &World, light: &Light) -> BuildTimes {
        if !light.is_usable() {
            return BuildTimes::default();
        }
        if self.construction == Construction::Crow {
            self.crow.update(world);
        }
        let mut scratch = lock(&self.scratch).pop().unwrap_or_default();
        scratch.marks.fit(world, self.construction);
        if self.chunks.is_empty() {
            self.chunks.push(Built::default());
        }
        let out = &mut self.chunks[0];
        out.clear();
        let makes = Makes {
            construction: self.construction,
            crow: &self.crow,
            layers: self.layers,
        };
        let hide = self.culls.has(Cull::Hidden) && self.construction == Construction::Counter;
        let mut clock = StageClock::start();
        build_one(
            world,
            light,
            None,
            hide,
            &makes,
            &mut scratch,
            out,
            &mut clock,
        );
        lock(&self.scratch).push(scratch);
        clock.times
    }

    /// `budget`: casters among which to look for hidden ones; all if there is none.
    fn update(
        &mut self,
        world: &World,
        lights: &[Light],
        wanted: impl Fn(&Light) -> bool,
        budget: Option<u32>,
        volumes: &mut Volumes,
    ) -> usize {
        let construction = self.construction;
        let culls = match construction {
            Construction::Counter => self.culls,
            Construction::Brute | Construction::Crow => self.culls.without(Cull::Hidden),
        };
        let layers = self.layers;
        volumes.forget_changes(world, lights, culls, construction, layers);
        if construction == Construction::Crow {
            self.crow.update(world);
        }
        let jobs = &volumes.jobs(lights, wanted, budget)[..];
        let length = (jobs.len() / (8 * rayon::current_num_threads())).clamp(1, 16);
        let chunk_count = jobs.len().div_ceil(length);
        self.chunks
            .resize_with(chunk_count.max(self.chunks.len()), Built::default);
        let (pool, old) = (&self.scratch, &*volumes);
        let makes = Makes {
            construction,
            crow: &self.crow,
            layers,
        };
        let build_chunk = |out: &mut Built, jobs: &[Job]| {
            let mut scratch = lock(pool).pop().unwrap_or_default();
            scratch.marks.fit(world, construction);
            out.clear();
            for job in jobs {
                let (light, kept) = (&lights[job.number], old.kept_fixed(job.number));
                let hide = job.hide && old.culls.has(Cull::Hidden);
                build_one(world, light, kept, hide, &makes, &mut scratch, out, &mut ());
            }
            lock(pool).push(scratch);
        };
        match (&mut self.chunks[..chunk_count], jobs) {
            ([chunk], jobs) => build_chunk(chunk, jobs),
            (chunks, jobs) => chunks
                .par_iter_mut()
                .zip(jobs.par_chunks(length))
                .for_each(|(out, jobs)| build_chunk(out, jobs)),
        }
        let stamp = stamp::next();
        for (chunk, jobs) in self.chunks.iter().zip(jobs.chunks(length)) {
            for (i, job) in jobs.iter().enumerate() {
                volumes.put(*job, &lights[job.number], chunk, i, stamp);
            }
        }
        volumes.compact(stamp);
        jobs.len()
    }
}

/// Scratch is valid whatever happened to the thread that last held it: its marks are
/// only ever returned zeroed.
fn lock(pool: &Mutex<Vec<Scratch>>) -> std::sync::MutexGuard<'_, Vec<Scratch>> {
    pool.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Built {
    fn clear(&mut self) {
        self.lights.clear();
        self.kept.clear();
        self.quads.clear();
        self.chains.clear();
    }
}

/// Chains longer than this leave no scratch behind.
const MANY_CLUSTERS: usize = 1 << 11;

fn casters(chain: &[Chain]) -> u32 {
    chain.iter().map(Chain::len).sum::<usize>() as u32
}

#[expect(clippy::too_many_arguments, reason = "two callers, one line each")]
fn build_one<C: Clock>(
    world: &World,
    light: &Light,
    kept: Option<(&[Chain], u32)>,
    hide: bool,
    makes: &Makes<'_>,
    scratch: &mut Scratch,
    out: &mut Built,
    clock: &mut C,
) {
    let start = Instant::now();
    let (first_quad, first_chain) = (out.quads.len(), out.chains.len());
    scratch.chain.clear();
    let mut subset_triangles = match kept {
        Some((chain, subset)) => {
            scratch.chain.extend_from_slice(chain);
            subset
        }
        None => {
            query(world, Layer::Fixed, light, &mut scratch.subset);
            clock.lap(BuildStage::Query);
            facing(world, light, &scratch.subset, &mut scratch.chain);
            clock.lap(BuildStage::Facing);
            scratch.subset.len() as u32
        }
    };
    if hide {
        let clusters = scratch.chain.len();
        drop_hidden(world, light, &mut scratch.chain, &mut scratch.hidden);
        if clusters > MANY_CLUSTERS {
            // A sun over a large world needs a hundred megabytes, once.
            scratch.hidden = HiddenScratch::default();
        }
    }
    clock.lap(BuildStage::Hidden);
    out.kept.push(Kept {
        chain: scratch.chain.len() as u32,
        casters: casters(&scratch.chain),
        subset: subset_triangles,
    });
    if !world.objects.is_empty() {
        query(world, Layer::Objects, light, &mut scratch.subset);
        clock.lap(BuildStage::Query);
        facing(world, light, &scratch.subset, &mut scratch.chain);
        clock.lap(BuildStage::Facing);
        subset_triangles += scratch.subset.len() as u32;
    }
    let chain = &scratch.chain;
    out.chains.extend_from_slice(chain);
    let mut volume = LightVolume {
        subset_triangles,
        facing_triangles: casters(chain),
        layers_bound: scratch
            .layers
            .bound(world, light, chain, makes.layers.whole),
        chain: first_chain as u32..out.chains.len() as u32,
        ..LightVolume::default()
    };
    let parts = match volume.layers_bound > makes.layers.whole {
        true => (scratch.layers).split(world, light, chain, makes.layers.part),
        false => Vec::new(),
    };
    clock.lap(BuildStage::Layers);
    if parts.len() < 2 {
        makes.quads(world, chain, &mut scratch.marks, &mut out.quads);
        clock.lap(BuildStage::Counters);
        let quads = &mut out.quads[first_quad..];
        volume.in_range = range_first(world, light, quads, &mut scratch.sorting);
    } else {
        for chain in &parts {
            let (quads, chains) = (out.quads.len() as u32, out.chains.len() as u32);
            makes.quads(world, chain, &mut scratch.marks, &mut out.quads);
            clock.lap(BuildStage::Counters);
            out.chains.extend_from_slice(chain);
            volume.parts.push(Part {
                quads: quads..out.quads.len() as u32,
                chain: chains..out.chains.len() as u32,
            });
        }
        volume.in_range = RangePrefix::all((out.quads.len() - first_quad) as u32);
    }
    volume.quads = first_quad as u32..out.quads.len() as u32;
    clock.lap(BuildStage::Emission);
    #[cfg(debug_assertions)]
    if makes.construction != Construction::Crow {
        let of = |range: &std::ops::Range<u32>| range.start as usize..range.end as usize;
        let whole = [(&volume.chain, &volume.quads)].into_iter();
        let parts = volume.parts.iter().map(|part| (&part.chain, &part.quads));
        for (chain, quads) in whole.chain(parts) {
            let chain = out.chains[of(chain)].iter().flat_map(Chain::triangles);
            if let Err(fault) = check_closed(world, chain, &out.quads[of(quads)]) {
                panic!("{fault}");
            }
        }
    }
    volume.build_us = start.elapsed().as_secs_f32() * 1e6;
    out.lights.push(volume);
}
