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
//! | input | behaviour |
//! |---|---|
//! | not there, a folder, a device, empty, binary or UTF-16 where text is due | error; an empty `.obj` is a scene without triangles |
//! | positions NaN, infinite or beyond f32, also once placed in the world | error with mesh or instance, and vertex |
//! | an index out of range: vertex, accessor, buffer view, node, material, skin, joint | error with who refers to what; OBJ: with the line |
//! | normals, texture coordinates, weights, images, animation channels that cannot be used | left out or repaired, counted |
//! | a node that is its own ancestor, or has two parents | error with the node; depth is not limited |
//! | an accessor, sparse or not, or buffer longer than its bytes | error before anything is allocated |
//! | geometry named, zero-filled or placed again and again | error beyond 512 MiB or 64 times the bytes read, soup included |
//! | an image larger than its bytes can hold, than 2^26 pixels, or than the scene may have left (2^26 pixels, or 64 a byte of image up to 2^28) | left out, counted |
//! | a file named again and again, in whatever spelling | read once (buffers, libraries) |
//! | an OBJ polygon of more than 256 corners | halved again and again, also where it is concave |
//! | no triangles, no lights | a scene |
//! | glTF lights with colour, intensity, range or cone out of bounds | clamped, counted: intensity below zero is zero, beyond f32 the largest, a range that is not above zero and finite is none |
//! | the same in a light file ([`light_file`]) | error with the light and the key |
//! | a transform that mirrors | the winding is reversed; the front stays the front |
//! | a transform without volume | kept: its triangles degenerate |
//! | a transform with NaN or infinity | error with the node |
//! | an unknown extension, if required | error with its name |
//!
//! What is no light or no place at the level of the world is stated in `umbrage-core` at
//! `Light::is_usable` and `World::MAX_COORDINATE`.
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
pub mod light_file;
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
pub use source::{Disk, Files};

/// Loads a `.glb`, `.gltf` or `.obj` file, chosen by its extension.
///
/// # Errors
/// An unknown extension, or whatever the file's format makes impossible to read.
pub fn load(path: &Path, progress: &dyn Progress) -> Result<Scene, SceneError> {
    load_from(path, &Disk, progress)
}

/// As [`load`], for files that lie elsewhere than on disk: in an archive, or in memory.
///
/// # Errors
/// As [`load`], and what `files` refuses.
pub fn load_from(
    path: &Path,
    files: &dyn Files,
    progress: &dyn Progress,
) -> Result<Scene, SceneError> {
    match Format::of(path)? {
        Format::Gltf => gltf::load(path, files, progress),
        Format::Obj => obj::load(path, files, progress),
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
