//! `gen:soup`: triangles that fit no mesh rule, to test what must work on any soup.
//!
//! Gives, in a box of ten metres: edges with 1 to 12 triangles on them, windings at random,
//! duplicates, coplanar overlaps, T-junctions, single- and double-sided materials. Welding by exact
//! position bits finds the shared edges; the mesh itself shares no vertices.

use glam::{DAffine3, Vec3, vec3};

use super::{rng::Rng, shape};
use crate::{Camera, Instance, Light, Mesh, Scene};

const LOW: Vec3 = Vec3::splat(-5.0);
const HIGH: Vec3 = Vec3::splat(5.0);

/// Most triangles on one edge.
const FAN: usize = 12;

/// Builds the soup.
pub(super) fn build(triangles: usize, lights: usize, seed: u64) -> Scene {
    let mut rng = Rng::new(seed, [0, 0]);
    let mut mesh = Mesh {
        name: "soup".to_owned(),
        ..Mesh::default()
    };
    let mut size = FAN;
    while mesh.triangles.len() < triangles {
        let left = triangles - mesh.triangles.len();
        fan(&mut mesh, &mut rng, size.min(left));
        size = if size == 1 { FAN } else { size - 1 };
        if size == FAN && triangles - mesh.triangles.len() >= 8 {
            oddities(&mut mesh, &mut rng);
        }
    }
    let mut scene = Scene::default();
    scene
        .materials
        .push(shape::paint("single-sided", [0.75, 0.42, 0.28], false));
    scene
        .materials
        .push(shape::paint("double-sided", [0.28, 0.46, 0.75], true));
    for number in 0..lights {
        scene.lights.push(Light {
            name: format!("light_{number}"),
            position: rng.point(LOW * 0.9, HIGH * 0.9).as_dvec3(),
            color: rng.point(Vec3::splat(0.5), Vec3::ONE),
            intensity: rng.within(10.0, 30.0),
            range: Some(rng.within(4.0, 12.0)),
            ..Light::default()
        });
    }
    let eye = vec3(9.0, 6.0, 12.0).as_dvec3();
    scene
        .cameras
        .push(Camera::look_at("default", eye, glam::DVec3::ZERO, 0.9));
    let transform = DAffine3::IDENTITY;
    scene.instances.push(Instance {
        name: "soup".to_owned(),
        mesh: 0,
        transform,
        ..Instance::default()
    });
    scene.meshes.push(mesh);
    scene
}

/// `count` triangles on one edge.
fn fan(mesh: &mut Mesh, rng: &mut Rng, count: usize) {
    let a = rng.point(LOW, HIGH);
    let b = near(rng, a);
    for _ in 0..count {
        let c = near(rng, a);
        add(mesh, rng, [a, b, c]);
    }
}

/// Eight triangles: one and its duplicate, two that overlap in a plane, one with two others that
/// share half of its edge each (a T-junction), and the first turned over.
fn oddities(mesh: &mut Mesh, rng: &mut Rng) {
    let a = rng.point(LOW, HIGH);
    let (b, c) = (near(rng, a), near(rng, a));
    add(mesh, rng, [a, b, c]);
    add(mesh, rng, [a, b, c]);
    add(mesh, rng, [c, b, a]);

    let p = rng.point(LOW, HIGH);
    for shift in [0.0, 0.25] {
        let p = p + vec3(shift, 0.0, shift);
        add(mesh, rng, [p, p + Vec3::Z, p + Vec3::X]);
    }

    // Coordinates on a grid of 1/256, so that the midpoint lies exactly on the edge.
    let q = (rng.point(LOW, HIGH) * 256.0).round() / 256.0;
    let (r, s) = (q + vec3(1.0, 0.5, 0.0), q + vec3(0.25, 1.0, 0.75));
    let middle = (q + r) * 0.5;
    let below = q + vec3(0.5, -1.0, 0.25);
    add(mesh, rng, [q, r, s]);
    add(mesh, rng, [q, below, middle]);
    add(mesh, rng, [middle, below, r]);
}

/// A point within a metre and a half in each direction, and inside the box.
fn near(rng: &mut Rng, p: Vec3) -> Vec3 {
    (p + rng.point(Vec3::splat(-1.5), Vec3::splat(1.5))).clamp(LOW, HIGH)
}

/// Appends a triangle, turned or not, one- or two-sided.
fn add(mesh: &mut Mesh, rng: &mut Rng, [a, b, c]: [Vec3; 3]) {
    let corners = if rng.one_in(2) { [a, b, c] } else { [c, b, a] };
    shape::triangle(mesh, corners, rng.below(2));
}
