//! The decisions: which side of a plane, which side of a line.
//!
//! Takes points in world space (f64, most of them exact f32 values); gives signs. Every sign is
//! that of the exact determinant of the numbers passed in: a filter in f64 answers first, and
//! exact arithmetic answers what the filter cannot.
//! Source: Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates" (doi 10.1007/PL00009321): `orient3d` through the `robust` crate, and section 2.4
//! (Grow-Expansion) for the determinant with a direction.

use glam::{DVec3, Vec3};
use robust::{Coord3D, orient3d};

/// Unit roundoff of f64, 2^-53.
const ROUNDOFF: f64 = f64::EPSILON * 0.5;

/// Shewchuk's bound is (7 + 56 e) e times the permanent of absolute values; the product of
/// 1-norms used here is never smaller than that permanent, but is rounded: hence 8 and not 7.
const ORIENT_BOUND: f64 = 8.0 * ROUNDOFF;

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

fn norm1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// The side of the triangle's plane that `p` is on: +1 front (counter-clockwise), -1 back, 0 in
/// the plane, or the triangle has no area.
pub(crate) fn side_of_point(corners: &[DVec3; 3], p: DVec3) -> i8 {
    let [a, b, c] = corners.map(|v| v - p);
    let across = a.cross(b);
    let volume = c.dot(across);
    // det[a-p, b-p, c-p]: negative where p is on the front.
    if volume.abs() > ORIENT_BOUND * norm1(a) * norm1(b) * norm1(c) {
        return -sign(volume);
    }
    let [a, b, c] = corners.map(coord);
    -sign(orient3d(a, b, c, coord(p)))
}

/// The side of the triangle's plane that infinitely far `towards` is on: the sign of
/// `((b - a) x (c - a)) . towards`, exact.
pub(crate) fn side_of_direction(corners: &[DVec3; 3], towards: Vec3) -> i8 {
    let [a, b, c] = *corners;
    let (u, v, w) = (b - a, c - a, towards.as_dvec3());
    let volume = w.dot(u.cross(v));
    if volume.abs() > ORIENT_BOUND * norm1(u) * norm1(v) * norm1(w) {
        return sign(volume);
    }
    exact_direction_sign([a, b, c], w)
}

/// Sign of `w . (a x b + b x c + c x a)`: each product of two is a sum of two f64, each product of
/// three one of four.
fn exact_direction_sign(corners: [DVec3; 3], w: DVec3) -> i8 {
    let mut sum = Expansion::default();
    for k in 0..3 {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            for (factor, other) in [(p[y], q[z]), (-p[z], q[y])] {
                let product = factor * other;
                sum.add_product(factor.mul_add(other, -product), w[axis]);
                sum.add_product(product, w[axis]);
            }
        }
    }
    sum.sign()
}

/// An exact sum of f64: nonoverlapping components in order of increasing magnitude.
#[derive(Default)]
struct Expansion {
    components: Vec<f64>,
}

impl Expansion {
    fn add_product(&mut self, x: f64, y: f64) {
        let product = x * y;
        let rest = x.mul_add(y, -product);
        self.add(rest);
        self.add(product);
    }

    /// Grow-Expansion, with zero components left out.
    fn add(&mut self, x: f64) {
        let mut carry = x;
        let mut kept = 0;
        for k in 0..self.components.len() {
            let (sum, rest) = two_sum(carry, self.components[k]);
            carry = sum;
            if rest != 0.0 {
                self.components[kept] = rest;
                kept += 1;
            }
        }
        self.components.truncate(kept);
        if carry != 0.0 {
            self.components.push(carry);
        }
    }

    fn sign(&self) -> i8 {
        self.components.last().map_or(0, |&x| sign(x))
    }
}

/// Knuth's exact sum: `sum + rest == a + b`.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_seen = sum - a;
    let a_seen = sum - b_seen;
    (sum, (a - a_seen) + (b - b_seen))
}

