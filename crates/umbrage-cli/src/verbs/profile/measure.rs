//! The figures of the scene as it is.

use std::time::Instant;

use umbrage_core::Light;
use umbrage_core::frame::LightPath;
use umbrage_core::volume::{BuildTimes, Chain, ChainTriangle, facing};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::picture::Lit;
use umbrage_lab::profile::{Counter, GpuCost, LightCounts};
use umbrage_lab::rendering::Rendering;
use umbrage_lab::stage::StageLight;
use umbrage_lab::timer::{StageTimes, median, medians};

use super::lights;
use crate::error::CliError;
use crate::setting::Setting;

/// What one light does, and what it takes.
#[derive(Clone, Debug)]
pub(super) struct Figures {
    pub(super) path: LightPath,
    pub(super) cached: bool,
    pub(super) work: Work,
    pub(super) build: BuildTimes,
    pub(super) upload_us: f64,
    /// None without timestamps; zero if it is not drawn.
    pub(super) gpu: Option<GpuCost>,
}

/// What a light has to do, as far as it can be counted: what costs are predicted from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Work {
    pub(super) subset: u32,
    /// Triangles that cast, hidden ones included.
    pub(super) casters: u32,
    pub(super) facing: u32,
    pub(super) quads: u32,
    pub(super) quads_drawn: u32,
    pub(super) cap_triangles: u32,
    /// Pixels.
    pub(super) scissor: u64,
    pub(super) counts: LightCounts,
}

/// Everything measured of the scene as it is.
#[derive(Debug)]
pub(super) struct Base {
    pub(super) method: Method,
    /// Of which every figure is the median.
    pub(super) rounds: usize,
    /// The ordinary frame.
    pub(super) frame: StageTimes,
    pub(super) lit: Lit,
    pub(super) exposure: f32,
    /// One a light.
    pub(super) lights: Vec<Figures>,
    /// Lights that the view draws.
    pub(super) drawn: Vec<usize>,
    /// Triangles of the world in each light's volume.
    pub(super) casters: Vec<Vec<u32>>,
    /// All volumes built anew, on one thread.
    pub(super) build_all_us: f64,
    pub(super) has_gpu_times: bool,
    /// How often each light is drawn for its time.
    pub(super) times: Vec<u32>,
    pub(super) rendering: Rendering,
    pub(super) counter: Counter,
}

/// Microseconds that drawing a light for its time should take, after the first time, and how many
/// times more than that at most. A light that takes longer than `ONCE_US` is drawn once: what a pass as
/// such takes is little beside it.
const LONG_US: f64 = 4000.0;
const ONCE_US: f64 = 20_000.0;
const MOST_TIMES: u32 = 16;

impl Base {
    /// What lights take to draw, and to build and hand over, in microseconds.
    pub(super) fn cost_of(&self, lights: &[usize]) -> (f64, f64) {
        let figures = lights.iter().map(|&light| &self.lights[light]);
        figures.fold((0.0, 0.0), |(drawn, built), figures| {
            (
                drawn + figures.gpu.map_or(0.0, |gpu| gpu.total_us),
                built + figures.build.total_us() + figures.upload_us,
            )
        })
    }

    /// Times ordinary frames, then takes every light apart, in so many rounds.
    pub(super) fn measure(
        lab: &mut Lab,
        setting: &Setting,
        method: Method,
        rounds: usize,
    ) -> Result<Self, CliError> {
        let Setting {
            stage,
            lights,
            view,
        } = setting;
        let mut rendering = lab.begin(stage, view, method)?;
        for _ in 0..2 {
            lab.draw(&mut rendering, stage, lights, view, Instant::now())?;
        }
        let cached: Vec<bool> = lab.volumes.lights.iter().map(|v| v.cached).collect();
        lab.read_calls(&rendering)?;
        let lit = lab.lit(&rendering)?;
        let exposure = lit.exposure();
        let (drawn, built) = (lights::drawn(lab), lights::built(lab));
        let once: Vec<(usize, u32)> = drawn.iter().map(|&light| (light, 1)).collect();
        let first = lab.time_lights(&mut rendering, stage, lights, view, &once)?;
        let has_gpu_times = first.is_some();
        let mut times = vec![1; lights.len()];
        for (&light, cost) in drawn.iter().zip(first.into_iter().flatten()) {
            let more = (LONG_US / cost.total_us.max(1.0)).ceil() as u32;
            times[light] = match cost.total_us {
                us if us > ONCE_US => 1,
                _ => 1 + more.clamp(2, MOST_TIMES),
            };
        }
        let often: Vec<(usize, u32)> = drawn.iter().map(|&light| (light, times[light])).collect();
        let mut all = Rounds::default();
        for _ in 0..rounds {
            // Frames are as they are one after the other.
            for frame in 0..2 {
                lab.draw(&mut rendering, stage, lights, view, Instant::now())?;
                all.frames.extend((frame > 0).then_some(lab.times));
            }
            lab.read_calls(&rendering)?;
            let round = lab.time_lights(&mut rendering, stage, lights, view, &often)?;
            all.gpu.extend(round);
            all.builds.push(lab.build_times(stage, &built));
            all.uploads.push(lab.upload_times(&built)?);
            all.build_all_us.push(lab.build_all_us(stage, &built)?);
        }
        let counter = lab.counter(stage, lights, view, exposure)?;
        let work = work(lab, setting, lights, &counter)?;
        let casters = (0..lights.len()).map(|light| {
            let chain = lab.volumes.chain_triangles(light);
            chain.map(ChainTriangle::triangle).collect()
        });
        let casters = casters.collect();
        let mut figures: Vec<Figures> = (0..lights.len())
            .map(|light| Figures {
                path: lab.path(light),
                cached: cached[light],
                work: work[light],
                build: BuildTimes::default(),
                upload_us: 0.0,
                gpu: has_gpu_times.then_some(GpuCost::default()),
            })
            .collect();
        for (place, &light) in drawn.iter().enumerate() {
            figures[light].gpu = has_gpu_times.then(|| all.gpu_of(place));
        }
        for (place, &light) in built.iter().enumerate() {
            figures[light].build = all.build_of(place);
            figures[light].upload_us = median_at(&all.uploads, place, |us| *us);
        }
        Ok(Self {
            method,
            rounds,
            frame: medians(&all.frames),
            lit,
            exposure,
            lights: figures,
            drawn,
            casters,
            build_all_us: median(&mut all.build_all_us).unwrap_or_default(),
            has_gpu_times,
            times,
            rendering,
            counter,
        })
    }
}

