//! Writing a scene as binary glTF.
//!
//! Takes a [`Scene`]; gives one `.glb` file that [`load`](crate::load) reads back: geometry,
//! instances, materials, images, lights, cameras. Transforms keep their f64 digits. Invariant: the
//! file appears whole or not at all, since it is written under another name and then renamed.

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3, Vec2, Vec3};
use serde_json::{Map, Value, json};

use crate::{AlphaMode, Camera, Image, Light, LightKind, Material, Mesh, Scene, SceneError};

/// Near plane, in metres, of a camera that has none: glTF demands one.
const NEAR: f64 = 0.05;

/// Writes `scene` to `path`, replacing what is there.
///
/// The triangles of a mesh come back grouped by material, in order of first use. Meshes without
/// triangles, and instances of them, are left out, since glTF has no empty mesh. A camera without
/// a near plane comes back with one of 5 cm.
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
        let encoded = png(image)
            .map_err(|what| scene.invalid(format!("image {index} ({})", image.name), what))?;
        let view = binary.view(&encoded, None);
        images.push(json!({"name": image.name, "bufferView": view, "mimeType": "image/png"}));
    }
    let nodes = nodes(scene, &numbers);
    let roots: Vec<usize> = (0..nodes.len()).collect();
    binary.pad(0);
    let textures: Vec<Value> = (0..images.len()).map(|i| json!({"source": i})).collect();
    let cameras: Vec<Value> = scene.cameras.iter().map(camera).collect();
    let lights: Vec<Value> = scene.lights.iter().map(light).collect();
    let materials: Vec<Value> = scene.materials.iter().map(material).collect();
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
    let mut json = Value::Object(root).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    save(scene, path, &json, &binary.bytes)
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

/// The binary chunk and what the JSON says about its parts.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    fn pad(&mut self, fill: u8) {
        self.bytes
            .resize(self.bytes.len().next_multiple_of(4), fill);
    }

    /// Appends bytes as a buffer view; gives its index.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.pad(0);
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Appends float vectors as an accessor; gives its index.
    fn floats<const N: usize>(&mut self, values: impl Iterator<Item = [f32; N]>) -> usize {
        let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        let mut bytes = Vec::new();
        for value in values {
            for i in 0..N {
                low[i] = low[i].min(value[i]);
                high[i] = high[i].max(value[i]);
                bytes.extend(value[i].to_le_bytes());
            }
        }
        let view = self.view(&bytes, Some(34962));
        let (count, shape) = (bytes.len() / (4 * N), ["SCALAR", "VEC2", "VEC3"][N - 1]);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": count, "type": shape,
            "min": low.to_vec(), "max": high.to_vec(),
        }));
        self.accessors.len() - 1
    }

    /// Appends a mesh: one set of vertices, one primitive for each material.
    fn mesh(&mut self, mesh: &Mesh) -> Value {
        let position = self.floats(mesh.positions.iter().map(Vec3::to_array));
        let mut attributes = json!({ "POSITION": position });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = json!(self.floats(mesh.normals.iter().map(Vec3::to_array)));
        }
        if !mesh.uvs.is_empty() {
            attributes["TEXCOORD_0"] = json!(self.floats(mesh.uvs.iter().map(Vec2::to_array)));
        }
        let mut groups: Vec<(u32, Vec<u8>)> = Vec::new();
        let mut group_of = std::collections::HashMap::new();
        for (triangle, &material) in mesh.triangles.iter().zip(&mesh.materials) {
            let group = *group_of.entry(material).or_insert_with(|| {
                groups.push((material, Vec::new()));
                groups.len() - 1
            });
            groups[group]
                .1
                .extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
        }
        let mut primitives = Vec::new();
        for (material, indices) in groups {
            let view = self.view(&indices, Some(34963));
            let count = indices.len() / 4;
            self.accessors.push(
                json!({"bufferView": view, "componentType": 5125, "count": count, "type": "SCALAR"}),
            );
            let accessor = self.accessors.len() - 1;
            primitives
                .push(json!({"attributes": attributes, "indices": accessor, "material": material}));
        }
        json!({"name": mesh.name, "primitives": primitives})
    }
}

