//! Where a light's map looks: a cube of six faces, one face for a spot's cone, one parallel
//! projection for a directional light.
//!
//! Depth is reversed: `near / distance` with an infinite far plane, or linear for parallel light.
//! As a float, `near / distance` is equally precise at every distance whatever `near` is, so that
//! the near plane can stand close to the light and lose no caster. It is also affine on screen, so
//! that slope bias is exact. A face is one texel wider than what it has to show, so that the four
//! texels around any direction lie in one face and no seam shows.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};
use umbrage_core::{Light, LightShape, View};

/// `struct Face` of the shaders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Face {
    right: Vec3,
    scale_x: f32,
    up: Vec3,
    scale_y: f32,
    forward: Vec3,
    near: f32,
    origin: Vec3,
    length: f32,
}

/// Cosine of the half angle beyond which a spot gets a cube.
const WIDEST_COS: f32 = 0.173_648_18; // 80 degrees
/// The near plane as a share of the range, and at most this far from the light, in metres.
const NEAR: f32 = 1.0 / 65536.0;
const FARTHEST_NEAR: f32 = 1e-4;

/// How many faces a light's map has.
pub(super) fn face_count(light: &Light) -> u32 {
    match light.shape {
        LightShape::Point => 6,
        LightShape::Spot { cos_outer, .. } if cos_outer < WIDEST_COS => 6,
        _ => 1,
    }
}

/// The faces of a light's map of `texels` a side. A directional light's shows what `view` sees of
/// the box `bounds`, no more: it follows every move of the eye, unsnapped.
pub(super) fn faces(light: &Light, texels: u32, view: &View, bounds: [Vec3; 2]) -> Vec<Face> {
    let shown = (texels - 1) as f32 / texels as f32;
    let perspective = |forward: Vec3, right: Vec3, tan: f32| Face {
        right,
        scale_x: shown / tan,
        up: right.cross(forward),
        scale_y: shown / tan,
        forward,
        near: (NEAR * light.range).min(FARTHEST_NEAR),
        origin: light.position.as_vec3(),
        length: 0.0,
    };
    match light.shape {
        LightShape::Directional { direction } => {
            vec![parallel(direction, shown, view, bounds)]
        }
        LightShape::Spot {
            direction,
            cos_outer,
        } if face_count(light) == 1 => {
            let sin = (1.0 - cos_outer * cos_outer).max(1e-6).sqrt();
            let forward = direction.normalize_or(Vec3::NEG_Y);
            vec![perspective(
                forward,
                forward.any_orthonormal_vector(),
                sin / cos_outer,
            )]
        }
        _ => [Vec3::X, Vec3::Y, Vec3::Z]
            .into_iter()
            .flat_map(|axis| [axis, -axis])
            .map(|forward| perspective(forward, Vec3::new(forward.y, forward.z, forward.x), 1.0))
            .collect(),
    }
}

/// Parallel light on what is seen of the box, turned with the eye so that little is wasted; in
/// depth, the whole box.
fn parallel(direction: Vec3, shown: f32, view: &View, bounds: [Vec3; 2]) -> Face {
    let forward = direction.normalize_or(Vec3::NEG_Y);
    let ahead = view.forward - view.forward.dot(forward) * forward;
    let up = ahead.try_normalize();
    let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
    let right = forward.cross(up);
    let all = corners(bounds.map(Vec3::as_dvec3));
    let seen = seen_of_box(view, bounds);
    let seen = if seen.is_empty() { &all[..] } else { &seen };
    let span = |axis: Vec3, points: &[DVec3]| {
        let along = points.iter().map(|p| p.dot(axis.as_dvec3()));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let ([left, right_end], [bottom, top]) = (span(right, seen), span(up, seen));
    let [near, far] = span(forward, &all);
    // So that what stands on either plane is not clipped by rounding.
    let slack = (far - near) * 1e-4 + 1e-3;
    let middle = |low: f64, high: f64| (low + high) * 0.5;
    let origin = right.as_dvec3() * middle(left, right_end)
        + up.as_dvec3() * middle(bottom, top)
        + forward.as_dvec3() * (near - slack);
    let scale = |low: f64, high: f64| shown * 2.0 / (high - low).max(1e-6) as f32;
    Face {
        right,
        scale_x: scale(left, right_end),
        up,
        scale_y: scale(bottom, top),
        forward,
        near: 0.0,
        origin: origin.as_vec3(),
        length: (far - near + 2.0 * slack) as f32,
    }
}

fn corners([min, max]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 1 {
                max[axis]
            } else {
                min[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// Inward normals of the view's sides.
fn side_normals(view: &View) -> [Vec3; 4] {
    let (x, y) = (view.right * view.scale_x, view.up * view.scale_y);
    [x, -x, y, -y].map(|side| (view.forward + side).normalize_or_zero())
}

/// Corners of the part of the box that is seen: where three planes meet, and no other cuts off.
fn seen_of_box(view: &View, [min, max]: [Vec3; 2]) -> Vec<DVec3> {
    let size = f64::from((max - min).max_element());
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let eye = view.eye;
    // Points inside have n.p >= d.
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    for (i, axis) in axes.into_iter().enumerate() {
        planes.push((axis, f64::from(min[i])));
        planes.push((-axis, -f64::from(max[i])));
    }
    for n in side_normals(view) {
        let n = n.as_dvec3();
        planes.push((n, n.dot(eye)));
    }
    let mut found = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in planes.iter().skip(j + 1) {
                let rows = DMat3::from_cols(a.0, b.0, c.0).transpose();
                if rows.determinant().abs() < 1e-9 {
                    continue;
                }
                let p = rows.inverse() * DVec3::new(a.1, b.1, c.1);
                if planes.iter().all(|(n, d)| n.dot(p) >= d - 1e-6 * size) {
                    found.push(p);
                }
            }
        }
    }
    found
}

impl Face {
    /// Whether the view may see what the face shows, within the light's range.
    pub(super) fn is_seen(&self, view: &View, range: f32) -> bool {
        if self.length > 0.0 || !range.is_finite() {
            return true;
        }
        let (x, y) = (self.right / self.scale_x, self.up / self.scale_y);
        let ends = [x + y, x - y, y - x, -x - y].map(|aside| (self.forward + aside) * range);
        let apex = self.origin - view.eye.as_vec3();
        let slack = 1e-4 * range;
        side_normals(view)
            .into_iter()
            .chain([view.forward])
            .all(|n| n.dot(apex) >= -slack || ends.iter().any(|end| n.dot(apex + *end) >= -slack))
    }

    /// Whether a triangle may be in it.
    pub(super) fn meets(&self, triangle: [Vec3; 3]) -> bool {
        if self.length > 0.0 {
            return true;
        }
        let clip = triangle.map(|p| {
            let q = p - self.origin;
            (
                self.scale_x * self.right.dot(q),
                self.scale_y * self.up.dot(q),
                // With slack for rounding.
                self.forward.dot(q) + 1e-5 * q.length(),
            )
        });
        let out = |beyond: fn(&(f32, f32, f32)) -> bool| clip.iter().all(beyond);
        !(out(|c| c.0 > c.2) || out(|c| -c.0 > c.2) || out(|c| c.1 > c.2) || out(|c| -c.1 > c.2))
    }
}