/// Whether the line from `p` through `q` passes through the closed triangle, given that `p` is on
/// side `p_side` (not 0) of its plane and that it runs towards the other side.
///
/// A line through an edge or a corner passes. The sign of a shared edge is exactly opposite for
/// its two triangles, so no line slips between them.
pub(crate) fn passes_through(p: DVec3, q: DVec3, corners: &[DVec3; 3], p_side: i8) -> bool {
    let along = q - p;
    let relative = corners.map(|v| v - p);
    let sizes = relative.map(norm1);
    let bound = ORIENT_BOUND * norm1(along);
    (0..3).all(|k| {
        let next = (k + 1) % 3;
        // orient3d(p, q, a, b) = -along . (a - p) x (b - p)
        let volume = -along.dot(relative[k].cross(relative[next]));
        let sign = if volume.abs() > bound * sizes[k] * sizes[next] {
            sign(volume)
        } else {
            sign(orient3d(
                coord(p),
                coord(q),
                coord(corners[k]),
                coord(corners[next]),
            ))
        };
        sign * p_side >= 0
    })
}

/// `(b - a) x (c - a)`, not normalised, each component within two ulp of the cross product of the
/// (nearly always exact) f64 differences: slivers keep a sound normal.
pub(crate) fn normal(corners: &[DVec3; 3]) -> DVec3 {
    let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
    // Kahan's difference of products.
    let minor = |a: f64, b: f64, c: f64, d: f64| {
        let cd = c * d;
        let rest = (-c).mul_add(d, cd);
        a.mul_add(b, -cd) + rest
    };
    DVec3::new(
        minor(u.y, v.z, u.z, v.y),
        minor(u.z, v.x, u.x, v.z),
        minor(u.x, v.y, u.y, v.x),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn front_is_counter_clockwise() {
        let floor = FLOOR;
        assert_eq!(side_of_point(&floor, DVec3::new(0.3, 0.3, 1.0)), 1);
        assert_eq!(side_of_point(&floor, DVec3::new(0.3, 0.3, -1e-300)), -1);
        assert_eq!(side_of_point(&floor, DVec3::new(7.0, -5.0, 0.0)), 0);
        assert_eq!(side_of_direction(&FLOOR, Vec3::new(1.0, 0.0, 1e-30)), 1);
        assert_eq!(side_of_direction(&FLOOR, Vec3::new(1.0, 0.0, -1e-30)), -1);
        assert_eq!(side_of_direction(&FLOOR, Vec3::new(1.0, -3.0, 0.0)), 0);
    }

    #[test]
    fn direction_sign_survives_offsets_that_break_f64_differences() {
        // The differences of 2^40 and 2^-20 need 61 bits: f64 alone loses the small corner.
        let big = 2f32.powi(40);
        let small = 2f32.powi(-20);
        let corners = [
            Vec3::new(big, 0.0, 0.0),
            Vec3::new(-big, 0.0, 0.0),
            Vec3::new(0.0, 1.0, small),
        ]
        .map(Vec3::as_dvec3);
        // normal is along (0, 2 big small, -2 big) up to sign; a direction in the plane, tilted
        // by one unit in the last place of f32.
        let flat = Vec3::new(0.0, 1.0, small);
        let up = Vec3::new(0.0, 1.0, f32::from_bits(small.to_bits() + 1));
        assert_eq!(side_of_direction(&corners, flat), 0);
        assert_eq!(
            side_of_direction(&corners, up),
            -side_of_direction(&corners, -up)
        );
        assert_ne!(side_of_direction(&corners, up), 0);
    }

    #[test]
    fn a_line_through_an_edge_passes_both_triangles() {
        let quad = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        for k in 0..=16 {
            let s = f64::from(k) / 16.0;
            let (p, q) = (DVec3::new(s, s, 3.0), DVec3::new(s, s, -1.0));
            assert!(passes_through(p, q, &[quad[0], quad[1], quad[2]], 1));
            assert!(passes_through(p, q, &[quad[0], quad[2], quad[3]], 1));
            assert!(passes_through(q, p, &[quad[0], quad[2], quad[3]], -1));
        }
        let (p, q) = (DVec3::new(1.5, 0.5, 3.0), DVec3::new(1.5, 0.5, -1.0));
        assert!(!passes_through(p, q, &[quad[0], quad[1], quad[2]], 1));
    }
}
