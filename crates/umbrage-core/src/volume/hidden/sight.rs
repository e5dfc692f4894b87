//! Casters as the light sees them: rays, planes through the light, closeness.
//!
//! Takes a light and triangles; gives each as a cone of three rays. A point light sees a vertex
//! along the ray `p - light`; for a directional light the two coordinates across its direction and
//! a 1 play that part, so that one set of formulas, linear in the ray, serves both. *Closeness* of
//! a triangle along a ray is linear as well: the inverse of the distance in units of the ray for a
//! point, minus the depth for a directional light; larger is nearer.
//!
//! **Shared edges.** The plane through the light and an edge is computed from the edge's lower
//! vertex to its higher and then negated where a triangle runs the other way: two triangles on an
//! edge get planes that are each other's negative, bit for bit.

use glam::DVec3;

use crate::light::{Light, LightShape};
use crate::world::World;

/// A light's rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    shape: Shape,
    /// Closeness must differ by more than this to count: 1e-9 of the distance.
    pub(super) nearer: f64,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// From a point.
    Point(DVec3),
    /// Two unit axes across the direction, the direction, and the size of the world.
    Parallel([DVec3; 3], f64),
}

/// A triangle as the light sees it: counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Caster {
    /// Closeness along a ray `r` of its cone: `plane . r`.
    pub(super) plane: DVec3,
    /// Unit normals of the planes through the light and sides (0,1), (1,2), (2,0); inward.
    pub(super) sides: [DVec3; 3],
    /// Rays to its corners.
    pub(super) rays: [DVec3; 3],
    /// Twice its area as seen at unit distance, roughly; 0 if the light is too nearly in its plane
    /// or in that of a side for it to hide anything, or to be proven hidden.
    pub(super) size: f64,
}

/// Sine of the angle below which a light counts as in a triangle's plane.
const GRAZING: f64 = 1e-6;

impl Sight {
    pub(super) fn new(world: &World, light: &Light) -> Self {
        let LightShape::Directional { direction } = light.shape else {
            return Self {
                shape: Shape::Point(light.position),
                nearer: 1e-9,
            };
        };
        let along = direction.as_dvec3().normalize_or(DVec3::NEG_Y);
        let across = along.any_orthonormal_vector();
        let extent = world.bvh.nodes.first().map_or(1.0, |root| {
            let far = root.min.as_dvec3().abs().max(root.max.as_dvec3().abs());
            far.length().max(f64::MIN_POSITIVE)
        });
        Self {
            shape: Shape::Parallel([across, along.cross(across), along], extent),
            nearer: 1e-9 * extent,
        }
    }

    /// Triangle `t`.
    pub(super) fn caster(&self, world: &World, t: u32) -> Caster {
        let mut vertices = world.triangles[t as usize];
        let position = |v: u32| world.places().at(v);
        let seen = |v: u32| match self.shape {
            Shape::Point(light) => (position(v) - light, 1.0),
            Shape::Parallel([u, v_axis, along], _) => {
                let p = position(v);
                (DVec3::new(p.dot(u), p.dot(v_axis), 1.0), -p.dot(along))
            }
        };
        let mut corners = vertices.map(seen);
        let [a, b, c] = corners.map(|(ray, _)| ray);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let turn = normal.dot(a);
        if turn < 0.0 {
            vertices.swap(1, 2);
            corners.swap(1, 2);
        }
        let rays = corners.map(|(ray, _)| ray);
        let mut side_ok = true;
        let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
            let flip = vertices[i] > vertices[j];
            let (from, to) = if flip { (j, i) } else { (i, j) };
            let step = rays[to] - rays[from];
            let n = rays[from].cross(step);
            let length = self.length(n);
            let most = match self.shape {
                Shape::Point(_) => rays[from].length() * step.length(),
                Shape::Parallel(..) => step.length(),
            };
            side_ok &= length > GRAZING * most;
            if flip { -n / length } else { n / length }
        });
        let (plane, size) = match self.shape {
            Shape::Point(_) => {
                let lengths = rays.map(DVec3::length);
                // By the longest ray: beside a corner the light is in the plane as the others see it,
                // and `plane . r` is rounding.
                let longest = lengths.into_iter().fold(0.0, f64::max);
                let lengths: f64 = lengths.into_iter().product();
                let steep = turn.abs() > GRAZING * normal.length() * longest
                    && normal.length() > GRAZING * ab.length() * ac.length();
                (
                    normal / turn,
                    if steep { turn.abs() / lengths } else { 0.0 },
                )
            }
            Shape::Parallel(_, extent) => {
                // Closeness as a plane over the two coordinates across.
                let [(a, ka), (b, kb), (c, kc)] = corners;
                let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
                let (up, vp) = (ab.extend(kb - ka), ac.extend(kc - ka));
                let n = up.cross(vp);
                let slope = -n.truncate() / n.z;
                let steep =
                    n.z > GRAZING * n.length() && n.length() > GRAZING * up.length() * vp.length();
                let plane = slope.extend(ka - slope.dot(a.truncate()));
                (plane, if steep { n.z / (extent * extent) } else { 0.0 })
            }
        };
        let size = if side_ok && size > 0.0 { size } else { 0.0 };
        Caster {
            plane,
            sides,
            rays,
            size,
        }
    }

    /// Distance at which a ray's end is seen, for tolerances relative to it.
    #[inline]
    pub(super) fn distance(&self, ray: DVec3) -> f64 {
        match self.shape {
            Shape::Point(_) => ray.length(),
            Shape::Parallel(_, extent) => extent,
        }
    }

    /// Closeness per unit of [`Self::distance`] that no point of the caster exceeds: its plane
    /// comes no nearer, nor does a ball around it.
    pub(super) fn closest(&self, caster: &Caster) -> f32 {
        let [a, b, c] = caster.rays;
        match self.shape {
            Shape::Point(_) => {
                let middle = (a + b + c) / 3.0;
                let radius = [a, b, c]
                    .map(|ray| (ray - middle).length_squared())
                    .into_iter()
                    .fold(0.0, f64::max)
                    .sqrt();
                let ball = middle.length() - radius;
                let plane = caster.plane.length();
                let closest = if ball > 0.0 {
                    plane.min(1.0 / ball)
                } else {
                    plane
                };
                closest as f32
            }
            Shape::Parallel(_, extent) => {
                let closest = [a, b, c].map(|ray| caster.plane.dot(ray));
                (closest.into_iter().fold(f64::NEG_INFINITY, f64::max) / extent) as f32
            }
        }
    }

    /// Length of a plane's normal: over it, the product with a ray is a distance from the plane.
    #[inline]
    pub(super) fn length(&self, normal: DVec3) -> f64 {
        match self.shape {
            Shape::Point(_) => normal.length(),
            Shape::Parallel(..) => normal.truncate().length(),
        }
    }

    /// Whether rays fan out from a point.
    pub(super) fn is_point(&self) -> bool {
        matches!(self.shape, Shape::Point(_))
    }
}
