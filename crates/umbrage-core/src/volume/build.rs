//! Volumes of many lights, in parallel, with nothing allocated in the steady state.
//!
//! Takes a world and lights; gives [`Volumes`]. They do not depend on the eye. Lights are cut into
//! chunks of fixed length whose results are joined in order, so the outcome is the same whatever
//! the number of threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;

use super::{Chain, ChainTriangle, ClosureFault, Quad, check_closed, counter, facing};
use crate::light::Light;
use crate::world::{Subset, World, query};

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
    /// Its chain, in [`Volumes::chains`].
    pub chain: Range<u32>,
    /// Time spent on it, in microseconds.
    pub build_us: f32,
}

/// The volumes of all lights.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    /// One entry a light.
    pub lights: Vec<LightVolume>,
    /// Silhouette quads, light after light.
    pub quads: Vec<Quad>,
    /// Chains, light after light: the triangles that caps are made of.
    pub chains: Vec<Chain>,
}

/// Keeps the scratch memory between builds.
#[derive(Debug, Default)]
pub struct VolumeBuilder {
    scratch: Mutex<Vec<Scratch>>,
    chunks: Vec<Volumes>,
}

/// What one thread needs while it builds.
#[derive(Debug, Default)]
struct Scratch {
    subset: Subset,
    touched: Vec<Quad>,
    counters: Vec<i32>,
}

const LIGHTS_PER_CHUNK: usize = 16;

impl VolumeBuilder {
    /// Builds the volumes of the lights for which `wanted` is true into `volumes`, replacing what
    /// was there; the others get an empty one.
    pub fn build(
        &mut self,
        world: &World,
        lights: &[Light],
        wanted: impl Fn(&Light) -> bool + Sync,
        volumes: &mut Volumes,
    ) {
        let chunk_count = lights.len().div_ceil(LIGHTS_PER_CHUNK);
        self.chunks
            .resize_with(chunk_count.max(self.chunks.len()), Volumes::default);
        let pool = &self.scratch;
        self.chunks[..chunk_count]
            .par_iter_mut()
            .zip(lights.par_chunks(LIGHTS_PER_CHUNK))
            .for_each(|(out, lights)| {
                let mut scratch = lock(pool).pop().unwrap_or_default();
                scratch.counters.resize(world.edges.vertices.len(), 0);
                out.clear();
                for light in lights {
                    if wanted(light) {
                        build_one(world, light, &mut scratch, out);
                    } else {
                        out.lights.push(LightVolume::default());
                    }
                }
                lock(pool).push(scratch);
            });

        volumes.clear();
        for chunk in &self.chunks[..chunk_count] {
            let (quad_base, chain_base) = (volumes.quads.len(), volumes.chains.len());
            let shift = |r: &Range<u32>, by: usize| r.start + by as u32..r.end + by as u32;
            volumes
                .lights
                .extend(chunk.lights.iter().map(|light| LightVolume {
                    quads: shift(&light.quads, quad_base),
                    chain: shift(&light.chain, chain_base),
                    ..light.clone()
                }));
            volumes.quads.extend_from_slice(&chunk.quads);
            volumes.chains.extend_from_slice(&chunk.chains);
        }
    }
}

/// Scratch is valid whatever happened to the thread that last held it: counters are only ever
/// returned zeroed.
fn lock(pool: &Mutex<Vec<Scratch>>) -> std::sync::MutexGuard<'_, Vec<Scratch>> {
    pool.lock().unwrap_or_else(PoisonError::into_inner)
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

    fn clear(&mut self) {
        self.lights.clear();
        self.quads.clear();
        self.chains.clear();
    }
}

fn build_one(world: &World, light: &Light, scratch: &mut Scratch, out: &mut Volumes) {
    let start = Instant::now();
    let (first_quad, first_chain) = (out.quads.len() as u32, out.chains.len() as u32);
    query(world, light, &mut scratch.subset);
    facing(world, light, &scratch.subset, &mut out.chains);
    let cast = &out.chains[first_chain as usize..];
    counter(
        world,
        cast,
        &mut scratch.counters,
        &mut scratch.touched,
        &mut out.quads,
    );
    #[cfg(debug_assertions)]
    if let Err(fault) = check_closed(
        world,
        cast.iter().flat_map(Chain::triangles),
        &out.quads[first_quad as usize..],
    ) {
        panic!("{fault}");
    }
    out.lights.push(LightVolume {
        subset_triangles: scratch.subset.len() as u32,
        facing_triangles: cast.iter().map(Chain::len).sum::<usize>() as u32,
        quads: first_quad..out.quads.len() as u32,
        chain: first_chain..out.chains.len() as u32,
        build_us: start.elapsed().as_secs_f32() * 1e6,
    });
}
