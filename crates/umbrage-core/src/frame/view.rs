//! The eye: the one set of numbers from which CPU, GPU and oracle derive every eye ray.

use glam::{DVec3, Vec3};

/// A perspective view with reversed, infinite depth (`depth = near / distance`).
///
/// For a world point `p` with `q = p - eye`:
/// clip = (`scale_x * right.q`, `scale_y * up.q`, `near`, `forward.q`).
/// These values are the view; they need not be orthonormal to the last bit, because every
/// user computes with the same ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World space, relative to the world origin.
    pub eye: DVec3,
    /// Towards +x on screen.
    pub right: Vec3,
    /// Towards +y on screen (up).
    pub up: Vec3,
    /// Viewing direction.
    pub forward: Vec3,
    /// Near plane distance in metres; also the clip-space z of every finite point.
    pub near: f32,
    /// cot(fovy / 2) / aspect.
    pub scale_x: f32,
    /// cot(fovy / 2).
    pub scale_y: f32,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl View {
    /// A view from `eye` towards `target`, +y up (or +z where the view is vertical).
    pub fn look_at(
        eye: impl Into<DVec3>,
        target: impl Into<DVec3>,
        fovy_rad: f32,
        near: f32,
        size: [u32; 2],
    ) -> Self {
        let eye = eye.into();
        let forward = (target.into() - eye).as_vec3().normalize_or(Vec3::NEG_Z);
        let up_hint = if forward.y.abs() > 0.999 {
            Vec3::Z
        } else {
            Vec3::Y
        };
        let right = forward.cross(up_hint).normalize();
        let up = right.cross(forward);
        let scale_y = 1.0 / (fovy_rad * 0.5).tan();
        let scale_x = scale_y * size[1] as f32 / size[0] as f32;
        Self {
            eye,
            right,
            up,
            forward,
            near,
            scale_x,
            scale_y,
            size,
        }
    }
}
