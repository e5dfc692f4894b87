//! Things in one plane.

use glam::Vec3;
use umbrage_core::Casting;

use super::placed::{furnish, near};
use super::soup::Rules;
use crate::case::{Case, look, point, sun};
use crate::rng::Random;

/// Planes full of triangles that overlap, with duplicates, some turned over, and T-junctions whose
/// middle lies on the edge to the last bit.
pub(super) fn overlaps(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = Case::default();
    for _ in 0..random.count(1, 4) {
        // On a lattice, so that all points are in the plane exactly.
        let on_lattice = |p: Vec3| (p * 16.0).round() / 16.0;
        let at = on_lattice(random.point(3.0));
        let [u, v] = [0; 2].map(|_| on_lattice(random.point(1.0)));
        let steps = |random: &mut Random| (random.count(0, 8) as f32 - 4.0) * 0.5;
        for _ in 0..random.count(2, 12) {
            let corners = [0; 3].map(|_| at + u * steps(random) + v * steps(random));
            let [a, b, c] = corners;
            let rule = rules.of_one(random);
            case.triangle(corners, rule);
            match random.below(6) {
                0 => case.triangle(corners, rule),
                1 => case.triangle([c, b, a], rule),
                // Two triangles beyond a-b that share half of it each.
                2 => {
                    let (middle, below) = ((a + b) * 0.5, a + b - c);
                    case.triangle([a, below, middle], rule);
                    case.triangle([middle, below, b], rule);
                }
                _ => {}
            }
        }
    }
    furnish(&mut case, random);
    case
}

/// Whole coordinates from 0 to 3: most planes hold several triangles, a light and an eye.
pub(super) fn lattice(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = Case::default();
    let whole =
        |random: &mut Random| Vec3::from_array(std::array::from_fn(|_| random.below(4) as f32));
    let half = |random: &mut Random| {
        Vec3::from_array(std::array::from_fn(|_| random.below(11) as f32 * 0.5 - 1.0))
    };
    for _ in 0..random.count(6, 60) {
        let corners = [0; 3].map(|_| whole(random));
        let rule = rules.of_one(random);
        case.triangle(corners, rule);
    }
    // A floor that receives and cannot matter otherwise.
    let down = Vec3::new(-2.0, -2.0, -2.0);
    case.quad(down, Vec3::Z * 8.0, Vec3::X * 8.0, Casting::None);
    for _ in 0..random.count(1, 3) {
        let at = half(random);
        case.lights.push(match random.one_in(5) {
            true => sun((whole(random) - Vec3::ONE)
                .try_normalize()
                .unwrap_or(Vec3::NEG_Y)),
            false => point(at, random.pick(&[1.0, 2.0, 20.0])),
        });
    }
    let near = near(&case);
    case.views.push(look(half(random), whole(random), near));
    for _ in 0..4 {
        let at = half(random).as_dvec3();
        case.points.push(at);
    }
    case
}
