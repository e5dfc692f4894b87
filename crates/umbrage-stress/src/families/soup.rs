//! Soups: what no modeller would make.

use glam::Vec3;
use umbrage_core::Casting;

use super::placed::furnish;
use crate::case::Case;
use crate::rng::Random;

/// Which rules the triangles of a case follow.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rules {
    One(Casting),
    /// Front and both, as materials have them.
    Material,
    /// All four.
    Mixed,
}

impl Rules {
    pub(super) fn any(random: &mut Random) -> Self {
        match random.below(6) {
            0 => Rules::One(Casting::Front),
            1 | 2 => Rules::One(Casting::Both),
            3 => Rules::One(Casting::Back),
            4 => Rules::Material,
            _ => Rules::Mixed,
        }
    }

    pub(super) fn of_one(self, random: &mut Random) -> Casting {
        match self {
            Rules::One(rule) => rule,
            Rules::Material => random.pick(&[Casting::Front, Casting::Both]),
            Rules::Mixed => {
                random.pick(&[Casting::Front, Casting::Both, Casting::Back, Casting::None])
            }
        }
    }
}

/// Triangles between few points.
pub(super) fn soup(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = between_points(random, rules);
    furnish(&mut case, random);
    case
}

/// All four rules on every edge.
pub(super) fn casting(random: &mut Random) -> Case {
    let mut case = between_points(random, Rules::Mixed);
    furnish(&mut case, random);
    case
}

fn between_points(random: &mut Random, rules: Rules) -> Case {
    let points: Vec<Vec3> = (0..random.count(4, 24))
        .map(|_| random.point(4.0))
        .collect();
    let mut case = Case::default();
    for _ in 0..random.count(8, 100) {
        // Now and then a corner comes twice: such a triangle has no area.
        let corners = [0; 3].map(|_| random.pick(&points));
        let rule = rules.of_one(random);
        case.triangle(corners, rule);
    }
    case
}

/// Edges with many triangles, some of them twice or turned over.
pub(super) fn fans(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = Case::default();
    for _ in 0..random.count(2, 10) {
        let a = random.point(4.0);
        let b = a + random.point(2.0);
        for _ in 0..random.count(1, 12) {
            let c = a + random.point(2.0);
            let corners = match random.one_in(2) {
                true => [a, b, c],
                false => [b, a, c],
            };
            let rule = rules.of_one(random);
            case.triangle(corners, rule);
            match random.below(8) {
                0 => case.triangle(corners, rule),
                1 => case.triangle([corners[1], corners[0], corners[2]], rule),
                _ => {}
            }
        }
    }
    furnish(&mut case, random);
    case
}

/// Triangles apart from each other, without lights: for families of placements.
pub(super) fn plain(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = Case::default();
    for _ in 0..random.count(6, 50) {
        let a = random.point(4.0);
        let corners = [a, a + random.point(2.0), a + random.point(2.0)];
        let rule = rules.of_one(random);
        case.triangle(corners, rule);
    }
    case
}
