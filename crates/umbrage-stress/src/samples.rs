//! Points at which a light's volume is asked.
//!
//! Takes a case and a light; gives points of its reach in the places where volumes go wrong: on and
//! near surfaces, just behind and far behind casters, along the sides of edges, near the light; and
//! anywhere.

use glam::DVec3;
use umbrage_core::{Light, LightShape};

use crate::case::Case;
use crate::exact::Point;
use crate::rng::Random;
use crate::surface::source;

/// Points a light.
const POINTS: usize = 24;

/// Whether the point is nearer than the light's range, and inside its cone.
pub(crate) fn reaches(light: &Light, at: DVec3) -> bool {
    let from_light = at - light.position;
    let within = from_light.length() < f64::from(light.range);
    match light.shape {
        LightShape::Directional { .. } => true,
        LightShape::Point => within,
        LightShape::Spot {
            direction,
            cos_outer,
        } => {
            let along = from_light.dot(direction.as_dvec3());
            within && along > f64::from(cos_outer) * from_light.length()
        }
    }
}

/// Points for one light; some may lie outside of its reach.
pub(crate) fn samples(case: &Case, light: &Light, random: &mut Random) -> Vec<DVec3> {
    let size = f64::from(case.size());
    let triangles = case.mesh.triangles.len();
    let [low, high] = case.bounds();
    let places = (0..POINTS).map(|k| {
        if triangles == 0 || k % 8 == 0 {
            let shares = DVec3::from_array(std::array::from_fn(|_| 1.5 * random.unit() - 0.25));
            return low + (high - low) * shares;
        }
        let [a, b, c] = case.mesh.corners(random.below(triangles));
        let shares = random.shares();
        let on = a * shares.x + b * shares.y + c * shares.z;
        let edge = a + (b - a) * random.unit();
        let small = small(random);
        let off = random.direction().as_dvec3() * small;
        match k % 8 {
            1 => on,
            2 => on + off * size,
            3 | 4 => behind(light, on, size, 3.0 * random.unit()),
            5 => behind(light, on, size, small),
            6 => behind(light, edge, size, 3.0 * random.unit()) + off * size,
            _ => match source(light) {
                Point::Near(at) => at + off * size,
                Point::Far(_) => on - off * size,
            },
        }
    });
    places.collect()
}

/// Beyond `p` as the light sees it, by a share of its distance (of `size` for a directional light).
fn behind(light: &Light, p: DVec3, size: f64, share: f64) -> DVec3 {
    match source(light) {
        Point::Near(at) => p + (p - at) * share,
        Point::Far(toward) => p - toward.normalize_or_zero() * (size * share),
    }
}

/// From 2^-30 to 1, small as often as large.
fn small(random: &mut Random) -> f64 {
    random.unit() / (1u64 << random.below(30)) as f64
}
