//! Eye rays: from a view and a pixel position to a line in world space.
//!
//! Takes a [`View`], whose numbers count as exact; gives rays in f64. Invariant: a ray is the
//! exact line through two f64 points, so every decision about it is about one and the same line,
//! and its parameter is the distance along the view's forward axis.

use glam::DVec3;
use umbrage_core::View;

/// What becomes of surfaces between the eye and the near plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NearClip {
    /// They are seen: the method draws its surfaces with depth clamping.
    #[default]
    Clamped,
    /// They are cut away: only hits at or beyond `View::near` count.
    Clipped,
}

/// All eye rays of one view. Pixel positions are in pixels, x to the right, y down, with the
/// centre of pixel `(i, j)` at `(i + 0.5, j + 0.5)`.
#[derive(Clone, Copy, Debug)]
pub struct EyeRays {
    eye: DVec3,
    /// Ray directions are `to_right * ndc_x + to_up * ndc_y + ahead`: the columns of the inverse
    /// of the matrix with rows right, up, forward, the first two over the view's scales.
    to_right: DVec3,
    to_up: DVec3,
    ahead: DVec3,
    size: [f64; 2],
    /// Power of two that lifts a direction to the size of the eye's coordinates.
    reach: f64,
    pub(crate) near: NearClip,
    /// Smallest distance along forward that counts, metres.
    pub(crate) min_distance: f64,
}

/// One eye ray: the line from `origin` through `through`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EyeRay {
    pub(crate) origin: DVec3,
    pub(crate) through: DVec3,
    /// `(through - origin)`, scaled so that its component along forward is 1.
    pub(crate) direction: DVec3,
}

impl EyeRay {
    /// The point at distance `t` along forward, metres.
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl EyeRays {
    /// The rays of `view`.
    pub fn new(view: &View, near: NearClip) -> Self {
        let (right, up, forward) = (
            view.right.as_dvec3(),
            view.up.as_dvec3(),
            view.forward.as_dvec3(),
        );
        let det = right.dot(up.cross(forward));
        let eye = view.eye;
        let largest = eye.abs().max_element().max(1.0);
        Self {
            eye,
            to_right: up.cross(forward) / (det * f64::from(view.scale_x)),
            to_up: forward.cross(right) / (det * f64::from(view.scale_y)),
            ahead: right.cross(up) / det,
            size: view.size.map(f64::from),
            reach: 2f64.powi(largest.log2().ceil() as i32),
            near,
            min_distance: match near {
                NearClip::Clamped => 0.0,
                NearClip::Clipped => f64::from(view.near),
            },
        }
    }

    /// The same rays, with the near plane moved to `factor` times its distance.
    pub(crate) fn with_near_scaled(mut self, factor: f64) -> Self {
        self.min_distance *= factor;
        self
    }

    pub(crate) fn ray(&self, x: f64, y: f64) -> EyeRay {
        let ndc_x = 2.0 * x / self.size[0] - 1.0;
        let ndc_y = 1.0 - 2.0 * y / self.size[1];
        let wanted = self.to_right * ndc_x + self.to_up * ndc_y + self.ahead;
        // Rounding the second point far out keeps the line within 2^-52 of the wanted direction
        // even where the eye's own coordinates are large.
        let through = self.eye + wanted * self.reach;
        EyeRay {
            origin: self.eye,
            through,
            direction: (through - self.eye) / self.reach,
        }
    }
}
