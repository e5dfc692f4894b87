//! What masks cannot show, and so are not asked for: each a placement with its reason.
//!
//! Takes a case and one of its lights; says which placement it is, if it is one. Reports count the
//! lights left out by name. Volumes and points have no such limits: they are asked about every
//! light.

use glam::DVec3;
use umbrage_core::{Casting, Light, View};
use umbrage_lab::lab::Method;

use crate::case::Case;
use crate::exact::{Point, side};

/// A placement of which no mask, or not both masks, are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Limit {
    /// Off an edge, and so near that its ends are in opposite directions.
    LightBesideEdge,
    /// Off a face, and so near that its corners are all around.
    LightBesideFace,
    /// Off the plane of a caster, and so near that f32 has it in the plane.
    LightInPlane,
    /// The eye is off the light, and so near that the two see the same.
    EyeBesideLight,
    /// The eye is just off a triangle, and so near that f32 has it in its plane.
    EyeOnTriangle,
}

/// Pi less the angle between the two ends of an edge.
const BESIDE_EDGE: f64 = 1e-3;
/// Volume spanned by the directions to the three corners of a face.
const BESIDE_FACE: f64 = 1e-3;
/// Between the eye and a triangle's plane, of the distance to the farthest corner: the 2^-22 within
/// which the shaders leave it out, and the 2^-21 within which f32 tells them that height, rounded up.
const ON_TRIANGLE: f64 = 1.0 / (1u64 << 20) as f64;
/// Between the light and a caster's plane, of the distance to the farthest corner.
const IN_PLANE: f64 = 1.0 / (1u64 << 24) as f64;
/// Between eye and light, of the mesh's size.
const BESIDE_EYE: f64 = 2e-3;

impl Limit {
    /// All of them.
    pub const ALL: [Limit; 5] = [
        Limit::LightBesideEdge,
        Limit::LightBesideFace,
        Limit::LightInPlane,
        Limit::EyeBesideLight,
        Limit::EyeOnTriangle,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Limit::LightBesideEdge => "light-beside-edge",
            Limit::LightBesideFace => "light-beside-face",
            Limit::LightInPlane => "light-in-plane",
            Limit::EyeBesideLight => "eye-beside-light",
            Limit::EyeOnTriangle => "eye-on-triangle",
        }
    }

    /// Where it is, what is not drawn, and why.
    pub fn reason(self) -> &'static str {
        match self {
            Limit::LightBesideEdge => {
                "the light is off an edge that it sees under 180 degrees less 1e-3: the edge's \
                 ends are extruded in opposite directions, and the rounding of f32 clip positions \
                 turns the side about the edge; drawn by neither method"
            }
            Limit::LightBesideFace => {
                "the light is off a face whose corners it sees all around (their directions span \
                 less than 1e-3): the face's dark cap covers half of all directions, and f32 \
                 rounding bends its rim; not drawn by counter-zfail"
            }
            Limit::LightInPlane => {
                "the light is off a caster's plane by less than 2^-24 of the distance to its \
                 farthest corner: its sides run within that of its own surface, and which is in \
                 front is rounding; drawn by neither method"
            }
            Limit::EyeBesideLight => {
                "eye and light are apart by less than 2e-3 of the mesh's size: sides are narrower \
                 than the rasteriser's grid, and their depth is rounding alone; drawn by neither \
                 method"
            }
            Limit::EyeOnTriangle => {
                "the eye is on a triangle but for 2^-20 of the distance to its farthest corner: \
                 depth pass and volumes take it for one seen edge-on (umbrage_eye_in_plane) and \
                 leave it out, where the oracle sees it fill the picture; drawn by neither method"
            }
        }
    }

    /// Whether `method` draws it all the same.
    pub fn is_drawn_by(self, method: Method) -> bool {
        match self {
            Limit::LightBesideFace => method == Method::Counter,
            Limit::LightBesideEdge
            | Limit::LightInPlane
            | Limit::EyeBesideLight
            | Limit::EyeOnTriangle => false,
        }
    }

    /// Which it is, for a light seen in a view.
    pub fn of(case: &Case, light: &Light, view: &View) -> Option<Self> {
        let eye = view.eye;
        let on_triangle = |t| eye_on_triangle(eye, case.mesh.corners(t));
        if (0..case.mesh.triangles.len()).any(on_triangle) {
            return Some(Limit::EyeOnTriangle);
        }
        if light.is_directional() {
            return None;
        }
        let at = light.position;
        let apart = at.distance(eye);
        if apart > 0.0 && apart < BESIDE_EYE * f64::from(case.size()) {
            return Some(Limit::EyeBesideLight);
        }
        let beside = |beside: fn(DVec3, [DVec3; 3]) -> bool| {
            casters(case).any(|t| beside(at, case.mesh.corners(t)))
        };
        if beside(beside_edge) {
            return Some(Limit::LightBesideEdge);
        }
        if beside(in_rounded_plane) {
            return Some(Limit::LightInPlane);
        }
        beside(beside_face).then_some(Limit::LightBesideFace)
    }
}

fn casters(case: &Case) -> impl Iterator<Item = usize> {
    let rules = case.mesh.casting.iter().enumerate();
    rules.filter_map(|(t, rule)| (*rule != Casting::None).then_some(t))
}

/// Off its plane by less than f32 can tell, and on it or within a thousandth of its size.
fn eye_on_triangle(eye: DVec3, corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    let size = corners
        .map(|p| p.distance(eye))
        .into_iter()
        .fold(0.0, f64::max);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let height = normal.dot(eye - a).abs();
    let on = |(p, q): (DVec3, DVec3)| {
        let inward = normal.cross((q - p).normalize_or_zero());
        inward.dot(eye - p) >= -1e-3 * size
    };
    height <= ON_TRIANGLE * size
        && !is_in_plane(eye, corners)
        && [(a, b), (b, c), (c, a)].into_iter().all(on)
}

/// Off an edge of a triangle that may cast, and between its ends.
fn beside_edge(light: DVec3, corners: [DVec3; 3]) -> bool {
    !is_in_plane(light, corners)
        && (0..3).any(|k| {
            let [u, v] =
                [corners[k], corners[(k + 1) % 3]].map(|p| (p - light).normalize_or_zero());
            u.dot(v) < 0.0 && u.cross(v).length() < BESIDE_EDGE
        })
}

fn beside_face(light: DVec3, corners: [DVec3; 3]) -> bool {
    let [u, v, w] = corners.map(|p| (p - light).normalize_or_zero());
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let turns = [u.cross(v), v.cross(w), w.cross(u)].map(|turn| turn.dot(normal) >= 0.0);
    !is_in_plane(light, corners) && turns == [true; 3] && u.cross(v).dot(w).abs() < BESIDE_FACE
}

/// Off it by less than f32 can tell.
fn in_rounded_plane(light: DVec3, corners: [DVec3; 3]) -> bool {
    height(light, corners) <= IN_PLANE * farthest(light, corners) && !is_in_plane(light, corners)
}

/// Above a triangle's plane or below it.
fn height(p: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    normal.dot(p - a).abs()
}

fn farthest(p: DVec3, corners: [DVec3; 3]) -> f64 {
    corners
        .map(|q| q.distance(p))
        .into_iter()
        .fold(0.0, f64::max)
}

/// Exactly: then the triangle casts nothing.
fn is_in_plane(light: DVec3, corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners.map(Point::Near);
    side(a, b, c, Point::Near(light)) == 0
}
