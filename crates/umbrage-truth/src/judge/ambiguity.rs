//! Ambiguity: does the oracle's own verdict change within the tolerance?
//!
//! Takes a pixel's surface, a light and the verdict; gives yes or no. The verdict is ambiguous if
//! it is another one (lit, shadowed or no sample)
//! - for one of eight eye rays, the sideways tolerance away on a circle around the pixel's centre,
//!   with surface, facing and range found anew; with a clipping near plane also for the plane moved by
//!   the depth tolerance; or
//! - for the surface point moved along its eye ray by [`TOLERANCE_DEPTH`] of its distance: towards
//!   the eye, against all casters; away from it, against all casters but those that the eye ray
//!   itself meets between the two moved points. Those are the surface that the point stands on:
//!   if they counted, every lit point would turn shadowed behind its own surface, and no lit point
//!   could ever be found wrong.
//!
//! What this hides. The moved point behind the surface sees the light only through the triangles
//! left out, so a lit point is ambiguous close to an edge of its own triangle, where the way from
//! the moved point to the light comes out through the neighbour instead. The band along such edges
//! is about the moved depth times the cotangent of the light's elevation: where a pixel covers
//! 1/600 of the distance, 0.0006 pixel times that cotangent, 1/30 pixel for a light 1 degree above
//! the surface. A wall in a concave corner adds nothing: it stands in front of the moved point's
//! surface, or the eye ray meets it and it is left out. The band is kept because it is real for a
//! depth buffer: along edges that carry silhouette quads (T-junctions) quad and surface compare
//! within rounding there. A shadowed point becomes lit behind its surface only if its last caster
//! is within 2^-20 of its distance along the eye ray, so contact shadows stay checked. A test
//! inverts a mask of boxes in a bumpy landscape and bounds what is called ambiguous.
//!
//! The verdict is also ambiguous if one of the eight rays first meets other triangles than the
//! pixel's own and those that coincide with it: then the pixel's centre is within four steps of the
//! rasteriser's grid of an edge, and the method may see either triangle's plane there, or, at a
//! T-junction that snapping to the grid tears open, what is behind both; and a silhouette quad may
//! start there, though a coincident triangle goes on (coplanar overlaps). This forgives whatever
//! happens in a band of 1/32 pixel along the edges of the mesh, nothing inside triangles.
//!
//! The sideways tolerance is [`TOLERANCE_PX`] unless a caller states another one, for a rasteriser
//! whose grid is known to be coarser. Within a wider one, circles of half the radius, of a quarter
//! and so on are asked too, down to the usual one: what is narrower than the tolerance counts.

use std::f64::consts::FRAC_1_SQRT_2;

use umbrage_core::Light;

use crate::oracle::{Memory, Oracle, Surface, Verdict};
use crate::rays::{EyeRays, NearClip};
use crate::tile::Pixel;

/// Sideways tolerance of the eye ray unless another is stated, pixels: four steps of the
/// rasteriser's 1/256 pixel grid.
pub const TOLERANCE_PX: f64 = 1.0 / 64.0;
/// Tolerance along the eye ray, as a share of the distance: 2^-20.
pub const TOLERANCE_DEPTH: f64 = 1.0 / (1u64 << 20) as f64;

/// Eight directions on the unit circle.
pub(super) const AROUND: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// All surface points within the tolerance of one pixel; serves every light.
pub(super) struct Neighbourhood {
    /// Whether a ray around the pixel's centre first meets another triangle.
    primary_changes: bool,
    /// `None`: background.
    sideways: Vec<Option<Surface>>,
    nearer: Surface,
    farther: Surface,
    /// Slots that the eye ray meets between the two, in no order.
    between: Vec<usize>,
}

impl Neighbourhood {
    pub(super) fn of(oracle: &Oracle, rays: &EyeRays, pixel: &Pixel, tolerance_px: f64) -> Self {
        let (x, y) = (f64::from(pixel.x) + 0.5, f64::from(pixel.y) + 0.5);
        let mut sideways: Vec<_> = radii(tolerance_px)
            .flat_map(|radius| AROUND.map(|[dx, dy]| (dx * radius, dy * radius)))
            .map(|(dx, dy)| oracle.surface(&rays.ray(x + dx, y + dy), rays.min_distance))
            .collect();
        let surface = &pixel.surface;
        let primary_changes = sideways.iter().any(|other| {
            other
                .as_ref()
                .is_none_or(|other| !same_triangles(other, surface))
        });
        let ray = rays.ray(x, y);
        if rays.near == NearClip::Clipped {
            sideways.extend(
                [1.0 - TOLERANCE_DEPTH, 1.0 + TOLERANCE_DEPTH]
                    .map(|factor| oracle.surface(&ray, rays.with_near_scaled(factor).min_distance)),
            );
        }
        let moved = |factor: f64| {
            let t = surface.t * factor;
            Surface {
                t,
                point: ray.at(t),
                ..surface.clone()
            }
        };
        let (nearer, farther) = (moved(1.0 - TOLERANCE_DEPTH), moved(1.0 + TOLERANCE_DEPTH));
        let mut between = oracle.crossed(&ray, nearer.t, farther.t);
        between.push(surface.slot);
        between.extend(&surface.ties);
        Self {
            primary_changes,
            sideways,
            nearer,
            farther,
            between,
        }
    }

    /// Whether the oracle's `verdict` on `light` changes anywhere within the tolerance.
    pub(super) fn is_ambiguous(&self, oracle: &Oracle, light: &Light, verdict: Verdict) -> bool {
        let mut memory = Memory::default();
        let mut differs = |other: &Option<Surface>| {
            let found = other.as_ref().map(|s| oracle.shade(s, light, &mut memory));
            found.unwrap_or(Verdict::Background) != verdict
        };
        self.primary_changes
            || self.sideways.iter().any(&mut differs)
            || oracle.shade_without(&self.nearer, light, &mut memory, |_| false) != verdict
            || oracle.shade_without(&self.farther, light, &mut memory, |slot| {
                self.between.contains(&slot)
            }) != verdict
    }
}

/// Of the circles to ask: the tolerance and its halves, down to [`TOLERANCE_PX`].
fn radii(tolerance_px: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(tolerance_px), |radius| Some(radius / 2.0))
        .enumerate()
        .take_while(|&(number, radius)| number == 0 || radius >= TOLERANCE_PX)
        .map(|(_, radius)| radius)
}

/// Whether two hits are on the same triangles, coincident ones included.
fn same_triangles(a: &Surface, b: &Surface) -> bool {
    let has = |s: &Surface, slot: &usize| s.slot == *slot || s.ties.contains(slot);
    a.ties.len() == b.ties.len() && has(a, &b.slot) && b.ties.iter().all(|slot| has(a, slot))
}
