//! Where a picture is seen from.

use glam::{DVec3, Vec3};

use crate::Error;

/// A perspective view with an infinite far plane, on all or part of a target.
///
/// ```
/// use umbrage::View;
///
/// let left = View::look_at([0.0, 1.7, 5.0], [0.0, 1.0, 0.0], 1.1, 0.05, [640, 720]);
/// let right = View::new([0.0, 1.7, 5.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.1, 0.05, [640, 720])
///     .viewport_at([640, 0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub(crate) core: umbrage_core::View,
    pub(crate) origin: [u32; 2],
}

impl View {
    /// From `eye` towards `target`, +y up (or +z where the view is vertical). `fovy_rad` is the
    /// angle from the lower to the upper border, `near_m` the distance of the near plane, `size` in
    /// pixels.
    pub fn look_at(
        eye: impl Into<[f64; 3]>,
        target: impl Into<[f64; 3]>,
        fovy_rad: f32,
        near_m: f32,
        size: [u32; 2],
    ) -> Self {
        let [eye, target] = [eye.into(), target.into()].map(DVec3::from);
        Self {
            core: umbrage_core::View::look_at(eye, target, fovy_rad, near_m, size),
            origin: [0; 2],
        }
    }

    /// From `eye` along `forward`, with `up` upwards: of any length, and not along `forward`.
    pub fn new(
        eye: impl Into<[f64; 3]>,
        forward: impl Into<[f32; 3]>,
        up: impl Into<[f32; 3]>,
        fovy_rad: f32,
        near_m: f32,
        size: [u32; 2],
    ) -> Self {
        let forward = Vec3::from(forward.into()).normalize_or_zero();
        let right = forward.cross(Vec3::from(up.into())).normalize_or_zero();
        let scale_y = 1.0 / (fovy_rad * 0.5).tan();
        Self {
            core: umbrage_core::View {
                eye: DVec3::from(eye.into()),
                right,
                up: right.cross(forward),
                forward,
                near: near_m,
                scale_x: scale_y * size[1] as f32 / size[0] as f32,
                scale_y,
                size,
            },
            origin: [0; 2],
        }
    }

    /// With its upper left pixel there in a larger target. The host's passes call `set_viewport`
    /// with the same rectangle, and depth from 0 to 1.
    #[must_use]
    pub fn viewport_at(mut self, origin: [u32; 2]) -> Self {
        self.origin = origin;
        self
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let v = &self.core;
        let wrong = |what| Err(Error::View { what });
        if v.size.contains(&0) || v.size.iter().any(|&side| side > 1 << 16) {
            return wrong("give it a size of 1 to 65,536 pixels a side");
        }
        if !v.eye.as_vec3().is_finite() {
            return wrong("give it a finite eye");
        }
        let is_unit = |d: Vec3| (d.length_squared() - 1.0).abs() < 1e-3;
        if ![v.right, v.up, v.forward].into_iter().all(is_unit) {
            return wrong("give it a direction, and another one upwards");
        }
        if !(v.near > 0.0 && v.near.is_finite()) {
            return wrong("give it a near plane at a finite distance above zero");
        }
        if ![v.scale_x, v.scale_y]
            .iter()
            .all(|s| *s > 0.0 && s.is_finite())
        {
            return wrong("give it a field of view above 0 and below pi");
        }
        Ok(())
    }
}
