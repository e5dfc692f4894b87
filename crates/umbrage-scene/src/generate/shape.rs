//! The shapes that generated worlds are made of.
//!
//! Takes corners and sizes in metres; appends to a [`Mesh`] without normals. Invariant: triangles
//! wind counter-clockwise seen from outside.

use glam::{Vec3, vec3};

use crate::{Material, Mesh};

/// Appends a triangle, counter-clockwise from its front.
pub(super) fn triangle(mesh: &mut Mesh, corners: [Vec3; 3], material: u32) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([base, base + 1, base + 2]);
    mesh.materials.push(material);
}

/// Appends two triangles that share four vertices, counter-clockwise from the front.
pub(super) fn quad(mesh: &mut Mesh, corners: [Vec3; 4], material: u32) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles
        .extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    mesh.materials.extend([material; 2]);
}

/// Appends a closed box of twelve triangles.
pub(super) fn cuboid(mesh: &mut Mesh, low: Vec3, high: Vec3, material: u32) {
    let at = |i: usize| {
        let pick = |bit: usize, l: f32, h: f32| if i & bit == 0 { l } else { h };
        vec3(
            pick(1, low.x, high.x),
            pick(2, low.y, high.y),
            pick(4, low.z, high.z),
        )
    };
    let base = mesh.positions.len() as u32;
    mesh.positions.extend((0..8).map(at));
    for [a, b, c, d] in [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ] {
        mesh.triangles
            .extend([[a, b, c], [a, c, d]].map(|t| t.map(|v: u32| base + v)));
        mesh.materials.extend([material; 2]);
    }
}

/// The eight corners of a unit octagon, counter-clockwise seen from +Y.
pub(super) fn octagon() -> [Vec3; 8] {
    const D: f32 = std::f32::consts::FRAC_1_SQRT_2;
    [
        (1.0, 0.0),
        (D, -D),
        (0.0, -1.0),
        (-D, -D),
        (-1.0, 0.0),
        (-D, D),
        (0.0, 1.0),
        (D, D),
    ]
    .map(|(x, z)| vec3(x, 0.0, z))
}

/// Appends the side of an octagonal cone or column, open at both ends: 16 triangles, or 8 where
/// the upper radius is zero.
pub(super) fn tube(mesh: &mut Mesh, foot: Vec3, radii: [f32; 2], height: f32, material: u32) {
    let [lower, upper] = radii;
    let top = foot + Vec3::Y * height;
    let ring = octagon();
    for i in 0..8 {
        let (a, b) = (ring[i], ring[(i + 1) % 8]);
        if upper == 0.0 {
            triangle(mesh, [foot + a * lower, foot + b * lower, top], material);
        } else {
            let up = [top + b * upper, top + a * upper];
            quad(
                mesh,
                [foot + a * lower, foot + b * lower, up[0], up[1]],
                material,
            );
        }
    }
}

/// A dull material of a linear colour.
pub(super) fn paint(name: &str, rgb: [f32; 3], double_sided: bool) -> Material {
    let base_color = Vec3::from(rgb).extend(1.0);
    Material {
        name: name.to_owned(),
        base_color,
        double_sided,
        roughness: 0.8,
        ..Material::default()
    }
}

/// A material that glows by itself.
pub(super) fn glow(name: &str, rgb: [f32; 3], strength: f32) -> Material {
    Material {
        emissive: Vec3::from(rgb) * strength,
        ..paint(name, rgb, false)
    }
}
