//! The binary, run as scripts run it.
#![allow(dead_code)] // each test binary uses its own part

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

/// A folder of its own for each test, removed with it.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("umbrage-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }

    pub(crate) fn files(&self) -> Vec<String> {
        let entries = self.0.read_dir().expect("the folder is there");
        let mut names: Vec<String> = entries
            .map(|e| e.expect("an entry").file_name().to_string_lossy().into())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Left behind at worst: it is the system's temporary folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) fn umbrage(arguments: &[&str]) -> Output {
    let binary = env!("CARGO_BIN_EXE_umbrage");
    Command::new(binary)
        .args(arguments)
        .output()
        .expect("the binary starts")
}

/// Runs and gives what `--json -` printed.
pub(crate) fn json(code: i32, arguments: &[&str]) -> Value {
    let output = umbrage(&[arguments, &["--json", "-", "--quiet"]].concat());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {errors}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{arguments:?}: {e}"))
}

/// Refused: this code, a message, nothing on standard output, no panic.
pub(crate) fn refused(code: i32, arguments: &[&str]) -> String {
    let output = umbrage(arguments);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {errors}");
    assert!(
        !errors.trim().is_empty() && !errors.contains("panicked"),
        "{arguments:?}: {errors}"
    );
    assert!(output.stdout.is_empty(), "{arguments:?} printed results");
    errors
}

pub(crate) fn assert_keys(value: &Value, keys: &str) {
    let object = value
        .as_object()
        .unwrap_or_else(|| panic!("no object: {value}"));
    for key in keys.split(' ') {
        assert!(
            object.contains_key(key),
            "{key} missing in {:?}",
            object.keys()
        );
    }
}

/// Width and height of a PNG that decodes whole.
pub(crate) fn png_size(path: &str) -> (u32, u32) {
    let ([width, height], _) = png_rgb(path);
    (width, height)
}

/// Size and pixels of a picture in red, green and blue, which shows something.
pub(crate) fn png_rgb(path: &str) -> ([u32; 2], Vec<[u8; 3]>) {
    let bytes = std::fs::read(path).expect("a picture");
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("whole image data");
    assert_eq!(info.color_type, png::ColorType::Rgb, "{path}");
    assert!(
        pixels.iter().any(|&p| p != pixels[0]),
        "{path} shows nothing"
    );
    let rgb = pixels.chunks_exact(3).map(|p| [p[0], p[1], p[2]]);
    ([info.width, info.height], rgb.collect())
}
