//! Plain lights.

use glam::Vec3;

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
/// The f32 position *is* the light: facing, eye count, GPU and oracle all use these very bits,
/// so no two stages can disagree about where the light stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// World space, relative to the world origin.
    pub position: Vec3,
    /// Distance beyond which the light does not shine, in metres; infinity is allowed.
    pub range: f32,
    /// Where it shines.
    pub shape: LightShape,
}

impl Light {
    /// Homogeneous position: `(p, 1)` for point and spot lights, `(-direction, 0)` for a
    /// directional one. A world point `x` is extruded along `x * w - xyz`.
    pub fn homogeneous(&self) -> [f32; 4] {
        match self.shape {
            LightShape::Directional { direction } => (-direction).extend(0.0),
            _ => self.position.extend(1.0),
        }
        .to_array()
    }

    /// Whether the light comes from infinitely far.
    pub fn is_directional(&self) -> bool {
        matches!(self.shape, LightShape::Directional { .. })
    }
}
