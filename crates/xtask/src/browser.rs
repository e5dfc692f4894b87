//! A browser for the tests of HTML reports: Chromium, headless.
//!
//! Without one those tests are skipped, each saying so, and everything else still holds; so a
//! browser that cannot be installed stops nothing. On Linux it brings SwiftShader, a Vulkan driver
//! other than Mesa's: the second that masks are compared on.

use std::path::{Path, PathBuf};

#[path = "../../umbrage-report/tests/browser/find.rs"]
mod places;

use crate::apt::Apt;
use places::find;

/// What to do where none can be installed for the user.
const ADVICE: &str = "\
No Chromium here: the tests that open an HTML report in a browser will be skipped.
  Debian           apt-get install chromium
  Fedora, Arch     dnf install chromium, pacman -S chromium
  elsewhere        Chrome, Chromium or Edge on the PATH, or its path in CHROMIUM";

/// Installs Chromium unless a browser of its kind is there; prints what to do otherwise.
pub(crate) fn ensure() {
    if find().is_some() {
        return;
    }
    if let Some(apt) = Apt::here() {
        println!("No Chromium here: installing it through apt.");
        if apt.install(&["chromium"]) && find().is_some() {
            println!("Installed chromium.");
            return;
        }
    }
    eprintln!("{ADVICE}");
}

/// The manifest of the browser's Vulkan driver: beside the browser, or where systems put what a
/// script on the path starts.
pub(crate) fn vulkan_driver() -> Option<PathBuf> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let browser = find().and_then(|path| path.canonicalize().ok());
    let beside = browser.as_deref().and_then(Path::parent);
    let elsewhere = [
        "/usr/lib/chromium",
        "/usr/lib64/chromium-browser",
        "/usr/lib/chromium-browser",
        "/opt/google/chrome",
        "/opt/microsoft/msedge",
    ];
    beside
        .into_iter()
        .chain(elsewhere.map(Path::new))
        .find(|folder| folder.join("libvk_swiftshader.so").is_file())
        .map(|folder| folder.join("vk_swiftshader_icd.json"))
        .filter(|manifest| manifest.is_file())
}
