//! The figures of the scene as it is.

use umbrage_core::Light;
use umbrage_core::frame::LightPath;
use umbrage_core::volume::{BuildTimes, Chain, ChainTriangle, facing};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::picture::Lit;
use umbrage_lab::profile::{Counter, GpuCost, LightCounts, Meter};
use umbrage_lab::stage::StageLight;
use umbrage_lab::timer::StageTimes;

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
    pub(super) rounds: usize,
    /// The same for GPU times.
    pub(super) gpu_rounds: usize,
    /// The ordinary frame that took least.
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
    pub(super) meter: Meter,
    pub(super) counter: Counter,
}

impl Base {
    /// Times ordinary frames, then takes every light apart, in so many rounds on CPU and GPU.
    pub(super) fn measure(
        lab: &mut Lab,
        setting: &Setting,
        method: Method,
        [rounds, gpu_rounds]: [usize; 2],
    ) -> Result<Self, CliError> {
        let Setting {
            stage,
            lights,
            view,
        } = setting;
        let lit = lab.render(stage, lights, view, method, rounds)?;
        let timed = &lab.frames[1..];
        let least = timed.iter().min_by(|a, b| a.frame.total_cmp(&b.frame));
        let frame = least.copied().unwrap_or(lab.times);
        let exposure = lit.exposure();
        let cached: Vec<bool> = lab.volumes.lights.iter().map(|v| v.cached).collect();

        let mut meter = lab.meter(stage, lights, view)?;
        let drawn = lights::drawn(lab);
        let mut gpu = vec![GpuCost::default(); drawn.len()];
        let mut has_gpu_times = true;
        for _ in 0..gpu_rounds {
            has_gpu_times = meter.round(&drawn, &mut gpu)?;
        }
        let counter = lab.counter(stage, lights, view, exposure)?;
        let work = work(lab, setting, lights, &counter)?;
        let built = lights::built(lab);
        let casters = (0..lights.len()).map(|light| {
            let chain = lab.volumes.chain_triangles(light);
            chain.map(ChainTriangle::triangle).collect()
        });
        let casters = casters.collect();
        let builds = lab.build_times(stage, &built, rounds);
        let build_all_us = lab.build_all_us(stage, &built, rounds)?;
        let uploads = lab.upload_times(&built, rounds)?;

        let none = GpuCost {
            volume_us: 0.0,
            light_us: 0.0,
        };
        let mut figures: Vec<Figures> = (0..lights.len())
            .map(|light| Figures {
                path: lab.path(light),
                cached: cached[light],
                work: work[light],
                build: BuildTimes::default(),
                upload_us: 0.0,
                gpu: has_gpu_times.then_some(none),
            })
            .collect();
        for (&light, cost) in drawn.iter().zip(&gpu) {
            figures[light].gpu = has_gpu_times.then_some(*cost);
        }
        for ((&light, build), us) in built.iter().zip(&builds).zip(&uploads) {
            figures[light].build = *build;
            figures[light].upload_us = *us;
        }
        Ok(Self {
            method,
            rounds,
            gpu_rounds,
            frame,
            lit,
            exposure,
            lights: figures,
            drawn,
            casters,
            build_all_us,
            has_gpu_times,
            meter,
            counter,
        })
    }
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
