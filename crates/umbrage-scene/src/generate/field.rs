//! `gen:field`: a dense height field of hills with lights above it.
//!
//! Takes the number of cells a side, of a metre each; gives `2 n^2` triangles in one open,
//! single-sided mesh with smooth normals. Hills are value noise in five octaves.

use glam::{DAffine3, DVec3, Vec2, Vec3, vec2, vec3};

use super::{rng::Rng, shape};
use crate::{Camera, Instance, Light, Mesh, Progress, Scene};

/// Builds the field.
pub(super) fn build(n: u32, lights: usize, seed: u64, progress: &dyn Progress) -> Scene {
    let side = n + 1;
    let half = n as f32 * 0.5;
    let height = |x: i64, z: i64| hills(seed, x as f32, z as f32);
    let mut mesh = Mesh {
        name: "field".to_owned(),
        ..Mesh::default()
    };
    progress.stage("field", u64::from(side));
    for row in 0..i64::from(side) {
        for column in 0..i64::from(side) {
            let (x, z) = (column as f32 - half, row as f32 - half);
            mesh.positions.push(vec3(x, height(column, row), z));
            let slope = |a: f32, b: f32| (b - a) * 0.5;
            let dx = slope(height(column - 1, row), height(column + 1, row));
            let dz = slope(height(column, row - 1), height(column, row + 1));
            mesh.normals.push(vec3(-dx, 1.0, -dz).normalize());
        }
        progress.advance(row as u64 + 1);
    }
    for row in 0..n {
        for column in 0..n {
            let [a, b] = [row * side + column, (row + 1) * side + column];
            mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    mesh.materials = vec![0; mesh.triangles.len()];

    let mut scene = Scene::default();
    scene
        .materials
        .push(shape::paint("grass", [0.16, 0.22, 0.09], false));
    let mut rng = Rng::new(seed, [-1, -1]);
    for number in 0..lights {
        let at = vec2(rng.unit(), rng.unit()) * n as f32;
        let y = hills(seed, at.x, at.y) + rng.within(2.0, 8.0);
        scene.lights.push(Light {
            name: format!("light_{number}"),
            position: vec3(at.x - half, y, at.y - half).as_dvec3(),
            color: vec3(1.0, rng.within(0.5, 0.95), rng.within(0.3, 0.9)),
            intensity: rng.within(60.0, 140.0),
            range: Some(rng.within(16.0, 32.0)),
            ..Light::default()
        });
    }
    let top = mesh.positions.iter().fold(0.0f32, |top, p| top.max(p.y));
    let eye = Vec3::new(0.0, top + 4.0 + 0.1 * half, half * 0.9).as_dvec3();
    scene
        .cameras
        .push(Camera::look_at("default", eye, DVec3::ZERO, 1.0));
    let transform = DAffine3::IDENTITY;
    scene.instances.push(Instance {
        name: "field".to_owned(),
        mesh: 0,
        transform,
        ..Instance::default()
    });
    scene.meshes.push(mesh);
    scene
}

/// Height of the hills in metres at a place in metres.
fn hills(seed: u64, x: f32, z: f32) -> f32 {
    let octaves = [
        (1.0 / 96.0, 14.0),
        (1.0 / 37.0, 6.0),
        (1.0 / 15.0, 2.2),
        (0.17, 0.8),
        (0.43, 0.25),
    ];
    octaves
        .iter()
        .zip(0u64..)
        .map(|(&(scale, size), o)| size * noise(seed ^ o, vec2(x, z) * scale))
        .sum()
}

/// Value noise, 0 to 1, smooth to the second derivative.
fn noise(seed: u64, at: Vec2) -> f32 {
    let cell = at.floor();
    let f = at - cell;
    let f = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let value = |dx: i64, dz: i64| Rng::new(seed, [cell.x as i64 + dx, cell.y as i64 + dz]).unit();
    let near = value(0, 0) + (value(1, 0) - value(0, 0)) * f.x;
    let far = value(0, 1) + (value(1, 1) - value(0, 1)) * f.x;
    near + (far - near) * f.y
}
