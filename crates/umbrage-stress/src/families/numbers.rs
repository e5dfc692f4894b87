//! Numbers at the ends of what f32 can hold or tell apart.

use glam::{DVec3, Vec3};

use super::placed::furnish;
use super::soup::{Rules, fans, soup};
use crate::case::Case;
use crate::rng::Random;

/// Needles and caps between other triangles.
pub(super) fn slivers(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = Case::default();
    for _ in 0..random.count(4, 40) {
        let (a, along) = (random.point(4.0), random.point(3.0));
        let thin = random.direction() * (along.length() / random.decades(0, 6) as f32);
        let corners = match random.below(3) {
            0 => [a, a + along, a + thin],
            1 => [a, a + along, a + along * random.within(0.0, 1.0) + thin],
            _ => [a, a + along, a + along + thin],
        };
        let rule = rules.of_one(random);
        case.triangle(corners, rule);
        // A neighbour across the long edge, so that it carries no quad alone.
        if random.one_in(2) {
            let c = a + random.point(2.0);
            case.triangle([a + along, a, c], rule);
        }
    }
    furnish(&mut case, random);
    case
}

/// A soup whose size is anything from a micrometre to a thousand kilometres.
pub(super) fn scales(random: &mut Random) -> Case {
    let factor = random.decades(-7, 5) as f32;
    let mut case = any(random);
    scale(&mut case, factor);
    case
}

/// Multiplies all lengths; as f32 rounds them, so that planes that had four points may not.
fn scale(case: &mut Case, factor: f32) {
    for p in &mut case.mesh.positions {
        *p *= factor;
    }
    for light in &mut case.lights {
        light.position *= factor;
        light.range *= factor;
    }
    for view in &mut case.views {
        view.eye *= factor;
        view.near *= factor;
    }
}

/// Far from zero in f32: coordinates are whole steps of what f32 can hold there, and the geometry is
/// some tens to thousands of them wide.
pub(super) fn far(random: &mut Random) -> Case {
    let mut case = any(random);
    let away = random.decades(2, 6) as f32;
    let offset = random.direction() * away;
    // 2^-23 of the distance is a step; 4 m of soup become some 16 to 2^20 of them.
    let steps = (1u32 << random.count(4, 20)) as f32;
    scale(&mut case, away / (1u32 << 23) as f32 * steps);
    for p in &mut case.mesh.positions {
        *p += offset;
    }
    for light in &mut case.lights {
        light.position += offset;
    }
    for view in &mut case.views {
        view.eye += offset;
    }
    case
}

/// A world origin far away, with detail of millimetres around it: f64 positions from which the
/// origin is subtracted before they are rounded.
///
/// The one place where positions are f64. They are absolute here; the mesh holds what is left of
/// them relative to [`Case::origin`].
pub(super) fn origins(random: &mut Random) -> Case {
    let mut case = any(random);
    let origin = match random.one_in(8) {
        true => DVec3::ZERO,
        false => random.direction().as_dvec3() * random.decades(2, 6),
    };
    // Absolute positions, as f64 rounds them.
    let absolute = |p: Vec3| p.as_dvec3() + origin;
    case.origin = origin.round();
    let local = |p: Vec3| (absolute(p) - case.origin).as_vec3();
    for p in &mut case.mesh.positions {
        *p = local(*p);
    }
    for light in &mut case.lights {
        light.position = local(light.position);
    }
    for view in &mut case.views {
        view.eye = local(view.eye);
    }
    case
}

fn any(random: &mut Random) -> Case {
    match random.one_in(2) {
        true => fans(random),
        false => soup(random),
    }
}
