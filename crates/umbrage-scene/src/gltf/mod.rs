//! glTF 2.0 files, text or binary.
//!
//! Takes a path; gives a [`Scene`] of the default scene's nodes. The stages are rooms: container
//! -> schema -> buffers -> materials and meshes -> nodes. The schema is our own, since node
//! transforms and light positions are kept in f64 here, which `gltf-json` rounds to f32, and since
//! every reference is resolved with a check.
//!
//! Source: glTF 2.0 specification, <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.

mod accessor;

mod buffers;
mod container;
mod lights;
mod material;
mod mesh;
mod nodes;
mod schema;

use std::path::{Path, PathBuf};

use crate::{LoadReport, Progress, Scene, SceneError, source};
use schema::Root;

/// What every stage of one load reads, and where it counts.
struct Context<'a> {
    path: PathBuf,
    root: &'a Root,
    buffers: buffers::Buffers,
    budget: crate::budget::Budget,
}

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

/// Loads a `.gltf` or `.glb` file; which of the two is decided by its first bytes.
pub(crate) fn load(path: &Path, progress: &dyn Progress) -> Result<Scene, SceneError> {
    let bytes = source::read(path)?;
    let mut report = LoadReport::default();
    let parts = container::split(&bytes, path, &mut report)?;
    let root = parse(parts.json, path)?;

    let buffers = buffers::load(&root, parts.binary, path)?;
    let budget = crate::budget::Budget::new(bytes.len() as u64 + buffers.bytes_read());
    let mut context = Context {
        path: path.to_owned(),
        root: &root,
        buffers,
        budget,
    };

    let mut scene = Scene {
        name: source::stem(path),
        report,
        ..Scene::default()
    };
    material::load(&mut context, &mut scene, progress)?;
    mesh::load(&mut context, &mut scene, progress)?;
    nodes::load(&context, &mut scene, progress)?;
    Ok(scene)
}

/// The schema of a file that can be loaded: version 2, no unknown required extension.
fn parse(json: &[u8], path: &Path) -> Result<Root, SceneError> {
    let root: Root = serde_json::from_slice(json).map_err(|source| SceneError::Json {
        path: path.to_owned(),
        source,
    })?;
    if !root.asset.version.starts_with("2.") && root.asset.version != "2" {
        let version = root.asset.version.clone();
        return Err(SceneError::Version {
            path: path.to_owned(),
            version,
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

impl Context<'_> {
    /// `items[index]`, or the error that `from` refers to a `kind` that does not exist.
    fn resolve<'t, T>(
        &self,
        items: &'t [T],
        index: usize,
        kind: &'static str,
        from: impl FnOnce() -> String,
    ) -> Result<&'t T, SceneError> {
        items.get(index).ok_or_else(|| SceneError::Dangling {
            path: self.path.clone(),
            from: from(),
            kind,
            index: index as u64,
            len: items.len() as u64,
        })
    }
}

/// The item's own name, or `kind_index`.
fn name_or(name: &Option<String>, kind: &str, index: usize) -> String {
    match name {
        Some(name) if !name.is_empty() => name.clone(),
        _ => format!("{kind}_{index}"),
    }
}
