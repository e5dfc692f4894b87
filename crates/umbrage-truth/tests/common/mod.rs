//! Small scenes and seeded numbers.
#![allow(dead_code)]

use glam::Vec3;
use umbrage_core::{Casting, Light, LightShape, Mesh, View};

pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// SplitMix64 (Steele, Lea and Flood 2014).
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [-1, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    pub(crate) fn point(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * size
    }
}

pub(crate) fn triangle(mesh: &mut Mesh, corners: [Vec3; 3], casting: Casting) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh.casting.push(casting);
}

/// Two triangles that share the diagonal a-c; front where a, b, c, d run counter-clockwise.
pub(crate) fn quad(mesh: &mut Mesh, [a, b, c, d]: [Vec3; 4], casting: Casting) {
    triangle(mesh, [a, b, c], casting);
    triangle(mesh, [a, c, d], casting);
}

/// A rectangle in the plane y = `height`, front upwards.
pub(crate) fn plate(mesh: &mut Mesh, min: [f32; 2], max: [f32; 2], height: f32, casting: Casting) {
    let corner = |x, z| Vec3::new(x, height, z);
    let corners = [
        corner(min[0], max[1]),
        corner(max[0], max[1]),
        corner(max[0], min[1]),
        corner(min[0], min[1]),
    ];
    quad(mesh, corners, casting);
}

/// A box, fronts outwards.
pub(crate) fn closed_box(mesh: &mut Mesh, min: Vec3, max: Vec3, casting: Casting) {
    let p = |k: u32| {
        let pick = |bit: u32, lo: f32, hi: f32| if k & bit != 0 { hi } else { lo };
        Vec3::new(
            pick(1, min.x, max.x),
            pick(2, min.y, max.y),
            pick(4, min.z, max.z),
        )
    };
    for face in [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ] {
        quad(mesh, face.map(p), casting);
    }
}

pub(crate) fn point_light(position: Vec3, range: f32) -> Light {
    Light {
        position: position.into(),
        range,
        shape: LightShape::Point,
    }
}

pub(crate) fn sun(direction: Vec3) -> Light {
    Light {
        position: glam::DVec3::ZERO,
        range: 0.0,
        shape: LightShape::Directional { direction },
    }
}

/// A floor at y = 0 and a square of half side 1 at y = 1.
pub(crate) fn floor_and_square(casting: Casting) -> Mesh {
    let mut mesh = Mesh::default();
    plate(&mut mesh, [-10.0; 2], [10.0; 2], 0.0, Casting::Front);
    plate(&mut mesh, [-1.0; 2], [1.0; 2], 1.0, casting);
    mesh
}

pub(crate) fn looking_down(size: [u32; 2]) -> View {
    View::look_at(
        Vec3::new(0.3, 6.0, 7.0),
        Vec3::new(0.1, 0.0, 0.0),
        1.0,
        0.1,
        size,
    )
}

/// A bumpy height field of `cells` x `cells` quads, side 2 `half` metres, with boxes standing on
/// (and in) it.
pub(crate) fn landscape(cells: u32, half: f32, boxes: u32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut mesh = Mesh::default();
    let side = cells + 1;
    let step = 2.0 * half / cells as f32;
    for z in 0..side {
        for x in 0..side {
            let (px, pz) = (x as f32 * step - half, z as f32 * step - half);
            let height = (px * 0.7).sin() * (pz * 0.9).cos() * 0.4 + random.unit() * step * 0.1;
            mesh.positions.push(Vec3::new(px, height, pz));
        }
    }
    for z in 0..cells {
        for x in 0..cells {
            let a = z * side + x;
            mesh.triangles.push([a, a + side, a + side + 1]);
            mesh.triangles.push([a, a + side + 1, a + 1]);
            mesh.casting.extend([Casting::Front; 2]);
        }
    }
    for _ in 0..boxes {
        let at = random.point(half) * Vec3::new(1.0, 0.0, 1.0);
        let size = (random.point(0.4) + 0.6) * (half / 15.0);
        closed_box(&mut mesh, at - size, at + size, Casting::Front);
    }
    mesh
}
