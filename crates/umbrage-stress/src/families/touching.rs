//! Lights on the geometry, and next to it.

use glam::Vec3;

use super::closed::boxes;
use super::placed::view;
use super::soup::{Rules, plain};
use crate::case::{Case, point};
use crate::rng::Random;

/// Lights on vertices, edges and faces, and in planes beside their triangles, as f32 rounds them;
/// half of the worlds stand on a lattice, where these are met to the last bit.
pub(super) fn on(random: &mut Random) -> Case {
    with_lights(random, |place, _, _| place)
}

/// The same places, missed: by one ulp in some coordinates, or by 2^-22 to 2^-3 of the triangle's
/// size.
pub(super) fn beside(random: &mut Random) -> Case {
    with_lights(random, |place, size, random| match random.one_in(2) {
        true => place.map(|x| match random.below(3) {
            0 => x.next_up(),
            1 => x.next_down(),
            _ => x,
        }),
        false => place + random.direction() * (size / (1u32 << random.count(3, 22)) as f32),
    })
}

fn with_lights(random: &mut Random, moved: impl Fn(Vec3, f32, &mut Random) -> Vec3) -> Case {
    let mut case = match random.one_in(2) {
        true => plain(random),
        false => {
            let rules = Rules::any(random);
            boxes(random, rules)
        }
    };
    for _ in 0..random.count(1, 3) {
        let [a, b, c] = case.corners(random.below(case.mesh.triangles.len()));
        let [u, v] = [0; 2].map(|_| random.count(1, 7) as f32 / 8.0);
        let place = match random.below(6) {
            0 | 1 => a,
            2 => (a + b) * 0.5,
            3 => a + (b - a) * u,
            4 => a + (b - a) * (u * (1.0 - v)) + (c - a) * (u * v),
            _ => a + (b - a) * (1.0 + 2.0 * u) + (c - a) * v,
        };
        let size = (b - a).length().max((c - a).length());
        let position = moved(place, size, random);
        case.lights.push(point(position, random.within(4.0, 30.0)));
    }
    let view = view(&case, random);
    case.views.push(view);
    case
}