/// What was measured, round by round.
#[derive(Default)]
struct Rounds {
    frames: Vec<StageTimes>,
    /// Of the lights drawn, in each round.
    gpu: Vec<Vec<GpuCost>>,
    /// Of the lights built.
    builds: Vec<Vec<BuildTimes>>,
    uploads: Vec<Vec<f64>>,
    build_all_us: Vec<f64>,
}

impl Rounds {
    fn gpu_of(&self, place: usize) -> GpuCost {
        GpuCost {
            volume_us: median_at(&self.gpu, place, |cost| cost.volume_us),
            total_us: median_at(&self.gpu, place, |cost| cost.total_us),
        }
    }

    fn build_of(&self, place: usize) -> BuildTimes {
        let of = |stage: fn(&BuildTimes) -> f64| median_at(&self.builds, place, stage);
        let mut build = BuildTimes::default();
        build.query_us = of(|b| b.query_us);
        build.facing_us = of(|b| b.facing_us);
        build.hidden_us = of(|b| b.hidden_us);
        build.layers_us = of(|b| b.layers_us);
        build.counters_us = of(|b| b.counters_us);
        build.emission_us = of(|b| b.emission_us);
        build
    }
}

/// The median over all rounds of what stands at one place.
fn median_at<T>(rounds: &[Vec<T>], place: usize, value: impl Fn(&T) -> f64) -> f64 {
    let mut values: Vec<f64> = rounds.iter().map(|round| value(&round[place])).collect();
    median(&mut values).unwrap_or_default()
}

/// What each of `lights` has to do in what the lab has prepared; `counter` is of that.
pub(super) fn work(
    lab: &Lab,
    setting: &Setting,
    lights: &[StageLight],
    counter: &Counter,
) -> Result<Vec<Work>, CliError> {
    let drawn = lights::drawn(lab);
    let counts = counter.count(&drawn)?;
    let mut finder = Finder::default();
    let mut all: Vec<Work> = (lab.volumes.lights.iter().zip(&lab.plan.lights))
        .enumerate()
        .map(|(light, (volume, plan))| Work {
            subset: volume.subset_triangles,
            casters: match volume.stamp {
                0 => 0,
                _ => finder.casters(&setting.stage.world, &lights[light].light),
            },
            facing: volume.facing_triangles,
            quads: volume.quads.len() as u32,
            quads_drawn: lab.quads_drawn(light),
            cap_triangles: lab.plan.cap_triangles(light) as u32,
            scissor: plan.scissor.area(),
            counts: LightCounts::default(),
        })
        .collect();
    for (light, counts) in drawn.into_iter().zip(counts) {
        all[light].counts = counts;
    }
    Ok(all)
}

/// Finds casters, hidden ones included.
#[derive(Default)]
struct Finder {
    subset: Subset,
    chain: Vec<Chain>,
}

impl Finder {
    fn casters(&mut self, world: &World, light: &Light) -> u32 {
        self.chain.clear();
        for layer in [Layer::Fixed, Layer::Objects] {
            query(world, layer, light, &mut self.subset);
            facing(world, light, &self.subset, &mut self.chain);
        }
        self.chain.iter().map(Chain::len).sum::<usize>() as u32
    }
}
