//! The one decision: on which side of a plane, or of a line, does a point lie?
//!
//! Takes four points of which up to three may lie at infinity; gives the sign of their determinant,
//! exact for the f64 numbers passed in. A filter in f64 answers first; four finite points that it
//! leaves open go to Shewchuk's `orient3d` (Discrete & Computational Geometry 18, 1997), points at
//! infinity to a sum of exact products (the same paper, section 2).

use glam::DVec3;
use robust::{Coord3D, orient3d};

/// A point, or a direction: the point infinitely far along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Point {
    /// World space.
    Near(DVec3),
    /// Any length but zero.
    Far(DVec3),
}

/// Above the rounding of a triple product of differences: three roundings of the differences, five
/// of products and sums, each at most 2^-53 of the product of the 1-norms.
const BOUND: f64 = 16.0 / (1u64 << 53) as f64;

/// +1 if `d` lies on the side of the plane from which `a`, `b`, `c` run counter-clockwise, -1 if on
/// the other, 0 in the plane. A point at infinity is where finite points tend to along it.
///
/// # Panics
/// If all four lie at infinity: then there is no such side.
pub fn side(a: Point, b: Point, c: Point, d: Point) -> i8 {
    let mut points = [a, b, c, d];
    let finite = points.iter().position(|p| matches!(p, Point::Near(_)));
    let base_at = finite.expect("one point is finite");
    // An exchange of two points turns the sign.
    points.swap(0, base_at);
    let turned = if base_at == 0 { 1 } else { -1 };
    let Point::Near(base) = points[0] else {
        unreachable!("it was found to be finite")
    };
    let rest = [points[1], points[2], points[3]];
    let [u, v, w] = rest.map(|p| match p {
        Point::Near(p) => p - base,
        Point::Far(direction) => direction,
    });
    let volume = u.cross(v).dot(w);
    if volume.abs() > BOUND * norm1(u) * norm1(v) * norm1(w) {
        return turned * sign(volume);
    }
    turned * exact_side(base, rest)
}

#[cold]
fn exact_side(base: DVec3, rest: [Point; 3]) -> i8 {
    if let [Point::Near(b), Point::Near(c), Point::Near(d)] = rest {
        let coord = |p: DVec3| Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        // robust: positive where `d` is below the plane of counter-clockwise a, b, c.
        return -sign(orient3d(coord(base), coord(b), coord(c), coord(d)));
    }
    let [u, v, w] = rest.map(|p| match p {
        Point::Near(p) => [0, 1, 2].map(|i| two_sum(p[i], -base[i])),
        Point::Far(direction) => direction.to_array().map(|x| (x, 0.0)),
    });
    let mut sum = Sum::default();
    for (i, x) in u.into_iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum.add_product(x, v[j], w[k], 1.0);
        sum.add_product(x, v[k], w[j], -1.0);
    }
    sum.sign()
}

/// A number as the exact sum of two f64.
type Pair = (f64, f64);

/// An exact sum: components that do not overlap, of increasing magnitude.
#[derive(Default)]
struct Sum(Vec<f64>);

impl Sum {
    fn add_product(&mut self, a: Pair, b: Pair, c: Pair, sign: f64) {
        for x in [a.0, a.1] {
            for y in [b.0, b.1] {
                let (xy, xy_rest) = two_product(sign * x, y);
                for z in [c.0, c.1] {
                    for part in [xy, xy_rest] {
                        let (product, rest) = two_product(part, z);
                        self.add(rest);
                        self.add(product);
                    }
                }
            }
        }
    }

    /// Grow-Expansion, without zeros.
    fn add(&mut self, x: f64) {
        if x == 0.0 {
            return;
        }
        let mut carry = x;
        self.0.retain_mut(|component| {
            let (sum, rest) = two_sum(carry, *component);
            carry = sum;
            *component = rest;
            rest != 0.0
        });
        if carry != 0.0 {
            self.0.push(carry);
        }
    }

    fn sign(&self) -> i8 {
        self.0.last().map_or(0, |&x| sign(x))
    }
}

fn two_sum(a: f64, b: f64) -> Pair {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

fn two_product(a: f64, b: f64) -> Pair {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

fn norm1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Random;

    #[test]
    fn above_a_counter_clockwise_triangle_is_positive() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y].map(Point::Near);
        assert_eq!(side(a, b, c, Point::Near(DVec3::new(0.3, 0.3, 1e-300))), 1);
        assert_eq!(side(a, b, c, Point::Far(DVec3::new(5.0, 5.0, -1e-9))), -1);
        assert_eq!(side(a, b, c, Point::Far(DVec3::new(5.0, -7.0, 0.0))), 0);
        // Seen from far above, everything turns the same way.
        let up = Point::Far(DVec3::Z);
        assert_eq!(side(up, a, b, c), -side(a, b, c, up));
    }

    /// A point far along a direction is on the same side as the direction, and every exchange of two
    /// points turns the sign, whether the filter answers or not.
    #[test]
    fn infinity_is_where_finite_points_tend_to() {
        let mut random = Random::new(7);
        for round in 0..2000 {
            // Small whole numbers: products are exact, and zeros are frequent.
            let mut p = || (random.point(3.0)).round().as_dvec3();
            let [a, b, c, d] = [p(), p(), p(), p()];
            let far = Point::Far(d);
            let finite = Point::Near(a + d * 1e6);
            let [a, b, c] = [a, b, c].map(Point::Near);
            assert_eq!(side(a, b, c, far), side(a, b, c, finite), "{round}");
            for (turned, sign) in [
                (side(b, a, c, far), -1),
                (side(far, b, c, a), -1),
                (side(b, c, a, far), 1),
                (side(c, far, a, b), 1),
            ] {
                assert_eq!(turned, sign * side(a, b, c, far), "{round}");
            }
        }
    }

    /// Differences that need 61 bits: f64 alone loses the small corner.
    #[test]
    fn directions_are_exact_where_differences_are_not() {
        let (big, small) = (2f64.powi(40), 2f64.powi(-20));
        let [a, b, c] = [
            DVec3::new(big, 0.0, 0.0),
            DVec3::new(-big, 0.0, 0.0),
            DVec3::new(0.0, 1.0, small),
        ]
        .map(Point::Near);
        assert_eq!(side(a, b, c, Point::Far(DVec3::new(0.0, 1.0, small))), 0);
        let up = Point::Far(DVec3::new(0.0, 1.0, small.next_up()));
        let down = Point::Far(DVec3::new(0.0, 1.0, small.next_down()));
        assert_eq!(side(a, b, c, up), -side(a, b, c, down));
        assert_ne!(side(a, b, c, up), 0);
    }
}
