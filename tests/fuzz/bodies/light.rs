//! Light files: bytes to lights, to volumes behind a few walls.

use std::path::Path;

use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Light, LightShape, Mesh};
use umbrage_scene::{Files, LightKind, SceneError, light_file};

use super::{Outcome, cast};

/// Lights that cast, at most.
const LIGHTS: usize = 16;

struct Bytes<'a>(&'a [u8]);

impl Files for Bytes<'_> {
    fn read(&self, _: &Path) -> Result<Vec<u8>, SceneError> {
        Ok(self.0.to_vec())
    }
}

pub(crate) fn lights(bytes: &[u8]) -> Outcome {
    match light_file::read(Path::new("fuzzed.json"), &Bytes(bytes)) {
        Ok(lights) => {
            lights.iter().for_each(check);
            let casting = lights.iter().take(LIGHTS);
            let casting = casting.map(|light| cast_by(light, DVec3::ZERO)).collect();
            cast::cast(&walls(), casting);
            Outcome::Used
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("fuzzed.json: "), "{message}");
            Outcome::Refused(message)
        }
    }
}

/// That a loaded light's values are in bounds.
pub(super) fn check(light: &umbrage_scene::Light) {
    assert!(light.position.is_finite(), "{light:?}");
    assert!((light.direction.length() - 1.0).abs() < 1e-6, "{light:?}");
    assert!(light.color.is_finite(), "{light:?}");
    assert!(
        light.intensity.is_finite() && light.intensity >= 0.0,
        "{light:?}"
    );
    let range = light.range.unwrap_or(1.0);
    assert!(range.is_finite() && range > 0.0, "{light:?}");
    if let LightKind::Spot {
        inner_rad,
        outer_rad,
    } = light.kind
    {
        let bounded = 0.0 <= inner_rad && inner_rad < outer_rad && outer_rad < 1.6;
        assert!(bounded, "{light:?}");
    }
}

/// The part of a light that casts, in a world with this origin.
pub(super) fn cast_by(light: &umbrage_scene::Light, origin: DVec3) -> Light {
    let direction = light.direction.as_vec3();
    Light {
        position: light.position - origin,
        range: light.range.unwrap_or(f32::INFINITY),
        shape: match light.kind {
            LightKind::Point => LightShape::Point,
            LightKind::Directional => LightShape::Directional { direction },
            LightKind::Spot { outer_rad, .. } => LightShape::Spot {
                direction,
                cos_outer: outer_rad.cos(),
            },
        },
    }
}

/// Two squares at right angles and a triangle on their common edge.
fn walls() -> Mesh {
    let at = |x: i8, y: i8, z: i8| Vec3::new(x.into(), y.into(), z.into());
    Mesh {
        positions: vec![
            at(0, 0, 0),
            at(4, 0, 0),
            at(4, 0, 4),
            at(0, 0, 4),
            at(0, 4, 0),
            at(4, 4, 0),
            at(2, 3, 5),
        ],
        triangles: vec![[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [0, 1, 6]],
        casting: vec![
            Casting::Front,
            Casting::Both,
            Casting::Both,
            Casting::Back,
            Casting::Both,
        ],
        ..Mesh::default()
    }
}
