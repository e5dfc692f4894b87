//! `umbrage bench` as scripts see it.

mod common;

use std::path::Path;
#[cfg(unix)]
use std::process::{Command, Stdio};

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
            "scene method size camera frame_ms build_ms gpu_ms wrong ambiguous samples wrong_ppm \
             first_frame_ms",
        );
        assert!(row["frame_ms"].as_f64() > Some(0.0), "{row}");
        assert!(row["first_frame_ms"].as_f64() > Some(0.0), "{row}");
        assert_eq!(row["build_ms"].is_null(), row["method"] == "none", "{row}");
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
    assert_eq!(doctored(|row| row["lights"] = 5.into()), Some(1));
    let compared = ["--baseline", &other, "--ratio", "1000", "--quiet"];
    let message = refused(1, &bench(&[&methods[..], &compared[..]].concat()));
    assert!(
        message.contains("counter in gen:soup") && message.contains("OTHER WORKLOAD"),
        "{message}"
    );
    let compared = ["--baseline", &other, "--casters", "both"];
    let message = refused(2, &bench(&[&methods[..], &compared[..]].concat()));
    assert!(message.contains("casters=both"), "{message}");
    std::fs::write(&other, "{}").expect("a file");
    refused(2, &bench(&["--baseline", &other]));
    refused(2, &bench(&["--methods", "counter,nope"]));
    refused(2, &bench(&["--baseline", &other, "--ratio", "0.5"]));
    assert!(refused(2, &bench(&["--ratio", "1.5"])).contains("--baseline"));
}

#[test]
fn what_cannot_be_read_or_written_shows_before_anything_is_measured() {
    let folder = Folder::new("bench-early");
    let world = folder.path("a.world");
    let message = refused(2, &bench(&[SCENE, "--world", &world]));
    assert!(message.contains("one by one"), "{message}");
    let out = folder.path("report");
    for scene in [
        "no/such.glb",
        "Cargo.toml",
        "gen:soup?trees=3",
        "gen:forest",
    ] {
        refused(2, &bench(&[scene, "-o", &out]));
    }
    refused(2, &bench(&["-o", "/dev/null/report"]));
    refused(2, &bench(&["--json", "/no/such/folder/report.json"]));
    assert!(folder.files().is_empty(), "{:?}", folder.files());
}

#[test]
fn an_error_in_a_later_scene_keeps_what_there_is() {
    let folder = Folder::new("bench-later");
    let (out, broken) = (folder.path("report"), folder.path("broken.glb"));
    std::fs::write(&broken, "no scene").expect("a file");
    let options = [&broken, "--methods", "none", "-o", &out];
    let report = json(2, &bench(&options));
    assert_eq!(report["complete"], false);
    assert_eq!(report["rows"].as_array().map(Vec::len), Some(1));
    let written = std::fs::read(Path::new(&out).join("report.json")).expect("a report");
    let written: Value = serde_json::from_slice(&written).expect("JSON");
    assert_eq!(written["rows"], report["rows"]);
}

#[test]
fn where_time_runs_on_volumes_are_those_of_the_frames() {
    let actor = "gen:soup?triangles=40?speed=1";
    let options = ["--methods", "counter", "--actor", actor, "--play", "30"];
    let row = &json(0, &bench(&options))["rows"][0];
    assert_eq!(row["wrong"], 0, "{row}");
    assert!(row["build_ms"].as_f64() > Some(0.0), "{row}");
    assert!(
        row["build_ms"].as_f64() < row["frame_ms_max"].as_f64(),
        "{row}"
    );
}

#[cfg(unix)]
#[test]
fn a_path_that_is_no_unicode_is_no_panic() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = Folder::new("bench-bytes");
    let mut out = std::ffi::OsString::from(folder.path("report-"));
    out.push(std::ffi::OsStr::from_bytes(b"\xff"));
    let done = Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(bench(&["--methods", "none", "--no-oracle", "-o"]))
        .arg(&out)
        .output()
        .expect("the binary starts");
    let errors = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{errors}");
    assert!(Path::new(&out).join("report.json").is_file());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_valid_report_of_what_there_is() {
    let folder = Folder::new("bench-interrupt");
    let out = folder.path("report");
    let mut run = Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(["bench", SCENE, "--size", "64x48", "-q", "-o", &out])
        .args(["--methods", "none,counter", "--limit", "1e6"])
        .args(["--repeat", "100000000"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    // Written empty before anything is measured, and after Ctrl-C is listened to.
    let page = Path::new(&out).join("index.html");
    while !page.is_file() && run.try_wait().expect("a child").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let id = run.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.expect("kill is there").success());
    let done = run.wait_with_output().expect("an end");
    let errors = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{errors}");
    assert!(errors.contains("interrupted: "), "{errors}");
    let text = std::fs::read(Path::new(&out).join("report.json")).expect("a report");
    let report: Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(report["complete"], false);
    let rows = report["rows"].as_array().expect("rows");
    assert!(rows.len() < 2, "{report}");
    for row in rows {
        let note = row["note"].as_str().expect("a note");
        assert!(note.contains("interrupted"), "{note}");
    }
    let mut names: Vec<_> = Path::new(&out)
        .read_dir()
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["index.html", "report.csv", "report.json"]);
}
