//! Which side of each triangle's plane a light is on: fast where it is clear, exact where not.
//!
//! Takes vertices; gives plane equations as a structure of arrays, and [`Planes::side`], whose
//! sign is that of the exact determinant. The f32 filter below is proven; behind it stands
//! Shewchuk's adaptive `orient3d` (Discrete & Computational Geometry 18, 1997), which has its own
//! f64 stage.
//!
//! **The bound.** With `n` a unit normal and `d = n.a`, all rounded to f32 from f64, and the light
//! `(l, w)`, `w` in {0, 1}: `s = n.l - d w`. Let `m = |lx| + |ly| + |lz| + |d w|`, `u = 2^-24`.
//! Rounding each `n_i` costs at most `u m / 2`, rounding `d` at most `u |d|`, four products and
//! three sums at most `4 u m / (1 - 4u)`. The f64 normal itself is within `2^-26` of the true
//! direction, or the plane is stored as zero and every query goes to the exact test. Together less
//! than `6 u m`; the filter uses `8 u m = 2^-21 m`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::array::Array;
use super::clusters::LANES;
use crate::light::Light;

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
    /// Distance of the plane from the origin along the normal.
    pub d: [f32; LANES],
}

/// Plane equations, cluster after cluster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// The last may be partly empty: zero planes.
    pub clusters: Array<PlaneCluster>,
}

pub(crate) const FILTER: f32 = 1.0 / (1 << 21) as f32;

impl Planes {
    /// Planes of counter-clockwise triangles.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let cluster = |triangles: &[[u32; 3]]| plane_cluster(positions, triangles);
        let planes: Vec<PlaneCluster> = triangles.par_chunks(LANES).map(cluster).collect();
        Self {
            clusters: planes.into(),
        }
    }

    /// The side of triangle `t`'s plane that the light is on; exact. `corners` are consulted only
    /// where the filter cannot tell.
    #[inline]
    pub fn side(&self, t: u32, light: &LightPoint, corners: impl FnOnce() -> [Vec3; 3]) -> Side {
        let (planes, i) = (&self.clusters[t as usize / LANES], t as usize % LANES);
        let [x, y, z, w] = light.homogeneous;
        let dw = planes.d[i] * w;
        let s = planes.nx[i] * x + planes.ny[i] * y + planes.nz[i] * z - dw;
        if s.abs() > FILTER * (light.norm1 + dw.abs()) {
            return if s > 0.0 { 1 } else { -1 };
        }
        exact_side(corners(), light.homogeneous)
    }
}

/// Planes of at most 64 triangles. Triangles without a trustworthy f64 normal (area lost to
/// cancellation) and missing lanes get a zero plane.
pub(super) fn plane_cluster(positions: &[Vec3], triangles: &[[u32; 3]]) -> PlaneCluster {
    let mut planes = PlaneCluster {
        nx: [0.0; LANES],
        ny: [0.0; LANES],
        nz: [0.0; LANES],
        d: [0.0; LANES],
    };
    for (lane, t) in triangles.iter().enumerate() {
        let (n, d) = plane(t.map(|v| positions[v as usize].as_dvec3()));
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
    pub(crate) homogeneous: [f32; 4],
    pub(crate) norm1: f32,
}

impl LightPoint {
    /// Of a point, spot or directional light.
    pub fn new(light: &Light) -> Self {
        let h = light.homogeneous();
        Self {
            homogeneous: h,
            norm1: h[0].abs() + h[1].abs() + h[2].abs(),
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
pub(crate) fn exact_side(corners: [Vec3; 3], [x, y, z, w]: [f32; 4]) -> Side {
    if let Some(side) = axis_aligned_side(corners, [x, y, z, w]) {
        return side;
    }
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let toward = DVec3::new(x.into(), y.into(), z.into());
    // A directional light is a point at infinity; any point that far along from a corner is on
    // the same side. The sum is exact unless its exponents differ by more than 29 bits.
    let light = if w == 0.0 { a + toward } else { toward };
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
fn axis_aligned_side(corners: [Vec3; 3], [x, y, z, w]: [f32; 4]) -> Option<Side> {
    let [a, b, c] = corners;
    let equal = a.cmpeq(b) & b.cmpeq(c);
    let axis = (0..3).find(|&axis| equal.test(axis))?;
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let at = |p: Vec3| Coord {
        x: f64::from(p[j]),
        y: f64::from(p[k]),
    };
    let normal = orient2d(at(a), at(b), at(c));
    let light = [x, y, z][axis];
    let offset = f64::from(light) - if w == 0.0 { 0.0 } else { f64::from(a[axis]) };
    Some(sign(normal) * sign(offset))
}

fn sign(x: f64) -> Side {
    Side::from(x > 0.0) - Side::from(x < 0.0)
}
