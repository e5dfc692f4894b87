//! Where the bytes of a scene, and of what lies beside it, come from.
//!
//! [`Disk`] reads whole files, bounded by what is really there: a path that is no regular file (a
//! device, a pipe) is refused, since it may never end.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::SceneError;

/// What a loader asks for bytes: the scene's own file first, then the buffers, images and libraries
/// that it names.
///
/// ```
/// # use std::path::Path;
/// # use umbrage_scene::{Files, SceneError};
/// struct Square;
///
/// impl Files for Square {
///     fn read(&self, _: &Path) -> Result<Vec<u8>, SceneError> {
///         Ok(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4".to_vec())
///     }
/// }
///
/// let scene = umbrage_scene::load_from(Path::new("square.obj"), &Square, &()).unwrap();
/// assert_eq!(scene.meshes[0].triangles.len(), 2);
/// ```
pub trait Files {
    /// All bytes of the file at `path`.
    ///
    /// # Errors
    /// If it is not there, or not a file.
    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError> {
        let metadata = std::fs::metadata(path).map_err(SceneError::io(path))?;
        if !metadata.is_file() {
            return Err(SceneError::NotAFile {
                path: path.to_owned(),
            });
        }
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(SceneError::io(path))?;
        file.take(metadata.len())
            .read_to_end(&mut bytes)
            .map_err(SceneError::io(path))?;
        Ok(bytes)
    }
}

/// File name without directories and extension; what a scene is called.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}
