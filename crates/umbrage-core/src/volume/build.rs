//! Volumes of many lights: built in parallel, kept as long as they are right.
//!
//! Takes a world and lights; brings [`Volumes`] up to date. They do not depend on the eye, so that
//! several views share them. A light is built again only if it changed, or if the geometry in its
//! range did; where only objects moved, what its fixed triangles cast is kept. Casters hidden behind
//! others are looked for once a light stands still, as many at a time as the host allows. Lights are
//! built in chunks whose results are stored in the order of the lights, so the outcome is the same
//! whatever the number of threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use super::store::{Block, Store, Version};
use super::{
    Chain, ChainTriangle, ClosureFault, HiddenScratch, Quad, RangePrefix, check_closed, counter,
    drop_hidden, facing, range_first,
};
use crate::cull::{Cull, Culls};
use crate::light::Light;
use crate::stamp;
use crate::world::{Layer, Reach, Subset, World, query};

/// One light's share of [`Volumes`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LightVolume {
    /// Triangles its query returned.
    pub subset_triangles: u32,
    /// Triangles of the chain: those that cast. Both caps together have twice as many.
    pub facing_triangles: u32,
    /// Its silhouette quads, in [`Volumes::quads`].
    pub quads: Range<u32>,
    /// How many of them an eye in its range has to draw.
    pub in_range: RangePrefix,
    /// Its chain, in [`Volumes::chains`]; objects' triangles come last.
    pub chain: Range<u32>,
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
pub struct Volumes {
    /// One entry a light.
    pub lights: Vec<LightVolume>,
    /// Silhouette quads; each light's are contiguous, with unused ones in between.
    pub quads: Vec<Quad>,
    /// Chains: the triangles that caps are made of; each light's are contiguous.
    pub chains: Vec<Chain>,
    keys: Vec<Key>,
    quad_store: Store,
    chain_store: Store,
    world: Seen,
    culls: Culls,
}

/// What one light was built from, and where it lies.
#[derive(Clone, Debug, Default)]
struct Key {
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
struct Kept {
    /// Length of its chain, in clusters.
    chain: u32,
    /// Triangles in that.
    casters: u32,
    /// Triangles in the subset.
    subset: u32,
}

/// One light to build.
#[derive(Clone, Copy, Debug)]
struct Job {
    number: usize,
    /// Look for hidden casters.
    hide: bool,
}

/// The world as it was at the last build.
#[derive(Clone, Debug, Default)]
struct Seen {
    stamp: u64,
    fixed: u64,
    /// When each object had last changed, and its box.
    objects: Vec<(u64, [glam::Vec3; 2])>,
}

/// Builds volumes; keeps the scratch memory between builds.
#[derive(Debug)]
pub struct VolumeBuilder {
    /// Which steps skip work. Changing them rebuilds what they change.
    pub culls: Culls,
    /// Casters among which one [`VolumeBuilder::build`] looks for hidden ones: what it may spend on
    /// lights that came to rest. Some 0.3 microseconds each.
    pub hidden_budget: u32,
    scratch: Mutex<Vec<Scratch>>,
    chunks: Vec<Built>,
}

/// What one thread needs while it builds.
#[derive(Debug, Default)]
struct Scratch {
    subset: Subset,
    chain: Vec<Chain>,
    touched: Vec<Quad>,
    counters: Vec<i32>,
    hidden: HiddenScratch,
}

/// What one chunk of lights became.
#[derive(Debug, Default)]
struct Built {
    lights: Vec<LightVolume>,
    /// Of each light.
    kept: Vec<Kept>,
    quads: Vec<Quad>,
    chains: Vec<Chain>,
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
            hidden_budget: 1 << 14,
            scratch: Mutex::default(),
            chunks: Vec::new(),
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
        volumes.forget_changes(world, lights, self.culls);
        let jobs = volumes.jobs(lights, wanted, Some(self.hidden_budget));
        self.work(world, lights, &jobs, volumes);
        jobs.len()
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
        volumes.forget_changes(world, lights, self.culls);
        let jobs = volumes.jobs(lights, wanted, None);
        self.work(world, lights, &jobs, volumes);
        jobs.len()
    }

