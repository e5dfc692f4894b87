//! The oracle: what one eye ray sees, and whether a light reaches it.
//!
//! Takes triangles; gives, for an eye ray and a light, a [`Verdict`]. The surface point is the
//! nearest hit among all triangles, whatever their casting; both sides are seen. Invariant:
//! whether a ray hits a triangle is decided exactly (through an edge or corner is a hit, within
//! the plane is none), so surfaces are watertight and shared edges never leak; only the distance
//! along the ray is rounded.

use std::ops::ControlFlow;

use glam::DVec3;
use rayon::prelude::*;
use umbrage_core::{Casting, Light, LightShape, Mesh, View};

use crate::bvh::Bvh;
use crate::judge::Verdicts;
use crate::mask::Mask;
use crate::predicate::{normal, passes_through, side_of_point};
use crate::rays::{EyeRay, EyeRays, NearClip};
use crate::shadow::{ShadowRay, Source};

/// Hits whose distances differ by less than this share count as one surface.
const TIE: f64 = 1.0 / (1u64 << 46) as f64;
/// Rounding of a surface point, as a share of the numbers that it is computed from: a plane
/// distance (five roundings), a product and a sum, with room to spare.
const TOUCH: f64 = 1.0 / (1u64 << 48) as f64;

/// The answer for one pixel and one light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The eye ray meets no triangle.
    Background,
    /// The surface point is not nearer than the light's range, or not inside the spot's cone.
    OutOfRange,
    /// Eye and light are not strictly on the same side of the surface's plane.
    FacingAway,
    /// No caster crosses the open segment from the surface point to the light.
    Lit,
    /// At least one caster does.
    Shadowed,
}

impl Verdict {
    /// Whether shadows matter here: lit or shadowed.
    #[inline]
    pub fn is_sample(self) -> bool {
        matches!(self, Self::Lit | Self::Shadowed)
    }
}

/// What an eye ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Index into `Mesh::triangles`; the lowest among surfaces that coincide.
    pub triangle: u32,
    /// Distance along the view's forward axis, metres.
    pub distance: f64,
    /// World space.
    pub point: [f64; 3],
}

/// All triangles, ready for rays.
#[derive(Clone, Debug)]
pub struct Oracle {
    pub(crate) bvh: Bvh,
    // By slot (leaf order of the hierarchy).
    pub(crate) corners: Vec<[DVec3; 3]>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) casting: Vec<Casting>,
    triangle: Vec<u32>,
    ignored: usize,
}

/// A primary hit.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub(crate) t: f64,
    pub(crate) point: DVec3,
    /// The representative: lowest triangle index.
    pub(crate) slot: usize,
    /// Other triangles at the same distance.
    pub(crate) ties: Vec<usize>,
    /// The side of the representative's plane that the eye is on.
    pub(crate) eye_side: i8,
    /// Bound on the rounding of `point`, metres.
    pub(crate) touch: f64,
}

impl Oracle {
    /// Takes in a mesh. Triangles without area, or with corners that are not finite, are ignored.
    ///
    /// # Panics
    /// If the mesh has not one casting rule a triangle, or an index points outside its positions.
    pub fn new(mesh: &Mesh) -> Self {
        assert_eq!(
            mesh.triangles.len(),
            mesh.casting.len(),
            "one casting rule a triangle"
        );
        let corners: Vec<[DVec3; 3]> = (0..mesh.triangles.len())
            .into_par_iter()
            .map(|t| mesh.corners(t))
            .collect();
        let normals: Vec<DVec3> = corners.par_iter().map(normal).collect();
        let mut triangle: Vec<u32> = (0..corners.len() as u32)
            .filter(|&t| {
                let n = normals[t as usize];
                n.is_finite() && n != DVec3::ZERO
            })
            .collect();
        let bvh = Bvh::build(&corners, &mut triangle);
        let by_slot = |t: &u32| *t as usize;
        Self {
            bvh,
            ignored: corners.len() - triangle.len(),
            corners: triangle.iter().map(|t| corners[by_slot(t)]).collect(),
            normals: triangle.iter().map(|t| normals[by_slot(t)]).collect(),
            casting: triangle.iter().map(|t| mesh.casting[by_slot(t)]).collect(),
            triangle,
        }
    }

    /// Number of triangles ignored: no area, or corners that are not finite.
    pub fn ignored(&self) -> usize {
        self.ignored
    }

    /// The nearest surface on the eye ray through pixel position `(x, y)` (pixels; pixel centres
    /// end in .5).
    pub fn first_hit(&self, rays: &EyeRays, x: f64, y: f64) -> Option<FirstHit> {
        self.surface(&rays.ray(x, y), rays.min_distance)
            .map(|s| FirstHit {
                triangle: self.triangle[s.slot],
                distance: s.t,
                point: s.point.to_array(),
            })
    }

    /// The verdict for the eye ray through pixel position `(x, y)` and a light.
    pub fn verdict(&self, rays: &EyeRays, x: f64, y: f64, light: &Light) -> Verdict {
        match self.surface(&rays.ray(x, y), rays.min_distance) {
            Some(surface) => self.shade(&surface, light, &mut Memory::default()),
            None => Verdict::Background,
        }
    }

