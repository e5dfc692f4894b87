//! Two processes, whatever their threads, write the same masks and report the same counts.

mod common;

use common::{Folder, json};
use serde_json::Value;

const SCENE: &str = "gen:city?triangles=3000&lights=20&seed=3&moon=1";

/// A report without what differs from run to run: times.
fn timeless(mut value: Value) -> Value {
    for key in ["frame_ms", "stages_ms"] {
        if let Some(ms) = value.get_mut(key) {
            *ms = Value::Null;
        }
    }
    let lights = value.get_mut("lights").and_then(Value::as_array_mut);
    for light in lights.into_iter().flatten() {
        light["build_us"] = Value::Null;
        light["gpu_us"] = Value::Null;
    }
    value
}

/// Every file in a folder, and the report.
fn rendered(threads: &str, seed: &str) -> (Vec<(String, Vec<u8>)>, Value) {
    let folder = Folder::new(&format!("threads-{threads}-{seed}"));
    let (masks, picture) = (folder.path(""), folder.path("picture.png"));
    let scene = SCENE.replace("seed=3", &format!("seed={seed}"));
    let arguments = [
        "render",
        &scene,
        "--size",
        "96x64",
        "--threads",
        threads,
        "--repeat",
        "1",
        "--mask-out",
        &masks,
        "-o",
        &picture,
    ];
    let report = timeless(json(0, &arguments));
    let read = |name: String| {
        let bytes = std::fs::read(folder.path(&name)).expect("a file");
        (name, bytes)
    };
    (folder.files().into_iter().map(read).collect(), report)
}

#[test]
fn threads_change_no_file() {
    let first = rendered("1", "3");
    assert_eq!(
        first.0.len(),
        first.1["lights"].as_array().map_or(0, Vec::len) + 1
    );
    for threads in ["1", "2", "8"] {
        assert!(rendered(threads, "3") == first, "{threads} threads");
    }
    // The control: another city is another set of files.
    assert!(rendered("2", "4").0 != first.0);
}

#[test]
fn threads_change_no_verdict() {
    let of = |threads: &str| {
        json(
            0,
            &["check", SCENE, "--size", "96x64", "--threads", threads],
        )
    };
    let first = of("1");
    assert!(first["samples"].as_u64() > Some(100));
    for threads in ["2", "8"] {
        assert_eq!(of(threads), first);
    }
}
