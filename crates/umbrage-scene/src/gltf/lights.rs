//! Lights of `KHR_lights_punctual` and perspective cameras, placed by their nodes.
//!
//! Takes what the file says and a node's transform; gives a light or camera in world space whose
//! values are in bounds; what was out of bounds is counted. Both look along the node's -Z axis.
//! Source: <https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_lights_punctual>.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DAffine3, DVec3, Vec3};

use gltf::json::Camera as SourceCamera;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Source, Spot, Type};
use gltf::json::validation::Checked;

use crate::{Camera, Light, LightKind, LoadReport};

/// A light at a node; `None`, and counted, if its type is unknown.
pub(super) fn light(
    source: &Source,
    name: String,
    transform: &DAffine3,
    report: &mut LoadReport,
) -> Option<Light> {
    let before = report.repaired_lights;
    let kind = match source.type_ {
        Checked::Valid(Type::Point) => LightKind::Point,
        Checked::Valid(Type::Directional) => LightKind::Directional,
        Checked::Valid(Type::Spot) => cone(source.spot.as_ref(), report),
        Checked::Invalid => {
            report.skipped_lights += 1;
            report.note(|| format!("light {name} is of unknown type, skipped"));
            return None;
        }
    };
    let color = source.color.map(|c| {
        report.repaired_lights += u64::from(!(0.0..=1.0).contains(&c));
        if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) }
    });
    let mut intensity = source.intensity;
    if !intensity.is_finite() || intensity < 0.0 {
        report.repaired_lights += 1;
        intensity = if intensity > 0.0 { f32::MAX } else { 0.0 };
    }
    let range = source.range;
    let bounded = range.filter(|r| r.is_finite() && *r > 0.0);
    report.repaired_lights += u64::from(range != bounded);

    let axis = transform.transform_vector3(DVec3::NEG_Z).try_normalize();
    let aimed = !matches!(kind, LightKind::Point);
    report.repaired_lights += u64::from(aimed && axis.is_none());
    if report.repaired_lights > before {
        report.note(|| format!("light {name} had values out of bounds"));
    }
    Some(Light {
        name,
        position: transform.translation,
        direction: axis.unwrap_or(DVec3::NEG_Z),
        color: Vec3::from(color),
        intensity,
        range: bounded,
        kind,
        node: None,
    })
}

/// The cone of a spot light: 0 <= inner < outer <= 90 degrees.
fn cone(spot: Option<&Spot>, report: &mut LoadReport) -> LightKind {
    let asked = spot.map_or((0.0, FRAC_PI_4), |s| {
        (s.inner_cone_angle, s.outer_cone_angle)
    });
    let outer = if asked.1 > 0.0 {
        asked.1.min(FRAC_PI_2)
    } else {
        FRAC_PI_4
    };
    let inner = asked.0.clamp(0.0, outer);
    // Equal angles would divide by zero in the falloff of the extension's text.
    let inner = if inner < outer { inner } else { outer * 0.999 };
    report.repaired_lights += u64::from((inner, outer) != asked);
    LightKind::Spot {
        inner_rad: inner,
        outer_rad: outer,
    }
}

/// A camera at a node; `None`, and counted, if it is orthographic or its angle is unusable.
pub(super) fn camera(
    source: &SourceCamera,
    name: String,
    transform: &DAffine3,
    report: &mut LoadReport,
) -> Option<Camera> {
    let perspective = source.perspective.as_ref();
    let fovy = perspective.map(|p| p.yfov).filter(|f| *f > 0.0 && *f < PI);
    let axes = basis(transform);
    let (Some(fovy), Some((forward, up))) = (fovy, axes) else {
        report.skipped_cameras += 1;
        report.note(|| format!("camera {name} is orthographic or has no usable view, skipped"));
        return None;
    };
    let near = perspective
        .map(|p| f64::from(p.znear))
        .filter(|n| n.is_finite() && *n > 0.0);
    Some(Camera {
        name,
        position: transform.translation,
        forward,
        up,
        fovy_rad: f64::from(fovy),
        near,
        node: None,
    })
}

/// View and up direction of a node, at right angles; `None` if its transform is singular.
fn basis(transform: &DAffine3) -> Option<(DVec3, DVec3)> {
    let forward = transform.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    let up = transform.transform_vector3(DVec3::Y);
    let up = (up - forward * up.dot(forward)).try_normalize()?;
    Some((forward, up))
}
