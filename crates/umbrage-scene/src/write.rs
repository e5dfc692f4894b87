//! Writing a scene as binary glTF.
//!
//! Takes a [`Scene`]; gives one `.glb` file that [`load`](crate::load) reads back: geometry,
//! instances, materials, images, lights, cameras. A node's transform is
//! read as f32, as everywhere in glTF; what stands where f32 cannot say hangs on a second node, and
//! comes back to 48 bits. Invariant: the file appears whole or not at all, since it is written under
//! another name and then renamed.

mod binary;
mod json;
mod whole;

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::{Scene, SceneError};
use binary::Binary;

pub use whole::whole;

/// Writes `scene` to `path`, replacing what is there.
///
/// The triangles of a mesh come back grouped by material, in order of first use. Meshes without
/// triangles, and instances of them, are left out, since glTF has no empty mesh. A camera without
/// a near plane comes back with one of 5 cm. What moves is written as the file it came from puts it,
/// without its skins and animations.
///
/// # Errors
/// An index out of range or a value that is not finite, more than the 4 GiB of a GLB container, or
/// what the system says about writing.
pub fn glb(scene: &Scene, path: &Path) -> Result<(), SceneError> {
    check(scene)?;
    let mut binary = Binary::default();
    let mut meshes = Vec::new();
    let mut numbers = Vec::new();
    for mesh in &scene.meshes {
        numbers.push((!mesh.triangles.is_empty()).then_some(meshes.len()));
        if !mesh.triangles.is_empty() {
            meshes.push(binary.mesh(mesh));
        }
    }
    let mut images = Vec::new();
    for (index, image) in scene.images.iter().enumerate() {
        let encoded = binary::png(image)
            .map_err(|what| scene.invalid(format!("image {index} ({})", image.name), what))?;
        let view = binary.view(&encoded, None);
        images.push(json!({"name": image.name, "bufferView": view, "mimeType": "image/png"}));
    }
    let (nodes, roots) = json::nodes(scene, &numbers);
    let textures: Vec<Value> = (0..images.len()).map(|i| json!({"source": i})).collect();
    let cameras: Vec<Value> = scene.cameras.iter().map(json::camera).collect();
    let lights: Vec<Value> = scene.lights.iter().map(json::light).collect();
    let materials: Vec<Value> = scene.materials.iter().map(json::material).collect();
    let mut used = Vec::new();
    if !lights.is_empty() {
        used.push("KHR_lights_punctual");
    }
    if scene
        .materials
        .iter()
        .any(|m| m.emissive.max_element() > 1.0)
    {
        used.push("KHR_materials_emissive_strength");
    }
    let buffers = match binary.bytes.len() {
        0 => vec![],
        length => vec![json!({ "byteLength": length })],
    };
    let mut root = Map::new();
    root.insert(
        "asset".to_owned(),
        json!({"version": "2.0", "generator": "umbrage"}),
    );
    root.insert("scene".to_owned(), json!(0));
    let scene_nodes = if roots.is_empty() {
        json!({})
    } else {
        json!({ "nodes": roots })
    };
    root.insert("scenes".to_owned(), json!([scene_nodes]));
    for (key, list) in [
        ("nodes", nodes),
        ("meshes", meshes),
        ("materials", materials),
        ("textures", textures),
        ("images", images),
        ("cameras", cameras),
        ("accessors", binary.accessors),
        ("bufferViews", binary.views),
        ("buffers", buffers),
        (
            "extensionsUsed",
            used.into_iter().map(Value::from).collect(),
        ),
    ] {
        if !list.is_empty() {
            root.insert(key.to_owned(), Value::Array(list)); // glTF has no empty arrays
        }
    }
    if !lights.is_empty() {
        root.insert(
            "extensions".to_owned(),
            json!({"KHR_lights_punctual": {"lights": lights}}),
        );
    }
    let text = Value::Object(root).to_string();
    binary::save(scene, path, text.as_bytes(), &binary.bytes)
}

/// Refuses what the format cannot hold: values that are not finite, indices out of range.
fn check(scene: &Scene) -> Result<(), SceneError> {
    let invalid = |item: String, what: &str| Err(scene.invalid(item, what.to_owned()));
    scene.check_meshes()?;
    for (i, mesh) in scene.meshes.iter().enumerate() {
        if !mesh.positions.iter().all(|p| p.is_finite()) {
            return invalid(
                format!("mesh {i} ({})", mesh.name),
                "a position is not finite",
            );
        }
    }
    for (i, instance) in scene.instances.iter().enumerate() {
        let item = format!("instance {i} ({})", instance.name);
        if instance.mesh as usize >= scene.meshes.len() {
            return invalid(item, "its mesh does not exist");
        }
        if !instance.transform.is_finite() {
            return invalid(item, "its transform is not finite");
        }
    }
    for (i, m) in scene.materials.iter().enumerate() {
        let item = format!("material {i} ({})", m.name);
        if m.base_color_image
            .is_some_and(|image| image as usize >= scene.images.len())
        {
            return invalid(item, "its image does not exist");
        }
        if !m.emissive.is_finite() || !m.base_color.is_finite() {
            return invalid(item, "a colour is not finite");
        }
    }
    for (i, light) in scene.lights.iter().enumerate() {
        let values = [
            light.intensity,
            light.range.unwrap_or(0.0),
            light.color.length(),
        ];
        let finite = values.iter().all(|v| v.is_finite());
        if !light.position.is_finite() || !light.direction.is_finite() || !finite {
            return invalid(
                format!("light {i} ({})", light.name),
                "a value is not finite",
            );
        }
    }
    for (i, c) in scene.cameras.iter().enumerate() {
        if !c.position.is_finite() || !c.forward.is_finite() || !c.up.is_finite() {
            return invalid(
                format!("camera {i} ({})", c.name),
                "its place is not finite",
            );
        }
    }
    Ok(())
}
