//! Finite volumes: that their ends stay outside the light's range, and which path they take.

mod common;

use common::{Random, dense_soup, grid, point_light, spot, strewn_soup, sun};
use glam::{DVec3, Vec3};
use umbrage_core::cull::{Cull, Culls};
use umbrage_core::frame::extrusion::{LEAST_COSINE, caps_cosine, sides_cosine};
use umbrage_core::frame::{
    Distance, Extrusion, FramePlan, LightPath, PathRule, PlanOptions, ZFailReason,
};
use umbrage_core::volume::{Construction, VolumeBuilder, Volumes};
use umbrage_core::world::World;
use umbrage_core::{Casting, Light, Mesh, View};

/// As the shader moves a vertex, in f32.
fn moved(light: &Light, p: Vec3, distance: f32) -> DVec3 {
    let at = light.position.as_vec3();
    let away = p - at;
    let away = away / away.abs().max_element();
    let length = p.distance(at);
    let far = match length >= distance {
        true => p,
        false => at + away / away.length() * distance,
    };
    far.as_dvec3() - light.position
}

fn to_segment(a: DVec3, b: DVec3) -> f64 {
    let step = b - a;
    let t = (-a.dot(step) / step.length_squared()).clamp(0.0, 1.0);
    if t.is_nan() {
        return a.length();
    }
    (a + t * step).length()
}

/// From the origin.
fn to_triangle([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let foot = normal * normal.dot(a);
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(p, q)| normal.dot((q - p).cross(foot - p)) >= 0.0);
    match inside && normal != DVec3::ZERO {
        true => sides.min(foot.length()),
        false => sides,
    }
}

/// How near the end of what a plan draws of a light comes to it.
fn nearest(
    world: &World,
    light: &Light,
    volumes: &Volumes,
    plan: &FramePlan,
    number: usize,
) -> f64 {
    let of = &plan.lights[number];
    let at = |v: u32| moved(light, world.positions[v as usize], of.extrusion_m);
    let quads = &volumes.quads[of.quads.start as usize..of.quads.end as usize];
    let edges = quads.iter().map(|q| {
        let [a, b] = q.ends(&world.edges).map(at);
        to_segment(a, b)
    });
    let caps = of.caps.clone().chain(of.reversed_caps.clone());
    let caps = caps.map(|i| {
        let t = plan.caps[i as usize].triangle();
        to_triangle(world.triangles[t as usize].map(at))
    });
    edges.chain(caps).fold(f64::INFINITY, f64::min)
}

fn soup(seed: u64) -> Mesh {
    match seed % 3 {
        0 => dense_soup(seed, 12, 40),
        1 => strewn_soup(seed, 300, 0.4),
        _ => strewn_soup(seed, 2000, 0.05),
    }
}

fn lights(r: &mut Random) -> Vec<Light> {
    let mut lights: Vec<Light> = (0..8).map(|_| point_light(1.2 * r.point(), 0.8)).collect();
    lights.extend([0.02, 0.3, 5.0].map(|range| point_light(r.point(), range)));
    lights.extend([spot(r.point(), r.point(), 0.7, 1.5), sun(r.point())]);
    lights
}

fn plan(
    world: &World,
    lights: &[Light],
    volumes: &Volumes,
    eye: Vec3,
    options: &PlanOptions,
) -> FramePlan {
    let view = View::look_at(eye, Vec3::ZERO, 1.2, 1e-3, [64, 64]);
    let mut plan = FramePlan::default();
    plan.make(world, lights, volumes, &view, options);
    plan
}

fn options(distance: Distance) -> PlanOptions {
    let mut options = PlanOptions::default();
    options.extrusion = Extrusion::Finite(distance);
    options.culls = Culls::EVERY.without(Cull::View);
    options
}

