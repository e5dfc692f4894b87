//! A light to its subset: the triangles that its range may touch.
//!
//! Takes a world and a light; gives a [`Subset`]. Conservative, and tight by triangle, not by
//! node: a triangle is in if its box meets the range ([`Reach::touches`]) and no tree node above it
//! proves otherwise. Whoever needs to know later what was in (the eye count) asks the chain.

use glam::Vec3;

use super::{LANES, Node, Subset, World};
use crate::lanes64::{Lanes64, with_lanes};
use crate::light::{Light, LightShape};
use crate::place::split;

/// Slack on squared distances: far above the rounding of the tests below (a few 2^-24), so that
/// rounding can only add a triangle, never lose one.
const SLACK: f32 = 1.0 + 1.0 / 65536.0;

/// The region of space a light can reach, prepared for many tests.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    center: Vec3,
    /// How far the light may stand from there.
    slack: f32,
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
    /// light: everything. Of a light that is not usable: nothing.
    pub fn new(light: &Light) -> Self {
        if !light.is_usable() {
            return Self {
                center: Vec3::ZERO,
                slack: 0.0,
                range2: -1.0,
                cone: None,
            };
        }
        let cone = match light.shape {
            LightShape::Spot {
                direction,
                cos_outer,
            } if cos_outer > -1.0 => Some(Cone {
                axis: direction,
                cos: cos_outer,
                sin: (1.0 - cos_outer * cos_outer).max(0.0).sqrt(),
            }),
            _ => None,
        };
        let [center, residual] = match light.is_directional() {
            true => [Vec3::ZERO; 2],
            false => split(light.position),
        };
        Self {
            center,
            slack: residual.length(),
            range2: if light.is_directional() {
                f32::INFINITY
            } else {
                let range = light.range + residual.length();
                range * range * SLACK
            },
            cone,
        }
    }

    /// Whether the light may reach the triangle in a box: the box meets the sphere and, for a spot, the
    /// sphere around its box meets the cone. On game maps this lets in 2 % more triangles than
    /// the exact distance to the triangle does, at a third of the time.
    #[inline]
    pub fn touches(&self, [min, max]: [Vec3; 2]) -> bool {
        let near = (min - self.center).max(self.center - max).max(Vec3::ZERO);
        let [x, y, z] = near.to_array();
        x * x + y * y + z * z <= self.range2 && self.cone_meets(min, max)
    }

    /// Whether the light may reach the box. An empty box (lower above upper corner) it cannot.
    pub fn touches_box(&self, [min, max]: [Vec3; 2]) -> bool {
        let near = (min - self.center).max(self.center - max).max(Vec3::ZERO);
        min.cmple(max).all()
            && near.length_squared() <= self.range2 * SLACK
            && self.cone_meets(min, max)
    }

    #[inline]
    fn cone_meets(&self, min: Vec3, max: Vec3) -> bool {
        self.cone.is_none_or(|cone| {
            let half = (max - min) * 0.5;
            // Subtracted first: far from zero the middle of a small box is no f32.
            cone.meets_sphere((min - self.center) + half, half.length() + 2.0 * self.slack)
        })
    }

    #[inline]
    fn overlap(&self, node: &Node) -> Overlap {
        if self.range2 < f32::INFINITY {
            let near = (node.min - self.center)
                .max(self.center - node.max)
                .max(Vec3::ZERO);
            if near.length_squared() > self.range2 * SLACK {
                return Overlap::None;
            }
        }
        if self.cone.is_some() {
            return if self.cone_meets(node.min, node.max) {
                Overlap::Some
            } else {
                Overlap::None
            };
        }
        let far = (node.max - self.center)
            .abs()
            .max((self.center - node.min).abs());
        if far.length_squared() * SLACK <= self.range2 {
            Overlap::Whole
        } else {
            Overlap::Some
        }
    }
}

impl Cone {
    /// Whether the sphere around `v` from the apex may meet the cone: the distance from its centre
    /// to the cone's surface, with slack for rounding.
    fn meets_sphere(&self, v: Vec3, radius: f32) -> bool {
        let length = v.length();
        let along = v.dot(self.axis);
        let aside = (v - along * self.axis).length();
        let slack = length * 1e-5;
        // Signed distance to the cone's side; beyond the apex the sphere around it decides.
        let side = self.cos * aside - self.sin * along;
        side <= radius + slack || length <= radius + slack
    }
}

/// A part of a world that changes at its own pace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The triangles the world was built from.
    Fixed,
    /// Those of its objects.
    Objects,
}

/// Replaces `subset` with the triangles of `layer` that `light` touches.
pub fn query(world: &World, layer: Layer, light: &Light, subset: &mut Subset) {
    subset.clear();
    let reach = Reach::new(light);
    for root in world.roots(layer) {
        query_tree(world, root, &reach, subset);
    }
}

fn query_tree(world: &World, root: u32, reach: &Reach, subset: &mut Subset) {
    with_lanes!(query_with(world, root, reach, subset));
}

/// Nodes of at most this many triangles are not descended into: their clusters are tested whole.
const FEW: u32 = 2 * LANES as u32;

#[inline(always)]
fn query_with<L: Lanes64>(l: L, world: &World, root: u32, reach: &Reach, subset: &mut Subset) {
    let nodes = &world.bvh.nodes;
    let mut stack = [root; 128];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let index = stack[top];
        let node = &nodes[index as usize];
        match reach.overlap(node) {
            Overlap::None => {}
            Overlap::Whole => subset.push_range(node.range()),
            // A tree deeper than the stack comes only from pathological input.
            Overlap::Some if node.count <= FEW || node.is_leaf() || top + 2 > stack.len() => {
                push_touched(l, world, reach, node, subset);
            }
            Overlap::Some => {
                stack[top] = node.second;
                stack[top + 1] = index + 1;
                top += 2;
            }
        }
    }
}

/// Adds the triangles of a node that the light touches, 64 at a time.
#[inline(always)]
fn push_touched<L: Lanes64>(l: L, world: &World, reach: &Reach, node: &Node, subset: &mut Subset) {
    let lanes = LANES as u32;
    let range = node.range();
    for cluster in range.start / lanes..range.end.div_ceil(lanes) {
        let first = range.start.max(cluster * lanes);
        let end = range.end.min((cluster + 1) * lanes);
        let asked = (u64::MAX >> (lanes - (end - first))) << (first % lanes);
        let boxes = &world.boxes[cluster as usize];
        let mut mask = asked & l.near(boxes, reach.center.to_array(), reach.range2);
        if reach.cone.is_some() {
            for lane in super::lanes(mask) {
                let meets = reach.touches(world.bounds(cluster * lanes + lane));
                mask &= !(u64::from(!meets) << lane);
            }
        }
        if mask != 0 {
            subset.push_mask(cluster, mask);
        }
    }
}
