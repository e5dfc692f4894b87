//! Whether this machine has a graphics driver that wgpu can use, and how to get one.
//!
//! On Linux that is the Vulkan loader and at least one driver manifest whose library exists.
//! Mesa's lavapipe runs on any CPU, so a machine without a GPU can have one too.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Stop;
use crate::apt::Apt;

/// What to do where no driver can be installed for the user.
pub(crate) const ADVICE: &str = "\
No usable graphics adapter. Umbrage draws through Vulkan, Metal or Direct3D 12:
  Debian, Ubuntu   apt-get install libvulkan1 mesa-vulkan-drivers
  Fedora           dnf install vulkan-loader mesa-vulkan-drivers
  Arch             pacman -S vulkan-icd-loader vulkan-swrast
  macOS            nothing to install: Metal is there
  Windows          nothing to install: Direct3D 12 is there (WARP without a GPU)
Mesa's packages bring lavapipe, which needs no GPU. Then run the task again.";

/// Installs a software driver unless a driver is already there.
pub(crate) fn ensure() -> Result<(), Stop> {
    if !cfg!(target_os = "linux") || is_present() {
        Ok(())
    } else {
        install()
    }
}

/// Installs Mesa's Vulkan drivers through apt, or prints what to do.
pub(crate) fn install() -> Result<(), Stop> {
    let Some(apt) = Apt::here() else {
        eprintln!("{ADVICE}");
        return Err(Stop::NoDriver);
    };
    println!("No Vulkan driver here: installing Mesa's software driver (lavapipe) through apt.");
    let packages = ["libvulkan1", "mesa-vulkan-drivers"];
    if apt.install(&packages) && is_present() {
        println!("Installed {}.", packages.join(" and "));
        return Ok(());
    }
    eprintln!("The driver could not be installed; apt's messages above say why.\n{ADVICE}");
    Err(Stop::NoDriver)
}

/// Whether the loader and a driver behind it are installed.
fn is_present() -> bool {
    let libraries = known_libraries();
    let loader = libraries.contains("libvulkan.so.1");
    loader
        && manifests()
            .iter()
            .any(|manifest| has_library(manifest, &libraries))
}

/// What the dynamic linker knows, one library a line.
fn known_libraries() -> String {
    ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"]
        .iter()
        .find_map(|program| Command::new(program).arg("-p").output().ok())
        .map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
        .unwrap_or_default()
}

/// Driver manifests (`*.json`) in the places where the Vulkan loader looks.
fn manifests() -> Vec<PathBuf> {
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(named) = std::env::var_os(name).filter(|value| !value.is_empty()) {
            return std::env::split_paths(&named).collect();
        }
    }
    let mut roots: Vec<PathBuf> = ["/etc", "/usr/local/share", "/usr/share"]
        .iter()
        .map(PathBuf::from)
        .collect();
    for name in ["XDG_DATA_DIRS", "XDG_DATA_HOME"] {
        roots.extend(
            std::env::var_os(name)
                .iter()
                .flat_map(std::env::split_paths),
        );
    }
    roots.extend(std::env::var_os("HOME").map(|home| Path::new(&home).join(".local/share")));
    let folders = roots
        .iter()
        .filter_map(|root| root.join("vulkan/icd.d").read_dir().ok());
    let files = folders
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()));
    files
        .filter(|path| path.extension() == Some(OsStr::new("json")))
        .collect()
}

/// Whether the library that a manifest names can be loaded.
fn has_library(manifest: &Path, libraries: &str) -> bool {
    let text = std::fs::read_to_string(manifest).unwrap_or_default();
    let Some(library) = library_path(&text) else {
        return false;
    };
    if library.contains('/') {
        manifest
            .parent()
            .is_some_and(|folder| folder.join(library).exists())
    } else {
        libraries.contains(library)
    }
}

/// The value of `"library_path"` in a driver manifest.
fn library_path(manifest: &str) -> Option<&str> {
    let (_, rest) = manifest.split_once("\"library_path\"")?;
    rest.split('"').nth(1).filter(|path| !path.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn manifest_names_its_library() {
        let text = r#"{ "ICD": { "api_version": "1.4", "library_path" : "libvulkan_lvp.so" } }"#;
        assert_eq!(library_path(text), Some("libvulkan_lvp.so"));
        assert_eq!(library_path("{}"), None);
    }
}
