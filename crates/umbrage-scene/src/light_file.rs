//! Light files: lights of their own, beside a scene.
//!
//! Takes a path; gives lights whose values are in bounds, or names the light at fault: nothing is
//! repaired. A JSON array, one object a light. All keys but the ones a type needs may be left out:
//!
//! ```json
//! [
//!   { "name": "lamp", "type": "point", "position": [0, 2.5, 0],
//!     "color": [1, 0.8, 0.6], "intensity": 100, "range": 12 },
//!   { "type": "spot", "position": [4, 3, 0], "direction": [0, -1, 0],
//!     "inner_deg": 20, "outer_deg": 35, "intensity": 400 },
//!   { "type": "directional", "direction": [0.3, -1, 0.2], "intensity": 2 }
//! ]
//! ```
//!
//! Positions and ranges are world metres, directions the way the light travels (any length),
//! colours linear, intensities candela (lux for directional ones), angles half angles of the cone
//! in degrees: as in glTF's KHR_lights_punctual.

use std::collections::HashSet;
use std::path::Path;

use glam::{DVec3, Vec3};
use serde::Deserialize;

use crate::{Files, Light, LightKind, SceneError};

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Type {
    #[default]
    Point,
    Spot,
    Directional,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Item {
    name: Option<String>,
    #[serde(default, rename = "type")]
    kind: Type,
    position: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    #[serde(default = "white")]
    color: [f32; 3],
    #[serde(default = "one")]
    intensity: f32,
    range: Option<f32>,
    #[serde(default)]
    inner_deg: f32,
    #[serde(default = "outer")]
    outer_deg: f32,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}

fn outer() -> f32 {
    45.0
}

/// Reads the light file at `path`.
///
/// # Errors
/// What `files` refuses, or [`SceneError::LightFile`] with the light at fault.
pub fn read(path: &Path, files: &dyn Files) -> Result<Vec<Light>, SceneError> {
    let bytes = files.read(path)?;
    parse(&bytes).map_err(|(item, what)| SceneError::LightFile {
        path: path.to_owned(),
        item,
        what,
    })
}

/// The lights, or the item at fault and what is wrong with it.
fn parse(bytes: &[u8]) -> Result<Vec<Light>, (String, String)> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let items: Vec<serde_json::Value> = serde_json::from_slice(bytes).map_err(|error| {
        let what = format!("not a JSON array of lights: {error}");
        ("the file".to_owned(), what)
    })?;
    let mut lights: Vec<Light> = Vec::with_capacity(items.len());
    let mut names = HashSet::new();
    for (number, value) in items.into_iter().enumerate() {
        let called = value.get("name").and_then(|name| name.as_str());
        let called = called.map(|name| format!(" ({name:?})"));
        let place = format!("light {number}{}", called.unwrap_or_default());
        let light = serde_json::from_value(value)
            .map_err(|error| error.to_string())
            .and_then(|item| to_light(item, number));
        let light = match light {
            Ok(light) if names.insert(light.name.clone()) => light,
            Ok(_) => return Err((place, "an earlier light has this name".to_owned())),
            Err(what) => return Err((place, what)),
        };
        lights.push(light);
    }
    Ok(lights)
}

fn to_light(item: Item, number: usize) -> Result<Light, String> {
    let kind = match item.kind {
        Type::Point => LightKind::Point,
        Type::Directional => LightKind::Directional,
        Type::Spot => {
            if !(0.0 <= item.inner_deg && item.inner_deg < item.outer_deg && item.outer_deg <= 90.0)
            {
                return Err("a spot needs 0 <= inner_deg < outer_deg <= 90".to_owned());
            }
            LightKind::Spot {
                inner_rad: item.inner_deg.to_radians(),
                outer_rad: item.outer_deg.to_radians(),
            }
        }
    };
    let position = match (item.position, item.kind) {
        (Some(position), _) => DVec3::from(position),
        (None, Type::Directional) => DVec3::ZERO,
        (None, _) => return Err("\"position\" is missing".to_owned()),
    };
    if !position.as_vec3().is_finite() {
        return Err("\"position\" must be finite in 32 bits".to_owned());
    }
    let direction = match (item.direction, item.kind) {
        (Some(direction), _) => unit(direction.into()).ok_or("\"direction\" has no length")?,
        (None, Type::Point) => DVec3::NEG_Y,
        (None, _) => return Err("\"direction\" is missing".to_owned()),
    };
    if !(item.intensity >= 0.0 && item.intensity.is_finite()) {
        return Err("\"intensity\" must be finite and not below 0".to_owned());
    }
    if item
        .range
        .is_some_and(|range| !(range > 0.0 && range.is_finite()))
    {
        return Err("\"range\" must be above 0; leave it out for a light without one".to_owned());
    }
    if item.color.iter().any(|part| !(0.0..=1.0).contains(part)) {
        return Err("\"color\" must be three linear values of 0 to 1".to_owned());
    }
    Ok(Light {
        name: item.name.unwrap_or_else(|| format!("light_{number}")),
        position,
        direction,
        color: Vec3::from(item.color),
        intensity: item.intensity,
        range: item.range,
        kind,
        node: None,
    })
}

/// Of any finite length, however small or large.
fn unit(direction: DVec3) -> Option<DVec3> {
    let longest = direction.abs().max_element();
    (direction / longest).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documented_example_is_read() {
        let example: String = include_str!("light_file.rs")
            .lines()
            .skip_while(|line| !line.contains("```json"))
            .skip(1)
            .take_while(|line| !line.contains("```"))
            .map(|line| line.trim_start_matches("//!"))
            .collect();
        let lights = parse(example.as_bytes()).unwrap();
        let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["lamp", "light_1", "light_2"]);
        assert_eq!(lights[0].range, Some(12.0));
        assert!(matches!(lights[1].kind, LightKind::Spot { outer_rad, .. } if outer_rad > 0.6));
        assert!((lights[2].direction.length() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn errors_name_the_light_and_the_key() {
        for (text, parts) in [
            (r#"{"lights": []}"#, ["JSON array", ""]),
            (
                r#"[{"position":[0,0,0]},{"name":"b"}]"#,
                ["light 1 (\"b\")", "position"],
            ),
            (r#"[{"position":[0,0]}]"#, ["light 0", "length 2"]),
            (
                r#"[{"position":[0,0,0],"colour":[1,1,1]}]"#,
                ["light 0", "colour"],
            ),
            (
                r#"[{"type":"lamp","position":[0,0,0]}]"#,
                ["light 0", "lamp"],
            ),
            (
                r#"[{"type":"spot","position":[0,0,0]}]"#,
                ["light 0", "direction"],
            ),
            (
                r#"[{"type":"directional","direction":[0,0,0]}]"#,
                ["light 0", "length"],
            ),
            (r#"[{"position":[0,0,0],"range":0}]"#, ["light 0", "range"]),
            (
                r#"[{"position":[0,0,0],"name":"a"},{"position":[1,0,0],"name":"a"}]"#,
                ["light 1", "name"],
            ),
        ] {
            let (item, what) = parse(text.as_bytes()).unwrap_err();
            let error = format!("{item}: {what}");
            assert!(
                parts.iter().all(|part| error.contains(part)),
                "{text}: {error}"
            );
        }
    }
}
