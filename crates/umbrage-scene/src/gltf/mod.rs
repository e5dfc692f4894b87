//! glTF 2.0 files, text or binary.
//!
//! Takes a path; gives a [`Scene`] of the default scene's nodes. The stages are rooms: container
//! -> root -> buffers -> materials and meshes -> nodes -> rig. The `gltf` package reads container and
//! JSON. Its wrapper types panic on a reference that leads nowhere, so what follows works on the
//! plain JSON types and resolves every reference with a check.
//!
//! Source: glTF 2.0 specification, <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.

mod accessor;
mod buffers;
mod clips;
mod container;
mod lights;
mod material;
mod mesh;
mod nodes;
mod rigging;
mod root;
mod skins;
mod weights;

use std::path::{Path, PathBuf};

use gltf::json::Root;

use crate::{Files, LoadReport, Progress, Scene, SceneError, source};

/// What every stage of one load reads, and where it counts.
struct Context<'a> {
    path: PathBuf,
    files: &'a dyn Files,
    root: &'a Root,
    buffers: buffers::Buffers,
    budget: crate::budget::Budget,
}

/// Loads a `.gltf` or `.glb` file; which of the two is decided by its first bytes.
pub(crate) fn load(
    path: &Path,
    files: &dyn Files,
    progress: &dyn Progress,
) -> Result<Scene, SceneError> {
    let bytes = files.read(path)?;
    let mut report = LoadReport::default();
    let parts = container::split(&bytes, path, &mut report)?;
    let root = root::parse(&parts.json, path, &mut report)?;

    let buffers = buffers::load(&root, parts.binary.as_deref(), path, files)?;
    let budget = crate::budget::Budget::new(bytes.len() as u64 + buffers.bytes_read());
    let mut context = Context {
        path: path.to_owned(),
        files,
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
    let tree = nodes::load(&context, &mut scene, progress)?;
    context.budget.take_flattened(&scene, path)?;
    rigging::load(&mut context, &mut scene, tree, progress)?;
    Ok(scene)
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
