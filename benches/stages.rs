//! Stages from a file to volumes, scene by scene.
//!
//! `cargo bench --bench stages` runs a bundled world and a generated one;
//! `SCENES=a.glb,b.glb cargo bench --bench stages -- edges` runs one stage on others, named as on
//! the command line or by the bare name of a file in data/worlds. `cargo test --bench stages` runs
//! everything once on a small world.

use std::path::Path;

use divan::{Bencher, black_box};
use umbrage_core::volume::{self, VolumeBuilder, Volumes, counter};
use umbrage_core::world::stages::{self, Welded};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_core::{Light, Mesh};
use umbrage_lab::stage::{Casters, Stage};

fn main() {
    divan::main();
}

fn scenes() -> Vec<String> {
    let chosen = std::env::var("SCENES").unwrap_or_else(|_| {
        // cargo says --bench where times are wanted.
        let timed = std::env::args().any(|argument| argument == "--bench");
        let scenes = match timed {
            true => "stormkeep,gen:city?triangles=100000&lights=256",
            false => "gen:city?triangles=4000&lights=16",
        };
        scenes.to_owned()
    });
    let bundled = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/worlds");
    let path = |name: &str| match bundled.join(name).with_extension("glb") {
        file if file.exists() => file.to_string_lossy().into_owned(),
        _ => name.to_owned(),
    };
    chosen.split(',').map(path).collect()
}

fn stage(scene: &str) -> (Stage, Vec<Light>) {
    let loaded = umbrage_scene::open(scene, &()).expect("a bundled or generated scene");
    let stage = Stage::new(loaded, Casters::Material, None).expect("a valid scene");
    let lights = stage.lights(None).iter().map(|l| l.light).collect();
    (stage, lights)
}

#[divan::bench(args = scenes())]
fn load(bencher: Bencher<'_, '_>, scene: &str) {
    bencher.bench(|| umbrage_scene::open(black_box(scene), &()));
}

#[divan::bench(args = scenes())]
fn world(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    bencher.bench(|| World::build(black_box(&stage.mesh)));
}

fn in_order(mesh: &Mesh) -> (Welded, Vec<u32>) {
    let welded = stages::weld(mesh);
    let source = stages::tree(mesh, &welded).source;
    (welded, source)
}

#[divan::bench(args = scenes())]
fn world_weld(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    bencher.bench(|| stages::weld(black_box(&stage.mesh)));
}

#[divan::bench(args = scenes())]
fn world_bvh(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    let welded = stages::weld(&stage.mesh);
    bencher.bench(|| stages::tree(black_box(&stage.mesh), &welded));
}

#[divan::bench(args = scenes())]
fn world_order(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    let (welded, source) = in_order(&stage.mesh);
    bencher.bench(|| stages::order(black_box(&stage.mesh), &welded, &source));
}

#[divan::bench(args = scenes())]
fn world_edges(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    let (welded, source) = in_order(&stage.mesh);
    let ordered = stages::order(&stage.mesh, &welded, &source);
    bencher.bench(|| stages::edges(black_box(&ordered)));
}

#[divan::bench(args = scenes())]
fn world_open(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    let file = std::env::temp_dir().join(format!("umbrage-bench-{}", std::process::id()));
    let fingerprint = stage.mesh.fingerprint();
    let saved = stage.world.save(&file, fingerprint);
    saved.expect("the temporary folder takes a world");
    bencher.bench(|| World::open(black_box(&file), fingerprint));
    // Left behind at worst: it is the system's temporary folder.
    let _ = std::fs::remove_file(file);
}

#[divan::bench(args = scenes())]
fn queries(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let mut subset = Subset::default();
    bencher.bench_local(|| {
        for light in &lights {
            query(&stage.world, Layer::Fixed, black_box(light), &mut subset);
        }
    });
}

#[divan::bench(args = scenes())]
fn facing(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let (mut subset, mut cast) = (Subset::default(), Vec::new());
    query(&stage.world, Layer::Fixed, &lights[0], &mut subset);
    bencher.bench_local(|| {
        cast.clear();
        volume::facing(&stage.world, black_box(&lights[0]), &subset, &mut cast);
    });
}

#[divan::bench(args = scenes())]
fn counters(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let (mut subset, mut cast) = (Subset::default(), Vec::new());
    let (mut touched, mut quads) = (Vec::new(), Vec::new());
    let mut counts = vec![0; stage.world.edges.vertices.len()];
    query(&stage.world, Layer::Fixed, &lights[0], &mut subset);
    volume::facing(&stage.world, &lights[0], &subset, &mut cast);
    bencher.bench_local(|| {
        quads.clear();
        let cast = black_box(&cast);
        counter(&stage.world, cast, &mut counts, &mut touched, &mut quads);
    });
}

#[divan::bench(args = scenes())]
fn volumes(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
    bencher.bench_local(|| builder.build(&stage.world, &lights, |_| true, &mut volumes));
}
