//! Keys, medians, and how rows of a view are related.

use super::*;

const VIEW: (&str, &str, [u32; 2]) = ("a.glb", "auto", [64, 48]);

#[test]
fn the_fixed_keys_are_there_and_unmeasured_ones_are_null() {
    let report = BenchReport {
        rows: vec![BenchRow::new("counter", VIEW)],
        ..BenchReport::default()
    };
    let json = serde_json::to_value(&report).unwrap();
    let row = json["rows"][0].as_object().unwrap();
    for key in ["scene", "method", "size", "camera"] {
        assert!(row.contains_key(key), "{key}");
    }
    for key in [
        "frame_ms",
        "build_ms",
        "first_frame_ms",
        "gpu_ms",
        "wrong",
        "ambiguous",
        "samples",
        "wrong_ppm",
        "times_none",
        "gpu_bytes",
        "failed",
    ] {
        assert!(row[key].is_null(), "{key}");
    }
    assert_eq!(row["size"], serde_json::json!([64, 48]));
    assert!(!row.contains_key("difference"));
    for key in [
        "command", "settings", "oracle", "when", "machine", "complete", "repeat", "views",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
}

#[test]
fn medians_and_quartiles_of_frames() {
    let mut row = BenchRow::new("counter", VIEW);
    row.set_frame_times(&[4.0, 1.0, 2.0, 3.0]);
    assert_eq!(row.frame_ms, Some(2.5));
    assert_eq!((row.frame_ms_min, row.frame_ms_max), (Some(1.0), Some(4.0)));
    assert_eq!(row.frame_ms_iqr, Some(1.5));
    assert_eq!(row.repeats, 4);
    row.set_frame_times(&[]);
    assert_eq!((row.frame_ms, row.frame_ms_iqr), (None, None));
}

#[test]
fn every_row_is_related_to_the_floor_of_its_own_view_whenever_that_comes() {
    let row = |method: &str, size, ms: f64| {
        let mut row = BenchRow::new(method, ("a.glb", "auto", size));
        row.set_frame_times(&[ms]);
        row
    };
    let mut report = BenchReport::default();
    report.push(row("counter", [64, 48], 6.0));
    assert_eq!(report.rows[0].times_none, None);
    report.push(row("counter", [128, 96], 9.0));
    report.push(row("none", [64, 48], 2.0));
    assert_eq!(report.rows[0].times_none, Some(3.0));
    assert_eq!(report.rows[1].times_none, None);
    assert_eq!(report.rows[2].times_none, Some(1.0));
    assert_eq!(report.views.len(), 2);
}

#[test]
fn errors_without_samples_are_none() {
    let mut row = BenchRow::new("counter", VIEW);
    row.set_errors(0, 0, 0);
    assert_eq!(row.wrong_ppm, Some(0.0));
    row.set_errors(3, 0, 1_000_000);
    assert_eq!(row.wrong_ppm, Some(3.0));
}
