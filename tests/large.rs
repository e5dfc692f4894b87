//! Worlds that f32 cannot hold: millimetres at 10,000 km from zero, rooms as far from each other, and
//! things that move there. Nothing may be wrong, whatever world position all others are relative to.

mod common;

use common::room::{self, crate_of};
use common::{EXACT, Site, assert_exact, by_profile, check, point, scene_of, staged};
use glam::{DAffine3, DVec3, Vec3};
use umbrage_core::world::{Pose, World};
use umbrage_core::{Mesh, View};
use umbrage_lab::gpu::GpuError;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::{Casters, Stage, StageLight};
use umbrage_scene::{Instance, Scene};
use umbrage_truth::Oracle;

const SIZE: [u32; 2] = if cfg!(debug_assertions) {
    [96, 72]
} else {
    [160, 120]
};

/// World positions in f64 that are no f32, from one to ten thousand kilometres from zero.
const FAR: [DVec3; 4] = [
    DVec3::new(1_000.1, -20.7, 950.3),
    DVec3::new(-1e4 + 0.3, 2e4 / 7.0, 1e5 / 3.0),
    DVec3::new(1e6 / 3.0, 1e6 / 7.0, -1e6 / 9.0),
    DVec3::new(1e7 + 1.0 / 3.0, -1e7 + 1.0 / 7.0, 1e7 / 1.1),
];

/// A stage whose positions are relative to `origin`.
fn site_at(scene: Scene, casters: Casters, origin: DVec3) -> Site {
    let stage = Stage::new(scene, casters, Some(origin)).expect("the scene can be staged");
    Site {
        lights: stage.lights(None),
        oracle: Oracle::new(&stage.mesh),
        stage,
    }
}

/// Moves a scene, but not its lights.
fn moved(mut scene: Scene, by: DVec3) -> Scene {
    for instance in &mut scene.instances {
        instance.transform = DAffine3::from_translation(by) * instance.transform;
    }
    scene
}

fn lights_at(by: DVec3) -> Vec<StageLight> {
    let mut lights = room::lights();
    for light in &mut lights {
        light.light.position += by;
    }
    lights
}

fn views(site: &Site, by: DVec3) -> Vec<View> {
    let eyes = [
        [DVec3::new(5.5, 3.5, 5.0), DVec3::new(-1.0, 1.0, 0.0)],
        [DVec3::new(-6.3, 1.1, -4.2), DVec3::new(3.0, 2.0, 2.0)],
        [DVec3::new(0.1, 0.2, 4.7), DVec3::new(1.0, 1.0, -3.0)],
    ];
    let pairs = eyes[..by_profile(3, 2)].iter();
    let look = |[eye, target]: &[DVec3; 2]| View {
        near: 1e-3,
        ..site.look(*eye + by, *target + by, SIZE)
    };
    pairs.map(look).collect()
}

fn assert_room(what: &str, site: &Site, by: DVec3) {
    for view in views(site, by) {
        for method in EXACT {
            let found = check(site, &site.lights, &view, method);
            let what = format!("{what}, {by}, {}", method.name());
            assert!(found.judgement.samples > 1000, "{what}: too little to see");
            assert_exact(&what, &found);
        }
    }
}

#[test]
fn a_room_far_from_the_origin() {
    for by in FAR {
        for casters in [Casters::Material, Casters::Both] {
            let mut site = site_at(moved(room::scene(), by), casters, DVec3::ZERO);
            assert!(!site.stage.world.residuals.is_empty() || by == FAR[0]);
            site.lights = lights_at(by);
            assert_room("a room", &site, by);
        }
    }
}

/// Four rooms in one world, from 1 to 10,000 km apart.
#[test]
fn rooms_far_from_each_other() {
    let mut scene = room::scene();
    let rooms = scene.instances.clone();
    for by in FAR {
        let there = rooms.iter().map(|room| Instance {
            transform: DAffine3::from_translation(by) * room.transform,
            ..room.clone()
        });
        scene.instances.extend(there);
    }
    let mut site = site_at(scene, Casters::Material, DVec3::ZERO);
    for by in FAR.into_iter().chain([DVec3::ZERO]) {
        site.lights = lights_at(by);
        assert_room("one of five", &site, by);
    }
}

/// A plain of large triangles under a room: their far corners are kilometres away, on all sides.
#[test]
fn a_room_on_a_plain() {
    let by = DVec3::new(123_456.7, 0.1, -98_765.4);
    let mut scene = moved(room::scene(), by);
    let mut plain = umbrage_scene::Mesh {
        name: "plain".into(),
        ..umbrage_scene::Mesh::default()
    };
    let steps: Vec<f32> = (-8..=8).map(|i| i as f32 * 777.7).collect();
    for x in &steps {
        plain
            .positions
            .extend(steps.iter().map(|z| Vec3::new(*x, -0.5, *z)));
    }
    for (i, j) in (0..16).flat_map(|i| (0..16).map(move |j| (i, j))) {
        let [a, b] = [17 * i + j, 17 * (i + 1) + j];
        plain.triangles.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
    }
    plain.materials = vec![0; plain.triangles.len()];
    scene.meshes.push(plain);
    scene.instances.push(Instance {
        mesh: scene.meshes.len() as u32 - 1,
        transform: DAffine3::from_translation(by),
        ..scene.instances[0].clone()
    });
    let mut site = site_at(scene, Casters::Both, DVec3::ZERO);
    site.lights = lights_at(by);
    site.lights
        .extend(staged([point(by + DVec3::new(12.0, 3.0, 1.0), 40.0)]));
    assert_room("on the plain", &site, by);
    let outside = site.look(by + DVec3::new(19.0, 4.0, 7.0), by, SIZE);
    for method in EXACT {
        assert_exact("outside", &check(&site, &site.lights, &outside, method));
    }
}

