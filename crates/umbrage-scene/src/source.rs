//! Reading whole files, bounded by what is really there.
//!
//! A path that is no regular file (a device, a pipe) is refused, since it may never end.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::SceneError;

/// All bytes of a regular file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
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

/// File name without directories and extension; what a scene is called.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}
