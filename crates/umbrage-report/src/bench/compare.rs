//! Two runs side by side: what got slower, less exact, or was lost.
//!
//! Takes an earlier report, a later one, and the ratio beyond which a difference counts; gives
//! one [`Change`] for each row of either, matched by scene, method, size and camera. Machines
//! differ and are noisy, so times are compared as multiples of the floor of the same run
//! (`times_none`) where both have it, and the floor itself is shown but not judged then.
//! Invariant: an exact method with anything wrong is a regression, whatever the ratio and
//! whatever the baseline had.

mod table;

use super::{BenchReport, BenchRow};

/// What two times were compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Frame time as a multiple of `none`'s in the same run: machines drop out.
    TimesNone,
    /// Frame time in milliseconds: for one machine only.
    FrameMs,
}

/// In what a row is worse than it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regression {
    /// Time grew beyond the ratio.
    Slower,
    /// More is wrong, beyond the ratio.
    LessExact,
    /// A method that promises none has wrong ones.
    PromiseBroken,
    /// It had figures, and fails now.
    Fails,
    /// It was in the baseline, and is not in this run.
    Missing,
}

/// One row, before and now.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Of the row.
    pub scene: String,
    /// Of the row.
    pub method: String,
    /// Of the row.
    pub size: [u32; 2],
    /// Of the row.
    pub camera: String,
    /// How time was compared, before and now; null where either has none.
    pub time: Option<(Measure, f64, f64)>,
    /// Wrong pixel-lights before and now; null where the oracle was not asked.
    pub wrong: [Option<u64>; 2],
    /// Whether the baseline has no such row.
    pub new: bool,
    /// In what it is worse; empty for most.
    pub regressions: Vec<Regression>,
}

/// A later run against an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Beyond which more time, or more wrong ones, count as worse: 1.1 allows a tenth more.
    pub ratio: f64,
    /// Rows of the baseline in its order, then new ones.
    pub changes: Vec<Change>,
}

/// Compares `now` with `baseline`; see [`Comparison::ratio`].
pub fn compare(baseline: &BenchReport, now: &BenchReport, ratio: f64) -> Comparison {
    let find = |report: &BenchReport, wanted: &BenchRow| -> Option<BenchRow> {
        let mut rows = report.rows.iter();
        rows.find(|row| is_same(row, wanted)).cloned()
    };
    let old = baseline.rows.iter().map(|before| match find(now, before) {
        Some(row) => change(Some(before), &row, ratio),
        None => Change {
            wrong: [before.wrong, None],
            regressions: vec![Regression::Missing],
            ..change(None, before, ratio)
        },
    });
    let new = now.rows.iter().filter(|row| find(baseline, row).is_none());
    let new = new.map(|row| Change {
        new: true,
        ..change(None, row, ratio)
    });
    Comparison {
        ratio,
        changes: old.chain(new).collect(),
    }
}

impl Comparison {
    /// Whether any row is.
    pub fn is_worse(&self) -> bool {
        self.changes
            .iter()
            .any(|change| !change.regressions.is_empty())
    }
}

fn is_same(a: &BenchRow, b: &BenchRow) -> bool {
    (&a.scene, &a.method, a.size, &a.camera) == (&b.scene, &b.method, b.size, &b.camera)
}

fn change(before: Option<&BenchRow>, now: &BenchRow, ratio: f64) -> Change {
    let time = before.and_then(|before| time(before, now));
    let was = before.and_then(|before| before.wrong);
    let mut regressions = Vec::new();
    if time.is_some_and(|(_, before, now)| now > before * ratio) {
        regressions.push(Regression::Slower);
    }
    if now.exact && now.wrong.is_some_and(|wrong| wrong > 0) {
        regressions.push(Regression::PromiseBroken);
    } else if let (Some(was), Some(is)) = (was, now.wrong)
        && is as f64 > was as f64 * ratio
    {
        regressions.push(Regression::LessExact);
    }
    let had_figures = before.is_some_and(|before| before.frame_ms.is_some());
    if had_figures && now.frame_ms.is_none() {
        regressions.push(Regression::Fails);
    }
    Change {
        scene: now.scene.clone(),
        method: now.method.clone(),
        size: now.size,
        camera: now.camera.clone(),
        time,
        wrong: [was, now.wrong],
        new: false,
        regressions,
    }
}

