//! The files of a profile: each appears whole or not at all.

use std::io::{self, Write as _};
use std::path::Path;

use umbrage_scene::write::whole;

use super::{ProfileReport, html, trace};

/// Names of the files.
pub const FILES: [&str; 3] = ["profile.json", "trace.json", "index.html"];

/// Writes all [`FILES`] to `dir`, which is made if it is not there.
///
/// # Errors
/// What the system says, with the path at fault.
pub fn write(dir: &Path, report: &ProfileReport) -> io::Result<()> {
    let at = |path: &Path, error: io::Error| {
        io::Error::new(error.kind(), format!("{}: {error}", path.display()))
    };
    std::fs::create_dir_all(dir).map_err(|error| at(dir, error))?;
    let json = serde_json::to_string_pretty(report)? + "\n";
    let trace = serde_json::to_string(&trace(report))? + "\n";
    for (name, text) in FILES.into_iter().zip([json, trace, html(report)]) {
        let path = dir.join(name);
        whole(&path, |file| file.write_all(text.as_bytes())).map_err(|error| at(&path, error))?;
    }
    Ok(())
}
