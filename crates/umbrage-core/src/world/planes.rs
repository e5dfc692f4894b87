//! Which side of each triangle's plane a light is on: fast where it is clear, exact where not.
//!
//! Takes vertices; gives plane equations as a structure of arrays, and [`Planes::side`], whose
//! sign is that of the exact determinant. The f32 filter below is proven; behind it stands
//! Shewchuk's adaptive `orient3d` (Discrete & Computational Geometry 18, 1997), which has its own
//! f64 stage.
//!
//! Planes of a cluster are kept relative to its centre, and lights are taken relative to it in f64,
//! so that the filter is as sharp 10,000 km from the origin as at it.
//!
//! **The bound.** With `n` a unit normal and `d = n.a`, `a` a corner relative to the centre, all
//! rounded to f32 from f64, and the light `(l, w)`, `w` in {0, 1}, relative to the centre and rounded
//! to f32: `s = n.l - d w`. Let `r >= |a|` (sums of absolute coordinates) for all triangles of the
//! cluster, `m = |l| + r w`, `u = 2^-24`. Rounding each `n_i` costs at most `u m / 2`, rounding `d` at
//! most `u r`, rounding `l` at most `u |l|`, four products and three sums at most `4 u m / (1 - 4u)`.
//! The f64 normal itself is within `2^-26` of the true direction, which costs at most `u m / 4`, or
//! the plane is stored as zero and every query goes to the exact test. Together less than `7 u m`; the
//! filter uses `8 u m = 2^-21 m`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::array::Array;
use super::clusters::LANES;
use crate::light::Light;
use crate::place::Places;

/// The side of a plane: +1 in front, -1 behind, 0 exactly in it.
pub type Side = i8;

/// Plane equations `n.x - d` of 64 triangles, positive in front.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct PlaneCluster {
    /// x of the unit normal.
    pub nx: [f32; LANES],
    /// y of the unit normal.
    pub ny: [f32; LANES],
    /// z of the unit normal.
    pub nz: [f32; LANES],
    /// Distance of the plane from the centre along the normal.
    pub d: [f32; LANES],
    /// What `d` is measured from.
    pub center: [f32; 3],
    /// No triangle's first corner is farther from the centre, in sums of absolute coordinates.
    pub radius: f32,
    /// So that the next begins with a cache line.
    pub unused: [f32; 12],
}

/// Plane equations, cluster after cluster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// The last may be partly empty: zero planes.
    pub clusters: Array<PlaneCluster>,
}

const FILTER: f32 = 1.0 / (1 << 21) as f32;

impl Planes {
    /// Planes of counter-clockwise triangles.
    pub fn new(places: Places<'_>, triangles: &[[u32; 3]]) -> Self {
        let cluster = |triangles: &[[u32; 3]]| plane_cluster(places, triangles);
        let planes: Vec<PlaneCluster> = triangles.par_chunks(LANES).map(cluster).collect();
        Self {
            clusters: planes.into(),
        }
    }

    /// The side of triangle `t`'s plane that the light is on; exact. `corners` are consulted only
    /// where the filter cannot tell.
    #[inline]
    pub fn side(&self, t: u32, light: &LightPoint, corners: impl FnOnce() -> [DVec3; 3]) -> Side {
        let (planes, i) = (&self.clusters[t as usize / LANES], t as usize % LANES);
        let near = light.from(planes);
        let [x, y, z, w] = near.homogeneous;
        let s = planes.nx[i] * x + planes.ny[i] * y + planes.nz[i] * z - planes.d[i] * w;
        if s.abs() > near.bound {
            return if s > 0.0 { 1 } else { -1 };
        }
        exact_side(corners(), light.exact)
    }
}

