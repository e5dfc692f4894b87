//! The same input gives the same bits: with any number of threads, in every run, and for each
//! light whatever its neighbours in the list.

mod common;

use common::{EXACT, Site, WALK, by_profile, check, lab, plain, walk};
use glam::{DVec3, Vec3};
use umbrage_core::frame::{FramePlan, LightPlan, PathRule, PlanOptions};
use umbrage_core::volume::{Chain, ChainTriangle, LayerLimit, Part, Quad, VolumeBuilder, Volumes};
use umbrage_core::world::{BuildTimes, Pose, World};
use umbrage_core::{Light, View};
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;
use umbrage_truth::Mask;

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

/// The pools that must agree.
const THREADS: [usize; 4] = [1, 2, 3, 8];

/// Few enough that many lights are in parts.
const FEW: LayerLimit = LayerLimit { whole: 3, part: 2 };

/// All that builds and plans give, but for times and stamps.
#[derive(Debug, PartialEq)]
struct Outcome {
    lights: Vec<(u32, u32, u32, Vec<Part>)>,
    quads: Vec<Quad>,
    chains: Vec<Chain>,
    plans: Vec<(Vec<LightPlan>, Vec<ChainTriangle>)>,
}

impl Outcome {
    fn new(world: &World, lights: &[Light], view: &View, volumes: &Volumes) -> Self {
        let plan = |path| {
            let (mut plan, mut options) = (FramePlan::default(), PlanOptions::default());
            options.path = path;
            plan.make(world, lights, volumes, view, &options);
            (plan.lights, plan.caps)
        };
        let light = |i: usize| {
            let light = &volumes.lights[i];
            let counts = [
                light.subset_triangles,
                light.facing_triangles,
                light.layers_bound,
            ];
            (counts[0], counts[1], counts[2], light.parts.clone())
        };
        Self {
            lights: (0..lights.len()).map(light).collect(),
            quads: volumes.quads.clone(),
            chains: volumes.chains.clone(),
            plans: [PathRule::ZPassWhereExact, PathRule::ZFailAlways]
                .map(plan)
                .into(),
        }
    }
}

/// A city in which a crate moves, frame after frame: first without looking for hidden casters, in
/// the end with.
fn play(site: &Site, frames: usize) -> Vec<Outcome> {
    let mut world = World::build(&site.stage.mesh).expect("the mesh is valid");
    let lights = plain(&site.lights);
    let view = site.first_camera([200, 150]);
    let at = lights[1].position;
    let moving = common::room::crate_of(Vec3::splat(0.7));
    let id = world.insert(&moving, &Pose::at(at)).expect("a crate");
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
    builder.layers = FEW;
    let mut outcomes = Vec::new();
    for frame in 0..frames {
        let by = DVec3::new(0.4, -0.3, 0.2) * frame as f64;
        world.pose(id, &Pose::at(at + by)).expect("it is there");
        builder.build(&world, &lights, |_| true, &mut volumes);
        outcomes.push(Outcome::new(&world, &lights, &view, &volumes));
    }
    builder.settle(&world, &lights, |_| true, &mut volumes);
    outcomes.push(Outcome::new(&world, &lights, &view, &volumes));
    outcomes
}

#[test]
fn threads_change_no_frame_of_a_moving_world() {
    let site = city();
    let played = THREADS.map(|count| with_threads(count, || play(&site, 2)));
    for other in &played[1..] {
        assert!(*other == played[0]);
    }
    let parts = |outcome: &Outcome| outcome.lights.iter().any(|light| light.3.len() > 1);
    assert!(played[0].iter().all(parts));
    // The comparison sees what it is to see: frames differ, and so does one with two quads swapped.
    let [first, second, ..] = &played[0][..] else {
        panic!("two frames")
    };
    assert!(first != second);
    let mut swapped = with_threads(2, || play(&site, 1)).swap_remove(0);
    assert!(swapped == *first);
    let other = (1..).find(|&i| swapped.quads[i] != swapped.quads[0]);
    swapped.quads.swap(0, other.expect("quads differ"));
    assert!(swapped != *first);
}

#[test]
fn threads_change_no_saved_world() {
    let site = city();
    let mesh = &site.stage.mesh;
    let saved = |count: usize| {
        let name = format!("umbrage-threads-{count}-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let bytes = with_threads(count, || {
            let mut world = World::build(mesh).expect("the mesh is valid");
            // What it cost is saved too.
            world.report.build_ms = BuildTimes::default();
            world
                .save(&path, mesh.fingerprint())
                .expect("it can be saved");
            let opened = World::open(&path, mesh.fingerprint()).expect("it can be opened");
            (
                std::fs::read(&path).expect("a file"),
                volumes(&opened, &plain(&site.lights)),
            )
        });
        std::fs::remove_file(&path).expect("it was there");
        (bytes.0, bytes.1.quads, bytes.1.chains)
    };
    let [first, others @ ..] = THREADS.map(saved);
    assert!(first.0.len() > 100_000);
    for other in others {
        assert!(first == other);
    }
}

/// Masks on both paths, of whole lights and of parts, with as many threads.
fn masks(site: &Site, view: &View, threads: usize) -> Vec<Mask> {
    let of = |(method, layers): (Method, LayerLimit)| {
        with_threads(threads, || {
            let mut lab = lab();
            lab.layers = layers;
            lab.volumes = Volumes::default();
            lab.prepare(&site.stage, &site.lights, view, method);
            let mask = lab.mask(&site.stage, &site.lights, view);
            (lab.layers, lab.volumes) = (LayerLimit::STENCIL, Volumes::default());
            mask.expect("a mask")
        })
    };
    let layers = [LayerLimit::STENCIL, FEW];
    let all = EXACT.into_iter().flat_map(|m| layers.map(|l| (m, l)));
    all.map(of).collect()
}

#[test]
fn threads_change_no_mask() {
    let site = city();
    let view = site.first_camera([200, 150]);
    let drawn = THREADS.map(|count| masks(&site, &view, count));
    assert!(drawn.iter().all(|masks| *masks == drawn[0]));
    let aside = View {
        eye: view.eye + 0.5 * view.right.as_dvec3(),
        ..view
    };
    assert!(masks(&site, &aside, 2) != drawn[0]);
}

/// A man who walks through stormkeep is posed, built and drawn alike.
#[test]
fn threads_change_no_step_of_an_actor() {
    let walked = |threads: usize| {
        let site = with_threads(threads, || {
            let mut site = Site::new(walk(), Casters::Material);
            site.stage.set_time(0.62).expect("he can walk");
            site
        });
        let view = site.look(WALK[0], WALK[1], by_profile([160, 90], [80, 45]));
        masks(&site, &view, threads)
    };
    let [first, others @ ..] = [1, 3].map(walked);
    assert!(others.into_iter().all(|masks| masks == first));
}