#[test]
fn ends_stay_outside_the_range() {
    let (mut finite, mut infinite, mut dips) = (0, 0, 0);
    for seed in 0..60 {
        let mut r = Random(seed);
        let world = World::build(&soup(seed)).unwrap();
        let lights = lights(&mut r);
        let mut builder = VolumeBuilder::default();
        builder.construction = match seed % 5 {
            3 => Construction::Brute,
            4 => Construction::Crow,
            _ => Construction::Counter,
        };
        let mut volumes = Volumes::default();
        builder.settle(&world, &lights, |_| true, &mut volumes);
        for path in [PathRule::ZPassWhereExact, PathRule::ZFailAlways] {
            let eye = 1.5 * r.point();
            let [corrected, naive] = [Distance::Corrected, Distance::Range].map(|distance| {
                let mut options = options(distance);
                options.path = path;
                plan(&world, &lights, &volumes, eye, &options)
            });
            for (number, light) in lights.iter().enumerate() {
                let range = f64::from(light.range);
                let at = nearest(&world, light, &volumes, &naive, number);
                dips +=
                    u32::from(naive.lights[number].extrusion_m.is_finite() && at < range * 0.999);
                if corrected.lights[number].extrusion_m.is_infinite() {
                    infinite += 1;
                    continue;
                }
                finite += 1;
                let at = nearest(&world, light, &volumes, &corrected, number);
                assert!(at > range, "seed {seed}, {light:?}: {at} of {range}");
            }
        }
    }
    assert!(
        finite > 500 && infinite > 100 && dips > 300,
        "{finite} {infinite} {dips}"
    );
}

