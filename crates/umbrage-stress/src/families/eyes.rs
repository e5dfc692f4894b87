//! Eyes and near planes where the z-pass count is in doubt.

use glam::Vec3;

use super::closed::boxes;
use super::placed::{near as small_near, place, view};
use super::soup::{Rules, plain};
use crate::case::{Case, look, point};
use crate::rng::Random;

fn world(random: &mut Random) -> Case {
    match random.one_in(2) {
        true => plain(random),
        false => {
            let rules = Rules::any(random);
            boxes(random, rules)
        }
    }
}

/// Eyes on the sides that an edge casts and within some of its length of them, in the planes of
/// sides and casters beside these, on casters, at the light and near it.
pub(super) fn eyes(random: &mut Random) -> Case {
    let mut case = world(random);
    // On a lattice, so that midpoints and doublings are exact for boxes.
    let at = (place(&case, random) * 4.0).round() * 0.25;
    case.lights.push(point(at, random.within(4.0, 40.0)));
    let [a, b, c] = case.corners(random.below(case.mesh.triangles.len()));
    let middle = (a + b) * 0.5;
    let beyond = random.pick(&[0.5, 1.0, 2.0, 4.0]);
    let on = match random.below(8) {
        0..=2 => middle + (middle - at) * beyond,
        // In the side's plane, beside it or before it.
        3 => a + (a - at) * beyond + (a - b) * random.pick(&[0.5, 2.0]),
        4 => at + (middle - at) * 0.5,
        // In the caster's plane, and on it.
        5 => a + (b - a) * 2.0 - (c - a),
        6 => random.pick(&[(a + b + c) / 3.0, a, middle]),
        _ => at,
    };
    let size = case.size();
    let off = match random.below(4) {
        0 => on,
        1 => on.map(|x| {
            if random.one_in(2) {
                x.next_up()
            } else {
                x.next_down()
            }
        }),
        _ => on + random.direction() * (size / (1u32 << random.count(4, 24)) as f32),
    };
    let ahead = match random.one_in(2) {
        true => random.direction(),
        false => (off - at).normalize_or(Vec3::X) + random.direction() * 0.4,
    };
    let near = small_near(&case);
    case.views.push(look(off, off + ahead, near));
    case
}

/// Near planes some way into the world: sides and casters lie before them.
pub(super) fn near(random: &mut Random) -> Case {
    let mut case = world(random);
    for _ in 0..random.count(1, 3) {
        let at = place(&case, random);
        case.lights.push(point(at, random.within(2.0, 40.0)));
    }
    let mut view = view(&case, random);
    view.near = case.size() * random.pick(&[0.01, 0.05, 0.2, 0.5]);
    case.views.push(view);
    case
}
