//! Where a browser may be. Shared with `cargo xtask test`, which installs one if none is found.

use std::path::PathBuf;

/// Chromium or a browser built on it: named in `CHROMIUM`, on the path, or where macOS has it.
pub(crate) fn find() -> Option<PathBuf> {
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
        "microsoft-edge",
    ];
    let path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&path)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .map(|path| path.with_extension(std::env::consts::EXE_EXTENSION));
    let elsewhere = [
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
        "/Applications/Chromium.app/Contents/MacOS/Chromium",
    ];
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    named
        .into_iter()
        .chain(on_path)
        .chain(elsewhere.map(PathBuf::from))
        .find(|path| path.is_file())
}