    fn work(&mut self, world: &World, lights: &[Light], jobs: &[Job], volumes: &mut Volumes) {
        let length = (jobs.len() / (8 * rayon::current_num_threads())).clamp(1, 16);
        let chunk_count = jobs.len().div_ceil(length);
        self.chunks
            .resize_with(chunk_count.max(self.chunks.len()), Built::default);
        let (pool, old) = (&self.scratch, &*volumes);
        let build_chunk = |out: &mut Built, jobs: &[Job]| {
            let mut scratch = lock(pool).pop().unwrap_or_default();
            scratch.counters.resize(world.edges.vertices.len(), 0);
            out.clear();
            for job in jobs {
                let (light, kept) = (&lights[job.number], old.kept_fixed(job.number));
                let hide = job.hide && old.culls.has(Cull::Hidden);
                build_one(world, light, kept, hide, &mut scratch, out);
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
    }
}

/// Scratch is valid whatever happened to the thread that last held it: counters are only ever
/// returned zeroed.
fn lock(pool: &Mutex<Vec<Scratch>>) -> std::sync::MutexGuard<'_, Vec<Scratch>> {
    pool.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Key {
    fn is_stale(&self) -> bool {
        self.fixed == Fixed::Stale || !self.objects
    }
}

impl Built {
    fn clear(&mut self) {
        self.lights.clear();
        self.kept.clear();
        self.quads.clear();
        self.chains.clear();
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

    /// Whether every light's volume is closed.
    pub fn check_closed(&self, world: &World) -> Result<(), ClosureFault> {
        (0..self.lights.len())
            .into_par_iter()
            .try_for_each(|light| {
                check_closed(world, self.chain_triangles(light), self.quads_of(light))
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

    /// Marks as stale what is not of these lights in this world.
    fn forget_changes(&mut self, world: &World, lights: &[Light], culls: Culls) {
        for key in self.keys.iter_mut().skip(lights.len()) {
            self.quad_store.free(&mut key.quads);
            self.chain_store.free(&mut key.chain);
        }
        self.keys.resize_with(lights.len(), Key::default);
        self.lights.resize_with(lights.len(), LightVolume::default);
        let all = !culls.has(Cull::Cache)
            || culls.has(Cull::Hidden) != self.culls.has(Cull::Hidden)
            || self.world.fixed != world.fixed_stamp;
        self.culls = culls;
        let moved = self.world.update(world);
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
    fn kept_fixed(&self, number: usize) -> Option<(&[Chain], u32)> {
        let key = &self.keys[number];
        let first = key.chain.first as usize;
        (key.fixed != Fixed::Stale).then(|| {
            let chain = &self.chains[first..first + key.kept.chain as usize];
            (chain, key.kept.subset)
        })
    }

    /// The wanted lights that are stale, and of those that are merely not settled as many as
    /// `budget` casters make up; without a budget all of them, to be settled at once.
    fn jobs(
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
            if (key.is_stale() || hide) && wanted(light) {
                if let (true, Some(after)) = (hide, after) {
                    left = after;
                }
                jobs.push(Job { number, hide });
            }
        }
        jobs
    }

    /// Stores the light of a job, the `i`th of a chunk.
    fn put(&mut self, job: Job, light: &Light, built: &Built, i: usize, stamp: u64) {
        let number = job.number;
        let volume = &built.lights[i];
        let of = |r: &Range<u32>| r.start as usize..r.end as usize;
        let (quads, chain) = (
            &built.quads[of(&volume.quads)],
            &built.chains[of(&volume.chain)],
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
        self.lights[number] = LightVolume {
            quads: key.quads.range(),
            chain: key.chain.range(),
            stamp,
            ..volume.clone()
        };
    }

    /// Closes the gaps once they make up half of the arrays.
    fn compact(&mut self, stamp: u64) {
        let quads = self.keys.iter_mut().map(|key| &mut key.quads);
        let moved = self.quad_store.compact(&mut self.quads, quads, stamp);
        let chains = self.keys.iter_mut().map(|key| &mut key.chain);
        let moved = moved | self.chain_store.compact(&mut self.chains, chains, stamp);
        if moved {
            for (volume, key) in self.lights.iter_mut().zip(&self.keys) {
                if !key.is_stale() {
                    (volume.quads, volume.chain) = (key.quads.range(), key.chain.range());
                }
            }
        }
    }
}

/// The box of what is not there.
const NOWHERE: [glam::Vec3; 2] = [glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY];

impl Seen {
    /// Takes in the world as it is; gives the boxes of what moved, before and after.
    fn update(&mut self, world: &World) -> Vec<[glam::Vec3; 2]> {
        let mut moved = Vec::new();
        if self.stamp == world.stamp {
            return moved;
        }
        // A world of fewer objects than the last, as of an undo, has lost those.
        let common = world.objects.len().min(self.objects.len());
        moved.extend(self.objects.drain(common..).map(|(_, bounds)| bounds));
        self.objects.resize(world.objects.len(), (0, NOWHERE));
        for (seen, object) in self.objects.iter_mut().zip(&world.objects) {
            if seen.0 != object.changed {
                moved.extend([seen.1, object.bounds]);
                *seen = (object.changed, object.bounds);
            }
        }
        (self.stamp, self.fixed) = (world.stamp, world.fixed_stamp);
        moved
    }
}

/// Chains longer than this leave no scratch behind.
const MANY_CLUSTERS: usize = 1 << 11;

fn casters(chain: &[Chain]) -> u32 {
    chain.iter().map(Chain::len).sum::<usize>() as u32
}

fn build_one(
    world: &World,
    light: &Light,
    kept: Option<(&[Chain], u32)>,
    hide: bool,
    scratch: &mut Scratch,
    out: &mut Built,
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
            facing(world, light, &scratch.subset, &mut scratch.chain);
            scratch.subset.len() as u32
        }
    };
    if hide {
        drop_hidden(world, light, &mut scratch.chain, &mut scratch.hidden);
        if scratch.chain.len() > MANY_CLUSTERS {
            // A sun over a large world needs a hundred megabytes, once.
            scratch.hidden = HiddenScratch::default();
        }
    }
    out.kept.push(Kept {
        chain: scratch.chain.len() as u32,
        casters: casters(&scratch.chain),
        subset: subset_triangles,
    });
    if !world.objects.is_empty() {
        query(world, Layer::Objects, light, &mut scratch.subset);
        facing(world, light, &scratch.subset, &mut scratch.chain);
        subset_triangles += scratch.subset.len() as u32;
    }
    let Scratch {
        chain,
        touched,
        counters,
        ..
    } = scratch;
    counter(world, chain, counters, touched, &mut out.quads);
    out.chains.extend_from_slice(chain);
    let quads = &mut out.quads[first_quad..];
    let in_range = range_first(world, light, quads, touched);
    #[cfg(debug_assertions)]
    if let Err(fault) = check_closed(world, chain.iter().flat_map(Chain::triangles), quads) {
        panic!("{fault}");
    }
    out.lights.push(LightVolume {
        subset_triangles,
        facing_triangles: casters(chain),
        quads: first_quad as u32..out.quads.len() as u32,
        in_range,
        chain: first_chain as u32..out.chains.len() as u32,
        build_us: start.elapsed().as_secs_f32() * 1e6,
        ..LightVolume::default()
    });
}
