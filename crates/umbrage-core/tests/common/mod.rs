//! Random soups for the tests of this crate.
#![allow(dead_code, reason = "each test binary uses its own part")]

use std::collections::BTreeMap;

use glam::{DQuat, DVec3, Vec3};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{Pose, World};
use umbrage_core::{Casting, Cull, Culls, Light, LightShape, Mesh};

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// In -1 .. 1.
    pub(crate) fn signed(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    pub(crate) fn casting(&mut self) -> Casting {
        [Casting::None, Casting::Front, Casting::Both, Casting::Back][self.below(4)]
    }
}

/// Triangles over few vertices: edges with many triangles, duplicates, degenerate ones.
pub(crate) fn dense_soup(seed: u64, vertices: usize, triangles: usize) -> Mesh {
    let mut r = Random(seed);
    Mesh {
        positions: (0..vertices).map(|_| r.point()).collect(),
        triangles: (0..triangles)
            .map(|_| [0; 3].map(|_| r.below(vertices) as u32))
            .collect(),
        casting: (0..triangles).map(|_| r.casting()).collect(),
        ..Mesh::default()
    }
}

/// Small triangles strewn about.
pub(crate) fn strewn_soup(seed: u64, triangles: usize, size: f32) -> Mesh {
    let mut r = Random(seed);
    let mut mesh = Mesh::default();
    for t in 0..triangles as u32 {
        let at = r.point();
        mesh.positions.extend([0; 3].map(|_| at + size * r.point()));
        mesh.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        mesh.casting.push(r.casting());
    }
    mesh
}

/// A flat grid of n x n cells at height 0, facing up, on integer coordinates around the origin.
pub(crate) fn grid(n: i32) -> Mesh {
    let mut mesh = Mesh::default();
    for z in -n..n {
        for x in -n..n {
            let first = mesh.positions.len() as u32;
            let corner = |dx: i32, dz: i32| Vec3::new((x + dx) as f32, 0.0, (z + dz) as f32);
            mesh.positions
                .extend([corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)]);
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.triangles.push([first, first + 2, first + 3]);
        }
    }
    mesh.casting = vec![Casting::Front; mesh.triangles.len()];
    mesh
}

/// A closed ring of n x n cells around the y axis, wound outward, with the rule on every triangle:
/// not convex, so that it hides parts of itself.
pub(crate) fn torus(n: u32, rule: Casting) -> Mesh {
    let angle = |i: u32| std::f32::consts::TAU * i as f32 / n as f32;
    let vertex = |i: u32, j: u32| {
        let (around, across) = (angle(i), angle(j));
        let radius = 1.0 + 0.4 * across.cos();
        Vec3::new(
            radius * around.cos(),
            0.4 * across.sin(),
            radius * around.sin(),
        )
    };
    let mut mesh = Mesh::default();
    for i in 0..n {
        mesh.positions.extend((0..n).map(|j| vertex(i, j)));
        for j in 0..n {
            let at = |di: u32, dj: u32| (i + di) % n * n + (j + dj) % n;
            mesh.triangles.push([at(0, 0), at(0, 1), at(1, 1)]);
            mesh.triangles.push([at(0, 0), at(1, 1), at(1, 0)]);
        }
    }
    mesh.casting = vec![rule; mesh.triangles.len()];
    mesh
}

pub(crate) fn point_light(position: impl Into<DVec3>, range: f32) -> Light {
    Light {
        position: position.into(),
        range,
        shape: LightShape::Point,
    }
}

pub(crate) fn sun(direction: Vec3) -> Light {
    let shape = LightShape::Directional {
        direction: direction.normalize(),
    };
    Light {
        position: DVec3::ZERO,
        range: f32::INFINITY,
        shape,
    }
}

pub(crate) fn spot(
    position: impl Into<DVec3>,
    direction: Vec3,
    cos_outer: f32,
    range: f32,
) -> Light {
    let shape = LightShape::Spot {
        direction: direction.normalize(),
        cos_outer,
    };
    Light {
        position: position.into(),
        range,
        shape,
    }
}

pub(crate) fn random_pose(r: &mut Random) -> Pose {
    let axis = r.point().as_dvec3().normalize_or(DVec3::Y);
    Pose {
        rotation: DQuat::from_axis_angle(axis, 3.0 * f64::from(r.signed())),
        translation: 2.0 * r.point().as_dvec3(),
    }
}

pub(crate) fn lights(r: &mut Random, count: usize) -> Vec<Light> {
    let mut lights = vec![sun(Vec3::new(0.3, -1.0, 0.2))];
    for i in 1..count {
        let (at, range) = (2.5 * r.point(), 0.4 + 0.3 * r.signed());
        lights.push(match i % 3 {
            0 => spot(at, r.point(), 0.7, 2.0 * range),
            _ => point_light(at, range),
        });
    }
    lights
}

pub(crate) type Corners = [[u64; 3]; 3];

pub(crate) fn bits(corners: [DVec3; 3]) -> Corners {
    corners.map(|p| p.to_array().map(f64::to_bits))
}

/// The chain of a light by where its triangles stand, whatever they are numbered.
pub(crate) fn chain(
    world: &World,
    volumes: &Volumes,
    light: usize,
) -> BTreeMap<(Corners, i32), usize> {
    let mut found = BTreeMap::new();
    for t in volumes.chain_triangles(light) {
        let key = (bits(world.corners(t.triangle())), t.coefficient());
        *found.entry(key).or_default() += 1;
    }
    found
}

/// Without hidden casters, whose choice depends on the tree.
pub(crate) fn builder() -> VolumeBuilder {
    VolumeBuilder::new(Culls::EVERY.without(Cull::Hidden))
}

pub(crate) fn build(world: &World, lights: &[Light]) -> Volumes {
    let mut volumes = Volumes::default();
    builder().build(world, lights, |_| true, &mut volumes);
    volumes
}
