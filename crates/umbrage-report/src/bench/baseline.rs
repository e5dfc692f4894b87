//! An earlier report, read to be compared with.
//!
//! Takes a `report.json`; gives it back as data. What an older version did not yet write reads as
//! not measured.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::BenchReport;

/// Why a file is no baseline.
#[derive(Debug, Error)]
pub enum BaselineError {
    /// It cannot be read.
    #[error("{}: cannot be read: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is not JSON.
    #[error("{}: is not JSON: {error}; give the report.json that `umbrage bench -o DIR` wrote", path.display())]
    NotJson {
        /// The file.
        path: PathBuf,
        /// Line and column.
        error: serde_json::Error,
    },
    /// It is the JSON of something else, or of a version with other keys.
    #[error("{}: is no bench report: {error}; give the report.json that `umbrage bench -o DIR` wrote, or run the baseline again with this version", path.display())]
    OtherSchema {
        /// The file.
        path: PathBuf,
        /// The key at fault.
        error: serde_json::Error,
    },
    /// There is nothing to compare with.
    #[error("{}: has no rows to compare with; run the baseline again to its end", path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },
}

/// Reads the `report.json` of an earlier run.
///
/// # Errors
/// A file that is none, each kind with its remedy. All are bad input.
pub fn read(path: &Path) -> Result<BenchReport, BaselineError> {
    let path = path.to_owned();
    let text = match std::fs::read(&path) {
        Ok(text) => text,
        Err(error) => return Err(BaselineError::Unreadable { path, error }),
    };
    let json: serde_json::Value = match serde_json::from_slice(&text) {
        Ok(json) => json,
        Err(error) => return Err(BaselineError::NotJson { path, error }),
    };
    // A report without `rows` would read as one with none: every other key has a default.
    if json.get("rows").is_none() {
        let error = serde::de::Error::missing_field("rows");
        return Err(BaselineError::OtherSchema { path, error });
    }
    match serde_json::from_value::<BenchReport>(json) {
        Ok(report) if report.rows.is_empty() => Err(BaselineError::NoRows { path }),
        Ok(report) => Ok(report),
        Err(error) => Err(BaselineError::OtherSchema { path, error }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(name: &str, text: &str) -> Result<BenchReport, BaselineError> {
        let name = format!("umbrage-baseline-{}-{name}.json", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, text).unwrap();
        let result = read(&path);
        std::fs::remove_file(&path).unwrap();
        if let Err(error) = &result {
            assert!(
                error.to_string().contains(path.to_str().unwrap()),
                "{error}"
            );
        }
        result
    }

    #[test]
    fn each_fault_has_its_own_error_that_names_the_file() {
        let missing = read(Path::new("no/such/report.json")).unwrap_err();
        assert!(matches!(missing, BaselineError::Unreadable { .. }));
        let other = read_text("html", "<!doctype html>");
        assert!(matches!(other, Err(BaselineError::NotJson { .. })));
        let check = read_text("check", r#"{"scene": "a.glb", "wrong": 0}"#);
        assert!(matches!(check, Err(BaselineError::OtherSchema { .. })));
        let row = read_text("row", r#"{"rows": [{"method": "counter"}]}"#);
        let message = row.unwrap_err().to_string();
        assert!(message.contains("missing field `scene`"), "{message}");
        let list = read_text("list", r#"[1, 2]"#);
        assert!(matches!(list, Err(BaselineError::OtherSchema { .. })));
        let empty = read_text("empty", r#"{"rows": []}"#);
        assert!(matches!(empty, Err(BaselineError::NoRows { .. })));
    }

    #[test]
    fn the_fixed_keys_are_enough() {
        let row = r#"{"scene": "a.glb", "method": "counter", "size": [64, 48], "camera": "auto",
            "frame_ms": 2.5, "build_ms": 1, "gpu_ms": null, "wrong": 0, "ambiguous": 3,
            "samples": 3000, "wrong_ppm": 0.0}"#;
        let report = read_text("fixed", &format!(r#"{{"rows": [{row}]}}"#)).unwrap();
        assert_eq!(report.rows[0].frame_ms, Some(2.5));
        assert!(!report.rows[0].exact && report.rows[0].times_none.is_none());
    }
}
