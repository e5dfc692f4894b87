//! The part of a caster that can shade anything: within the light's range and cone.
//!
//! Takes a light; cuts polygons to half spaces that contain what it reaches. A caster's points
//! beyond the reach shade only points beyond it.

use glam::DVec3;

use super::cover::Point;
use crate::light::{Light, LightShape};
use crate::volume::range::SLACK;

/// Half spaces around a light's reach.
#[derive(Clone, Debug, Default)]
pub(super) struct ReachPlanes {
    /// With slack; infinite if nothing is to be cut.
    range: f64,
    /// Inward normals of planes through a spot's position that touch its cone.
    cone: Vec<DVec3>,
}

/// Unit vectors around a circle.
const AROUND: [(f64, f64); 8] = {
    let s = std::f64::consts::FRAC_1_SQRT_2;
    [
        (1.0, 0.0),
        (s, s),
        (0.0, 1.0),
        (-s, s),
        (-1.0, 0.0),
        (-s, -s),
        (0.0, -1.0),
        (s, -s),
    ]
};

impl ReachPlanes {
    /// Of a light, replacing what was there.
    pub(super) fn set(&mut self, light: &Light) {
        self.cone.clear();
        self.range = f64::from(light.range) * (1.0 + SLACK);
        match light.shape {
            LightShape::Directional { .. } => self.range = f64::INFINITY,
            LightShape::Spot {
                direction,
                cos_outer,
            } if f64::from(cos_outer) > SLACK => {
                let axis = direction.as_dvec3().normalize_or_zero();
                let cos = f64::from(cos_outer) - SLACK;
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                self.cone
                    .extend(around(axis).map(|outward| sin * axis - cos * outward));
            }
            _ => {}
        }
    }

    /// Cuts `piece` to the reach; it is empty afterwards if it lies outside. For a light with a
    /// range `plane . r` is 1 in the piece's plane.
    pub(super) fn clip(&self, piece: &mut Vec<Point>, plane: DVec3, scratch: &mut Vec<Point>) {
        for n in &self.cone {
            cut(piece, scratch, |p| n.dot(p));
        }
        let range2 = self.range * self.range;
        if piece.len() < 3 || piece.iter().all(|p| p.ray.length_squared() <= range2) {
            return;
        }
        // The range cuts a disc out of the caster's plane.
        let normal = plane.normalize_or_zero();
        let center = plane / plane.length_squared();
        let radius2 = range2 - center.length_squared();
        if radius2 <= 0.0 {
            piece.clear();
            return;
        }
        let radius = radius2.sqrt();
        for outward in around(normal) {
            cut(piece, scratch, |p| radius - outward.dot(p - center));
        }
    }
}

/// Unit vectors around a unit axis.
fn around(axis: DVec3) -> impl Iterator<Item = DVec3> {
    let (u, v) = if axis == DVec3::ZERO {
        (DVec3::ZERO, DVec3::ZERO)
    } else {
        axis.any_orthonormal_pair()
    };
    AROUND.into_iter().map(move |(x, y)| x * u + y * v)
}

/// Keeps where the height is not negative.
fn cut(piece: &mut Vec<Point>, scratch: &mut Vec<Point>, height: impl Fn(DVec3) -> f64) {
    if piece.iter().all(|p| height(p.ray) >= 0.0) {
        return;
    }
    scratch.clear();
    for i in 0..piece.len() {
        let (p, q) = (piece[i], piece[(i + 1) % piece.len()]);
        let (hp, hq) = (height(p.ray), height(q.ray));
        if hp >= 0.0 {
            scratch.push(p);
        }
        if (hp >= 0.0) != (hq >= 0.0) {
            let t = hp / (hp - hq);
            scratch.push(Point {
                ray: p.ray + t * (q.ray - p.ray),
                closeness: p.closeness + t * (q.closeness - p.closeness),
            });
        }
    }
    std::mem::swap(piece, scratch);
}