    /// Whether any caster crosses the open segment from `point` (world space) to the light.
    /// The point stands on no surface; range, cone and facing are not asked.
    pub fn is_occluded(&self, point: [f64; 3], light: &Light) -> bool {
        let ray = ShadowRay::new(DVec3::from_array(point), Source::of(light), 0.0);
        self.blocker(&ray, None, |_| false).is_some()
    }

    /// The oracle's own mask: 1 where the verdict at the pixel's centre is [`Verdict::Lit`].
    pub fn shadow_mask(&self, view: &View, lights: &[Light], near: NearClip) -> Mask {
        Verdicts::new(self, view, lights, near, &|_, _| ()).mask()
    }

    pub(crate) fn corners(&self, slot: usize) -> [DVec3; 3] {
        self.corners[slot]
    }

    /// Where the ray hits the triangle, in front of the eye; with the side that the eye is on.
    fn hit(&self, slot: usize, ray: &EyeRay) -> Option<(f64, i8)> {
        let corners = self.corners(slot);
        let eye_side = side_of_point(&corners, ray.origin);
        if eye_side == 0 || !passes_through(ray.origin, ray.through, &corners, eye_side) {
            return None;
        }
        let n = self.normals[slot];
        let t = n.dot(corners[0] - ray.origin) / n.dot(ray.direction);
        // The hit lies between the corners: this bounds t where the ray grazes the plane and the
        // quotient is rounding alone (max and min drop a NaN).
        let along = corners.map(|c| (c - ray.origin).dot(ray.direction));
        let square = ray.direction.length_squared();
        let least = along[0].min(along[1]).min(along[2]) / square;
        let most = along[0].max(along[1]).max(along[2]) / square;
        Some((t.max(least.max(0.0)).min(most), eye_side))
    }

    /// The nearest hit at or beyond `min_distance`.
    pub(crate) fn surface(&self, ray: &EyeRay, min_distance: f64) -> Option<Surface> {
        let mut near: Vec<(f64, usize, i8)> = Vec::new();
        let mut nearest = f64::INFINITY;
        self.bvh.visit(
            ray.origin,
            ray.direction,
            nearest,
            |slot, limit| match self.hit(slot, ray) {
                Some((t, side)) if t >= min_distance && t <= limit => {
                    if t < nearest {
                        nearest = t;
                        near.retain(|hit| hit.0 <= t * (1.0 + TIE));
                    }
                    near.push((t, slot, side));
                    ControlFlow::Continue(nearest * (1.0 + TIE))
                }
                _ => ControlFlow::Continue(limit),
            },
        );
        let &(t, slot, eye_side) = near.iter().min_by_key(|hit| self.triangle[hit.1])?;
        let point = ray.at(t);
        let size = (self.corners(slot)[0] - ray.origin).length()
            + point.abs().max_element()
            + ray.origin.abs().max_element()
            + (point - ray.origin).length();
        let ties = near
            .iter()
            .map(|hit| hit.1)
            .filter(|&s| s != slot)
            .collect();
        Some(Surface {
            t,
            point,
            slot,
            ties,
            eye_side,
            touch: size * TOUCH,
        })
    }

    /// All slots that the ray hits between two distances.
    pub(crate) fn crossed(&self, ray: &EyeRay, from: f64, to: f64) -> Vec<usize> {
        let mut slots = Vec::new();
        self.bvh
            .visit(ray.origin, ray.direction, to, |slot, limit| {
                if self
                    .hit(slot, ray)
                    .is_some_and(|(t, _)| t >= from && t <= to)
                {
                    slots.push(slot);
                }
                ControlFlow::Continue(limit)
            });
        slots
    }

    /// The verdict for a surface point: range, then facing, then shadow.
    pub(crate) fn shade(&self, s: &Surface, light: &Light, memory: &mut Memory) -> Verdict {
        self.shade_without(s, light, memory, |slot| {
            slot == s.slot || s.ties.contains(&slot)
        })
    }

    /// The same, with the casters to leave out named by the caller.
    pub(crate) fn shade_without(
        &self,
        s: &Surface,
        light: &Light,
        memory: &mut Memory,
        left_out: impl Fn(usize) -> bool,
    ) -> Verdict {
        if !reaches(light, s.point) {
            return Verdict::OutOfRange;
        }
        let source = Source::of(light);
        let light_side = match memory.side {
            Some((slot, side)) if slot == s.slot => side,
            _ => self.light_side(s.slot, source),
        };
        memory.side = Some((s.slot, light_side));
        if light_side != s.eye_side {
            return Verdict::FacingAway;
        }
        let ray = ShadowRay::new(s.point, source, s.touch);
        match self.blocker(&ray, memory.blocker, left_out) {
            Some(slot) => {
                memory.blocker = Some(slot);
                Verdict::Shadowed
            }
            None => Verdict::Lit,
        }
    }
}

/// What the last pixel found out about the same light; saves time, changes no verdict.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    side: Option<(usize, i8)>,
    blocker: Option<usize>,
}

/// Whether `point` is nearer than the light's range, and inside its cone.
fn reaches(light: &Light, point: DVec3) -> bool {
    let from_light = point - light.position;
    let range = f64::from(light.range);
    match light.shape {
        LightShape::Directional { .. } => true,
        LightShape::Point => from_light.length_squared() < range * range,
        LightShape::Spot {
            direction,
            cos_outer,
        } => {
            let square = from_light.length_squared();
            square < range * range
                && from_light.dot(direction.as_dvec3()) > f64::from(cos_outer) * square.sqrt()
        }
    }
}
