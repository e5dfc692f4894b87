//! Stages from triangles to volumes, on a bundled world and a generated one.
//!
//! `cargo bench --bench stages`

use divan::{Bencher, black_box};
use umbrage_core::Light;
use umbrage_core::volume::{self, VolumeBuilder, Volumes, counter};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_lab::stage::{Casters, Stage};

const SCENES: [&str; 2] = [
    concat!(env!("CARGO_MANIFEST_DIR"), "/data/worlds/stormkeep.glb"),
    "gen:city?triangles=100000&lights=256",
];

fn main() {
    divan::main();
}

fn stage(scene: &str) -> (Stage, Vec<Light>) {
    let loaded = umbrage_scene::open(scene, &()).expect("a bundled or generated scene");
    let stage = Stage::new(loaded, Casters::Material, None).expect("a valid scene");
    let lights = stage.lights(None).iter().map(|l| l.light).collect();
    (stage, lights)
}

#[divan::bench(args = SCENES)]
fn load(bencher: Bencher<'_, '_>, scene: &str) {
    bencher.bench(|| umbrage_scene::open(black_box(scene), &()));
}

#[divan::bench(args = SCENES)]
fn world(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, _) = stage(scene);
    bencher.bench(|| World::build(black_box(&stage.mesh)));
}

#[divan::bench(args = SCENES)]
fn queries(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let mut subset = Subset::default();
    bencher.bench_local(|| {
        for light in &lights {
            query(&stage.world, Layer::Fixed, black_box(light), &mut subset);
        }
    });
}

#[divan::bench(args = SCENES)]
fn facing(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let (mut subset, mut cast) = (Subset::default(), Vec::new());
    query(&stage.world, Layer::Fixed, &lights[0], &mut subset);
    bencher.bench_local(|| {
        cast.clear();
        volume::facing(&stage.world, black_box(&lights[0]), &subset, &mut cast);
    });
}

#[divan::bench(args = SCENES)]
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

#[divan::bench(args = SCENES)]
fn volumes(bencher: Bencher<'_, '_>, scene: &str) {
    let (stage, lights) = stage(scene);
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
    bencher.bench_local(|| builder.build(&stage.world, &lights, |_| true, &mut volumes));
}
