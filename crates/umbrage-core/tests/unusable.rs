//! What is no light or no place: stated results, never a panic, a hang or a wrong shadow.

mod common;

use common::{grid, strewn_soup};
use glam::{DVec3, Vec3};
use umbrage_core::frame::bounds::light_rect;
use umbrage_core::frame::{FramePlan, LightPath, PlanOptions, SkipReason, eye_count};
use umbrage_core::volume::{
    Chain, HiddenScratch, VolumeBuilder, Volumes, check_closed, drop_hidden, facing, plain_counter,
    range_first,
};
use umbrage_core::world::{Layer, Subset, World, WorldError, query};
use umbrage_core::{Casting, Cull, Culls, Light, LightShape, Mesh, View};

fn light(position: Vec3, range: f32, shape: LightShape) -> Light {
    Light {
        position: position.as_dvec3(),
        range,
        shape,
    }
}

fn spot(direction: Vec3, cos_outer: f32) -> LightShape {
    LightShape::Spot {
        direction,
        cos_outer,
    }
}

/// Lights that are none, each for one reason.
fn unusable() -> Vec<Light> {
    let (here, far) = (Vec3::splat(0.5), f32::INFINITY);
    let point = |position, range| light(position, range, LightShape::Point);
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut lights = Vec::new();
    for bad in numbers {
        lights.push(point(Vec3::new(0.5, bad, 0.5), far));
        lights.push(light(Vec3::splat(bad), 1.0, spot(Vec3::X, 0.5)));
        lights.push(light(here, far, spot(Vec3::new(bad, 0.0, 0.0), 0.5)));
        lights.push(light(here, far, spot(Vec3::X, bad)));
        let direction = Vec3::new(0.0, bad, 1.0);
        lights.push(light(here, far, LightShape::Directional { direction }));
    }
    for range in [f32::NAN, 0.0, -0.0, -1.0, f32::NEG_INFINITY] {
        lights.push(point(here, range));
        lights.push(light(here, range, spot(Vec3::X, 0.5)));
    }
    for direction in [Vec3::ZERO, Vec3::splat(1e-30), Vec3::splat(1e30)] {
        lights.push(light(here, far, spot(direction, 0.5)));
        lights.push(light(here, far, LightShape::Directional { direction }));
    }
    lights.push(light(here, far, spot(Vec3::X, 1.001)));
    lights.push(light(here, far, spot(Vec3::X, -1.001)));
    lights
}

/// Lights at the edge of what is one.
fn usable() -> Vec<Light> {
    let here = Vec3::splat(0.5);
    let point = |position, range| light(position, range, LightShape::Point);
    let direction = Vec3::NEG_Y;
    vec![
        point(here, f32::INFINITY),
        point(here, f32::MAX),
        point(here, f32::from_bits(1)),
        point(Vec3::splat(f32::MAX), f32::INFINITY),
        point(Vec3::splat(f32::MAX), 1.0),
        point(Vec3::splat(f32::from_bits(1)), 1.0),
        light(here, 2.0, spot(Vec3::X, 1.0)),
        light(here, 2.0, spot(Vec3::X, -1.0)),
        light(here, 2.0, spot(Vec3::X, 0.0)),
        // Position and range of a directional light are not used.
        light(Vec3::NAN, f32::NAN, LightShape::Directional { direction }),
    ]
}

fn worlds() -> [World; 2] {
    [grid(4), strewn_soup(3, 200, 0.2)].map(|mesh| World::build(&mesh).unwrap())
}

fn view() -> View {
    View::look_at(Vec3::splat(3.0), Vec3::ZERO, 1.0, 0.05, [64, 48])
}

#[test]
fn what_is_no_light_has_an_empty_volume_and_is_skipped_with_its_own_reason() {
    let lights = unusable();
    for world in worlds() {
        let (mut volumes, mut plan) = (Volumes::default(), FramePlan::default());
        let mut builder = VolumeBuilder::default();
        assert_eq!(builder.settle(&world, &lights, |_| true, &mut volumes), 0);
        plan.make(&world, &lights, &volumes, &view(), &PlanOptions::default());
        for (number, light) in lights.iter().enumerate() {
            assert!(!light.is_usable(), "{light:?}");
            assert!(volumes.quads_of(number).is_empty() && volumes.chain_of(number).is_empty());
            let skipped = LightPath::Skipped(SkipReason::Unusable);
            assert_eq!(plan.lights[number].path, skipped, "{light:?}");
        }
        assert_eq!(plan.drawn().count(), 0);
        plan.unshadowed(&lights, &view());
        assert_eq!(plan.drawn().count(), 0);
    }
}

#[test]
fn lights_at_the_edge_of_what_is_one_are_built_and_close() {
    let lights = usable();
    for world in worlds() {
        let (mut volumes, mut plan) = (Volumes::default(), FramePlan::default());
        let mut builder = VolumeBuilder::default();
        builder.settle(&world, &lights, |_| true, &mut volumes);
        volumes.check_closed(&world).unwrap();
        plan.make(&world, &lights, &volumes, &view(), &PlanOptions::default());
        for (light, plan) in lights.iter().zip(&plan.lights) {
            assert!(light.is_usable(), "{light:?}");
            let unusable = LightPath::Skipped(SkipReason::Unusable);
            assert_ne!(plan.path, unusable, "{light:?}");
        }
        // The first reaches everything, and so does the directional one.
        for light in [0, lights.len() - 1] {
            let subset = volumes.lights[light].subset_triangles;
            assert_eq!(subset as usize, world.triangles.len());
        }
    }
}

