//! `umbrage bench` as scripts see it.

mod common;

use std::path::Path;

use common::{Folder, assert_keys, json, refused, umbrage};
use serde_json::Value;

const SCENE: &str = "gen:soup?triangles=300&lights=4";

fn bench<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let fixed = ["bench", SCENE, "--size", "64x48", "--repeat", "2"];
    [&fixed, more].concat()
}

#[test]
fn every_view_has_a_row_a_method() {
    let folder = Folder::new("bench");
    let out = folder.path("report");
    let sizes = [
        "--size",
        "32x24",
        "--methods",
        "none,counter,crow",
        "-o",
        &out,
    ];
    let report = json(0, &bench(&sizes));
    assert_keys(&report, "command when machine complete repeat rows views");
    assert_eq!(report["complete"], true);
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert_keys(
            row,
            "scene method size camera frame_ms build_ms gpu_ms wrong ambiguous samples wrong_ppm",
        );
        assert!(row["frame_ms"].as_f64() > Some(0.0), "{row}");
        assert!(row["samples"].as_u64() > Some(0), "{row}");
        let wrong = row["wrong"].as_u64().expect("a count");
        assert_eq!(row["method"] == "counter", wrong == 0, "{row}");
    }
    for name in ["report.json", "report.csv", "index.html"] {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
}

#[test]
fn without_an_oracle_errors_are_null() {
    let report = json(0, &bench(&["--no-oracle", "--methods", "none"]));
    assert!(report["rows"][0]["wrong"].is_null());
    assert_eq!(report["rows"][0]["times_none"], 1.0);
}

#[test]
fn a_baseline_is_held_to() {
    let folder = Folder::new("baseline");
    let (out, other) = (folder.path("report"), folder.path("other.json"));
    let methods = ["--methods", "none,counter"];
    json(0, &bench(&[&methods[..], &["-o", &out]].concat()));
    let baseline = Path::new(&out).join("report.json");
    let text = std::fs::read_to_string(&baseline).expect("a report");
    let doctored = |change: fn(&mut Value)| {
        let mut report: Value = serde_json::from_str(&text).expect("JSON");
        change(&mut report["rows"][1]);
        std::fs::write(&other, report.to_string()).expect("a file");
        let compared = ["--baseline", &other, "--ratio", "1000"];
        umbrage(&bench(&[&methods[..], &compared[..]].concat()))
            .status
            .code()
    };
    assert_eq!(doctored(|_| ()), Some(0));
    assert_eq!(doctored(|row| row["times_none"] = 1e-6.into()), Some(1));
    assert_eq!(doctored(|row| row["scene"] = "another".into()), Some(1));
    std::fs::write(&other, "{}").expect("a file");
    refused(2, &bench(&["--baseline", &other]));
    refused(2, &bench(&["--methods", "counter,nope"]));
    refused(2, &bench(&["--ratio", "0.5"]));
}
