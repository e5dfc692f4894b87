//! `umbrage volumes`: volume generation alone, without a GPU, by every method in one run.
//!
//! All methods share query and facing, so that what differs is the algorithm. Methods are timed
//! in turn, repeat by repeat, on one thread; the library's own build on all
//! threads is timed beside them.

use std::time::Instant;

use umbrage_core::Light;
use umbrage_core::volume::{
    Chain, Crow, Quad, VolumeBuilder, Volumes, brute, counter, facing, plain_counter,
};
use umbrage_core::world::{Layer, Subset, World, query};

use crate::args::VolumesArgs;
use crate::error::CliError;
use crate::report::{VolumesMethod, VolumesReport};
use crate::setting::Setting;
use crate::table::Table;

/// What turns a chain into quads.
trait Method {
    fn name(&self) -> &'static str;
    fn quads(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>);
    /// What edges and faces know of each other, in bytes, for the whole world.
    fn adjacency_bytes(&self, world: &World) -> usize;
}

#[derive(Default)]
struct CounterMethod {
    counters: Vec<i32>,
    touched: Vec<Quad>,
}

impl Method for CounterMethod {
    fn name(&self) -> &'static str {
        "counter"
    }

    fn quads(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>) {
        self.counters.resize(world.edges.vertices.len(), 0);
        counter(world, chain, &mut self.counters, &mut self.touched, quads);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        size_of_val(&world.edges.sides[..]) + size_of_val(&world.clusters[..])
    }
}

#[derive(Default)]
struct PlainMethod {
    counters: Vec<i32>,
}

impl Method for PlainMethod {
    fn name(&self) -> &'static str {
        "counter-plain"
    }

    fn quads(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>) {
        self.counters.resize(world.edges.vertices.len(), 0);
        plain_counter(world, chain, &mut self.counters, quads);
    }

    fn adjacency_bytes(&self, world: &World) -> usize {
        size_of_val(&world.edges.sides[..])
    }
}

struct BruteMethod;

impl Method for BruteMethod {
    fn name(&self) -> &'static str {
        "brute"
    }

    fn quads(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>) {
        brute(&world.edges, chain.iter().flat_map(Chain::triangles), quads);
    }

    fn adjacency_bytes(&self, _: &World) -> usize {
        0
    }
}

impl Method for Crow {
    fn name(&self) -> &'static str {
        "crow"
    }

    fn quads(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>) {
        self.silhouette(world, chain, quads);
    }

    fn adjacency_bytes(&self, _: &World) -> usize {
        self.bytes()
    }
}

/// Scratch that all methods share.
#[derive(Default)]
struct Shared {
    subset: Subset,
    chain: Vec<Chain>,
    quads: Vec<Quad>,
}

/// Sums over all lights of one method, one repeat.
#[derive(Clone, Copy, Default)]
struct Sums {
    ms: f64,
    subset: u64,
    facing: u64,
    quads: u64,
}

/// Loads, times every method, reports.
pub(crate) fn run(args: &VolumesArgs) -> Result<(), CliError> {
    let setting = Setting::new(&args.scene, &args.common)?;
    let world = &setting.stage.world;
    let lights: Vec<Light> = setting.lights.iter().map(|light| light.light).collect();
    let mut methods: [Box<dyn Method>; 4] = [
        Box::new(CounterMethod::default()),
        Box::new(PlainMethod::default()),
        Box::new(Crow::new(world)),
        Box::new(BruteMethod),
    ];
    let repeat = args.common.run.repeat.get();
    let mut shared = Shared::default();
    let mut times = vec![Vec::new(); methods.len()];
    let mut sums = vec![Sums::default(); methods.len()];
    for round in 0..=repeat {
        for (method, (sums, times)) in methods.iter_mut().zip(sums.iter_mut().zip(&mut times)) {
            *sums = all_lights(method.as_mut(), world, &lights, &mut shared);
            if round > 0 {
                times.push(sums.ms);
            }
        }
    }
    let mut rows = Vec::new();
    let triangles = world.triangles.len().max(1) as f64;
    for ((method, sums), times) in methods.iter().zip(&sums).zip(&mut times) {
        let ms_total = median(times);
        rows.push(VolumesMethod {
            name: method.name().to_owned(),
            ms_total,
            ns_per_triangle: ms_total * 1e6 / sums.subset.max(1) as f64,
            quads: sums.quads,
            cap_triangles: 2 * sums.facing,
            polygons: sums.quads + 2 * sums.facing,
            adjacency_bytes_per_triangle: method.adjacency_bytes(world) as f64 / triangles,
        });
    }
    let report = VolumesReport {
        scene: setting.stage.scene.name.clone(),
        lights: lights.len() as u64,
        threads: rayon::current_num_threads() as u64,
        subset_triangles: sums[0].subset,
        parallel_ms_total: parallel(world, &lights, repeat),
        methods: rows,
    };
    args.common.results.show(&table(&report), &report)
}

fn all_lights(
    method: &mut dyn Method,
    world: &World,
    lights: &[Light],
    shared: &mut Shared,
) -> Sums {
    let mut sums = Sums::default();
    let start = Instant::now();
    for light in lights {
        query(world, Layer::Fixed, light, &mut shared.subset);
        shared.chain.clear();
        facing(world, light, &shared.subset, &mut shared.chain);
        shared.quads.clear();
        method.quads(world, &shared.chain, &mut shared.quads);
        sums.subset += shared.subset.len() as u64;
        sums.facing += shared.chain.iter().map(|c| c.len() as u64).sum::<u64>();
        sums.quads += shared.quads.len() as u64;
    }
    sums.ms = start.elapsed().as_secs_f64() * 1e3;
    sums
}

/// Median milliseconds of the library's own build of all lights, on all threads.
fn parallel(world: &World, lights: &[Light], repeat: usize) -> f64 {
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
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
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or_default()
}

fn table(report: &VolumesReport) -> Table {
    let mut table = Table::default();
    table
        .row(["scene", &report.scene])
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
            .count("  polygons with caps", method.polygons)
            .row([
                "  adjacency a triangle".to_owned(),
                format!("{:.1} bytes", method.adjacency_bytes_per_triangle),
            ]);
    }
    table.row([
        format!("counter, {} threads", report.threads),
        format!("{:.2} ms", report.parallel_ms_total),
    ]);
    table
}
