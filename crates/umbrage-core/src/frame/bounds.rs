//! The screen rectangle that a light's range can touch.

use glam::DVec2;

use super::view::View;
use crate::light::Light;

/// Pixels: left, top, width, height; y down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rect {
    /// Left edge.
    pub x: u32,
    /// Top edge.
    pub y: u32,
    /// Width; may be zero.
    pub width: u32,
    /// Height; may be zero.
    pub height: u32,
}

impl Rect {
    /// The whole view.
    pub fn full(view: &View) -> Self {
        let [width, height] = view.size;
        Self {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    /// Covers no pixel.
    pub fn is_empty(&self) -> bool {
        self.width == 0 || self.height == 0
    }

    /// Pixels covered.
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// A rectangle that contains every pixel in which a point within the light's range can be seen;
/// empty if there is none. Conservative by one pixel.
///
/// Follows the tangent construction of Mara and McGuire, "2D Polyhedral Bounds of a Clipped,
/// Perspective-Projected 3D Sphere" (JCGT 2013), an axis at a time.
pub fn light_rect(view: &View, light: &Light) -> Rect {
    if light.is_directional() || !light.range.is_finite() {
        return Rect::full(view);
    }
    let q = light.position - view.eye;
    let radius = f64::from(light.range) * (1.0 + 1e-6) + q.length() * 1e-6;
    let depth = q.dot(view.forward.as_dvec3());
    if depth <= -radius {
        return Rect::default();
    }
    let across = q.dot(view.right.as_dvec3());
    let above = q.dot(view.up.as_dvec3());
    let (left, right) = tangents(DVec2::new(across, depth), radius);
    let (bottom, top) = tangents(DVec2::new(above, depth), radius);
    let [w, h] = view.size.map(f64::from);
    let pixel = |slope: f64, scale: f32, size: f64| {
        ((slope * f64::from(scale) * 0.5 + 0.5) * size).clamp(-1.0, size + 1.0)
    };
    let x0 = (pixel(left, view.scale_x, w) - 1.0).floor().max(0.0);
    let x1 = (pixel(right, view.scale_x, w) + 1.0).ceil().min(w);
    let y0 = (h - pixel(top, view.scale_y, h) - 1.0).floor().max(0.0);
    let y1 = (h - pixel(bottom, view.scale_y, h) + 1.0).ceil().min(h);
    if x1 <= x0 || y1 <= y0 {
        return Rect::default();
    }
    Rect {
        x: x0 as u32,
        y: y0 as u32,
        width: (x1 - x0) as u32,
        height: (y1 - y0) as u32,
    }
}

/// Slopes (x over depth) of the tangents from the eye to a disc; infinite where the disc reaches
/// round behind the eye plane.
fn tangents(center: DVec2, radius: f64) -> (f64, f64) {
    let distance = center.length();
    if distance <= radius {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    let middle = center.x.atan2(center.y);
    let half = (radius / distance).asin();
    let right_angle = std::f64::consts::FRAC_PI_2;
    let slope = |angle: f64| {
        if angle <= -right_angle {
            f64::NEG_INFINITY
        } else if angle >= right_angle {
            f64::INFINITY
        } else {
            angle.tan()
        }
    };
    (slope(middle - half), slope(middle + half))
}
