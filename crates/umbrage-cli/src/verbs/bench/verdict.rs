//! What a finished run proves, for the exit code: rows that failed, promises that were broken, and
//! what the baseline did better.

use umbrage_report::bench::{self, BenchReport, BenchRow};

use crate::args::BenchArgs;
use crate::error::CliError;
use crate::json;

/// Ends the run; `asked` is the number of rows that a whole one has.
pub(super) fn verdict(
    args: &BenchArgs,
    baseline: Option<&BenchReport>,
    report: &BenchReport,
    asked: usize,
) -> Result<(), CliError> {
    let mut faults = Vec::new();
    if !report.complete {
        let rows = report.rows.len();
        faults.push(format!("interrupted: {rows} of {asked} rows were measured"));
    }
    faults.extend(bad_rows(report));
    faults.extend(unjudged_rows(report));
    if let Some(baseline) = baseline.filter(|_| report.complete) {
        let found = bench::compare(baseline, report, args.ratio)?;
        if args.results.shows_tables() {
            json::print(&format!("\n{found}"));
        }
        if found.is_worse() {
            faults.push(found.summary());
        }
    }
    match faults.is_empty() {
        true => Ok(()),
        false => Err(CliError::CheckFailed(faults.join("; "))),
    }
}

/// How many rows failed, or are wrong where none may be, and the first of them.
fn bad_rows(report: &BenchReport) -> Option<String> {
    let is_bad = |row: &&BenchRow| row.failed.is_some() || row.breaks_promise();
    let first = report.rows.iter().find(is_bad)?;
    let why = match (&first.failed, first.wrong) {
        (Some(why), _) => why.clone(),
        (None, wrong) => format!("{} wrong", wrong.unwrap_or(0)),
    };
    let (bad, all) = (report.rows.iter().filter(is_bad).count(), report.rows.len());
    Some(format!(
        "{bad} of {all} rows failed, or are wrong where none may be; first {}: {why}",
        first.name()
    ))
}

/// How many rows the oracle was asked for and did not get to: Ctrl-C came in the last.
fn unjudged_rows(report: &BenchReport) -> Option<String> {
    let is_unjudged = |row: &&BenchRow| row.wrong.is_none() && row.failed.is_none();
    let rows = report.rows.iter().filter(is_unjudged).count();
    let first = report.rows.iter().find(is_unjudged)?;
    let were = if rows == 1 { "row was" } else { "rows were" };
    let text = format!("{rows} {were} not judged; first {}", first.name());
    report.oracle.then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_fails_or_breaks_its_promise_is_named() {
        let mut report = BenchReport::default();
        for method in ["none", "counter", "brute"] {
            let mut row = BenchRow::new(method, ("a.glb", "auto", [8, 8]));
            row.exact = method != "none";
            row.set_errors(u64::from(method == "none"), 0, 64);
            report.push(row);
        }
        assert_eq!(bad_rows(&report), None);
        report.oracle = true;
        assert_eq!(unjudged_rows(&report), None);
        report.rows[2].wrong = None;
        let message = unjudged_rows(&report).unwrap();
        assert_eq!(
            message,
            "1 row was not judged; first brute in a.glb, camera auto, 8x8"
        );
        report.oracle = false;
        assert_eq!(unjudged_rows(&report), None);
        report.rows[1].wrong = Some(3);
        let message = bad_rows(&report).unwrap();
        assert!(message.starts_with("1 of 3 rows"), "{message}");
        assert!(message.contains("counter in a.glb") && message.ends_with("3 wrong"));
        report.rows[0].failed = Some("out of memory".into());
        let message = bad_rows(&report).unwrap();
        assert!(message.starts_with("2 of 3 rows"), "{message}");
        assert!(message.contains("none in a.glb") && message.ends_with("out of memory"));
    }
}
