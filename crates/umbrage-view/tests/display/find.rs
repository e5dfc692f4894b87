// Of the tests that open a window, and of the task that installs what they need.

use std::path::PathBuf;

/// An X server that draws into memory, where it is on the path.
pub(crate) fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|folder| folder.join("Xvfb"))
        .find(|file| file.is_file())
}
