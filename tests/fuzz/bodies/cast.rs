//! From triangles and lights to what is drawn: world, volumes, plan.

use glam::{DVec3, Vec3};
use umbrage_core::frame::{Distance, Extrusion, FramePlan, PathRule, PlanOptions};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{World, WorldError};
use umbrage_core::{Light, LightShape, Mesh, View};

/// Builds the world of a mesh with finite positions and indices in range, and casts the shadows of
/// `lights` and of one among the triangles in it. A mesh that reaches too far becomes no world.
pub(super) fn cast(mesh: &Mesh, mut lights: Vec<Light>) {
    let world = match World::build(mesh) {
        Ok(world) => world,
        Err(WorldError::TooFar { vertex, limit }) => {
            let place = mesh.places().at(vertex as u32);
            assert!(place.abs().max_element() > f64::from(limit));
            return;
        }
        Err(error) => panic!("a mesh in bounds is no world: {error}"),
    };
    if let Err(fault) = world.validate() {
        panic!("a world that is none: {fault}");
    }
    lights.push(among(&world));
    let volumes = shadows(&world, &lights);
    if let Err(fault) = volumes.check_closed(&world) {
        panic!("an open volume: {fault}");
    }
}

/// A light off the middle of the first corners.
fn among(world: &World) -> Light {
    let count = world.positions.len().min(4) as u32;
    let sum: DVec3 = (0..count)
        .map(|v| world.places().at(v) / f64::from(count))
        .sum();
    Light {
        position: sum + DVec3::new(0.01, 0.02, 0.03),
        range: f32::INFINITY,
        shape: LightShape::Point,
    }
}

/// Volumes of all lights, hidden casters left out, and plans of every kind for a view of them.
pub(super) fn shadows(world: &World, lights: &[Light]) -> Volumes {
    let mut volumes = Volumes::default();
    let mut builder = VolumeBuilder::default();
    builder.settle(world, lights, |_| true, &mut volumes);
    let eye = world.positions.first().copied().unwrap_or_default() + Vec3::ONE;
    let view = View::look_at(eye, Vec3::ZERO, 1.0, 0.05, [64, 48]);
    let mut plan = FramePlan::default();
    let mut options = PlanOptions::default();
    for (path, extrusion) in [
        (PathRule::ZPassWhereExact, Extrusion::Infinite),
        (PathRule::ZFailAlways, Extrusion::Infinite),
        (
            PathRule::ZPassWhereExact,
            Extrusion::Finite(Distance::Corrected),
        ),
    ] {
        (options.path, options.extrusion) = (path, extrusion);
        plan.make(world, lights, &volumes, &view, &options);
        assert_eq!(plan.lights.len(), lights.len());
        for light in &plan.lights {
            let rect = light.scissor;
            assert!(rect.x + rect.width <= 64 && rect.y + rect.height <= 48);
        }
    }
    volumes
}
