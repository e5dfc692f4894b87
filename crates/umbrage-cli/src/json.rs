//! Machine-readable results: one JSON document to a file or to standard output.
//!
//! A file appears whole or not at all: it is written beside its place and then renamed.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::CliError;

/// Writes `value` to `path`, or to standard output for `-`.
pub(crate) fn write(path: &Path, value: &impl Serialize) -> Result<(), CliError> {
    let mut text = serde_json::to_string_pretty(value).map_err(|e| CliError::file(path, e))?;
    text.push('\n');
    if is_stdout(path) {
        print(&text);
        return Ok(());
    }
    write_whole(path, text.as_bytes())
}

/// Writes `bytes` beside `path`, then renames.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    let beside = beside(path)?;
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path));
    written.map_err(|error| {
        // Nothing to do if there is no file to remove; the first error is the one to tell.
        let _ = std::fs::remove_file(&beside);
        CliError::file(path, format!("cannot be written: {error}"))
    })
}

/// A name in the folder of `path` that no other run of this program uses.
pub(crate) fn beside(path: &Path) -> Result<PathBuf, CliError> {
    let Some(name) = path.file_name() else {
        return Err(CliError::file(path, "is a folder, not a file name"));
    };
    let mut name = name.to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    Ok(path.with_file_name(name))
}

/// Whether `path` stands for standard output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Prints text to standard output; a reader that has gone away (`| head`) is no failure.
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        eprintln!("umbrage: standard output: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let folder = std::env::temp_dir().join(format!("umbrage-json-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("out.json");
        std::fs::write(&path, "a much longer text that was there before").unwrap();
        write(&path, &[1, 2]).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "[\n  1,\n  2\n]\n");
        assert_eq!(folder.read_dir().unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn an_impossible_place_is_bad_input_and_names_the_path() {
        let error = write(Path::new("/no/such/folder/x.json"), &0).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(
            error.to_string().contains("/no/such/folder/x.json"),
            "{error}"
        );
    }
}
