//! Plain lights.

use glam::{DVec3, Vec3};

use crate::place;

/// Where a light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightShape {
    /// All directions from a point, up to the range.
    Point,
    /// A cone from a point, up to the range.
    Spot {
        /// Unit axis, pointing away from the light.
        direction: Vec3,
        /// Cosine of the half angle beyond which no light falls.
        cos_outer: f32,
    },
    /// Parallel light from infinitely far; position and range are not used.
    Directional {
        /// Unit direction in which the light travels.
        direction: Vec3,
    },
}

/// A light as the shadow system sees it: no colour, no intensity.
///
/// Facing, eye count and oracle use the position as it is; the GPU has 48 bits of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// World space, relative to the world origin.
    pub position: DVec3,
    /// Distance beyond which the light does not shine, in metres; infinity is allowed.
    pub range: f32,
    /// Where it shines.
    pub shape: LightShape,
}

impl Light {
    /// Homogeneous position: `(p, 1)` for point and spot lights, `(-direction, 0)` for a
    /// directional one. A world point `x` is extruded along `x * w - xyz`.
    pub fn homogeneous(&self) -> [f64; 4] {
        match self.shape {
            LightShape::Directional { direction } => (-direction).as_dvec3().extend(0.0),
            _ => self.position.extend(1.0),
        }
        .to_array()
    }

    /// [`Light::homogeneous`] as two f32 each (see [`place`]): rounded, and what that leaves.
    pub fn homogeneous_f32(&self) -> [[f32; 4]; 2] {
        let [x, y, z, w] = self.homogeneous();
        let [position, residual] = place::split(DVec3::new(x, y, z));
        [position.extend(w as f32), residual.extend(0.0)].map(|v| v.to_array())
    }

    /// The position rounded to f32, and what that leaves.
    pub fn position_f32(&self) -> [Vec3; 2] {
        place::split(self.position)
    }

    /// Whether the light comes from infinitely far.
    pub fn is_directional(&self) -> bool {
        matches!(self.shape, LightShape::Directional { .. })
    }
}
