//! `umbrage volumes`: volume generation alone, without a GPU, by every method in one run.
//!
//! All methods share query and facing, so that what differs is the algorithm; `counter-cuts` also
//! leaves out hidden casters and counts the quads that an eye within the light's reach needs.
//! Methods are timed in turn, repeat by repeat, on one thread; the library's own build on one
//! thread and on all is timed beside them.

mod methods;

use std::collections::BTreeMap;
use std::time::Instant;

use umbrage_core::volume::{Chain, Quad, VolumeBuilder, Volumes, facing};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_core::{Cull, Culls, InstructionSet, Light};
use umbrage_lab::stage::{Stage, StageError};
use umbrage_lab::timer;

use self::methods::Method;
use crate::args::VolumesArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::{VolumesLight, VolumesMethod, VolumesReport};
use crate::setting::{self, limit_threads, stage};
use umbrage_report::Table;
use umbrage_scene::Progress as _;

/// Scratch that all methods share.
#[derive(Default)]
struct Shared {
    subset: Subset,
    chain: Vec<Chain>,
    quads: Vec<Quad>,
}

/// What one method made of one light.
#[derive(Clone, Default)]
struct Made {
    subset: u64,
    facing: u64,
    quads: u64,
    /// One time a repeat, in microseconds.
    us: Vec<f64>,
}

/// One method over all lights.
struct Run {
    method: Box<dyn Method>,
    lights: Vec<Made>,
    /// One time a repeat.
    ms: Vec<f64>,
}

/// Loads, times every method, reports.
pub(crate) fn run(args: &VolumesArgs) -> Result<(), CliError> {
    if let Some(instructions) = args.instructions {
        instructions.0.limit();
    }
    limit_threads(args.threads);
    let bar = Bar::new(args.results.quiet);
    let stage = stage(&args.scene, &args.world, &bar)?;
    bar.stage("place lights", 0);
    let stage_lights = setting::lights(&stage, &args.lights, &args.world)?;
    drop(bar);
    // Generation alone: actors are triangles like others where they stand.
    let flat = match stage.actors.is_empty() {
        true => None,
        false => Some(flat(&stage)?),
    };
    let world = flat.as_ref().unwrap_or(&stage.world);
    let lights: Vec<Light> = stage_lights.iter().map(|light| light.light).collect();
    let mut runs: Vec<Run> = methods::all(world)
        .into_iter()
        .map(|method| Run {
            method,
            lights: vec![Made::default(); lights.len()],
            ms: Vec::new(),
        })
        .collect();
    let repeat = args.repeat.get();
    let mut shared = Shared::default();
    for round in 0..=repeat {
        for run in &mut runs {
            run.all_lights(world, &lights, &mut shared, round > 0);
        }
    }
    let triangles = world.triangles.len().max(1) as f64;
    let methods = runs.iter_mut().map(|run| {
        let sum = |part: fn(&Made) -> u64| run.lights.iter().map(part).sum::<u64>();
        let (subset, casting, quads) = (sum(|m| m.subset), sum(|m| m.facing), sum(|m| m.quads));
        let ms_total = median(&mut run.ms);
        VolumesMethod {
            name: run.method.name().to_owned(),
            ms_total,
            ns_per_triangle: ms_total * 1e6 / subset.max(1) as f64,
            quads,
            quads_per_light: mean(&run.lights, |_| true),
            quads_per_local_light: mean(&run.lights, |i| !lights[i].is_directional()),
            cap_triangles: 2 * casting,
            polygons: quads + 2 * casting,
            adjacency_bytes_per_triangle: run.method.adjacency_bytes(world) as f64 / triangles,
        }
    });
    let methods: Vec<VolumesMethod> = methods.collect();
    let detail = stage_lights.iter().enumerate().map(|(i, light)| {
        let made = &runs[0].lights[i];
        let by_method = |of: fn(&Made) -> u64| -> BTreeMap<String, u64> {
            let of_run = |run: &Run| (run.method.name().to_owned(), of(&run.lights[i]));
            runs.iter().map(of_run).collect()
        };
        VolumesLight {
            name: light.name.clone(),
            kind: light.kind().to_owned(),
            subset_triangles: made.subset,
            facing_triangles: by_method(|m| m.facing),
            quads: by_method(|m| m.quads),
            build_us: runs
                .iter()
                .map(|run| {
                    let mut us = run.lights[i].us.clone();
                    (run.method.name().to_owned(), median(&mut us))
                })
                .collect(),
        }
    });
    let lights_detail: Vec<VolumesLight> = detail.collect();
    let report = VolumesReport {
        scene: stage.scene.name.clone(),
        lights: lights.len() as u64,
        instructions: InstructionSet::in_use().name().to_owned(),
        threads: rayon::current_num_threads() as u64,
        subset_triangles: runs[0].lights.iter().map(|made| made.subset).sum(),
        parallel_ms_total: library(world, &lights, repeat),
        serial_ms_total: one_thread(|| library(world, &lights, repeat)),
        methods,
        lights_detail,
    };
    args.results.show(&table(&report), &report)
}