/// Slats of a millimetre, a millimetre apart, two centimetres above a floor.
fn comb() -> Scene {
    let mut mesh = umbrage_scene::Mesh {
        name: "comb".into(),
        ..umbrage_scene::Mesh::default()
    };
    let mut quad = |low: Vec3, high: Vec3| {
        let first = mesh.positions.len() as u32;
        let corners = [
            [low.x, low.z],
            [low.x, high.z],
            [high.x, high.z],
            [high.x, low.z],
        ];
        let corners = corners.map(|[x, z]| Vec3::new(x, low.y, z));
        mesh.positions.extend(corners);
        mesh.triangles
            .extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
        mesh.materials.extend([1, 1]);
    };
    quad(Vec3::new(-0.1, 0.0, -0.1), Vec3::new(0.1, 0.0, 0.1));
    for slat in -20..20 {
        let x = slat as f32 * 0.002;
        quad(Vec3::new(x, 0.02, -0.04), Vec3::new(x + 0.001, 0.02, 0.04));
    }
    scene_of("comb", mesh)
}

fn comb_at(by: DVec3) -> (Site, View) {
    let mut site = site_at(moved(comb(), by), Casters::Material, DVec3::ZERO);
    let lamps = [DVec3::new(0.02, 0.3, 0.01), DVec3::new(-0.2, 0.25, 0.1)];
    site.lights = staged(lamps.map(|p| point(p + by, 1.0)));
    let eye = by + DVec3::new(0.06, 0.05, 0.12);
    let view = View {
        near: 1e-4,
        ..site.look(eye, by + DVec3::new(0.0, 0.0, 0.01), SIZE)
    };
    (site, view)
}

#[test]
fn millimetres_at_ten_thousand_kilometres() {
    for by in FAR.into_iter().chain([DVec3::ZERO]) {
        let (site, view) = comb_at(by);
        for method in EXACT {
            let found = check(&site, &site.lights, &view, method);
            assert!(found.judgement.samples > 2000);
            assert_exact(&format!("a comb at {by}, {}", method.name()), &found);
        }
    }
}

/// What is drawn from positions rounded to f32 is not that world.
#[test]
fn without_residuals_it_goes_red() {
    let (mut site, view) = comb_at(FAR[2]);
    let rounded = Mesh {
        residuals: Vec::new(),
        ..site.stage.mesh.clone()
    };
    site.stage.world = World::build(&rounded).expect("a world");
    let found = check(&site, &site.lights, &view, Method::Counter);
    assert!(found.judgement.wrong > 100, "{:?}", found.judgement);
}

/// Objects that move where f32 is too coarse, in a world whose fixed part is not there.
#[test]
fn objects_far_away() {
    let by = FAR[3];
    let mut site = site_at(room::scene(), Casters::Material, DVec3::ZERO);
    site.lights = staged([point(by + DVec3::new(0.4, 2.0, 0.3), 9.0)]);
    let world = &mut site.stage.world;
    world.keep_residuals();
    let floor = world
        .insert(&crate_of(Vec3::new(3.0, 0.1, 3.0)), &Pose::at(by))
        .expect("a floor");
    let id = world
        .insert(&crate_of(Vec3::splat(0.3)), &Pose::at(by + DVec3::Y))
        .expect("a crate");
    assert!(world.object(floor).is_ok());
    for step in 0..by_profile(12, 5) {
        let at = by
            + DVec3::new(
                0.0371 * f64::from(step),
                1.0 + 0.001 * f64::from(step),
                -0.2,
            );
        site.stage.world.pose(id, &Pose::at(at)).expect("it moves");
        site.stage.mesh = site.stage.world.to_mesh();
        site.oracle = Oracle::new(&site.stage.mesh);
        let view = site.look(by + DVec3::new(2.5, 1.7, 2.2), by, SIZE);
        for method in EXACT {
            let found = check(&site, &site.lights, &view, method);
            assert!(found.judgement.samples > 500);
            assert_exact(&format!("step {step}, {}", method.name()), &found);
        }
    }
}

/// Methods that take f32 positions say so.
#[test]
fn methods_in_f32_refuse() {
    let (site, view) = comb_at(FAR[3]);
    let mut lab = common::lab();
    for method in [Method::RayTrace, Method::ShadowMap { texels: 256 }] {
        lab.prepare(&site.stage, &site.lights, &view, method);
        let refused = lab.mask(&site.stage, &site.lights, &view);
        assert!(
            matches!(refused, Err(GpuError::NeedsF32 { .. })),
            "{method:?}"
        );
    }
}
