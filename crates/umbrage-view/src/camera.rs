//! A camera that flies: where keys and mouse take the eye.
//!
//! Begins as the view it is given, to the last bit; the first look around sets it upright, with +Y up.

use std::f32::consts::FRAC_PI_2;

use glam::{DVec3, Vec3};
use umbrage_core::View;

/// Radians a pixel of mouse movement.
const TURN: f32 = 0.003;
/// Just short of straight up or down, where left and right would have no meaning.
const STEEPEST: f32 = FRAC_PI_2 - 0.01;
/// What the fast key multiplies speed by.
const FAST: f32 = 5.0;
/// What a notch of the wheel multiplies speed by.
const NOTCH: f32 = 1.2;

/// Which way the keys push, each from -1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// To the right.
    pub right: f32,
    /// Upwards, along +Y.
    pub up: f32,
    /// Ahead.
    pub ahead: f32,
    /// Whether to hurry.
    pub fast: bool,
}

/// An eye on the move.
#[derive(Clone, Debug)]
pub struct FlyCamera {
    /// What it sees.
    pub view: View,
    /// Metres a second.
    pub speed_m_s: f32,
}

impl FlyCamera {
    /// Begins as `view`, at `speed_m_s` metres a second.
    pub fn new(view: View, speed_m_s: f32) -> Self {
        Self { view, speed_m_s }
    }

    /// Flies for `seconds`.
    pub fn fly(&mut self, push: Push, seconds: f32) {
        let view = &self.view;
        let way = view.right * push.right + Vec3::Y * push.up + view.forward * push.ahead;
        let hurry = if push.fast { FAST } else { 1.0 };
        let step = way.normalize_or_zero() * self.speed_m_s * hurry * seconds;
        let eye = self.view.eye + step.as_dvec3();
        if eye.is_finite() {
            self.view.eye = eye;
        }
    }

    /// Turns by a mouse movement in pixels, right and down.
    pub fn turn(&mut self, right_px: f32, down_px: f32) {
        let ahead = self.view.forward;
        let heading = ahead.x.atan2(-ahead.z) + right_px * TURN;
        let pitch = ahead.y.clamp(-1.0, 1.0).asin() - down_px * TURN;
        let (sin, cos) = pitch.clamp(-STEEPEST, STEEPEST).sin_cos();
        let forward = Vec3::new(cos * heading.sin(), sin, -cos * heading.cos());
        self.view.right = forward.cross(Vec3::Y).normalize();
        self.view.up = self.view.right.cross(forward);
        self.view.forward = forward;
    }

    /// Faster or slower, by notches of the wheel.
    pub fn change_speed(&mut self, notches: f32) {
        let speed = self.speed_m_s * NOTCH.powf(notches);
        self.speed_m_s = speed.clamp(1e-6, 1e9);
    }

    /// Fits the view to a window of another size in pixels, neither of them zero; what is seen from
    /// top to bottom stays.
    pub fn resize(&mut self, size: [u32; 2]) {
        let view = &mut self.view;
        view.scale_x = view.scale_y * size[1] as f32 / size[0] as f32;
        view.size = size;
    }
}

/// A speed that crosses a world with these corners in some twenty seconds.
pub(crate) fn speed_for([low, high]: [Vec3; 2]) -> f32 {
    let across = (high.as_dvec3() - low.as_dvec3()).max(DVec3::ZERO).length() as f32;
    if across > 0.0 { across / 20.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> FlyCamera {
        let view = View::look_at(DVec3::ZERO, DVec3::NEG_Z, 1.0, 0.1, [640, 480]);
        FlyCamera::new(view, 2.0)
    }

    #[test]
    fn it_flies_where_it_looks() {
        let mut camera = camera();
        let push = Push {
            ahead: 1.0,
            ..Push::default()
        };
        camera.fly(push, 0.5);
        assert_eq!(camera.view.eye, DVec3::NEG_Z);
        camera.fly(Push { fast: true, ..push }, 0.5);
        assert_eq!(camera.view.eye, DVec3::NEG_Z * 6.0);
        // A quarter turn to the right: ahead is +X then.
        camera.turn(FRAC_PI_2 / TURN, 0.0);
        let before = camera.view.eye;
        camera.fly(push, 0.5);
        assert!((camera.view.eye - before).distance(DVec3::X) < 1e-5);
        // Opposite keys cancel.
        let before = camera.view;
        camera.fly(Push::default(), 1.0);
        assert_eq!(camera.view, before);
    }

    #[test]
    fn it_stays_upright_and_never_tips_over() {
        let mut camera = camera();
        for _ in 0..50 {
            camera.turn(37.0, -200.0);
            let View {
                right, up, forward, ..
            } = camera.view;
            assert!(right.y.abs() < 1e-6 && up.y > 0.0 && forward.is_normalized());
            assert!(right.cross(forward).distance(up) < 1e-5);
        }
        assert!(camera.view.forward.y > 0.99);
    }

    #[test]
    fn a_wider_window_shows_more_at_the_sides_only() {
        let mut camera = camera();
        let before = camera.view;
        camera.resize([1280, 480]);
        assert_eq!(camera.view.scale_y, before.scale_y);
        assert_eq!(camera.view.scale_x, before.scale_x / 2.0);
    }

    #[test]
    fn speed_is_never_lost() {
        let mut camera = camera();
        camera.change_speed(1.0);
        assert_eq!(camera.speed_m_s, 2.0 * NOTCH);
        camera.change_speed(-1e9);
        assert!(camera.speed_m_s > 0.0);
        camera.change_speed(1e9);
        assert!(camera.speed_m_s.is_finite());
        assert_eq!(speed_for([Vec3::MAX, Vec3::MIN]), 1.0);
    }
}
