//! Eye counts and light rectangles.

mod common;

use common::{Random, grid, point_light, spot, strewn_soup, sun};
use glam::{DVec3, Vec3};
use umbrage_core::frame::bounds::light_rect;
use umbrage_core::frame::{EyeCount, FramePlan, LightPath, PlanOptions, eye_count};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::World;
use umbrage_core::{Light, View};

fn count(world: &World, light: &Light, eye: impl Into<DVec3>) -> EyeCount {
    let eye = eye.into();
    let mut volumes = Volumes::default();
    VolumeBuilder::default().build(world, &[*light], |_| true, &mut volumes);
    eye_count(world, light, volumes.chain_of(0), volumes.quads_of(0), eye)
}

/// Casters on the segment, by Moeller and Trumbore in f64; `None` where a decision is close.
fn plain_count(world: &World, chain: &[u32], from: DVec3, to: DVec3) -> Option<u32> {
    let mut count = 0;
    for &t in chain {
        let [a, b, c] = world.corners(t);
        let (d, u, v) = (to - from, b - a, c - a);
        let p = d.cross(v);
        let det = u.dot(p);
        let s = (from - a) / det;
        let (x, q) = (s.dot(p), s.cross(u));
        let (y, at) = (d.dot(q), v.dot(q));
        let margins = [x, y, 1.0 - x - y, at, 1.0 - at];
        let least = margins.into_iter().fold(f64::INFINITY, f64::min);
        if least.abs() < 1e-4 || det.abs() < 1e-9 {
            return None;
        }
        count += u32::from(least > 0.0);
    }
    Some(count)
}

#[test]
fn eye_counts_are_the_casters_on_the_segment() {
    let mut counted = [0; 6];
    for seed in 0..40 {
        let mut r = Random(seed ^ 99);
        let world = World::build(&strewn_soup(seed, 600, 0.5)).unwrap();
        for _ in 0..25 {
            // A spot's cone is tested by spheres around boxes, tree nodes before triangles: what is
            // counted must be what is in the volume, not what the test says of a triangle alone.
            let light = match r.below(2) {
                0 => point_light(1.5 * r.point(), 2.0),
                _ => spot(1.5 * r.point(), r.point(), 0.9, 2.0),
            };
            let eye = 2.0 * r.point();
            let mut volumes = Volumes::default();
            VolumeBuilder::default().build(&world, &[light], |_| true, &mut volumes);
            let chain: Vec<u32> = volumes
                .chain_triangles(0)
                .map(umbrage_core::volume::ChainTriangle::triangle)
                .collect();
            let (from, to) = (light.position, eye.as_dvec3());
            let Some(expected) = plain_count(&world, &chain, from, to) else {
                continue;
            };
            match eye_count(
                &world,
                &light,
                volumes.chain_of(0),
                volumes.quads_of(0),
                eye.into(),
            ) {
                EyeCount::Exact(found) => assert_eq!(found, expected, "seed {seed}"),
                EyeCount::Ambiguous => continue,
            }
            counted[expected.min(5) as usize] += 1;
        }
    }
    assert!(
        counted.iter().all(|&n| n > 0),
        "every count from 0 to 5 must occur: {counted:?}"
    );
}

/// Straight through vertices and edges inside a patch of casters: always exactly one.
#[test]
fn a_segment_through_an_interior_vertex_or_edge_counts_one_caster() {
    let world = World::build(&grid(4)).unwrap();
    for (x, z) in [
        (0.0, 0.0),
        (1.0, -1.0),
        (0.5, 0.0),
        (0.5, 0.5),
        (2.0, 0.25),
        (0.3, 0.3),
    ] {
        let light = point_light(Vec3::new(x, 2.0, z), 50.0);
        let straight = Vec3::new(x, -3.0, z);
        assert_eq!(
            count(&world, &light, straight),
            EyeCount::Exact(1),
            "{x} {z}"
        );
        let down = sun(Vec3::NEG_Y);
        assert_eq!(
            count(&world, &down, straight),
            EyeCount::Exact(1),
            "{x} {z}"
        );
        let same_side = Vec3::new(-x, 3.0, z);
        assert_eq!(count(&world, &light, same_side), EyeCount::Exact(0));
        let outside = Vec3::new(40.0, -3.0, 0.0);
        assert_eq!(count(&world, &light, outside), EyeCount::Exact(0));
    }
}

