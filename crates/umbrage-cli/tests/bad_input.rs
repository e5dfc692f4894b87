//! What a person may type or hand over wrongly: exit code 2, a message that names it, nothing left.

mod common;

use common::{Folder, json, refused};

const SOUP: &str = "gen:soup?triangles=300&lights=5&seed=3";

#[test]
fn options_out_of_bounds_name_themselves() {
    let folder = Folder::new("options");
    let picture = folder.path("out.png");
    for (option, values) in [
        (
            "--size",
            &[
                "0x0",
                "0x8",
                "8x0",
                "8193x8",
                "99999999999x8",
                "8",
                "-8x8",
                "nanx8",
            ][..],
        ),
        ("--range", &["nan", "inf", "-inf", "0", "-1", "1e39"]),
        (
            "--lights",
            &["-1", "1e9", "1000000000", "1:", "1:-1", "nan"],
        ),
        ("--near", &["nan", "inf", "0", "-1"]),
        ("--time", &["nan", "inf"]),
        ("--weld", &["nan", "inf", "-1", "0"]),
        ("--origin", &["nan,0,0", "inf,0,0", "1,2", ""]),
        ("--threads", &["0", "-1", "1.5"]),
        ("--repeat", &["0", "-1"]),
        (
            "--camera",
            &[
                "1e300,0,0,1,1,1",
                "0,0,0,0,0,0",
                "0,0,0,1,1,1,nan",
                "0,0,0,1,1,1,-5",
                "1,2",
            ],
        ),
    ] {
        for value in values {
            let option_value = format!("{option}={value}");
            let message = refused(2, &["render", SOUP, "-o", &picture, &option_value]);
            assert!(message.contains(option), "{option_value}: {message}");
        }
    }
    assert!(folder.files().is_empty(), "a refusal left something behind");
}

#[test]
fn files_that_are_none_are_named_with_a_remedy() {
    let folder = Folder::new("files");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let directory = folder.path("folder.glb");
    std::fs::create_dir(&directory).expect("a folder");
    let scenes = [
        directory,
        file("empty.glb", b""),
        file("empty.gltf", b""),
        file("nan.obj", b"v 0 0 nan"),
        file("far.obj", b"v 3e38 0 0\nv 0 3e38 0\nv 0 0 0\nf 1 2 3"),
        folder.path("missing.obj"),
    ];
    for scene in &scenes {
        for verb in ["inspect", "check"] {
            let message = refused(2, &[verb, scene, "--quiet"]);
            let name = scene.rsplit('/').next().expect("a name");
            let name = name.strip_suffix(".obj").unwrap_or(name);
            assert!(message.contains(name), "{message}");
            assert!(
                message.contains("; ") || message.contains(": scale"),
                "{message}"
            );
        }
    }
    for (name, bytes) in [
        ("empty.json", &b""[..]),
        ("object.json", b"{}"),
        ("nan.json", b"[{\"position\": [NaN, 0, 0]}]"),
        ("range.json", b"[{\"position\": [0, 0, 0], \"range\": -1}]"),
    ] {
        let lights = file(name, bytes);
        let message = refused(2, &["check", SOUP, "--lights", &lights, "--quiet"]);
        assert!(
            message.contains(name) && message.contains("; "),
            "{message}"
        );
    }
}

#[test]
fn odd_names_no_lights_and_no_triangles_are_fine() {
    let folder = Folder::new("odd");
    let odd = folder.path("\u{fc} \u{1F600} %20 #'.obj");
    std::fs::write(&odd, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").expect("a file");
    assert_eq!(json(0, &["inspect", &odd])["triangles"], 1);
    let empty = folder.path("empty.obj");
    std::fs::write(&empty, "").expect("a file");
    assert_eq!(json(0, &["inspect", &empty])["triangles"], 0);
    let small = ["--size", "16x12"];
    let report = json(0, &[&["check", &empty][..], &small].concat());
    assert_eq!(report["wrong"], 0);
    let report = json(0, &[&["check", SOUP, "--lights", "0"][..], &small].concat());
    assert_eq!([&report["lights"], &report["wrong"]], [0, 0]);
}

#[test]
fn outputs_that_cannot_be_written_leave_nothing() {
    let folder = Folder::new("outputs");
    let nowhere = |name: &str| folder.path(&format!("no/such/{name}"));
    for (arguments, output) in [
        (&["gen", "soup", "-o"][..], nowhere("a.glb")),
        (&["inspect", SOUP, "--quiet", "--json"], nowhere("a.json")),
        (&["inspect", SOUP, "--world"], nowhere("a.world")),
        (&["render", SOUP, "--size", "16x12", "-o"], nowhere("a.png")),
        (&["render", SOUP, "--size", "16x12", "-o"], folder.path("")),
    ] {
        let message = refused(2, &[arguments, &[&output]].concat());
        assert!(message.contains(&output), "{message}");
        assert!(message.contains("; "), "has no remedy: {message}");
    }
    assert!(folder.files().is_empty(), "a refusal left something behind");
}

/// A limit on the size of files stands for a disk that is full.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing() {
    let folder = Folder::new("full");
    let scene = folder.path("soup.glb");
    let world = folder.path("soup.world");
    for arguments in [
        &["gen", "soup?triangles=3000", "-o", &scene][..],
        &["inspect", "gen:soup?triangles=3000", "--world", &world],
    ] {
        let output = std::process::Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\""])
            .arg(env!("CARGO_BIN_EXE_umbrage"))
            .args(arguments)
            .output()
            .expect("a shell");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(
            message.contains("soup.") && message.contains("; "),
            "{message}"
        );
    }
    assert!(folder.files().is_empty(), "half a file was left behind");
}

/// A limit on address space stands for a device whose memory is full: how much a driver takes for
/// itself differs, so some of these limits leave none for the driver, and one leaves too little for
/// the picture.
#[cfg(target_os = "linux")]
#[test]
fn a_device_without_memory_is_said() {
    let folder = Folder::new("memory");
    let picture = folder.path("large.png");
    let mut said = 0;
    for kilobytes in (1_000_000..=3_000_000).step_by(500_000) {
        let output = std::process::Command::new("sh")
            .args(["-c", &format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"")])
            .arg(env!("CARGO_BIN_EXE_umbrage"))
            .args(["render", "gen:city?triangles=500&lights=1", "-o", &picture])
            .args(["--size", "8192x8192", "--repeat", "1", "--adapter", "cpu"])
            .output()
            .expect("a shell");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!message.contains("panicked"), "{kilobytes} kB: {message}");
        if message.contains("ran out of memory") {
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains("--size"), "no remedy: {message}");
            said += 1;
        }
    }
    assert!(said > 0, "no limit was between the driver and the picture");
    assert!(folder.files().is_empty(), "half a file was left behind");
}