/// By the floor of the same run where both have it. A floor is always once itself.
fn time(before: &BenchRow, now: &BenchRow) -> Option<(Measure, f64, f64)> {
    match (before.times_none, now.times_none) {
        (Some(before), Some(now)) => Some((Measure::TimesNone, before, now)),
        _ => Some((Measure::FrameMs, before.frame_ms?, now.frame_ms?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (method, exact, ms, wrong), over a floor of `floor_ms`.
    fn run(floor_ms: f64, rows: &[(&str, bool, f64, u64)]) -> BenchReport {
        let mut report = BenchReport::default();
        let floor = ("none", false, floor_ms, 500);
        for &(method, exact, ms, wrong) in rows.iter().chain([&floor]) {
            let mut row = BenchRow::new(method, ("a.glb", "auto", [64, 48]));
            row.exact = exact;
            row.set_frame_times(&[ms]);
            row.set_errors(wrong, 0, 1_000_000);
            report.push(row);
        }
        report
    }

    fn regressions(comparison: &Comparison) -> Vec<(&str, &[Regression])> {
        let worse = comparison
            .changes
            .iter()
            .filter(|one| !one.regressions.is_empty());
        worse.map(|one| (&*one.method, &*one.regressions)).collect()
    }

    #[test]
    fn a_machine_twice_as_slow_is_no_regression_but_a_method_is() {
        let before = run(2.0, &[("counter", true, 6.0, 0), ("half", false, 4.0, 90)]);
        let slow_machine = run(4.0, &[("counter", true, 12.0, 0), ("half", false, 8.0, 90)]);
        let same = compare(&before, &slow_machine, 1.1);
        assert!(!same.is_worse(), "{same}");
        assert_eq!(same.changes[0].time, Some((Measure::TimesNone, 3.0, 3.0)));
        let slower = compare(
            &before,
            &run(2.0, &[("counter", true, 7.0, 0), ("half", false, 4.0, 90)]),
            1.1,
        );
        assert_eq!(
            regressions(&slower),
            [("counter", &[Regression::Slower][..])]
        );
        assert!(slower.to_string().contains("SLOWER"), "{slower}");
        assert!(
            !compare(
                &before,
                &run(2.0, &[("counter", true, 6.5, 0), ("half", false, 4.0, 90)]),
                1.1
            )
            .is_worse()
        );
    }

    #[test]
    fn without_a_floor_milliseconds_are_compared() {
        let without = |ms| {
            let mut report = run(1.0, &[("counter", true, ms, 0)]);
            report.rows.retain(|row| !row.is_floor());
            report.rows[0].times_none = None;
            report
        };
        let comparison = compare(&without(6.0), &without(9.0), 1.1);
        assert_eq!(
            comparison.changes[0].time,
            Some((Measure::FrameMs, 6.0, 9.0))
        );
        assert!(comparison.is_worse());
    }

    #[test]
    fn a_broken_promise_is_worse_at_any_ratio_and_even_if_it_was_broken_before() {
        let broken = run(2.0, &[("counter", true, 6.0, 3)]);
        let comparison = compare(&broken, &broken, 1e9);
        assert_eq!(
            regressions(&comparison),
            [("counter", &[Regression::PromiseBroken][..])]
        );
    }

    #[test]
    fn an_inexact_method_may_be_wrong_within_the_ratio() {
        let with = |wrong| run(2.0, &[("half", false, 4.0, wrong)]);
        assert!(!compare(&with(100), &with(105), 1.1).is_worse());
        let worse = compare(&with(100), &with(111), 1.1);
        assert_eq!(
            regressions(&worse),
            [("half", &[Regression::LessExact][..])]
        );
        assert!(compare(&with(0), &with(1), 1.1).is_worse());
    }

    #[test]
    fn rows_that_went_missing_or_fail_are_worse_and_new_ones_are_not() {
        let before = run(2.0, &[("counter", true, 6.0, 0)]);
        let mut now = run(2.0, &[("counter", true, 6.0, 0), ("half", false, 4.0, 9)]);
        assert!(!compare(&before, &now, 1.1).is_worse());
        assert!(compare(&before, &now, 1.1).to_string().contains("new"));
        let lost = compare(&now, &before, 1.1);
        assert_eq!(regressions(&lost), [("half", &[Regression::Missing][..])]);
        now.rows[0].frame_ms = None;
        now.rows[0].times_none = None;
        let fails = compare(&before, &now, 1.1);
        assert_eq!(regressions(&fails), [("counter", &[Regression::Fails][..])]);
    }

    #[test]
    fn what_is_no_longer_judged_is_said() {
        let before = run(2.0, &[("half", false, 4.0, 9)]);
        let mut now = before.clone();
        now.rows[0].wrong = None;
        let comparison = compare(&before, &now, 1.1);
        assert!(
            comparison
                .to_string()
                .contains("1 rows that the baseline judged")
        );
        assert!(!comparison.is_worse());
    }
}
