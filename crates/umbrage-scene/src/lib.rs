//! Scene files and generated worlds as plain data.
//!
//! [`open`] takes a path (`.glb`, `.gltf`, `.obj`) or `gen:NAME?key=value&...` and gives a
//! [`Scene`]; [`Scene::soup`] flattens it into one triangle soup; [`write::glb`] writes it back.
//! This crate knows nothing of shadows, BVHs or GPUs.
//!
//! Input is not trusted: a broken file gives a [`SceneError`] that names the item at fault, never
//! a panic, and memory stays bounded by the real size of the file, not by what it claims.
//! Oddities that do no harm are repaired or skipped, and counted in [`Scene::report`].
//!
//! ```
//! let scene = umbrage_scene::open("gen:field?n=8&lights=2", &()).unwrap();
//! let soup = scene.soup().unwrap();
//! assert_eq!((soup.triangles.len(), scene.lights.len()), (128, 2));
//! ```
#![forbid(unsafe_code)]

mod budget;
mod check;
mod error;
mod generate;
mod gltf;
mod image;
mod obj;
mod progress;
mod report;
pub mod rig;
mod scene;
mod soup;
mod source;
mod uri;
pub mod write;

use std::path::Path;

pub use error::SceneError;
pub use progress::Progress;
pub use report::LoadReport;
pub use scene::{AlphaMode, Camera, Image, Instance, Light, LightKind, Material, Mesh, Scene};
pub use soup::{MAX_ROUNDING_M, MAX_TRIANGLES, Soup};

/// Loads a `.glb`, `.gltf` or `.obj` file, chosen by its extension.
///
/// # Errors
/// An unknown extension, or whatever the file's format makes impossible to read.
pub fn load(path: &Path, progress: &dyn Progress) -> Result<Scene, SceneError> {
    match Format::of(path)? {
        Format::Gltf => gltf::load(path, progress),
        Format::Obj => obj::load(path, progress),
    }
}

/// What a file's extension says it is.
enum Format {
    Gltf,
    Obj,
}

impl Format {
    fn of(path: &Path) -> Result<Self, SceneError> {
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "obj" => Ok(Self::Obj),
            _ => Err(SceneError::UnknownFormat {
                path: path.to_owned(),
            }),
        }
    }
}

/// Opens what a person names: a path as [`load`] takes it, or `gen:NAME?key=value&...`.
///
/// Generators: `gen:city?triangles=100000&lights=256&seed=1&moon=0`,
/// `gen:soup?triangles=2000&lights=8&seed=1`, `gen:field?n=512&lights=64&seed=1`.
///
/// # Errors
/// As [`load`]; for a generator, an unknown name, key or value, with the valid ones listed.
pub fn open(spec: &str, progress: &dyn Progress) -> Result<Scene, SceneError> {
    match spec.strip_prefix("gen:") {
        Some(generator) => generate::generate(generator, progress),
        None => load(Path::new(spec), progress),
    }
}

/// Whether [`open`] would find what a person names: the file is there and may be read, or the
/// generator knows all that is asked. Nothing is loaded, so a broken file passes.
///
/// # Errors
/// As [`open`], as far as that shows.
pub fn find(spec: &str) -> Result<(), SceneError> {
    if let Some(generator) = spec.strip_prefix("gen:") {
        return generate::check(generator);
    }
    let path = Path::new(spec);
    Format::of(path)?;
    let file = std::fs::File::open(path).map_err(SceneError::io(path))?;
    match file.metadata().map_err(SceneError::io(path))?.is_file() {
        true => Ok(()),
        false => Err(SceneError::NotAFile {
            path: path.to_owned(),
        }),
    }
}
