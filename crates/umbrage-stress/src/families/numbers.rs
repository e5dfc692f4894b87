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
    moved(case, |p| (p * factor).as_dvec3());
    for light in &mut case.lights {
        light.range *= factor;
    }
    for view in &mut case.views {
        view.near *= factor;
    }
}

/// Puts vertices, lights and eyes, which f32 holds, elsewhere.
fn moved(case: &mut Case, to: impl Fn(Vec3) -> DVec3) {
    let positions = std::mem::take(&mut case.mesh.positions);
    case.mesh.stand(positions.into_iter().map(&to));
    for light in &mut case.lights {
        light.position = to(light.position.as_vec3());
    }
    for view in &mut case.views {
        view.eye = to(view.eye.as_vec3());
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
    moved(&mut case, |p| (p + offset).as_dvec3());
    case
}

/// Up to 1e7 m from zero in f64, with detail from metres down to tenths of millimetres: vertices with
/// residuals, lights and eyes that f32 cannot hold. In a quarter of the cases, offsets of some metres
/// that f32 holds, without residuals.
///
/// Coordinates are whole steps of 2^-24 m, which 48 bits hold anywhere here (2^-16 m without
/// residuals), and the differences from [`Case::origin`] are f32: so a file can say them.
pub(super) fn origins(random: &mut Random) -> Case {
    let mut case = any(random);
    let is_f32 = random.one_in(4);
    let (away, step) = match is_f32 {
        true => (random.decades(0, 1), 1.0 / (1u32 << 16) as f32),
        false => (random.decades(0, 6), 1.0 / (1u32 << 24) as f32),
    };
    let origin = random.direction() * away as f32;
    let origin = if is_f32 { origin.round() } else { origin };
    if random.one_in(2) {
        scale(&mut case, random.pick(&[1e-3, 0.03]));
    }
    case.origin = (origin.as_dvec3() / f64::from(step)).round() * f64::from(step);
    let origin = case.origin;
    moved(&mut case, |p| {
        ((p / step).round() * step).as_dvec3() + origin
    });
    case
}

fn any(random: &mut Random) -> Case {
    match random.one_in(2) {
        true => fans(random),
        false => soup(random),
    }
}
