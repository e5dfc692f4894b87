//! The files of a report.
//!
//! Takes a report, complete or not; gives `report.json`, `report.csv` and `index.html` in a
//! folder. Each appears whole or not at all, so a run may write after every row.

use std::io::{self, Write as _};
use std::path::Path;

use umbrage_scene::write::whole;

use super::{BenchReport, csv, html};

/// Names of the files.
pub const FILES: [&str; 3] = ["report.json", "report.csv", "index.html"];

/// Writes all [`FILES`] to `dir`, which is made if it is not there.
///
/// # Errors
/// What the system says, with the path at fault.
pub fn write(dir: &Path, report: &BenchReport) -> io::Result<()> {
    let at = |path: &Path, error: io::Error| {
        io::Error::new(error.kind(), format!("{}: {error}", path.display()))
    };
    std::fs::create_dir_all(dir).map_err(|error| at(dir, error))?;
    let mut json = serde_json::to_string_pretty(report)?;
    json.push('\n');
    for (name, text) in FILES.into_iter().zip([json, csv(report), html(report)]) {
        let path = dir.join(name);
        whole(&path, |file| file.write_all(text.as_bytes())).map_err(|error| at(&path, error))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{BenchRow, read};

    #[test]
    fn what_is_written_reads_back_and_a_partial_report_is_one() {
        let dir = std::env::temp_dir().join(format!("umbrage-report-{}/deep", std::process::id()));
        let mut report = BenchReport::default();
        let mut row = BenchRow::new("counter", ("a \"b\" <c>.glb", "auto", [64, 48])).exact();
        row.set_frame_times(&[0.1 + 0.2]);
        report.push(row);
        write(&dir, &report).unwrap();
        let back = read(&dir.join("report.json")).unwrap();
        assert_eq!(back.rows[0].frame_ms, report.rows[0].frame_ms);
        assert_eq!(back.views, report.views);
        assert!(!back.complete && back.rows[0].exact);
        let mut names: Vec<_> = dir
            .read_dir()
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, ["index.html", "report.csv", "report.json"]);
        std::fs::remove_dir_all(dir.parent().unwrap()).unwrap();
    }

    #[test]
    fn the_path_at_fault_is_named() {
        let error = write(Path::new("/dev/null/x"), &BenchReport::default()).unwrap_err();
        assert!(error.to_string().contains("/dev/null/x"), "{error}");
    }
}