/// Planes of at most 64 triangles. Triangles without a trustworthy f64 normal (area lost to
/// cancellation) and missing lanes get a zero plane.
pub(super) fn plane_cluster(places: Places<'_>, triangles: &[[u32; 3]]) -> PlaneCluster {
    let mut planes = PlaneCluster {
        nx: [0.0; LANES],
        ny: [0.0; LANES],
        nz: [0.0; LANES],
        d: [0.0; LANES],
        center: [0.0; 3],
        radius: 0.0,
        unused: [0.0; 12],
    };
    let first = |t: &[u32; 3]| places.at(t[0]);
    let corners = || triangles.iter().map(first);
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = (low * 0.5 + high * 0.5).as_vec3();
    if middle.is_finite() {
        planes.center = middle.to_array();
    }
    let center = Vec3::from_array(planes.center).as_dvec3();
    for (lane, t) in triangles.iter().enumerate() {
        let corners = t.map(|v| places.at(v) - center);
        let far = corners[0].abs().element_sum();
        planes.radius = planes.radius.max((far * (1.0 + 1e-6)) as f32);
        let (n, d) = plane(corners);
        planes.nx[lane] = n.x as f32;
        planes.ny[lane] = n.y as f32;
        planes.nz[lane] = n.z as f32;
        planes.d[lane] = d as f32;
    }
    planes
}

/// A light prepared for many side tests.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint {
    /// Homogeneous, as it is.
    pub(crate) exact: [f64; 4],
}

/// A light as one cluster's planes see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearLight {
    /// Relative to the cluster's centre.
    pub(crate) homogeneous: [f32; 4],
    /// A height above a plane that is farther from zero has the right sign.
    pub(crate) bound: f32,
}

impl LightPoint {
    /// Of a point, spot or directional light.
    pub fn new(light: &Light) -> Self {
        Self {
            exact: light.homogeneous(),
        }
    }

    #[inline]
    pub(crate) fn from(&self, planes: &PlaneCluster) -> NearLight {
        let [x, y, z, w] = self.exact;
        let center = planes.center.map(|c| f64::from(c) * w);
        let [x, y, z] = [x - center[0], y - center[1], z - center[2]].map(|x| x as f32);
        let norm1 = x.abs() + y.abs() + z.abs();
        let w = w as f32;
        NearLight {
            homogeneous: [x, y, z, w],
            bound: FILTER * (norm1 + planes.radius * w),
        }
    }
}

/// Unit normal and distance, or zero where cancellation ate the normal.
fn plane([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let length = normal.length();
    // Each component is a difference of two products of exact factors: its rounding error is
    // below 2^-52 of the larger product.
    let error = u.abs().max_element() * v.abs().max_element() * 2f64.powi(-51);
    let n = if error < length * 2f64.powi(-27) {
        normal / length
    } else {
        DVec3::ZERO
    };
    (n, n.dot(a))
}

/// The side without the filter.
#[cold]
pub(crate) fn exact_side(corners: [DVec3; 3], [x, y, z, w]: [f64; 4]) -> Side {
    if let Some(side) = axis_aligned_side(corners, [x, y, z, w]) {
        return side;
    }
    let [a, b, c] = corners;
    let toward = DVec3::new(x, y, z);
    // A directional light is a point at infinity; any point that far along from a corner is on
    // the same side. At about the corner's own distance from the origin the sum is exact, or
    // rounded by 2^-53 of the direction.
    let reach = 2f64.powi(a.abs().max_element().max(1.0).log2() as i32);
    let light = if w == 0.0 { a + toward * reach } else { toward };
    let coord = |p: DVec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    // robust: positive where `light` is below the plane of counter-clockwise a, b, c.
    -sign(orient3d(coord(a), coord(b), coord(c), coord(light)))
}

/// A plane of constant x, y or z needs one comparison. Level floors and straight walls with lights
/// in their planes are most of what the filter leaves open in game maps.
fn axis_aligned_side(corners: [DVec3; 3], [x, y, z, w]: [f64; 4]) -> Option<Side> {
    let [a, b, c] = corners;
    let equal = a.cmpeq(b) & b.cmpeq(c);
    let axis = (0..3).find(|&axis| equal.test(axis))?;
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let at = |p: DVec3| Coord { x: p[j], y: p[k] };
    let normal = orient2d(at(a), at(b), at(c));
    let light = [x, y, z][axis];
    let height = if w == 0.0 { 0.0 } else { a[axis] };
    // Compared, not subtracted: in f64 a difference may be rounded, but not to the other side.
    Some(sign(normal) * (Side::from(light > height) - Side::from(light < height)))
}

fn sign(x: f64) -> Side {
    Side::from(x > 0.0) - Side::from(x < 0.0)
}
