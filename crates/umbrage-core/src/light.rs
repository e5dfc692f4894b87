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
        /// Cosine of the half angle beyond which no light falls, -1 to 1.
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
/// Facing, eye count and oracle use the position as it is; the GPU has 48 bits of it. A light that
/// is none ([`Light::is_usable`]) is an error nowhere: it gets an empty volume, and is skipped in
/// plans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// World space, relative to the world origin.
    pub position: DVec3,
    /// Distance beyond which the light does not shine, in metres; above zero, infinity is allowed.
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

    /// Whether it can shine: its position is finite in f32 and its range above zero, its direction is of
    /// unit length and its cone has an angle, as far as its shape uses them.
    pub fn is_usable(&self) -> bool {
        let is_unit = |direction: Vec3| (direction.length_squared() - 1.0).abs() < 1e-2;
        let shines = self.position.as_vec3().is_finite() && self.range > 0.0;
        match self.shape {
            LightShape::Point => shines,
            LightShape::Spot {
                direction,
                cos_outer,
            } => shines && is_unit(direction) && (-1.0..=1.0).contains(&cos_outer),
            LightShape::Directional { direction } => is_unit(direction),
        }
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
