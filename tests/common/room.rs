//! A room with objects, on a lattice of 1/16 m: midpoints and extrusions by powers of two are
//! exact in f32, so a test can stand exactly on a plane.

use glam::Vec3;
use umbrage_core::{Casting, Light, LightShape};
use umbrage_lab::stage::StageLight;
use umbrage_scene::{Mesh, Scene};

use super::{point, scene_of, staged};

/// Inner corners of the room.
pub(crate) const LOW: Vec3 = Vec3::new(-8.0, 0.0, -6.0);
pub(crate) const HIGH: Vec3 = Vec3::new(8.0, 5.0, 6.0);

/// Where the table's closed box stands.
pub(crate) const BOX: [Vec3; 2] = [Vec3::new(-3.0, 0.0, -2.0), Vec3::new(-1.0, 1.5, 0.0)];

/// A leaning double-sided triangle.
pub(crate) const SAIL: [Vec3; 3] = [
    Vec3::new(1.0, 0.5, 2.0),
    Vec3::new(3.5, 1.0, 1.0),
    Vec3::new(2.0, 3.0, 2.5),
];

/// Walls seen from inside, a closed box, a floating cube and a pillar: two triangles on each edge.
pub(crate) fn boxes() -> Scene {
    scene_of("boxes", cuboids())
}

fn cuboids() -> Mesh {
    let mut mesh = Mesh {
        name: "room".to_owned(),
        ..Mesh::default()
    };
    cuboid(&mut mesh, LOW, HIGH, true);
    cuboid(&mut mesh, BOX[0], BOX[1], false);
    cuboid(
        &mut mesh,
        Vec3::new(0.5, 2.0, -3.5),
        Vec3::new(1.5, 3.0, -2.5),
        false,
    );
    cuboid(
        &mut mesh,
        Vec3::new(4.0, 0.0, -2.0),
        Vec3::new(4.5, 5.0, -1.5),
        false,
    );
    mesh
}

/// The boxes, a double-sided sail, a single-sided screen, and a fan of three triangles on one edge.
pub(crate) fn scene() -> Scene {
    let mut mesh = cuboids();
    triangle(&mut mesh, SAIL, 1);
    let screen = [
        Vec3::new(-5.0, 0.5, 2.0),
        Vec3::new(-3.0, 0.5, 3.0),
        Vec3::new(-3.0, 2.5, 3.0),
        Vec3::new(-5.0, 2.5, 2.0),
    ];
    quad(&mut mesh, screen, 0);
    let (a, b) = (Vec3::new(-6.0, 1.0, -4.0), Vec3::new(-5.0, 3.0, -4.5));
    for c in [
        Vec3::new(-6.5, 2.5, -3.0),
        Vec3::new(-4.5, 1.5, -3.0),
        Vec3::new(-5.5, 2.0, -5.5),
    ] {
        triangle(&mut mesh, [a, b, c], 1);
    }
    scene_of("room", mesh)
}

pub(crate) fn triangle(mesh: &mut Mesh, corners: [Vec3; 3], material: u32) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh.materials.push(material);
}

/// Front where a, b, c, d run counter-clockwise.
pub(crate) fn quad(mesh: &mut Mesh, [a, b, c, d]: [Vec3; 4], material: u32) {
    triangle(mesh, [a, b, c], material);
    triangle(mesh, [a, c, d], material);
}

/// Counter-clockwise from outside; bits 0, 1, 2 of a corner's number say high in x, y, z.
pub(crate) const CUBOID_FACES: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Fronts outwards, or inwards.
fn cuboid(mesh: &mut Mesh, low: Vec3, high: Vec3, inwards: bool) {
    let p = |k: u32| {
        let pick = |bit: u32, low: f32, high: f32| if k & bit == 0 { low } else { high };
        Vec3::new(
            pick(1, low.x, high.x),
            pick(2, low.y, high.y),
            pick(4, low.z, high.z),
        )
    };
    for [a, b, c, d] in CUBOID_FACES {
        let corners = if inwards { [d, c, b, a] } else { [a, b, c, d] };
        quad(mesh, corners.map(p), 0);
    }
}

/// A box with its front outside.
pub(crate) fn crate_of(half: Vec3) -> umbrage_core::Mesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half * Vec3::new(sign(0), sign(1), sign(2))
    };
    let triangles: Vec<[u32; 3]> = (CUBOID_FACES.into_iter())
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    umbrage_core::Mesh {
        positions: (0..8).map(corner).collect(),
        casting: vec![Casting::Front; triangles.len()],
        triangles,
        ..umbrage_core::Mesh::default()
    }
}

/// One light of each kind and temper: free ones, one in the box, one close to the floor, a spot, a
/// sun, and one whose range touches little.
pub(crate) fn lights() -> Vec<StageLight> {
    let spot = LightShape::Spot {
        direction: Vec3::new(0.0, -0.8, -0.6),
        cos_outer: 0.75,
    };
    let sun = LightShape::Directional {
        direction: Vec3::new(0.48, -0.8, 0.36),
    };
    staged([
        point(Vec3::new(0.5, 4.5, 1.0), 20.0),
        point(Vec3::new(-4.0, 2.0, -1.0), 9.0),
        point((BOX[0] + BOX[1]) * 0.5, 8.0),
        point(Vec3::new(2.0, 0.0625, -4.0), 10.0),
        Light {
            position: Vec3::new(1.0, 4.5, 3.0).into(),
            range: 12.0,
            shape: spot,
        },
        Light {
            position: glam::DVec3::ZERO,
            range: f32::INFINITY,
            shape: sun,
        },
        point(Vec3::new(2.0, 2.0, 2.5), 1.25),
    ])
}