/// A light that stops being one loses its volume, and gets it back.
#[test]
fn a_light_may_break_and_recover() {
    let [world, _] = worlds();
    let mut lights = usable();
    lights.truncate(2);
    let (mut volumes, mut builder) = (Volumes::default(), VolumeBuilder::default());
    builder.settle(&world, &lights, |_| true, &mut volumes);
    let quads = volumes.quads_of(0).to_vec();
    let good = lights[0];
    lights[0].range = f32::NAN;
    builder.settle(&world, &lights, |_| true, &mut volumes);
    assert!(volumes.quads_of(0).is_empty() && !volumes.quads_of(1).is_empty());
    // It is not built again and again.
    assert_eq!(builder.settle(&world, &lights, |_| true, &mut volumes), 0);
    lights[0] = good;
    assert_eq!(builder.settle(&world, &lights, |_| true, &mut volumes), 1);
    assert_eq!(volumes.quads_of(0), quads);
}

/// The stages by themselves, for hosts that call them so.
#[test]
fn every_stage_alone_ends_and_reaches_nothing() {
    for world in worlds() {
        let (mut subset, mut scratch) = (Subset::default(), HiddenScratch::default());
        for light in unusable() {
            query(&world, Layer::Fixed, &light, &mut subset);
            assert!(subset.is_empty(), "{light:?}");
            // As if the query had let everything in.
            subset.push_range(0..world.triangles.len() as u32);
            let mut chain: Vec<Chain> = Vec::new();
            facing(&world, &light, &subset, &mut chain);
            drop_hidden(&world, &light, &mut chain, &mut scratch);
            let mut quads = Vec::new();
            let mut counters = vec![0; world.edges.vertices.len()];
            plain_counter(&world, &chain, &mut counters, &mut quads);
            range_first(&world, &light, &mut quads, &mut Vec::new());
            let triangles = chain.iter().flat_map(Chain::triangles);
            check_closed(&world, triangles, &quads).unwrap();
            eye_count(&world, &light, &chain, &quads, DVec3::splat(3.0));
            let rect = light_rect(&view(), &light);
            assert!(rect.x + rect.width <= 64 && rect.y + rect.height <= 48);
        }
    }
}

fn triangle(corner: Vec3) -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, corner],
        triangles: vec![[0, 1, 2]; 3],
        casting: vec![Casting::Both; 3],
        ..Mesh::default()
    }
}

/// Found by fuzzing OBJ files: areas of such triangles overflow f32, and the tree builder merged a
/// node with itself.
#[test]
fn areas_that_overflow_are_no_world() {
    let limit = World::MAX_COORDINATE;
    for far in [
        Vec3::Y * 3e38,
        Vec3::splat(-3e38),
        Vec3::Z * limit.next_up(),
    ] {
        let mut mesh = triangle(far);
        mesh.positions[0] = -far;
        let error = World::build(&mesh).map(|_| ()).unwrap_err();
        assert_eq!(error, WorldError::TooFar { vertex: 0, limit });
        let message = error.to_string();
        assert!(
            message.contains("vertex 0") && message.contains("scale"),
            "{message}"
        );
    }
    let found = Mesh {
        positions: vec![Vec3::X * 3e38, Vec3::Y * -3e38, Vec3::Y * 1e-40, Vec3::X],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 2, 3]],
        casting: vec![Casting::Both; 3],
        ..Mesh::default()
    };
    let refused = World::build(&found).map(|_| ());
    assert_eq!(refused, Err(WorldError::TooFar { vertex: 0, limit }));
    for bad in [f32::NAN, f32::INFINITY] {
        let refused = World::build(&triangle(Vec3::Y * bad)).map(|_| ());
        assert_eq!(refused, Err(WorldError::NotFinite { vertex: 2 }));
    }
}

#[test]
fn a_world_as_wide_as_allowed_casts_closed_volumes() {
    let limit = World::MAX_COORDINATE;
    let mut mesh = strewn_soup(7, 300, 0.5);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        *p = (*p * [limit, 1.0, 1e-30][i % 3]).clamp(Vec3::splat(-limit), Vec3::splat(limit));
    }
    let world = World::build(&mesh).unwrap();
    world.validate().unwrap();
    let lights = usable();
    let mut volumes = Volumes::default();
    VolumeBuilder::default().settle(&world, &lights, |_| true, &mut volumes);
    volumes.check_closed(&world).unwrap();
}

#[test]
fn no_triangle_and_no_light_are_a_world_and_a_plan() {
    let world = World::build(&Mesh::default()).unwrap();
    world.validate().unwrap();
    let (mut volumes, mut plan) = (Volumes::default(), FramePlan::default());
    let mut builder = VolumeBuilder::default();
    for lights in [Vec::new(), usable()] {
        builder.settle(&world, &lights, |_| true, &mut volumes);
        plan.make(&world, &lights, &volumes, &view(), &PlanOptions::default());
        assert_eq!(plan.lights.len(), lights.len());
        assert_eq!(plan.drawn().count(), 0);
    }
}

/// The tree's builder takes quadratic time over equal boxes: 40,000 took half a minute.
#[test]
fn the_same_triangle_many_thousand_times_is_soon_a_world() {
    let mut mesh = strewn_soup(5, 300, 0.2);
    for _ in 0..20_000 {
        mesh.triangles.push([0, 1, 2]);
        mesh.casting.push(Casting::Both);
    }
    let world = World::build(&mesh).unwrap();
    world.validate().unwrap();
    assert_eq!(world.triangles.len(), 20_300);
    assert!(world.bvh.nodes.len() < 600, "one leaf for all of them");
    let mut volumes = Volumes::default();
    // Looking for hidden ones among so many in one place takes longer, and has a budget.
    let mut builder = VolumeBuilder::new(Culls::EVERY.without(Cull::Hidden));
    builder.settle(&world, &usable(), |_| true, &mut volumes);
    volumes.check_closed(&world).unwrap();
}
