//! Machine-readable results: one JSON document to a file or to standard output.
//!
//! A file appears whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::Path;

use serde::Serialize;
use umbrage_scene::write::whole;

use crate::error::CliError;

/// Writes `value` to `path`, or to standard output for `-`.
pub(crate) fn write(path: &Path, value: &impl Serialize) -> Result<(), CliError> {
    let mut text = serde_json::to_string_pretty(value).map_err(|e| CliError::file(path, e))?;
    text.push('\n');
    if is_stdout(path) {
        print(&text);
        return Ok(());
    }
    whole(path, |file| file.write_all(text.as_bytes())).map_err(|error| {
        CliError::file(
            path,
            format!("cannot be written: {error}; is the folder there and writable?"),
        )
    })
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
    fn an_impossible_place_is_bad_input_and_names_the_path() {
        let error = write(Path::new("/no/such/folder/x.json"), &0).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(
            error.to_string().contains("/no/such/folder/x.json"),
            "{error}"
        );
    }
}
