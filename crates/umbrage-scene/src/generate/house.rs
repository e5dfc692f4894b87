//! A house of the generated city: walls with inset windows and a roof.
//!
//! Takes a lot and a random stream; appends to a [`Mesh`]. Walls and roof together are closed
//! except under a sheet roof, which is a single layer of a double-sided material.

use glam::{Vec3, vec3};

use super::rng::Rng;
use super::shape::{cuboid, quad, triangle};
use crate::Mesh;

/// Materials of a house, as indices.
#[derive(Clone, Copy)]
pub(super) struct Paint {
    pub(super) wall: u32,
    pub(super) trim: u32,
    pub(super) roof: u32,
    /// Double-sided.
    pub(super) sheet: u32,
    pub(super) glass: u32,
    pub(super) lit: u32,
}

/// Height of a floor, and depth of a window's reveal, in metres.
const FLOOR: f32 = 3.0;
const REVEAL: f32 = 0.18;

/// Appends a house on the rectangle from `low` to `high` (its ground corners, y = 0).
pub(super) fn build(mesh: &mut Mesh, rng: &mut Rng, low: Vec3, high: Vec3, paint: Paint) {
    let floors = 2 + rng.below(3);
    let height = floors as f32 * FLOOR;
    let corners = [
        low,
        vec3(low.x, 0.0, high.z),
        high,
        vec3(high.x, 0.0, low.z),
    ]
    .map(|c| c.with_y(0.0));
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        wall(mesh, rng, from, to, floors, paint);
    }
    let [low, top] = [low.with_y(height), high.with_y(height)];
    match rng.below(4) {
        0 => flat(mesh, rng, low, top, paint),
        1 => gable(mesh, low, top, paint.sheet, paint.wall, 0.5),
        _ => gable(mesh, low, top, paint.roof, paint.wall, 0.0),
    }
    // The underside, so that light from a cellar would not pass.
    quad(
        mesh,
        [corners[0], corners[3], corners[2], corners[1]],
        paint.trim,
    );
}

/// A wall with a window, or at the ground a door, in each cell of about three metres.
fn wall(mesh: &mut Mesh, rng: &mut Rng, from: Vec3, to: Vec3, floors: u32, paint: Paint) {
    let length = (to - from).length();
    let columns = (length / 3.0) as u32;
    let along = (to - from) / columns as f32;
    let unit = (to - from) / length;
    let inward = vec3(-unit.z, 0.0, unit.x) * -REVEAL;
    for floor in 0..floors {
        for column in 0..columns {
            let origin = from + along * column as f32 + Vec3::Y * (floor as f32 * FLOOR);
            // Shared corners must be the same bits seen from both cells.
            let right = match column + 1 == columns {
                true => to + Vec3::Y * (floor as f32 * FLOOR),
                false => from + along * (column + 1) as f32 + Vec3::Y * (floor as f32 * FLOOR),
            };
            let pane = if rng.one_in(5) {
                paint.lit
            } else {
                paint.glass
            };
            cell(
                mesh,
                [origin, right],
                unit,
                inward,
                paint.wall,
                paint.trim,
                pane,
            );
        }
    }
}

/// One cell of a wall: 8 triangles around the window, 8 of its reveal, 2 of its pane.
fn cell(
    mesh: &mut Mesh,
    [left, right]: [Vec3; 2],
    unit: Vec3,
    inward: Vec3,
    wall: u32,
    trim: u32,
    pane: u32,
) {
    let up = Vec3::Y * FLOOR;
    let outer = [left, right, right + up, left + up];
    let width = (right - left).dot(unit);
    let at = |u: f32, v: f32| left + unit * (width * u) + Vec3::Y * v;
    let inner = [at(0.3, 0.9), at(0.7, 0.9), at(0.7, 2.4), at(0.3, 2.4)];
    let back = inner.map(|p| p + inward);
    for i in 0..4 {
        let j = (i + 1) % 4;
        quad(mesh, [outer[i], outer[j], inner[j], inner[i]], wall);
        quad(mesh, [inner[i], inner[j], back[j], back[i]], trim);
    }
    quad(mesh, back, pane);
}

/// A flat roof with a parapet and a chimney.
fn flat(mesh: &mut Mesh, rng: &mut Rng, low: Vec3, high: Vec3, paint: Paint) {
    cuboid(
        mesh,
        low - vec3(0.2, 0.0, 0.2),
        high + vec3(0.2, 0.25, 0.2),
        paint.trim,
    );
    let (l, h, t) = (low + Vec3::Y * 0.25, high + Vec3::Y * 0.85, 0.2);
    cuboid(mesh, l, vec3(h.x, h.y, l.z + t), paint.wall);
    cuboid(mesh, vec3(l.x, l.y, h.z - t), h, paint.wall);
    cuboid(
        mesh,
        vec3(l.x, l.y, l.z + t),
        vec3(l.x + t, h.y, h.z - t),
        paint.wall,
    );
    cuboid(
        mesh,
        vec3(h.x - t, l.y, l.z + t),
        vec3(h.x, h.y, h.z - t),
        paint.wall,
    );
    let foot = l + (h - l) * vec3(rng.within(0.2, 0.6), 0.0, rng.within(0.2, 0.6));
    cuboid(mesh, foot, foot + vec3(0.8, 1.8, 0.8), paint.roof);
}

/// A ridge along x over two slopes and two gables; `eave` metres of overhang make the slopes a
/// single open layer, none closes the roof with a floor.
fn gable(mesh: &mut Mesh, low: Vec3, high: Vec3, roof: u32, wall: u32, eave: f32) {
    let middle = (low.z + high.z) * 0.5;
    let rise = (high.z - low.z) * 0.4;
    let ridge = [
        vec3(low.x, low.y + rise, middle),
        vec3(high.x, low.y + rise, middle),
    ];
    let (a, b) = (low, vec3(high.x, low.y, low.z));
    let (c, d) = (high, vec3(low.x, low.y, high.z));
    triangle(mesh, [d, ridge[0], a], wall);
    triangle(mesh, [b, ridge[1], c], wall);
    let out = vec3(eave, 0.0, 0.0);
    let slip = |p: Vec3, z: f32| p + vec3(0.0, -0.8 * eave, z * eave);
    let ridge = [ridge[0] - out, ridge[1] + out];
    quad(
        mesh,
        [slip(d, 1.0) - out, slip(c, 1.0) + out, ridge[1], ridge[0]],
        roof,
    );
    quad(
        mesh,
        [slip(b, -1.0) + out, slip(a, -1.0) - out, ridge[0], ridge[1]],
        roof,
    );
    if eave == 0.0 {
        quad(mesh, [a, b, c, d], wall);
    }
}