#[test]
fn an_eye_on_a_side_is_ambiguous() {
    let world = World::build(&grid(4)).unwrap();
    let light = point_light(Vec3::new(0.5, 2.0, 0.25), 50.0);
    for k in [0.5, 2.0, 30.0] {
        // A point of the rim, pushed away from the light.
        let rim = Vec3::new(4.0, 0.0, 1.3);
        let on_side = rim + k * (rim - light.position.as_vec3());
        assert_eq!(count(&world, &light, on_side), EyeCount::Ambiguous, "{k}");
        let clear = 0.05 * k * Vec3::X;
        assert_eq!(count(&world, &light, on_side - clear), EyeCount::Exact(1));
        assert_eq!(count(&world, &light, on_side + clear), EyeCount::Exact(0));
    }
    // On a caster.
    assert_eq!(
        count(&world, &light, Vec3::new(0.3, 0.0, 0.1)),
        EyeCount::Ambiguous
    );
}

#[test]
fn a_light_rectangle_holds_every_pixel_the_range_can_touch() {
    let mut r = Random(5);
    let mut empty = 0;
    for _ in 0..4000 {
        let view = View::look_at(
            r.point(),
            r.point(),
            1.0 + 0.5 * r.signed(),
            0.01,
            [160, 90],
        );
        let light = point_light(4.0 * r.point(), 1.0 + r.signed());
        let rect = light_rect(&view, &light);
        empty += u32::from(rect.is_empty());
        assert!(rect.x + rect.width <= 160 && rect.y + rect.height <= 90);
        for _ in 0..20 {
            let out = light.range * r.point().normalize_or_zero();
            let q = (light.position + out.as_dvec3() - view.eye).as_vec3();
            let depth = view.forward.dot(q);
            let x = (view.scale_x * view.right.dot(q) / depth * 0.5 + 0.5) * 160.0;
            let y = (0.5 - view.scale_y * view.up.dot(q) / depth * 0.5) * 90.0;
            if depth > 0.0 && (0.0..160.0).contains(&x) && (0.0..90.0).contains(&y) {
                let (x, y) = (x as u32, y as u32);
                let inside = (rect.x..rect.x + rect.width).contains(&x)
                    && (rect.y..rect.y + rect.height).contains(&y);
                assert!(inside, "{x} {y} outside {rect:?}");
            }
        }
    }
    assert!(empty > 500, "only {empty} lights were out of view");
}

#[test]
fn a_plan_says_why_a_light_is_not_drawn_and_takes_caps_only_where_needed() {
    let world = World::build(&grid(4)).unwrap();
    let view = View::look_at(Vec3::new(0.0, 3.0, 9.0), Vec3::ZERO, 1.0, 0.1, [64, 64]);
    let lights = [
        point_light(Vec3::new(0.0, 2.0, 0.0), 5.0),
        point_light(Vec3::new(0.0, 3.0, 90.0), 5.0),
        point_light(Vec3::new(0.0, 3.0, -40.0), 5.0),
    ];
    let (mut volumes, mut plan) = (Volumes::default(), FramePlan::default());
    VolumeBuilder::default().build(&world, &lights, |_| true, &mut volumes);
    plan.make(&world, &lights, &volumes, &view, &PlanOptions::default());
    let words: Vec<_> = plan
        .lights
        .iter()
        .map(|l| (l.path.name(), l.path.reason()))
        .collect();
    assert_eq!(words[0], ("zpass", ""));
    assert_eq!(words[1], ("skipped", "its range is outside the view"));
    assert_eq!(words[2], ("skipped", "no triangle is in its range"));
    assert!(plan.caps.is_empty() && plan.drawn().count() == 1);

    let mut zfail = PlanOptions::default();
    zfail.path = umbrage_core::frame::PathRule::ZFailAlways;
    plan.make(&world, &lights, &volumes, &view, &zfail);
    assert!(matches!(plan.lights[0].path, LightPath::ZFail(_)));
    assert_eq!(
        plan.cap_triangles(0),
        2 * volumes.chain_triangles(0).count()
    );
}
