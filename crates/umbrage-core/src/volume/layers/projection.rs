//! Clusters and triangles as the light sees them: rectangles on the faces of a cube around a point
//! light, or on a map across a directional one.
//!
//! Takes a light and a chain; gives rectangles that hold every ray which meets a cluster's box or a
//! triangle, and says whether a triangle's own cone may touch a window.

use glam::{DVec2, DVec3};

use super::PAD;
use super::clusters::Seen;
use super::refine::{Item, Window};
use crate::light::{Light, LightShape};
use crate::volume::cube::to_face;
use crate::volume::{Chain, ChainTriangle};
use crate::world::World;

/// A chain seen from a light.
pub(super) struct Projection<'a> {
    world: &'a World,
    chain: &'a [Chain],
    from: From,
    /// Of each cluster of the chain.
    seen: &'a [Seen],
}

/// Where rays come from.
enum From {
    Point(DVec3),
    /// Two axes across, of such length that coordinates lie in -1 .. 1.
    Direction([DVec3; 2]),
}

/// A depth below this share of the size of what is seen counts as none: rectangles are whole faces.
const NEAR: f64 = 1e-6;

/// A triangle whose volume with the light is below this share of the product of its rays is taken
/// to touch whatever its rectangle does.
const FLAT: f64 = 1e-12;

/// A rectangle that no ray is in.
const NOWHERE: [DVec2; 2] = [DVec2::INFINITY, DVec2::NEG_INFINITY];

impl<'a> Projection<'a> {
    pub(super) fn new(
        world: &'a World,
        light: &Light,
        chain: &'a [Chain],
        seen: &'a [Seen],
    ) -> Self {
        let from = match light.shape {
            LightShape::Directional { direction } => {
                let along = direction.as_dvec3().normalize_or(DVec3::NEG_Y);
                let across = along.any_orthonormal_vector();
                let far = |seen: &Seen| seen.low.abs().max(seen.high.abs()).as_dvec3().length();
                let size = seen.iter().map(far).fold(f64::MIN_POSITIVE, f64::max);
                From::Direction([across, along.cross(across)].map(|axis| axis / size))
            }
            _ => From::Point(light.position),
        };
        Self {
            world,
            chain,
            from,
            seen,
        }
    }

    pub(super) fn faces(&self) -> std::ops::Range<u32> {
        match self.from {
            From::Point(_) => 0..6,
            From::Direction(_) => 0..1,
        }
    }

    /// Replaces `items` with an item for each cluster of the chain that is seen on `face`.
    pub(super) fn clusters(&self, face: u32, items: &mut Vec<Item>) {
        items.clear();
        for (number, seen) in (0..).zip(self.seen) {
            push(self.box_on(face, seen), seen.layers, number, items);
        }
    }

    /// Replaces `items` with an item for each triangle of the chain that is seen on `face`, and
    /// `casters` with all triangles of the chain, by which items are numbered.
    pub(super) fn triangles(
        &self,
        face: u32,
        casters: &mut Vec<ChainTriangle>,
        items: &mut Vec<Item>,
    ) {
        casters.clear();
        items.clear();
        for (part, seen) in self.chain.iter().zip(self.seen) {
            let first = casters.len();
            casters.extend(part.triangles());
            if self.box_on(face, seen) == NOWHERE {
                continue;
            }
            for (number, t) in (first as u32..).zip(&casters[first..]) {
                push(self.triangle_on(face, *t), 1, number, items);
            }
        }
    }

    /// Rays to the corners, in coordinates of the face.
    fn rays(&self, face: u32, t: ChainTriangle) -> [DVec3; 3] {
        let corners = self.world.corners(t.triangle());
        match self.from {
            From::Point(light) => corners.map(|p| to_face(face, p - light)),
            From::Direction([u, v]) => corners.map(|p| DVec3::new(p.dot(u), p.dot(v), 1.0)),
        }
    }

    fn triangle_on(&self, face: u32, t: ChainTriangle) -> [DVec2; 2] {
        let [a, b, c] = self.rays(face, t);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let size = low.abs().max(high.abs()).max_element();
        if low.z <= NEAR * size {
            return box_on_face(low, high);
        }
        let [a, b, c] = [a, b, c].map(|ray| ray.truncate() / ray.z);
        on_face(a.min(b).min(c), a.max(b).max(c))
    }

    fn box_on(&self, face: u32, seen: &Seen) -> [DVec2; 2] {
        let (low, high) = (seen.low.as_dvec3(), seen.high.as_dvec3());
        match self.from {
            From::Point(light) => {
                let (low, high) = (to_face(face, low - light), to_face(face, high - light));
                box_on_face(low.min(high), low.max(high))
            }
            From::Direction(axes) => {
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                let at = DVec2::from(axes.map(|axis| axis.dot(middle)));
                let by = DVec2::from(axes.map(|axis| axis.abs().dot(half)));
                on_face(at - by, at + by)
            }
        }
    }

    /// False only if the plane through the light and a side of the triangle keeps it from the
    /// window.
    pub(super) fn touches(&self, face: u32, t: ChainTriangle, window: &Window) -> bool {
        let [a, b, c] = self.rays(face, t);
        let volume = a.dot(b.cross(c));
        if volume.abs() <= FLAT * a.length() * b.length() * c.length() {
            return true;
        }
        [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
            let inward = from.cross(to) * volume.signum();
            let farthest = |n: f64, low: f64, high: f64| if n > 0.0 { n * high } else { n * low };
            let reach = farthest(inward.x, window.low.x, window.high.x)
                + farthest(inward.y, window.low.y, window.high.y)
                + inward.z;
            reach >= -PAD * from.length() * to.length()
        })
    }
}

fn push([low, high]: [DVec2; 2], weight: u32, number: u32, items: &mut Vec<Item>) {
    if low.cmple(high).all() {
        items.push(Item {
            low: low - PAD,
            high: high + PAD,
            weight,
            number,
        });
    }
}

/// What of a face the rays into a box cover. Rays on a face are no farther aside than ahead: that
/// cuts off the part of the box before `near`.
fn box_on_face(low: DVec3, high: DVec3) -> [DVec2; 2] {
    let size = low.abs().max(high.abs()).max_element();
    let aside = low.truncate().max(-high.truncate()).max_element();
    let near = low.z.max(aside * (1.0 - PAD));
    if high.z < 0.0 || high.z < near {
        return NOWHERE;
    }
    if near <= NEAR * size {
        return on_face(DVec2::NEG_ONE, DVec2::ONE);
    }
    let [a, b] = [low, high].map(|corner| corner.truncate() / near);
    let [c, d] = [low, high].map(|corner| corner.truncate() / high.z);
    on_face(a.min(c), b.max(d))
}

/// A rectangle, as far as it lies on a face.
fn on_face(low: DVec2, high: DVec2) -> [DVec2; 2] {
    let edge = DVec2::splat(1.0 + PAD);
    if low.cmpgt(edge).any() || high.cmplt(-edge).any() {
        return NOWHERE;
    }
    [low.max(-edge), high.min(edge)]
}
