//! Each method over all views.
//!
//! Takes the rows; gives one summary a method. Ratios to `none` are averaged geometrically, so
//! that twice as slow here and twice as fast there cancel; errors are summed, never averaged.

use super::BenchReport;

/// One method over the views in which it has figures.
#[derive(Clone, Debug, PartialEq)]
pub struct OverAll {
    /// Its name.
    pub method: String,
    /// Whether it promises that nothing is wrong.
    pub exact: bool,
    /// Geometric mean of `times_none`; null where that is not known for any view.
    pub times_none: Option<f64>,
    /// Smallest and largest `times_none`.
    pub span: Option<(f64, f64)>,
    /// Sum of `wrong_ppm`; null where the oracle judged no view.
    pub wrong_ppm: Option<f64>,
    /// Sum of `wrong`.
    pub wrong: Option<u64>,
    /// Views in which it has a frame time.
    pub views: usize,
    /// Of those, views in which the oracle judged it.
    pub judged: usize,
}

impl OverAll {
    /// Whether it has a time in each of `views` views, was judged in all, and nothing was wrong.
    pub(super) fn is_faultless_in(&self, views: usize) -> bool {
        self.wrong == Some(0) && self.views == views && self.judged == views
    }
}

/// Summaries, in order of first use.
pub fn over_all(report: &BenchReport) -> Vec<OverAll> {
    let of = |method: &str| {
        let rows = || report.rows.iter().filter(|row| row.method == method);
        let ratios: Vec<f64> = rows().filter_map(|row| row.times_none).collect();
        let logs: f64 = ratios.iter().map(|ratio| ratio.ln()).sum();
        let least = ratios.iter().copied().reduce(f64::min);
        OverAll {
            method: method.to_owned(),
            exact: rows().any(|row| row.exact),
            times_none: least.map(|_| (logs / ratios.len() as f64).exp()),
            span: least.zip(ratios.iter().copied().reduce(f64::max)),
            wrong_ppm: rows().filter_map(|row| row.wrong_ppm).reduce(|a, b| a + b),
            wrong: rows().filter_map(|row| row.wrong).reduce(|a, b| a + b),
            views: rows().filter(|row| row.frame_ms.is_some()).count(),
            judged: rows()
                .filter(|row| row.frame_ms.is_some() && row.wrong.is_some())
                .count(),
        }
    };
    report.methods().into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BenchRow;

    #[test]
    fn ratios_are_averaged_geometrically_and_errors_summed() {
        let mut report = BenchReport::default();
        for (scene, floor, ms, wrong) in [("a", 1.0, 2.0, 5), ("b", 10.0, 80.0, 7)] {
            for (method, ms) in [("none", floor), ("half", ms)] {
                let mut row = BenchRow::new(method, (scene, "auto", [8, 8]));
                row.set_frame_times(&[ms]);
                if method == "half" {
                    row.set_errors(wrong, 0, 1_000_000);
                }
                report.push(row);
            }
        }
        let all = over_all(&report);
        let half = all.iter().find(|one| one.method == "half").unwrap();
        assert!((half.times_none.unwrap() - 4.0).abs() < 1e-9);
        assert_eq!(half.span, Some((2.0, 8.0)));
        assert_eq!((half.wrong, half.wrong_ppm), (Some(12), Some(12.0)));
        let floor = all.iter().find(|one| one.method == "none").unwrap();
        assert_eq!((floor.wrong, floor.views), (None, 2));
        assert_eq!((half.judged, floor.judged), (2, 0));
    }

    #[test]
    fn a_view_without_a_verdict_is_not_without_fault() {
        let mut report = BenchReport::default();
        for scene in ["a", "b"] {
            let mut row = BenchRow::new("counter", (scene, "auto", [8, 8]));
            row.set_frame_times(&[1.0]);
            row.set_errors(0, 0, 64);
            report.push(row);
        }
        assert!(over_all(&report)[0].is_faultless_in(2));
        report.rows[1].wrong = None;
        assert!(!over_all(&report)[0].is_faultless_in(2));
    }
}
