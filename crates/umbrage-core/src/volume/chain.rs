//! Facing: a subset to the chain of triangles that cast, with their sign.
//!
//! Takes a subset and a light; gives the triangles whose coefficient is not zero. The side of the
//! plane is exact (see [`Planes`](crate::world::Planes)).

use bytemuck::{Pod, Zeroable};

use crate::light::Light;
use crate::world::{LightPoint, World};

/// A triangle of the chain: its number and whether it is taken with reversed winding, packed so
/// that the renderer can draw it as a cap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct ChainTriangle(pub u32);

impl ChainTriangle {
    /// `coefficient` is +1 or -1.
    #[inline]
    pub fn new(triangle: u32, coefficient: i8) -> Self {
        Self(triangle << 1 | u32::from(coefficient < 0))
    }

    /// Number of the triangle.
    #[inline]
    pub fn triangle(self) -> u32 {
        self.0 >> 1
    }

    /// +1 taken as wound, -1 reversed.
    #[inline]
    pub fn coefficient(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

/// Coefficient of one triangle for one light: -1, 0 or +1.
#[inline]
pub fn coefficient(world: &World, light: &LightPoint, triangle: u32) -> i8 {
    let side = world.planes.side(triangle, light, || world.corners(triangle));
    world.casting[triangle as usize].coefficient(side)
}

/// Replaces `chain` with the casting triangles of `subset`, in its order.
pub fn chain(world: &World, light: &Light, subset: &[u32], chain: &mut Vec<ChainTriangle>) {
    let point = LightPoint::new(light);
    chain.clear();
    for &t in subset {
        let c = coefficient(world, &point, t);
        if c != 0 {
            chain.push(ChainTriangle::new(t, c));
        }
    }
}