/// Nodes of instances, lights and cameras, in this order.
fn nodes(scene: &Scene, numbers: &[Option<usize>]) -> Vec<Value> {
    let mut nodes = Vec::new();
    for instance in &scene.instances {
        let Some(mesh) = numbers[instance.mesh as usize] else {
            continue;
        };
        let mut node = json!({"name": instance.name, "mesh": mesh});
        if instance.transform != glam::DAffine3::IDENTITY {
            let m = instance.transform.matrix3.to_cols_array();
            let t = instance.transform.translation;
            let rows = [
                m[0], m[1], m[2], 0.0, m[3], m[4], m[5], 0.0, m[6], m[7], m[8], 0.0, t.x, t.y, t.z,
                1.0,
            ];
            node["matrix"] = json!(rows.to_vec());
        }
        nodes.push(node);
    }
    let place = |name: &str, position: DVec3, rotation: DQuat| {
        let (translation, rotation) = (position.to_array(), rotation.normalize().to_array());
        json!({"name": name, "translation": translation, "rotation": rotation})
    };
    for (index, light) in scene.lights.iter().enumerate() {
        let direction = light.direction.try_normalize().unwrap_or(DVec3::NEG_Z);
        let rotation = DQuat::from_rotation_arc(DVec3::NEG_Z, direction);
        let mut node = place(&light.name, light.position, rotation);
        node["extensions"] = json!({"KHR_lights_punctual": {"light": index}});
        nodes.push(node);
    }
    for (index, camera) in scene.cameras.iter().enumerate() {
        let right = camera.forward.cross(camera.up);
        let basis = DMat3::from_cols(right, camera.up, -camera.forward);
        let mut node = place(&camera.name, camera.position, DQuat::from_mat3(&basis));
        node["camera"] = json!(index);
        nodes.push(node);
    }
    nodes
}

fn light(light: &Light) -> Value {
    let kind = match light.kind {
        LightKind::Point => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional => "directional",
    };
    let mut value = json!({
        "name": light.name, "type": kind,
        "color": light.color.to_array(), "intensity": light.intensity,
    });
    if let Some(range) = light.range {
        value["range"] = json!(range);
    }
    if let LightKind::Spot {
        inner_rad,
        outer_rad,
    } = light.kind
    {
        value["spot"] = json!({"innerConeAngle": inner_rad, "outerConeAngle": outer_rad});
    }
    value
}

fn camera(camera: &Camera) -> Value {
    let near = camera.near.unwrap_or(NEAR);
    json!({
        "name": camera.name, "type": "perspective",
        "perspective": {"yfov": camera.fovy_rad, "znear": near},
    })
}

fn material(material: &Material) -> Value {
    let mut value = json!({
        "name": material.name,
        "doubleSided": material.double_sided,
        "pbrMetallicRoughness": {
            "baseColorFactor": material.base_color.to_array(),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
    });
    if let Some(image) = material.base_color_image {
        value["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": image });
    }
    let strength = material.emissive.max_element();
    if strength > 1.0 {
        // A power of two divides without rounding.
        let strength = strength.log2().ceil().exp2();
        value["emissiveFactor"] = json!((material.emissive / strength).to_array());
        value["extensions"] =
            json!({"KHR_materials_emissive_strength": {"emissiveStrength": strength}});
    } else if strength > 0.0 {
        value["emissiveFactor"] = json!(material.emissive.to_array());
    }
    match material.alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Mask { cutoff } => {
            value["alphaMode"] = json!("MASK");
            value["alphaCutoff"] = json!(cutoff);
        }
        AlphaMode::Blend => value["alphaMode"] = json!("BLEND"),
    }
    value
}

fn png(image: &Image) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.size[0], image.size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer
        .write_image_data(&image.rgba8)
        .map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Writes the container beside its final place, then renames it.
fn save(scene: &Scene, path: &Path, json: &[u8], binary: &[u8]) -> Result<(), SceneError> {
    let body = if binary.is_empty() {
        0
    } else {
        8 + binary.len()
    };
    let Ok(length) = u32::try_from(12 + 8 + json.len() + body) else {
        let what = "it exceeds the 4 GiB of a GLB container".to_owned();
        return Err(scene.invalid("scene".to_owned(), what));
    };
    let mut part = path.as_os_str().to_owned();
    part.push(format!(".{}.part", std::process::id()));
    let part = PathBuf::from(part);
    let write = || -> std::io::Result<()> {
        let mut file = std::fs::File::create(&part)?;
        for word in [0x4654_6C67, 2, length, json.len() as u32, 0x4E4F_534A] {
            file.write_all(&word.to_le_bytes())?;
        }
        file.write_all(json)?;
        if !binary.is_empty() {
            file.write_all(&(binary.len() as u32).to_le_bytes())?;
            file.write_all(b"BIN\0")?;
            file.write_all(binary)?;
        }
        file.sync_all()?;
        std::fs::rename(&part, path)
    };
    write().map_err(|error| {
        let _ = std::fs::remove_file(&part); // it may not exist; the first error matters
        SceneError::io(path)(error)
    })
}
