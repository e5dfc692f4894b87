//! A light to its subset: exactly the triangles that its range touches.
//!
//! Takes a world and a light; gives triangle numbers in ascending order. A triangle is in the
//! subset if and only if [`Reach::touches`] says so, whatever path through the tree led to it: the
//! eye count relies on that.

use glam::Vec3;

use super::{Node, Subset, World};
use crate::light::{Light, LightShape};

/// Slack on squared distances: far above the rounding of the tests below (a few 2^-24), so that
/// rounding can only add a triangle, never lose one.
const SLACK: f32 = 1.0 + 1.0 / 65536.0;

/// The region of space a light can reach, prepared for many tests.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    center: Vec3,
    /// Squared range with slack; infinite for directional lights.
    range2: f32,
    cone: Option<Cone>,
}

#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: Vec3,
    cos: f32,
    sin: f32,
}

enum Overlap {
    None,
    Some,
    Whole,
}

impl Reach {
    /// Of a point light: its sphere. Of a spot: its sphere cut by its cone. Of a directional
    /// light: everything.
    pub fn new(light: &Light) -> Self {
        let cone = match light.shape {
            LightShape::Spot { direction, cos_outer } if cos_outer > -1.0 => Some(Cone {
                axis: direction,
                cos: cos_outer,
                sin: (1.0 - cos_outer * cos_outer).max(0.0).sqrt(),
            }),
            _ => None,
        };
        Self {
            center: light.position,
            range2: if light.is_directional() {
                f32::INFINITY
            } else {
                light.range * light.range * SLACK
            },
            cone,
        }
    }

    /// Whether any point of the triangle may be reached; conservative by rounding, and by the
    /// triangle's bounding sphere against a cone.
    #[inline]
    pub fn touches(&self, corners: [Vec3; 3]) -> bool {
        if self.range2 < f32::INFINITY {
            let q = closest_point(corners, self.center);
            if (q - self.center).length_squared() > self.range2 {
                return false;
            }
        }
        self.cone.is_none_or(|cone| {
            let [a, b, c] = corners;
            let mid = a.min(b).min(c).midpoint(a.max(b).max(c));
            let radius2 = [a, b, c]
                .map(|p| p.distance_squared(mid))
                .into_iter()
                .fold(0.0, f32::max);
            cone.meets_sphere(self.center, mid, radius2.sqrt())
        })
    }

    fn overlap(&self, node: &Node) -> Overlap {
        if self.range2 < f32::INFINITY {
            let near = (node.min - self.center).max(self.center - node.max).max(Vec3::ZERO);
            if near.length_squared() > self.range2 * SLACK {
                return Overlap::None;
            }
        }
        if let Some(cone) = &self.cone {
            let half = (node.max - node.min) * 0.5;
            return if cone.meets_sphere(self.center, node.min + half, half.length() * SLACK) {
                Overlap::Some
            } else {
                Overlap::None
            };
        }
        let far = (node.max - self.center).abs().max((self.center - node.min).abs());
        if far.length_squared() * SLACK <= self.range2 {
            Overlap::Whole
        } else {
            Overlap::Some
        }
    }
}

impl Cone {
    /// Whether the sphere may meet the cone: the distance from the sphere's centre to the cone's
    /// surface, with slack for rounding.
    fn meets_sphere(&self, apex: Vec3, center: Vec3, radius: f32) -> bool {
        let v = center - apex;
        let length = v.length();
        let along = v.dot(self.axis);
        let aside = (v - along * self.axis).length();
        let slack = length * 1e-5;
        // Signed distance to the cone's side; beyond the apex the sphere around it decides.
        let side = self.cos * aside - self.sin * along;
        side <= radius + slack || length <= radius + slack
    }
}

/// Replaces `subset` with the triangles that `light` touches.
pub fn query(world: &World, light: &Light, subset: &mut Subset) {
    subset.clear();
    let reach = Reach::new(light);
    let nodes = &world.bvh.nodes;
    let mut stack = [0u32; 128];
    let mut top = usize::from(!nodes.is_empty());
    while top > 0 {
        top -= 1;
        let index = stack[top];
        let node = &nodes[index as usize];
        match reach.overlap(node) {
            Overlap::None => {}
            Overlap::Whole => subset.push_range(node.range()),
            Overlap::Some if node.is_leaf() => {
                push_touched(world, &reach, node, subset);
            }
            Overlap::Some if top + 2 > stack.len() => {
                // A tree this deep comes only from pathological input: finish it without a stack.
                push_touched(world, &reach, node, subset);
            }
            Overlap::Some => {
                stack[top] = node.second;
                stack[top + 1] = index + 1;
                top += 2;
            }
        }
    }
}

fn push_touched(world: &World, reach: &Reach, node: &Node, subset: &mut Subset) {
    for t in node.range().filter(|&t| reach.touches(world.corners(t))) {
        subset.push(t);
    }
}

/// The point of a triangle closest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
fn closest_point([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let scale = 1.0 / (va + vb + vc);
    a + ab * (vb * scale) + ac * (vc * scale)
}
