//! What is marked, and which columns are left out.

use super::*;

fn report() -> BenchReport {
    let mut report = BenchReport::default();
    let view = ("a.glb", "auto", [64, 48]);
    for (method, ms, wrong) in [
        ("none", 1.0, 99),
        ("half", 2.0, 9),
        ("counter", 3.0, 0),
        ("brute", 4.0, 0),
    ] {
        let mut row = BenchRow::new(method, view);
        row.set_frame_times(&[ms]);
        row.set_errors(wrong, 0, 1000);
        report.push(row);
    }
    report
}

#[test]
fn the_fastest_without_error_and_the_floor_are_marked() {
    let report = report();
    let views: Vec<&View> = report.views.iter().collect();
    let html = scene_table(&report, "a.glb", &views);
    assert!(
        html.contains("<tr class=\"best\" data-method=\"counter\">"),
        "{html}"
    );
    assert!(html.contains("<tr class=\"floor start\" data-method=\"none\">"));
    assert_eq!(html.matches("fastest, none wrong").count(), 1);
}

#[test]
fn columns_that_say_nothing_are_left_out() {
    let mut report = report();
    let views = report.views.clone();
    let views: Vec<&View> = views.iter().collect();
    let html = scene_table(&report, "a.glb", &views);
    for key in ["gpu_ms", "camera", "size", "note"] {
        assert!(!html.contains(&format!("data-key=\"{key}\"")), "{key}");
    }
    report.rows[0].gpu_ms = Some(1.0);
    report.rows[0].note = "n".into();
    let html = scene_table(&report, "a.glb", &views);
    assert!(html.contains("data-key=\"gpu_ms\"") && html.contains("data-key=\"note\""));
}

#[test]
fn a_broken_promise_is_marked() {
    let mut report = report();
    report.rows[1].exact = true;
    let views = report.views.clone();
    let views: Vec<&View> = views.iter().collect();
    let html = scene_table(&report, "a.glb", &views);
    assert!(
        html.contains("<tr class=\"broken\" data-method=\"half\">"),
        "{html}"
    );
}
