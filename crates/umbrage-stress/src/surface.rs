//! A light's volume as polygons, and how often a ray runs through them.
//!
//! Takes the quads and the chain that a light's volume is made of; gives, for a point, the number of
//! casters between it and the light, as the volume says: the signed number of times a ray from the
//! point to infinity leaves the volume. Quads are taken as they are drawn, from their edge to
//! infinity; light caps are the chain; dark caps lie at infinity and are what the ray's far end is
//! behind. Every sign is exact. Shares no code with the oracle, which looks at triangles only, and
//! none with the library, whose plain data it reads.
//!
//! **Why the count is that of casters.** Caps and quads bound the chain of the casters' own
//! volumes, so the winding number about a point is the number of casters that it is behind. Where
//! the volume is not closed, rays in different directions count differently.

use glam::DVec3;
use umbrage_core::volume::{ChainTriangle, Quad};
use umbrage_core::world::World;
use umbrage_core::{Light, LightShape};

use crate::exact::{Point, side};

/// The polygons of one light's volume.
#[derive(Clone, Debug)]
pub struct Surface {
    light: Point,
    /// Edges with the shadow on their left, as the light sees them.
    quads: Vec<Edge>,
    /// Triangles that the light sees counter-clockwise.
    caps: Vec<Cap>,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [DVec3; 2],
    plane: Plane,
}

#[derive(Clone, Copy, Debug)]
struct Cap {
    corners: [DVec3; 3],
    plane: Plane,
}

/// A filter for the side of a plane through three points.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    /// A point of the plane.
    at: DVec3,
    /// What the rounding of the normal may turn into, for each metre of distance.
    bound: f64,
}

/// A ray that cannot be counted: it meets an edge, or starts on the volume itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// Another ray from the same point may do.
    RayOnEdge,
    /// The point lies on a polygon.
    PointOnSurface,
}

/// Far above what a dozen roundings of 2^-53 cost.
const BOUND: f64 = 32.0 / (1u64 << 53) as f64;

impl Plane {
    /// `u` and `v` are the differences (or directions) that span it.
    fn new(at: DVec3, u: DVec3, v: DVec3) -> Self {
        Self {
            normal: u.cross(v),
            at,
            bound: BOUND * norm1(u) * norm1(v),
        }
    }

    /// The side, where f64 can tell.
    fn side(&self, p: DVec3) -> Option<i8> {
        let q = p - self.at;
        let height = self.normal.dot(q);
        (height.abs() > self.bound * norm1(q)).then_some(if height > 0.0 { 1 } else { -1 })
    }
}

fn norm1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// The light, or where it comes from.
pub fn source(light: &Light) -> Point {
    match light.shape {
        LightShape::Directional { direction } => Point::Far(-direction.as_dvec3()),
        LightShape::Point | LightShape::Spot { .. } => Point::Near(light.position),
    }
}

impl Surface {
    /// The volume of a light, or a part of it, with all of its quads or with some.
    pub fn new(
        world: &World,
        light: &Light,
        quads: &[Quad],
        chain: impl IntoIterator<Item = ChainTriangle>,
    ) -> Self {
        let light = source(light);
        let places = world.places();
        let at = |v: u32| places.at(v);
        let edge = |ends: [DVec3; 2]| Edge {
            ends,
            plane: match light {
                Point::Near(l) => Plane::new(ends[0], ends[0] - l, ends[1] - l),
                // The light at infinity: side(light, a, b, p) = ((b - a) x light) . (p - a).
                Point::Far(l) => Plane::new(ends[0], ends[1] - ends[0], l),
            },
        };
        let cap = |corners: [DVec3; 3]| Cap {
            corners,
            plane: Plane::new(corners[0], corners[1] - corners[0], corners[2] - corners[0]),
        };
        Self {
            light,
            quads: quads
                .iter()
                .map(|quad| edge(quad.ends(&world.edges).map(at)))
                .collect(),
            caps: chain
                .into_iter()
                .map(|taken| {
                    let [a, b, c] = world.triangles[taken.triangle() as usize].map(at);
                    cap(match taken.coefficient() {
                        1 => [a, b, c],
                        _ => [a, c, b],
                    })
                })
                .collect(),
        }
    }

    /// Casters between `from` and the light, along the ray in `direction`.
    pub fn count(&self, from: DVec3, direction: DVec3) -> Result<i64, Hindrance> {
        Ok(self.behind_dark_caps(direction)? + self.leaves(from, Point::Far(direction))?)
    }

    /// How often the way from `from` to `to` leaves the volume, less how often it enters.
    pub fn leaves(&self, from: DVec3, to: Point) -> Result<i64, Hindrance> {
        let (x, y) = (Point::Near(from), to);
        let mut count = 0;
        for quad in &self.quads {
            let [a, b] = quad.ends.map(Point::Near);
            let at_start = || side(self.light, a, b, x);
            let at_start = quad.plane.side(from).unwrap_or_else(at_start);
            let at_end = match to {
                Point::Near(to) => quad.plane.side(to),
                Point::Far(_) => None,
            };
            let at_end = at_end.unwrap_or_else(|| side(self.light, a, b, y));
            if at_start == at_end && at_start != 0 {
                continue;
            }
            // The line runs through the wedge between light and edge, beyond the edge.
            let toward = if at_end > at_start { 1 } else { -1 };
            let signs = [
                toward * side(x, y, self.light, a),
                toward * side(x, y, b, self.light),
                -toward * side(x, y, a, b),
            ];
            count += crossing([at_start, at_end], signs)?;
        }
        for cap in &self.caps {
            let [a, b, c] = cap.corners.map(Point::Near);
            let at_start = || side(a, b, c, x);
            let at_start = cap.plane.side(from).unwrap_or_else(at_start);
            let at_end = match to {
                Point::Near(to) => cap.plane.side(to),
                Point::Far(_) => None,
            };
            let at_end = at_end.unwrap_or_else(|| side(a, b, c, y));
            if at_start == at_end && at_start != 0 {
                continue;
            }
            let toward = if at_end > at_start { 1 } else { -1 };
            let signs = [(a, b), (b, c), (c, a)].map(|(p, q)| toward * side(x, y, p, q));
            count += crossing([at_start, at_end], signs)?;
        }
        Ok(count)
    }

    /// Dark caps before the far end of a direction.
    fn behind_dark_caps(&self, direction: DVec3) -> Result<i64, Hindrance> {
        let Point::Near(_) = self.light else {
            // They are one point, opposite the light.
            return Ok(0);
        };
        let end = Point::Far(direction);
        let mut count = 0;
        for cap in &self.caps {
            let [a, b, c] = cap.corners.map(Point::Near);
            let signs = [(a, b), (b, c), (c, a)].map(|(p, q)| -side(self.light, p, q, end));
            count += crossing([-1, 1], signs)?;
        }
        Ok(count)
    }
}

/// One crossing from one side of a polygon's plane to the other, if the line is inside all three
/// bounds.
fn crossing([at_start, at_end]: [i8; 2], signs: [i8; 3]) -> Result<i64, Hindrance> {
    if signs.contains(&-1) {
        return Ok(0);
    }
    if at_end == 0 || signs.contains(&0) {
        return Err(Hindrance::RayOnEdge);
    }
    match at_start {
        0 => Err(Hindrance::PointOnSurface),
        _ => Ok(i64::from(at_end)),
    }
}
