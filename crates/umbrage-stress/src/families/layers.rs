//! Many layers: more shadows upon each other than a stencil may hold.

use glam::Vec3;
use umbrage_core::Casting;

use super::placed::near;
use crate::case::{Case, look, point, sun};
use crate::rng::Random;

/// As many as eight bits hold.
pub(super) fn layers(random: &mut Random) -> Case {
    let count = match random.one_in(3) {
        true => 127,
        false => random.count(10, 126),
    };
    stack(random, count)
}

/// As many as they do not hold, so that volumes come in parts: multiples of 256 among them.
pub(super) fn deep(random: &mut Random) -> Case {
    let count = match random.one_in(3) {
        true => random.pick(&[256, 512]),
        false => random.count(256, 700),
    };
    stack(random, count)
}

/// Sheets above a floor, under a light; each a triangle, so that their number is that of the layers
/// in the middle. Apart, crossing each other, or in one place.
fn stack(random: &mut Random, count: usize) -> Case {
    let mut case = Case::default();
    let kind = random.below(4);
    let shared = random.point(1.0);
    for k in 0..count {
        let height = 1.0 + 3.0 * k as f32 / count as f32;
        let shift = match kind {
            // The same edges, many times over.
            0 => shared * 0.5,
            _ => random.point(0.4).with_y(0.0),
        };
        let [a, b, c] = [
            Vec3::new(-3.0, 0.0, -2.0),
            Vec3::new(3.0, 0.0, -2.0),
            Vec3::new(0.0, 0.0, 4.0),
        ];
        let lift = |p: Vec3, random: &mut Random| match kind {
            // In one place; flat; leaning through each other.
            0 => p + shift + Vec3::Y * 2.0,
            1 | 2 => p + shift + Vec3::Y * height,
            _ => p + shift + Vec3::Y * (height + random.within(-0.5, 0.5)),
        };
        let corners = [a, b, c].map(|p| lift(p, random));
        let rule = Casting::Both;
        match random.one_in(2) {
            true => case.triangle(corners, rule),
            false => case.triangle([corners[0], corners[2], corners[1]], rule),
        }
    }
    case.quad(
        Vec3::new(-6.0, 0.0, -6.0),
        Vec3::Z * 12.0,
        Vec3::X * 12.0,
        Casting::Both,
    );
    let above = Vec3::new(random.within(-1.0, 1.0), 6.0, random.within(-1.0, 1.0));
    case.lights.push(match random.one_in(4) {
        true => sun(Vec3::new(0.1, -1.0, 0.2).normalize()),
        false => point(above, 40.0),
    });
    // Beside the stack, under it, and within.
    let eye = match random.below(3) {
        0 => Vec3::new(random.within(3.0, 5.0), 3.0, random.within(3.0, 5.0)),
        1 => Vec3::new(0.3, 0.5, 0.2),
        _ => Vec3::new(0.1, random.within(1.5, 3.5), 0.3),
    };
    let near = near(&case);
    case.views.push(look(eye, Vec3::new(0.0, 0.0, 0.1), near));
    case
}
