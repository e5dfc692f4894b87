//! The same input gives the same bits: with any number of threads, in every run, and for each
//! light whatever its neighbours in the list.

mod common;

use common::{Site, check, plain};
use umbrage_core::Light;
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{BuildTimes, World};
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;

fn city() -> Site {
    Site::open(
        "gen:city?triangles=8000&lights=70&seed=6&moon=1",
        Casters::Material,
    )
}

fn volumes(world: &World, lights: &[Light]) -> Volumes {
    let mut volumes = Volumes::default();
    VolumeBuilder::default().build(world, lights, |_| true, &mut volumes);
    volumes
}

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    pool.expect("a thread pool").install(work)
}

#[test]
fn threads_change_no_volume() {
    let (site, [one, many]) = (city(), [1, 7]);
    let lights = plain(&site.lights);
    let [single, parallel] =
        [one, many].map(|count| with_threads(count, || volumes(&site.stage.world, &lights)));
    assert!(!single.quads.is_empty());
    assert_eq!(single.quads, parallel.quads);
    assert_eq!(single.chains, parallel.chains);
    for (a, b) in single.lights.iter().zip(&parallel.lights) {
        assert_eq!((&a.quads, &a.chain), (&b.quads, &b.chain));
        assert_eq!(a.subset_triangles, b.subset_triangles);
    }
}

#[test]
fn threads_change_no_world() {
    let site = city();
    let [single, parallel] = [1, 7].map(|count| {
        with_threads(count, || {
            World::build(&site.stage.mesh).expect("the mesh is valid")
        })
    });
    let timeless = |mut world: World| {
        world.report.build_ms = BuildTimes::default();
        world
    };
    assert!(timeless(single) == timeless(parallel));
}

#[test]
fn used_scratch_changes_no_volume() {
    let site = city();
    let (world, lights) = (&site.stage.world, plain(&site.lights));
    let fresh = volumes(world, &lights);
    let (mut builder, mut reused) = (VolumeBuilder::default(), Volumes::default());
    builder.build(world, &lights[20..], |_| true, &mut reused);
    builder.build(world, &lights, |_| true, &mut reused);
    for light in 0..lights.len() {
        assert_eq!(fresh.quads_of(light), reused.quads_of(light));
        assert_eq!(fresh.chain_of(light), reused.chain_of(light));
    }
}

#[test]
fn order_of_lights_changes_no_volume() {
    let site = city();
    let lights = plain(&site.lights);
    let forward = volumes(&site.stage.world, &lights);
    // 29 and the number of lights have no common divisor: a permutation.
    let order: Vec<usize> = (0..lights.len())
        .map(|i| (i * 29 + 3) % lights.len())
        .collect();
    let permuted: Vec<Light> = order.iter().map(|&i| lights[i]).collect();
    let shuffled = volumes(&site.stage.world, &permuted);
    for (place, &light) in order.iter().enumerate() {
        assert_eq!(shuffled.quads_of(place), forward.quads_of(light));
        assert_eq!(shuffled.chain_of(place), forward.chain_of(light));
    }
}

#[test]
fn two_runs_draw_the_same_mask() {
    let [first, second] = [(); 2].map(|()| {
        let site = city();
        let view = site.first_camera([200, 150]);
        check(&site, &site.lights, &view, Method::Counter)
    });
    assert_eq!(first.mask, second.mask);
    assert_eq!(first.plan.lights, second.plan.lights);
    assert_eq!(first.judgement, second.judgement);
    assert!(first.judgement.samples > 0);
}
