//! Which differences count as worse, and which do not.

use super::*;

fn compare(baseline: &BenchReport, now: &BenchReport, ratio: f64) -> Comparison {
    super::compare(baseline, now, ratio).expect("the same settings")
}

/// (method, exact, ms, wrong), over a floor of `floor_ms`.
fn run(floor_ms: f64, rows: &[(&str, bool, f64, u64)]) -> BenchReport {
    let mut report = BenchReport {
        oracle: true,
        ..BenchReport::default()
    };
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
    // As the oracle's step fails it: the time is there.
    now.rows[0].failed = Some("out of memory".into());
    let fails = compare(&before, &now, 1.1);
    assert_eq!(regressions(&fails), [("counter", &[Regression::Fails][..])]);
    assert_eq!(
        fails.summary(),
        "1 row worse than the baseline: counter in a.glb, camera auto, 64x48 (FAILS)"
    );
    assert!(!compare(&now, &now, 1.1).is_worse(), "it failed before");
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
    now.oracle = false;
    let text = compare(&before, &now, 1.1).to_string();
    assert!(text.contains("Errors were not compared"), "{text}");
}

#[test]
fn an_exact_row_must_stay_judged_unless_none_was_asked_for() {
    let before = run(2.0, &[("counter", true, 6.0, 0)]);
    let mut now = before.clone();
    now.rows[0].wrong = None;
    assert_eq!(
        regressions(&compare(&before, &now, 1.1)),
        [("counter", &[Regression::NotJudged][..])]
    );
    now.oracle = false;
    assert!(!compare(&before, &now, 1.1).is_worse());
}

#[test]
fn what_slows_the_floor_too_shows_on_the_same_machine_only() {
    let on = |cpu: &str, floor_ms: f64| {
        let mut report = run(floor_ms, &[("counter", true, 2.0 * floor_ms, 0)]);
        report.machine.cpu = cpu.into();
        report.machine.adapter = "Graphics".into();
        report
    };
    let slower = compare(&on("A", 3.0), &on("A", 9.0), 1.2);
    assert_eq!(regressions(&slower), [("none", &[Regression::Slower][..])]);
    assert!(!compare(&on("A", 3.0), &on("B", 9.0), 1.2).is_worse());
    // Twice the excess: 1.4.
    assert!(!compare(&on("A", 3.0), &on("A", 4.1), 1.2).is_worse());
    assert!(compare(&on("A", 3.0), &on("A", 4.3), 1.2).is_worse());
}

#[test]
fn other_lights_or_triangles_are_another_workload() {
    let lit = |lights, triangles, ms| {
        let mut report = run(2.0, &[("half", false, ms, 9)]);
        (report.rows[0].lights, report.rows[0].triangles) = (lights, triangles);
        report
    };
    let before = lit(8, 100, 4.0);
    for now in [lit(9, 100, 4.0), lit(8, 50, 40.0)] {
        let other = compare(&before, &now, 1.1);
        assert_eq!(
            regressions(&other),
            [("half", &[Regression::OtherWorkload][..])]
        );
        assert!(other.to_string().contains("OTHER WORKLOAD"), "{other}");
    }
    assert!(!compare(&lit(0, 0, 4.0), &before, 1.1).is_worse());
}

#[test]
fn other_settings_are_refused_and_unknown_ones_are_not() {
    let with = |settings: &str| {
        let mut report = run(2.0, &[]);
        report.settings = settings.into();
        report
    };
    let error = super::compare(&with("casters=front"), &with("casters=both"), 1.1).unwrap_err();
    assert!(error.to_string().contains("casters=front"), "{error}");
    assert!(super::compare(&with("casters=front"), &with("casters=front"), 1.1).is_ok());
    assert!(super::compare(&with(""), &with("casters=both"), 1.1).is_ok());
}