/// A world of everything on the stage.
fn flat(stage: &Stage) -> Result<World, StageError> {
    World::build(&stage.mesh).map_err(|error| StageError::World {
        scene: stage.scene.name.clone(),
        error,
    })
}

impl Run {
    fn all_lights(&mut self, world: &World, lights: &[Light], shared: &mut Shared, timed: bool) {
        let start = Instant::now();
        for (light, made) in lights.iter().zip(&mut self.lights) {
            let start = Instant::now();
            query(world, Layer::Fixed, light, &mut shared.subset);
            shared.chain.clear();
            facing(world, light, &shared.subset, &mut shared.chain);
            shared.quads.clear();
            self.method
                .quads(world, light, &mut shared.chain, &mut shared.quads);
            if timed {
                made.us.push(start.elapsed().as_secs_f64() * 1e6);
            }
            made.subset = shared.subset.len() as u64;
            made.facing = shared.chain.iter().map(|c| c.len() as u64).sum();
            made.quads = shared.quads.len() as u64;
        }
        if timed {
            self.ms.push(start.elapsed().as_secs_f64() * 1e3);
        }
    }
}

/// Mean quads of the lights whose number is `wanted`; 0 if there are none.
fn mean(lights: &[Made], wanted: impl Fn(usize) -> bool) -> f64 {
    let wanted = (0..lights.len()).filter(|i| wanted(*i));
    let (count, sum) = wanted.fold((0u64, 0), |(n, sum), i| (n + 1, sum + lights[i].quads));
    sum as f64 / count.max(1) as f64
}

/// Runs `work` on one thread; the time it would give on all if none can be had.
fn one_thread(work: impl Fn() -> f64 + Sync) -> f64 {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(&work),
        Err(_) => work(),
    }
}

/// Median milliseconds of the library's own build of all lights, on the threads at hand.
fn library(world: &World, lights: &[Light], repeat: usize) -> f64 {
    // Every light anew, as if all had moved.
    let mut builder = VolumeBuilder::new(Culls::EVERY.without(Cull::Cache));
    let mut volumes = Volumes::default();
    let mut times: Vec<f64> = (0..=repeat)
        .map(|_| {
            let start = Instant::now();
            builder.build(world, lights, |_| true, &mut volumes);
            start.elapsed().as_secs_f64() * 1e3
        })
        .skip(1)
        .collect();
    median(&mut times)
}

fn median(times: &mut [f64]) -> f64 {
    timer::median(times).unwrap_or_default()
}

fn table(report: &VolumesReport) -> Table {
    let mut table = Table::default();
    table
        .row(["scene", &report.scene])
        .row(["instructions", &report.instructions])
        .count("lights", report.lights)
        .count("subset triangles", report.subset_triangles);
    let counter = report.methods.first().map_or(1.0, |m| m.ms_total);
    for method in &report.methods {
        let (ms, ns) = (method.ms_total, method.ns_per_triangle);
        table
            .row([
                method.name.clone(),
                format!("{ms:.2} ms, {:.2} x counter", ms / counter),
            ])
            .row(["  a subset triangle".to_owned(), format!("{ns:.2} ns")])
            .count("  quads", method.quads)
            .row([
                "  quads a light, a local light".to_owned(),
                format!(
                    "{:.1}, {:.1}",
                    method.quads_per_light, method.quads_per_local_light
                ),
            ])
            .count("  polygons with caps", method.polygons)
            .row([
                "  adjacency a triangle".to_owned(),
                format!("{:.1} bytes", method.adjacency_bytes_per_triangle),
            ]);
    }
    for (threads, ms) in [
        (1, report.serial_ms_total),
        (report.threads, report.parallel_ms_total),
    ] {
        table.row([
            format!("library's build, {threads} threads"),
            format!("{ms:.2} ms"),
        ]);
    }
    table
}