/// One triangle of known angles: the distance is that of its widest side, or of its cone.
#[test]
fn distances_are_no_longer_than_needed() {
    // Three directions at right angles: half a side subtends 45 degrees, the cone is wider.
    let mesh = Mesh {
        positions: vec![Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![[0, 1, 2]],
        casting: vec![Casting::Both],
        ..Mesh::default()
    };
    let world = World::build(&mesh).unwrap();
    let light = point_light(Vec3::ZERO, 2.0);
    let mut volumes = Volumes::default();
    VolumeBuilder::default().settle(&world, &[light], |_| true, &mut volumes);
    let sides = sides_cosine(&world, &light, volumes.quads_of(0));
    let caps = caps_cosine(&world, &light, volumes.chain_of(0));
    assert!((sides - 0.5f64.sqrt()).abs() < 1e-12, "{sides}");
    assert!((caps - (1.0f64 / 3.0).sqrt()).abs() < 1e-12, "{caps}");
    let eye = Vec3::splat(0.2);
    let mut options = options(Distance::Corrected);
    let by_zpass = plan(&world, &[light], &volumes, eye, &options).lights[0].extrusion_m;
    options.path = PathRule::ZFailAlways;
    let by_zfail = plan(&world, &[light], &volumes, eye, &options).lights[0].extrusion_m;
    for (found, expected) in [
        (by_zpass, 2.0 * 2.0f64.sqrt()),
        (by_zfail, 2.0 * 3.0f64.sqrt()),
    ] {
        let found = f64::from(found);
        assert!(
            found > expected && found < expected * 1.002,
            "{found} {expected}"
        );
    }
    // A flat triangle's smallest cone is that of its widest side.
    let flat = [
        Vec3::new(-1.0, 1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(0.0, 1.0, 0.01),
    ];
    let mesh = Mesh {
        positions: flat.to_vec(),
        ..mesh
    };
    let world = World::build(&mesh).unwrap();
    VolumeBuilder::default().settle(&world, &[light], |_| true, &mut volumes);
    let caps = caps_cosine(&world, &light, volumes.chain_of(0));
    assert!((caps - 0.5f64.sqrt()).abs() < 1e-12, "{caps}");
}

#[test]
fn what_subtends_too_much_is_extruded_to_infinity() {
    // A floor of one cell, seen from closer and closer.
    let world = World::build(&grid(1)).unwrap();
    let mut infinite = Vec::new();
    for height in [1.0, 0.1, 0.01, 0.001, 1e-4, 1e-20] {
        let light = point_light(Vec3::new(0.3, height, 0.4), 0.5);
        let mut volumes = Volumes::default();
        VolumeBuilder::default().settle(&world, &[light], |_| true, &mut volumes);
        let caps = caps_cosine(&world, &light, volumes.chain_of(0));
        let found = Distance::Corrected.of(&light, caps);
        assert_eq!(found.is_infinite(), caps < LEAST_COSINE, "{height}");
        assert!(found > light.range && (found.is_infinite() || found < 129.0));
        infinite.push(found.is_infinite());
    }
    assert_eq!(infinite, [false, false, false, true, true, true]);
    let endless = point_light(Vec3::Y, f32::INFINITY);
    for light in [endless, sun(Vec3::NEG_Y)] {
        for distance in [Distance::Range, Distance::Corrected] {
            assert!(distance.of(&light, 1.0).is_infinite());
        }
    }
}

#[test]
fn an_eye_beyond_the_range_takes_both_caps() {
    let world = World::build(&grid(4)).unwrap();
    let lights = [
        point_light(Vec3::new(0.3, 1.0, 0.4), 2.0),
        sun(Vec3::new(0.2, -1.0, 0.1)),
    ];
    let mut volumes = Volumes::default();
    VolumeBuilder::default().settle(&world, &lights, |_| true, &mut volumes);
    for distance in [Distance::Range, Distance::Corrected] {
        let options = options(distance);
        let near = plan(
            &world,
            &lights,
            &volumes,
            Vec3::new(0.1, 2.0, 0.9),
            &options,
        );
        assert!(matches!(near.lights[0].path, LightPath::ZPass { .. }));
        assert!(near.lights[0].extrusion_m.is_finite() && near.lights[0].caps.is_empty());
        let far = plan(
            &world,
            &lights,
            &volumes,
            Vec3::new(0.1, 4.0, 0.9),
            &options,
        );
        assert_eq!(
            far.lights[0].path,
            LightPath::ZFail(ZFailReason::EyeBeyondRange)
        );
        assert_eq!(
            far.lights[0].caps.len() as u32,
            volumes.lights[0].facing_triangles
        );
        assert_eq!(far.lights[0].quads, volumes.lights[0].quads);
        for plan in [near, far] {
            assert!(matches!(plan.lights[1].path, LightPath::ZPass { .. }));
            assert_eq!(plan.lights[1].extrusion_m, f32::INFINITY);
        }
    }
    let infinite = PlanOptions::default();
    let far = plan(
        &world,
        &lights,
        &volumes,
        Vec3::new(0.1, 4.0, 0.9),
        &infinite,
    );
    assert!(matches!(far.lights[0].path, LightPath::ZPass { .. }));
    assert_eq!(far.lights[0].extrusion_m, f32::INFINITY);
}

/// A plan that is used again keeps what it knows, and forgets it where volumes or paths changed.
#[test]
fn a_plan_used_again_is_the_plan_made_anew() {
    let mut r = Random(3);
    let world = World::build(&strewn_soup(8, 400, 0.3)).unwrap();
    let mut lights = lights(&mut r);
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
    let mut kept = FramePlan::default();
    for round in 0..12 {
        lights[round % 5].position += 0.1 * r.point().as_dvec3();
        builder.settle(&world, &lights, |_| true, &mut volumes);
        let mut options = options(Distance::Corrected);
        if round % 3 == 2 {
            options.path = PathRule::ZFailAlways;
        }
        let eye = r.point();
        let view = View::look_at(eye, Vec3::ZERO, 1.2, 1e-3, [64, 64]);
        kept.make(&world, &lights, &volumes, &view, &options);
        let anew = plan(&world, &lights, &volumes, eye, &options);
        assert_eq!(kept.lights, anew.lights, "round {round}");
    }
}
