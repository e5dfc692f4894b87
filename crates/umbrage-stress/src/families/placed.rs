//! Lights and eyes in general places, for families whose geometry is the matter; and a family of
//! lights of every shape and range.

use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Light, View};

use super::soup;
use crate::case::{Case, look, point, spot, sun};
use crate::rng::Random;

/// Adds one to four lights and a view.
pub(super) fn furnish(case: &mut Case, random: &mut Random) {
    for _ in 0..random.count(1, 3) {
        let light = light(case, random);
        case.lights.push(light);
    }
    let view = view(case, random);
    case.views.push(view);
}

/// A place in and around the mesh.
pub(super) fn place(case: &Case, random: &mut Random) -> Vec3 {
    let [low, high] = case.bounds().map(DVec3::as_vec3);
    let half = (high - low) * 0.5;
    low + half + random.point(1.0) * 1.3 * (half + case.size() * 0.1)
}

/// A light of any shape, whose range takes in everything, a part, or next to nothing.
pub(super) fn light(case: &Case, random: &mut Random) -> Light {
    let (position, size) = (place(case, random), case.size());
    let range = match random.below(6) {
        0 => size * random.within(0.02, 0.1),
        1 | 2 => size * random.within(0.1, 1.0),
        _ => size * random.within(1.0, 8.0),
    };
    match random.below(7) {
        0 => sun(random.direction()),
        1 => {
            let [low, high] = case.bounds().map(DVec3::as_vec3);
            let toward = ((low + high) * 0.5 - position) / size;
            let direction = (toward + random.point(0.5)).normalize_or(Vec3::NEG_Y);
            spot(position, range, direction, random.within(-0.7, 0.99))
        }
        _ => point(position, range),
    }
}

/// A near plane before everything that is worth seeing.
pub(super) fn near(case: &Case) -> f32 {
    case.size() * 1e-6
}

/// An eye above a triangle, looking at another.
pub(super) fn view(case: &Case, random: &mut Random) -> View {
    let mut center = || {
        let [a, b, c] = match case.mesh.triangles.len() {
            0 => [Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles => case.corners(random.below(triangles)),
        };
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        let length = (b - a).length().max((c - a).length());
        ((a + b + c) / 3.0, normal * length)
    };
    let ((from, above), (to, _)) = (center(), center());
    let off = random.point(1.0) * case.size() * 0.05;
    let side = if random.one_in(2) { 0.4 } else { -0.4 };
    look(from + above * side + off, to, near(case))
}

/// Cones from a needle to more than a half space, suns along axes and askew, points whose range
/// ends on, before and behind a triangle.
pub(super) fn shapes(random: &mut Random) -> Case {
    let mut case = soup::plain(random);
    let (count, size) = (random.count(1, 4), case.size());
    for _ in 0..count {
        let position = place(&case, random);
        let direction = match random.one_in(3) {
            true => random.pick(&[Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_X]),
            false => random.direction(),
        };
        let nearest = case.corners(random.below(case.mesh.triangles.len()))[0];
        let range = match random.below(5) {
            // To the last bit as far as a vertex.
            0 => (nearest - position).length(),
            1 => size * 1e-3,
            2 => 1e18,
            _ => size * random.within(0.1, 2.0),
        };
        let cosines = [
            0.999_99, 0.999, 0.9, 0.5, 1e-3, 0.0, -1e-4, -0.3, -0.95, -1.0,
        ];
        case.lights.push(match random.below(4) {
            0 => sun(direction),
            1 | 2 => spot(position, range, direction, random.pick(&cosines)),
            _ => point(position, range),
        });
    }
    if random.one_in(2) {
        let [low, high] = case.bounds().map(DVec3::as_vec3);
        let far = Vec3::new(high.x - low.x, 0.0, 0.0);
        case.quad(low, Vec3::new(0.0, 0.0, high.z - low.z), far, Casting::Both);
    }
    let view = view(&case, random);
    case.views.push(view);
    case
}
