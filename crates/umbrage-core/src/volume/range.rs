//! Quads that cannot reach a point the light can light, moved behind those that can.
//!
//! Takes a light and its quads; gives them in stable order, in three groups: those that may touch
//! the light's *reach* (its range, for a spot cut by its cone), those that may touch only the rest
//! of the range, and the others. A quad is the part of the wedge between the light and its edge
//! that lies beyond the edge, so it comes no nearer to the light than the edge does and keeps to
//! the wedge's directions: an edge outside the range, or a wedge outside the cone, is a quad
//! outside. Reach and range are convex: along a ray from an eye inside to a lit point inside, no
//! quad of the later groups is crossed, and they need not be drawn.

use glam::{DVec3, Vec3};

use super::Quad;
use crate::light::{Light, LightShape};
use crate::world::World;

/// A light's quads from the front of the list that suffice for eyes in its reach or range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RangePrefix {
    /// Quads that may touch the reach.
    pub reach: u32,
    /// Quads that may touch the range; `reach` if the light has no cone, or one of 180 degrees or
    /// more, which is not convex.
    pub range: u32,
}

/// What a light can light, prepared for many tests in f64.
#[derive(Clone, Copy, Debug)]
pub struct QuadReach {
    light: DVec3,
    /// Squared range with slack; infinite for a directional light.
    range2: f64,
    /// Axis and cosine, with slack.
    cone: Option<(DVec3, f64)>,
    /// The light's own, for points that are clearly inside.
    inner: Inner,
}

/// The reach without slack, in f32: where a point is inside, no rounding puts it outside the other.
#[derive(Clone, Copy, Debug)]
struct Inner {
    range2: f32,
    /// Axis and squared cosine; anything is inside if the cosine is negative.
    axis: Vec3,
    cos2: f32,
}

impl Inner {
    #[inline]
    fn has(&self, from_light: DVec3) -> bool {
        let v = from_light.as_vec3();
        let (along, distance2) = (v.dot(self.axis), v.length_squared());
        distance2 <= self.range2
            && (self.cos2 < 0.0 || along > 0.0 && along * along >= self.cos2 * distance2)
    }
}

/// Relative to the range, and of the cosine: far above what a shader's f32 test may be off by, with
/// which a host decides where a light ends.
pub(crate) const SLACK: f64 = 1.0 / 1024.0;

/// Where an edge's quad can matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum QuadRange {
    /// It may touch the reach.
    Reach,
    /// It may touch the range, not the reach.
    Range,
    /// Neither.
    Beyond,
}

impl QuadReach {
    /// Of a light.
    pub fn new(light: &Light) -> Self {
        let range = f64::from(light.range) * (1.0 + SLACK);
        let (axis, cos2) = match light.shape {
            LightShape::Spot {
                direction,
                cos_outer,
            } if f64::from(cos_outer) > SLACK => (direction, cos_outer * cos_outer),
            _ => (Vec3::ZERO, -1.0),
        };
        Self {
            inner: Inner {
                range2: light.range * light.range,
                axis,
                cos2,
            },
            light: light.position,
            range2: if light.is_directional() {
                f64::INFINITY
            } else {
                range * range
            },
            cone: match light.shape {
                LightShape::Spot {
                    direction,
                    cos_outer,
                } if f64::from(cos_outer) > SLACK => Some((
                    direction.as_dvec3().normalize_or_zero(),
                    f64::from(cos_outer) - SLACK,
                )),
                _ => None,
            },
        }
    }

    /// Where the quad of an edge can matter.
    pub fn of_edge(&self, ends: [DVec3; 2]) -> QuadRange {
        if self.range2 == f64::INFINITY && self.cone.is_none() {
            return QuadRange::Reach;
        }
        let [a, b] = ends.map(|p| p - self.light);
        if self.inner.has(a) || self.inner.has(b) {
            return QuadRange::Reach;
        }
        if segment_distance2(a, b) > self.range2 {
            return QuadRange::Beyond;
        }
        match self.cone {
            Some((axis, cos)) if wedge_cos(a, b, axis) < cos => QuadRange::Range,
            _ => QuadRange::Reach,
        }
    }
}

/// Squared distance from the origin to a segment.
fn segment_distance2(a: DVec3, b: DVec3) -> f64 {
    let step = b - a;
    let t = (-a.dot(step) / step.length_squared()).clamp(0.0, 1.0);
    if t.is_nan() {
        return 0.0;
    }
    (a + t * step).length_squared()
}

/// Largest cosine between an axis and a direction between `a` and `b`; 1 where in doubt.
fn wedge_cos(a: DVec3, b: DVec3, axis: DVec3) -> f64 {
    let normal = a.cross(b);
    if normal.length_squared() <= 1e-20 * a.length_squared() * b.length_squared() {
        return 1.0;
    }
    let normal = normal.normalize();
    let flat = axis - axis.dot(normal) * normal;
    if a.cross(flat).dot(normal) >= 0.0 && flat.cross(b).dot(normal) >= 0.0 {
        return flat.length();
    }
    a.normalize().dot(axis).max(b.normalize().dot(axis))
}

/// Sorts `quads` by [`QuadRange`], stably. `scratch` is overwritten.
pub fn range_first(
    world: &World,
    light: &Light,
    quads: &mut [Quad],
    scratch: &mut Vec<Quad>,
) -> RangePrefix {
    let reach = QuadReach::new(light);
    scratch.clear();
    scratch.resize(quads.len(), Quad::default());
    // Quads in reach move forward in place; of the others, those in range fill the scratch from
    // its start and the rest from its end, backwards.
    let (mut in_reach, mut in_range, mut rest) = (0, 0, quads.len());
    for i in 0..quads.len() {
        let quad = quads[i];
        let ends = quad.ends(&world.edges).map(|v| world.places().at(v));
        match reach.of_edge(ends) {
            QuadRange::Reach => {
                quads[in_reach] = quad;
                in_reach += 1;
            }
            QuadRange::Range => {
                scratch[in_range] = quad;
                in_range += 1;
            }
            QuadRange::Beyond => {
                rest -= 1;
                scratch[rest] = quad;
            }
        }
    }
    scratch[rest..].reverse();
    quads[in_reach..in_reach + in_range].copy_from_slice(&scratch[..in_range]);
    quads[in_reach + in_range..].copy_from_slice(&scratch[rest..]);
    RangePrefix {
        reach: in_reach as u32,
        range: (in_reach + in_range) as u32,
    }
}

impl RangePrefix {
    /// All of a light's `quads`, in whatever order, for any eye.
    pub(super) fn all(quads: u32) -> Self {
        Self {
            reach: quads,
            range: quads,
        }
    }

    /// How many of the light's `all` quads an eye must draw.
    pub fn for_eye(&self, light: &Light, eye: DVec3, all: u32) -> u32 {
        let v = eye - light.position;
        if light.is_directional() || v.length() > f64::from(light.range) {
            return all;
        }
        match light.shape {
            LightShape::Spot {
                direction,
                cos_outer,
            } if v.dot(direction.as_dvec3().normalize_or_zero())
                < f64::from(cos_outer) * v.length() =>
            {
                self.range
            }
            _ => self.reach,
        }
    }
}
