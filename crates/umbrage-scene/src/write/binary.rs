//! The binary chunk of a written file, and the container around it.
//!
//! Takes meshes and encoded images; gives their bytes, aligned to four, with the buffer views and
//! accessors that name them. Saves them with the JSON through the `gltf` package.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use glam::{Vec2, Vec3};
use gltf::Glb;
use gltf::binary::Header;
use serde_json::{Value, json};

use crate::{Image, Mesh, Scene, SceneError};

/// The binary chunk and what the JSON says about its parts.
#[derive(Default)]
pub(super) struct Binary {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Binary {
    /// Appends bytes as a buffer view; gives its index.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let start = self.bytes.len().next_multiple_of(4);
        self.bytes.resize(start, 0);
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": bytes.len()});
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
    pub(super) fn mesh(&mut self, mesh: &Mesh) -> Value {
        let position = self.floats(mesh.positions.iter().map(Vec3::to_array));
        let mut attributes = json!({ "POSITION": position });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = json!(self.floats(mesh.normals.iter().map(Vec3::to_array)));
        }
        if !mesh.uvs.is_empty() {
            attributes["TEXCOORD_0"] = json!(self.floats(mesh.uvs.iter().map(Vec2::to_array)));
        }
        let mut groups: Vec<(u32, Vec<u8>)> = Vec::new();
        let mut group_of = HashMap::new();
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

/// An image as a PNG file.
pub(super) fn png(image: &Image) -> Result<Vec<u8>, String> {
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
pub(super) fn save(
    scene: &Scene,
    path: &Path,
    json: &[u8],
    binary: &[u8],
) -> Result<(), SceneError> {
    let chunk = |bytes: &[u8]| 8 + bytes.len().next_multiple_of(4);
    let length = 12 + chunk(json) + if binary.is_empty() { 0 } else { chunk(binary) };
    let Ok(length) = u32::try_from(length) else {
        let what = "it exceeds the 4 GiB of a GLB container".to_owned();
        return Err(scene.invalid("scene".to_owned(), what));
    };
    let container = Glb {
        header: Header {
            magic: *b"glTF",
            version: 2,
            length,
        },
        json: json.into(),
        bin: (!binary.is_empty()).then_some(Cow::Borrowed(binary)),
    };
    let fill = |file: &mut std::fs::File| {
        container.to_writer(file).map_err(|error| match error {
            gltf::Error::Io(error) => error,
            other => std::io::Error::other(other),
        })
    };
    super::whole(path, fill).map_err(SceneError::io(path))
}
