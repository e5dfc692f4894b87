//! The JSON of a file as the types of the `gltf` package.
//!
//! Takes the text; gives a [`Root`] of version 2 without unknown required extensions. Its indices
//! are not checked yet: who follows one resolves it. The package demands fields that the
//! specification leaves optional or that no scene needs; a file that lacks one is completed and
//! read again.

use std::path::Path;

use gltf::json::{self, Animation, Root, Value};

use crate::{LoadReport, SceneError};

type Object = serde_json::Map<String, Value>;

/// Extensions that may be required: they change nothing, or what they change is handled here.
const KNOWN_EXTENSIONS: [&str; 8] = [
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
];

/// The root of a file that can be loaded.
pub(super) fn parse(text: &[u8], path: &Path, report: &mut LoadReport) -> Result<Root, SceneError> {
    let root = read(text, report).map_err(|source| SceneError::Json {
        path: path.to_owned(),
        source,
    })?;
    if !root.asset.version.starts_with("2.") && root.asset.version != "2" {
        return Err(SceneError::Version {
            path: path.to_owned(),
            version: root.asset.version,
        });
    }
    let unknown =
        |e: &&String| !KNOWN_EXTENSIONS.contains(&e.as_str()) && !e.starts_with("KHR_materials_");
    if let Some(extension) = root.extensions_required.iter().find(unknown) {
        let (path, extension) = (path.to_owned(), extension.clone());
        return Err(SceneError::UnsupportedExtension { path, extension });
    }
    Ok(root)
}

/// Reads the text as it is, else completed, else without the animations that cannot be read, else
/// without skins too; the first error has line and column.
fn read(text: &[u8], report: &mut LoadReport) -> Result<Root, json::Error> {
    let first = match json::deserialize::from_slice(text) {
        Ok(root) => return Ok(root),
        Err(first) => first,
    };
    let completed = json::deserialize::from_slice::<Value>(text).map(complete);
    let Ok(mut left) = completed else {
        return Err(first);
    };
    if let Ok(root) = json::deserialize::from_value(left.clone()) {
        return Ok(root);
    }
    let animations = leave_out_animations(&mut left);
    let mut skins = 0;
    let root = json::deserialize::from_value(left.clone()).or_else(|_| {
        skins = leave_out_skins(&mut left);
        json::deserialize::from_value(left)
    });
    let root = root.map_err(|_| first)?;
    for (what, count) in [("animations", animations), ("skins", skins)] {
        report.skipped_rigs += count;
        if count > 0 {
            report.note(|| format!("{count} {what} left out: JSON without what glTF demands"));
        }
    }
    Ok(root)
}

/// Leaves out every animation that cannot be read: nothing refers to one. Gives their number.
fn leave_out_animations(root: &mut Value) -> u64 {
    let Some(animations) = root.get_mut("animations") else {
        return 0;
    };
    let Some(items) = animations.as_array_mut() else {
        *animations = Value::Array(vec![]);
        return 1;
    };
    let before = items.len();
    let reads = |item: &Value| json::deserialize::from_value::<Animation>(item.clone()).is_ok();
    items.retain(reads);
    (before - items.len()) as u64
}

/// Leaves out all skins, to which nodes refer by number. Gives their number.
fn leave_out_skins(root: &mut Value) -> u64 {
    let Some(root) = root.as_object_mut() else {
        return 0;
    };
    for node in list(root, "nodes") {
        node.remove("skin");
    }
    let skins = root.remove("skins");
    skins.map_or(0, |skins| skins.as_array().map_or(1, Vec::len) as u64)
}

/// Leaves out what is never read, and gives fields that may be absent a value that says so.
fn complete(mut root: Value) -> Value {
    let default = |item: &mut Object, key: &str, value: Value| {
        item.entry(key).or_insert(value);
    };
    let Some(root_object) = root.as_object_mut() else {
        return root;
    };
    root_object.remove("samplers");
    for animation in list(root_object, "animations") {
        default(animation, "samplers", Value::Array(vec![]));
        default(animation, "channels", Value::Array(vec![]));
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            // Without a node they move nothing that is read.
            channels.retain(|channel| channel.pointer("/target/node").is_some());
        }
    }
    for skin in list(root_object, "skins") {
        default(skin, "joints", Value::Array(vec![]));
    }
    for scene in list(root_object, "scenes") {
        default(scene, "nodes", Value::Array(vec![]));
    }
    for mesh in list(root_object, "meshes") {
        default(mesh, "primitives", Value::Array(vec![]));
        for primitive in list(mesh, "primitives") {
            default(primitive, "attributes", Value::Object(Object::new()));
        }
    }
    for material in list(root_object, "materials") {
        for unread in ["normalTexture", "occlusionTexture", "emissiveTexture"] {
            material.remove(unread);
        }
    }
    for camera in list(root_object, "cameras") {
        default(camera, "type", Value::from(""));
        camera.remove("orthographic");
        if let Some(Value::Object(perspective)) = camera.get_mut("perspective") {
            default(perspective, "yfov", Value::from(0));
            default(perspective, "znear", Value::from(0));
        }
    }
    for node in list(root_object, "nodes") {
        if let Some(Value::Object(extensions)) = node.get_mut("extensions") {
            let light = extensions.get("KHR_lights_punctual");
            if light.is_some_and(|l| l.get("light").is_none()) {
                extensions.remove("KHR_lights_punctual");
            }
        }
    }
    if let Some(Value::Object(lights)) = root.pointer_mut("/extensions/KHR_lights_punctual") {
        default(lights, "lights", Value::Array(vec![]));
        for light in list(lights, "lights") {
            default(light, "type", Value::from(""));
        }
    }
    root
}

/// The objects in the array under `key`; none if it is anything else.
fn list<'a>(item: &'a mut Object, key: &str) -> impl Iterator<Item = &'a mut Object> + use<'a> {
    let items = item.get_mut(key).and_then(Value::as_array_mut);
    items.into_iter().flatten().filter_map(Value::as_object_mut)
}
