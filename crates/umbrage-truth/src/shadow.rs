//! The shadow test: does a caster cross the open segment from a surface point to a light?
//!
//! Takes a point and a light; gives yes or no. A caster is a triangle whose casting rule takes it
//! for the side that faces the light; a light in its plane makes it no caster. Every sign is exact
//! for the f64 point. A point within its own rounding of a caster's plane touches the caster and
//! is not shadowed by it, so that coplanar duplicates do not shadow each other.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Light, LightShape};

use crate::oracle::Oracle;
use crate::predicate::{passes_through, side_of_direction, side_of_point};

/// Where light comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// World space.
    Near(DVec3),
    /// Towards the light, any length.
    Far(Vec3),
}

impl Source {
    pub(crate) fn of(light: &Light) -> Self {
        match light.shape {
            LightShape::Directional { direction } => Self::Far(-direction),
            LightShape::Point | LightShape::Spot { .. } => Self::Near(light.position),
        }
    }
}

/// The open segment from a point to a light.
pub(crate) struct ShadowRay {
    from: DVec3,
    /// The line's second point: the light, or a point far towards it.
    to: DVec3,
    source: Source,
    /// Distance below which `from` cannot be told from a plane, metres; 0 where it is exact.
    touch: f64,
}

impl ShadowRay {
    pub(crate) fn new(from: DVec3, source: Source, touch: f64) -> Self {
        let to = match source {
            Source::Near(position) => position,
            Source::Far(towards) => {
                // At least as far out as the point is from the origin, so that rounding turns the
                // direction by no more than 2^-52.
                let size = from.abs().max_element().max(1.0);
                from + towards.as_dvec3() * 2f64.powi(size.log2().ceil() as i32 + 1)
            }
        };
        Self {
            from,
            to,
            source,
            touch,
        }
    }
}

/// Whether the rule takes a triangle as a caster when the light is on `side` of its plane.
fn casts(rule: Casting, side: i8) -> bool {
    match rule {
        Casting::None => false,
        Casting::Front => side > 0,
        Casting::Back => side < 0,
        Casting::Both => side != 0,
    }
}

impl Oracle {
    /// The side of slot's plane that the light is on.
    pub(crate) fn light_side(&self, slot: usize, source: Source) -> i8 {
        match source {
            Source::Near(position) => side_of_point(&self.corners(slot), position),
            Source::Far(towards) => side_of_direction(&self.corners[slot], towards),
        }
    }

    /// Whether the triangle in `slot` is a caster that properly crosses the segment.
    pub(crate) fn blocks(&self, slot: usize, ray: &ShadowRay) -> bool {
        let rule = self.casting[slot];
        if rule == Casting::None {
            return false;
        }
        let side = self.light_side(slot, ray.source);
        if !casts(rule, side) {
            return false;
        }
        let corners = self.corners(slot);
        if !passes_through(ray.from, ray.to, &corners, -side)
            || side_of_point(&corners, ray.from) != -side
        {
            return false;
        }
        if ray.touch == 0.0 {
            // The point counts as exact, and so does the side that it is on.
            return true;
        }
        let offset = ray.from - corners[0];
        let normal = self.normals[slot];
        let distance = normal.dot(offset).abs() / normal.length();
        // The second term is the rounding of `distance` itself: three products and two sums.
        distance > ray.touch + offset.length() * f64::EPSILON * 4.0
    }

    /// How many casters cross the open segment from `point` (world space) to the light: one through
    /// whose edge it runs counts. Range and cone are not asked.
    pub fn casters(&self, point: [f64; 3], light: &Light) -> u32 {
        let ray = ShadowRay::new(DVec3::from_array(point), Source::of(light), 0.0);
        let t_max = match ray.source {
            Source::Near(_) => 1.0,
            Source::Far(_) => f64::INFINITY,
        };
        let mut count = 0;
        let along = ray.to - ray.from;
        self.bvh.visit(ray.from, along, t_max, |slot, t_max| {
            count += u32::from(self.blocks(slot, &ray));
            ControlFlow::Continue(t_max)
        });
        count
    }

    /// The first caster found on the segment, apart from the slots for which `left_out` holds.
    /// `guess` is tried before all others; which one is found is not determined, whether one is
    /// found is.
    pub(crate) fn blocker(
        &self,
        ray: &ShadowRay,
        guess: Option<usize>,
        left_out: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        if let Some(slot) = guess.filter(|&slot| !left_out(slot) && self.blocks(slot, ray)) {
            return Some(slot);
        }
        let t_max = match ray.source {
            Source::Near(_) => 1.0,
            Source::Far(_) => f64::INFINITY,
        };
        let mut found = None;
        self.bvh
            .visit(ray.from, ray.to - ray.from, t_max, |slot, t_max| {
                if self.blocks(slot, ray) && !left_out(slot) {
                    found = Some(slot);
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(t_max)
            });
        found
    }
}
