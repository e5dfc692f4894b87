//! `umbrage inspect`: what a scene's triangles are made of, and what building a world of them
//! costs. No GPU.

use std::time::Instant;

use umbrage_core::volume::Crow;
use umbrage_lab::saved_world::{WorldFromFile, open_or_build};
use umbrage_lab::stage::{self, StageError, fixed_part};
use umbrage_scene::Progress;

use crate::actor;
use crate::args::InspectArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::{BuildMs, EdgesByTriangles, InspectReport};
use crate::setting::{limit_threads, world_step};
use umbrage_report::Table;

/// Loads, builds, counts.
pub(crate) fn run(args: &InspectArgs) -> Result<(), CliError> {
    limit_threads(args.threads);
    let bar = Bar::new(args.results.quiet);
    let start = Instant::now();
    let options = &args.world;
    let scene = actor::open(&args.scene, &options.actors, &bar)?;
    let posed = scene.posed(options.time);
    let soup = scene.soup_posed(&posed, options.origin.map(|point| point.0))?;
    let load = start.elapsed().as_secs_f64() * 1e3;

    let world_file = options.file.as_deref();
    bar.stage(world_step(world_file), 0);
    let [fixed, _] = fixed_part(&scene, &soup);
    // Every triangle counts here, whatever it casts.
    let mut mesh = stage::mesh(&scene, &soup, options.casters.into());
    mesh.weld_first_within(fixed, options.weld)
        .map_err(|error| StageError::new(&scene, None, error.into()))?;
    let WorldFromFile { world, opened_in } = open_or_build(&mesh, world_file)
        .map_err(|error| StageError::new(&scene, world_file, error))?;
    drop(bar);

    let found = &world.report;
    let per_triangle = |bytes: usize| bytes as f64 / found.triangles.max(1) as f64;
    let memory = world.memory();
    let [one, two, three, more] = found.edges_by_triangles.map(|count| count as u64);
    let times = &found.build_ms;
    let report = InspectReport {
        scene: scene.name.clone(),
        triangles: mesh.triangles.len() as u64,
        vertices: found.vertices as u64,
        welded_vertices: found.welded_vertices as u64,
        unique_edges: found.unique_edges as u64,
        edges_by_triangles: EdgesByTriangles {
            one,
            two,
            three,
            more,
        },
        opposite_wound_pairs: found.opposite_wound_pairs as u64,
        degenerate_triangles: found.degenerate_triangles as u64,
        duplicate_triangles: found.duplicate_triangles as u64,
        bytes_per_triangle: per_triangle(memory.total()),
        memory: memory
            .by_array()
            .map(|(array, bytes)| (array, per_triangle(bytes)))
            .into(),
        face_pointer_bytes_per_triangle: per_triangle(Crow::new(&world).bytes(&world)),
        lights: scene.lights.len() as u64,
        oddities: actor::oddities(&scene.report),
        oddity_notes: scene.report.notes.clone(),
        open_ms: opened_in.map(|time| time.as_secs_f64() * 1e3),
        build_ms: BuildMs {
            load,
            weld: times.weld,
            edges: times.edges,
            bvh: times.bvh,
            order: times.order,
            total: load + times.total,
        },
    };
    args.results.show(&table(&report), &report)
}

fn table(report: &InspectReport) -> Table {
    let mut table = Table::default();
    let edges = &report.edges_by_triangles;
    table
        .row(["scene", &report.scene])
        .count("triangles", report.triangles)
        .count("  degenerate", report.degenerate_triangles)
        .count("  duplicate", report.duplicate_triangles)
        .count("vertices", report.vertices)
        .count("  after weld", report.welded_vertices)
        .count("unique edges", report.unique_edges)
        .count("  of 1 triangle", edges.one)
        .count("  of 2 triangles", edges.two)
        .count("    wound alike along it", report.opposite_wound_pairs)
        .count("  of 3 triangles", edges.three)
        .count("  of 4 and more", edges.more)
        .count("lights", report.lights);
    for oddity in report.oddities.iter().chain(&report.oddity_notes) {
        table.row(["odd", oddity]);
    }
    let mut bytes = |name: &str, bytes: f64| {
        table.row([name, &format!("{bytes:.1}")]);
    };
    bytes("bytes per triangle", report.bytes_per_triangle);
    for (array, &amount) in &report.memory {
        bytes(&format!("  {array}"), amount);
    }
    bytes(
        "sides and face pointers, for sides and clusters",
        report.face_pointer_bytes_per_triangle,
    );
    let times = &report.build_ms;
    if let Some(ms) = report.open_ms {
        table.row(["saved world opened", &format!("{ms:.1} ms")]);
    }
    let build = match report.open_ms {
        Some(_) => "build, when it was saved",
        None => "build",
    };
    for (stage, ms) in [
        (build, times.total),
        ("  load", times.load),
        ("  weld", times.weld),
        ("  edges", times.edges),
        ("  bvh", times.bvh),
        ("  order", times.order),
    ] {
        table.row([stage, &format!("{ms:.1} ms")]);
    }
    table
}
