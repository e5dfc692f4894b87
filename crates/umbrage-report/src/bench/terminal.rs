//! The report for a terminal: a table a view, methods by growing time.

use std::cmp::Ordering;

use super::{BenchReport, BenchRow, View};
use crate::figure::{count_or_dash, figure_or_dash};
use crate::{Table, grouped};

/// Tables of all views; why a method failed, or what else should be known, is in the last column.
pub fn terminal(report: &BenchReport) -> String {
    let mut text = String::new();
    for view in &report.views {
        text += &format!("{}\n{}\n", heading(view), table(report, view));
    }
    if report.rows.is_empty() {
        text += "No rows.\n";
    }
    if !report.complete {
        text += "Not complete: the run ended early.\n";
    }
    text
}

fn heading(view: &View) -> String {
    let [width, height] = view.size;
    let (lights, triangles) = (grouped(view.lights), grouped(view.triangles));
    let View { scene, camera, .. } = view;
    format!("{scene}, {lights} lights, {triangles} triangles, camera {camera}, {width}x{height}")
}

fn table(report: &BenchReport, view: &View) -> Table {
    let mut rows: Vec<&BenchRow> = report.rows_of(view).collect();
    rows.sort_by(|a, b| by_time(a, b));
    let mut table = Table::default();
    table.row([
        "method",
        "frame ms",
        "x none",
        "volumes ms",
        "first ms",
        "gpu ms",
        "wrong",
        "ppm",
        "ambiguous",
        "",
    ]);
    for row in rows {
        let times = row.times_none.map(|times| format!("{times:.2} x"));
        table.row([
            row.method.clone(),
            figure_or_dash(row.frame_ms),
            times.unwrap_or_default(),
            figure_or_dash(row.build_ms),
            figure_or_dash(row.first_frame_ms),
            figure_or_dash(row.gpu_ms),
            count_or_dash(row.wrong),
            figure_or_dash(row.wrong_ppm),
            count_or_dash(row.ambiguous),
            remark(row),
        ]);
    }
    table
}

/// Longer remarks are cut; files have them whole.
const LONGEST_REMARK: usize = 64;

fn remark(row: &BenchRow) -> String {
    let text = match &row.failed {
        Some(why) => format!("failed: {why}"),
        None if row.breaks_promise() && row.note.is_empty() => "must be 0".to_owned(),
        None if row.breaks_promise() => format!("must be 0; {}", row.note),
        None => row.note.clone(),
    };
    let line: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(LONGEST_REMARK) {
        Some((end, _)) => format!("{}\u{2026}", &line[..end]),
        None => line,
    }
}

/// By growing frame time; what has none comes last.
pub(super) fn by_time(a: &BenchRow, b: &BenchRow) -> Ordering {
    match (a.frame_ms, b.frame_ms) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (a, b) => b.is_some().cmp(&a.is_some()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_by_time_and_the_failed_one_last_with_its_reason() {
        let view = ("a.glb", "auto", [64, 48]);
        let mut report = BenchReport::default();
        for (method, ms, wrong) in [("slow", 9.0, 1_234), ("none", 2.0, 99), ("fast", 3.0, 0)] {
            let mut row = BenchRow::new(method, view);
            row.set_frame_times(&[ms]);
            row.set_errors(wrong, 0, 1_000_000);
            report.push(row);
        }
        let mut failed = BenchRow::new("raytrace", view);
        failed.failed = Some("no compute shaders".into());
        report.rows.insert(0, failed);
        let text = terminal(&report);
        let places = ["none", "fast", "slow", "raytrace"].map(|m| text.find(&format!("\n{m}")));
        assert!(places.is_sorted() && places[0].is_some(), "{text}");
        assert!(text.contains("4.50 x") && text.contains("1,234"), "{text}");
        assert!(text.contains("failed: no compute shaders"), "{text}");
        assert!(text.contains("Not complete"), "{text}");
    }

    #[test]
    fn an_exact_method_that_is_wrong_is_pointed_out() {
        let mut report = BenchReport::default();
        let mut row = BenchRow::new("counter", ("a.glb", "auto", [8, 8])).exact();
        row.set_frame_times(&[1.0]);
        row.set_errors(1, 0, 64);
        report.push(row);
        assert!(terminal(&report).contains("must be 0"));
        report.rows[0].set_errors(0, 0, 64);
        assert!(!terminal(&report).contains("must be 0"));
        report.rows[0].note = "maps: 84 of 471 lights cached".into();
        assert!(terminal(&report).contains("84 of 471 lights cached"));
        report.rows[0].note = "\u{e9}".repeat(200);
        let text = terminal(&report);
        assert!(text.contains('\u{2026}') && text.lines().all(|line| line.chars().count() < 160));
    }

    #[test]
    fn an_empty_report_says_so() {
        assert!(terminal(&BenchReport::default()).contains("No rows."));
    }
}
