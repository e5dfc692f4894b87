//! The binary as scripts see it: exit codes, JSON keys, and files that are whole or not there.

mod common;

use std::path::Path;

use common::{Folder, assert_keys, json, png_size, refused, umbrage};
use serde_json::Value;

const SOUP: &str = "gen:soup?triangles=300&lights=5&seed=3";
const SMALL: [&str; 2] = ["--size", "128x96"];

#[test]
fn render_reports_and_writes_a_picture() {
    let folder = Folder::new("render");
    let (picture, masks) = (folder.path("soup.png"), folder.path("masks"));
    let options = [
        "render",
        SOUP,
        "-o",
        &picture,
        "--mask-out",
        &masks,
        "--repeat",
        "1",
    ];
    let report = json(0, &[&options[..], &SMALL].concat());
    assert_keys(
        &report,
        "scene method adapter size frame_ms stages_ms totals lights",
    );
    assert_keys(
        &report["totals"],
        "subset_triangles facing_triangles quads cap_triangles polygons uploaded_bytes \
         lights_rebuilt lights_cached lights_skipped",
    );
    let lights = report["lights"].as_array().expect("a list of lights");
    assert_eq!(lights.len(), 5);
    for light in lights {
        assert_keys(
            light,
            "name kind range subset_triangles facing_triangles quads cap_triangles path reason \
             cached build_us gpu_us",
        );
        let path = light["path"].as_str().expect("a word");
        assert!(["zpass", "zfail", "skipped"].contains(&path));
        assert_eq!(path == "zpass", light["reason"] == "", "{light}");
    }
    let sum = |key: &str| lights.iter().filter_map(|l| l[key].as_u64()).sum::<u64>();
    assert_eq!(report["totals"]["quads"], sum("quads"));
    assert!(sum("quads") > 0);
    assert_eq!(report["method"], "counter");
    assert!(report["gpu_bytes"].as_u64() >= Some(4 * sum("quads")));
    assert_eq!(report["note"], "");
    assert_eq!(report["size"], serde_json::json!([128, 96]));
    assert_eq!(png_size(&picture), (128, 96));
    assert_eq!(folder.files(), ["masks", "soup.png"]);
    assert_eq!(Path::new(&masks).read_dir().expect("masks").count(), 5);
}

/// From 10,000 km away a scene has the vertices and edges that it has from near, and its world file
/// is that of every verb.
#[test]
fn inspect_sees_what_f32_cannot_hold() {
    let scene = "gen:field?n=4&lights=2";
    let origin = ["--origin", "-12345678.9,0,4567890.1"];
    let near = json(0, &["inspect", scene]);
    let far = json(0, &[&["inspect", scene][..], &origin].concat());
    for counted in ["welded_vertices", "unique_edges", "degenerate_triangles"] {
        assert_eq!(far[counted], near[counted], "{counted}");
    }
    let folder = Folder::new("far");
    let file = folder.path("far.world");
    let world = ["--world", &file];
    json(0, &[&["inspect", scene][..], &origin, &world].concat());
    json(0, &[&["volumes", scene][..], &origin, &world].concat());
}

#[test]
fn inspect_counts() {
    let report = json(0, &["inspect", "gen:field?n=4&lights=2"]);
    assert_keys(
        &report,
        "triangles vertices welded_vertices unique_edges edges_by_triangles opposite_wound_pairs \
         degenerate_triangles duplicate_triangles bytes_per_triangle lights build_ms",
    );
    assert_keys(&report["build_ms"], "load weld edges bvh order total");
    let arrays = "positions triangles source casting edges sides clusters planes boxes bvh";
    assert_keys(&report["memory"], arrays);
    let memory = report["memory"].as_object().expect("arrays");
    let sum: f64 = memory.values().filter_map(Value::as_f64).sum();
    assert!((sum - report["bytes_per_triangle"].as_f64().expect("bytes")).abs() < 1e-6);
    assert_eq!(report["memory"]["triangles"], 12.0);
    assert_eq!(report["memory"]["edges"], 8.0 * 56.0 / 32.0);
    // 8 bytes of faces an edge, and the triangles' edges.
    let face_pointers = 8.0 * 56.0 / 32.0 + report["memory"]["sides"].as_f64().expect("bytes");
    assert_eq!(report["face_pointer_bytes_per_triangle"], face_pointers);
    // Wider than a cell, and nothing is left.
    let wide = json(0, &["inspect", "gen:field?n=4&lights=2", "--weld", "1e4"]);
    assert_eq!(wide["degenerate_triangles"], 32);
    assert_eq!(wide["welded_vertices"], 1);
    // 4 x 4 cells of two triangles: 2 * 4 * 5 + 16 edges, of which 16 are on the border.
    assert_eq!(report["triangles"], 32);
    assert_eq!(report["welded_vertices"], 25);
    assert_eq!(report["unique_edges"], 56);
    let classes = serde_json::json!({"1": 16, "2": 40, "3": 0, "4+": 0});
    assert_eq!(report["edges_by_triangles"], classes);
    assert_eq!(report["lights"], 2);
}

#[test]
fn check_passes_for_exact_methods() {
    for method in ["counter", "counter-zfail"] {
        for casters in ["material", "both"] {
            let options = ["check", SOUP, "--method", method, "--casters", casters];
            let report = json(0, &[&options[..], &SMALL].concat());
            assert_keys(
                &report,
                "scene method adapter size pixels lights samples wrong ambiguous tolerance_px \
                 tolerance_depth closed worst lights_by_path",
            );
            assert_keys(&report["lights_by_path"], "zpass zfail skipped");
            assert_eq!(
                (&report["wrong"], &report["closed"]),
                (&0.into(), &true.into())
            );
            assert!(report["samples"].as_u64() > Some(1000), "{report}");
            assert_eq!(report["tolerance_px"], 1.0 / 64.0);
        }
    }
}

/// A method that promises nothing is counted, not failed.
#[test]
fn check_counts_what_no_shadows_get_wrong() {
    let report = json(
        0,
        &[&["check", SOUP, "--method", "none"][..], &SMALL].concat(),
    );
    assert!(report["wrong"].as_u64() > Some(100), "{report}");
    let worst = report["worst"].as_array().expect("a list");
    assert!(!worst.is_empty());
    worst
        .iter()
        .for_each(|pixel| assert_keys(pixel, "x y light"));
}

/// What a method says about itself is for whoever reads its figures.
#[test]
fn methods_note_what_readers_must_know() {
    let report = |verb: &str| {
        let options = [verb, SOUP, "--method", "shadowmap-256", "--repeat", "1"];
        json(0, &[&options[..], &SMALL].concat())
    };
    let render = report("render");
    assert!(render["gpu_bytes"].as_u64() > Some(256 * 256));
    for report in [render, report("check")] {
        let note = report["note"].as_str().expect("a note");
        assert!(note.contains("cached"), "{note}");
    }
}

/// Common options may be passed to every verb; what a verb does not use is not looked at.
#[test]
fn verbs_that_draw_nothing_accept_common_options_and_look_at_none() {
    let common = [
        "--size",
        "64x48",
        "--camera",
        "no-such-camera",
        "--method",
        "mask-alpha",
        "--adapter",
        "no-such-adapter",
        "--threads",
        "2",
        "--casters",
        "both",
        "--range",
        "auto",
    ];
    let lights = ["--lights", "no-such-file.json"];
    json(0, &[&["inspect", SOUP][..], &common, &lights].concat());
    let volumes = ["volumes", SOUP, "--repeat", "1"];
    json(0, &[&volumes[..], &common].concat());
    refused(2, &[&volumes[..], &lights].concat());
    for verb in ["inspect", "volumes"] {
        refused(2, &[verb, SOUP, "--no-cull", "all"]);
        refused(2, &[verb, SOUP, "--shadows", "ambient"]);
        let help = umbrage(&[verb, "--help"]);
        assert!(String::from_utf8_lossy(&help.stdout).contains("Accepted and ignored"));
    }
}

/// What a loader skipped is said once, of scenes and of actors, and not with `--quiet`.
#[test]
fn oddities_are_said() {
    let folder = Folder::new("oddities");
    let file = folder.path("odd.obj");
    std::fs::write(&file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n").expect("an OBJ file");
    let actor = [SOUP, "--actor", &file];
    for scene in [&[file.as_str()][..], &actor] {
        let inspect = [&["inspect"], scene].concat();
        assert_eq!(json(0, &inspect)["oddities"][0], "skipped faces: 1");
        let said = umbrage(&inspect);
        let said = String::from_utf8_lossy(&said.stderr).into_owned();
        assert!(said.ends_with(": skipped faces: 1\n"), "{said:?}");
        let quiet = umbrage(&[&inspect[..], &["--quiet"]].concat());
        assert!(quiet.status.success() && quiet.stderr.is_empty());
    }
    assert_eq!(
        json(0, &["inspect", SOUP])["oddities"],
        serde_json::json!([])
    );
}

#[test]
fn gen_writes_what_loads_again() {
    for spec in [
        SOUP,
        "gen:city?triangles=3000&lights=7&seed=2",
        "gen:field?n=16&lights=3",
    ] {
        let folder = Folder::new(&format!("gen-{}", spec.len()));
        let file = folder.path("world.glb");
        let written = json(0, &["gen", spec, "-o", &file]);
        assert_eq!(folder.files(), ["world.glb"]);
        let [generated, loaded] = [spec, file.as_str()].map(|scene| json(0, &["inspect", scene]));
        assert_eq!(written["triangles"], loaded["triangles"]);
        for key in [
            "triangles",
            "welded_vertices",
            "unique_edges",
            "edges_by_triangles",
            "opposite_wound_pairs",
            "degenerate_triangles",
            "duplicate_triangles",
            "lights",
        ] {
            assert_eq!(generated[key], loaded[key], "{spec}: {key}");
        }
    }
}

#[test]
fn bad_input_exits_with_2_and_writes_nothing() {
    let folder = Folder::new("bad");
    let broken = folder.path("broken.glb");
    std::fs::write(&broken, b"glTF but not really").expect("a broken file");
    let before = folder.files();
    let (picture, results) = (folder.path("out.png"), folder.path("out.json"));
    let missing = folder.path("missing.glb");
    let outputs = ["-o", &picture, "--json", &results];
    for scene in [
        broken.as_str(),
        &missing,
        "gen:nowhere",
        "gen:soup?triangles=-1",
        "scene.txt",
    ] {
        refused(2, &[&["render", scene][..], &outputs].concat());
        refused(2, &["inspect", scene, "--json", &results]);
        refused(2, &["check", scene, "--json", &results]);
    }
    for options in [
        ["--size", "0x10"],
        ["--camera", "no-such-camera"],
        ["--method", "no-such-method"],
        ["--lights", "no-such-file.json"],
        ["--range", "-1"],
        ["--near", "0"],
        ["--threads", "0"],
    ] {
        refused(2, &[&["render", SOUP][..], &outputs, &options].concat());
    }
    refused(2, &["gen", "gen:nowhere", "-o", &folder.path("out.glb")]);
    refused(2, &["gen", "soup", "-o", &folder.path("out.obj")]);
    refused(2, &["dance", SOUP]);
    refused(2, &[]);
    assert_eq!(folder.files(), before, "a refusal left something behind");
}

/// The first run saves, later ones map; what is not this scene's world is refused and left alone.
#[test]
fn a_world_is_kept_in_a_file() {
    let folder = Folder::new("world");
    let file = folder.path("soup.world");
    let world = ["--world", file.as_str()];
    let built = json(0, &[&["inspect", SOUP][..], &world].concat());
    assert!(built["open_ms"].is_null());
    assert_eq!(folder.files(), ["soup.world"]);
    let saved = std::fs::read(&file).expect("the world");
    let mut opened = json(0, &[&["inspect", SOUP][..], &world].concat());
    assert!(opened["open_ms"].as_f64() > Some(0.0));
    opened["open_ms"] = Value::Null;
    opened["build_ms"] = built["build_ms"].clone();
    assert_eq!(built, opened);

    // Every verb that takes a scene maps it.
    let [fresh, mapped] = [&[][..], &world].map(|world| {
        let picture = folder.path("soup.png");
        let render = ["render", SOUP, "-o", &picture, "--repeat", "1"];
        json(0, &[&render[..], &SMALL, world].concat());
        std::fs::read(picture).expect("a picture")
    });
    assert!(fresh == mapped, "the picture depends on --world");
    let check = json(0, &[&["check", SOUP][..], &SMALL, &world].concat());
    assert_eq!(check["wrong"], 0);
    json(
        0,
        &[&["volumes", SOUP, "--repeat", "1"][..], &world].concat(),
    );

    let stale = refused(2, &[&["inspect", "gen:soup?seed=4"][..], &world].concat());
    assert!(stale.contains(&file) && stale.contains("stale") && stale.contains("delete"));
    let casters = ["check", SOUP, "--casters", "back"];
    refused(2, &[&casters[..], &SMALL, &world].concat());
    assert!(std::fs::read(&file).expect("the world") == saved, "changed");

    let broken = folder.path("broken.world");
    let mut bytes = saved;
    bytes[4000] ^= 1;
    std::fs::write(&broken, &bytes).expect("a broken world");
    let damaged = refused(2, &["inspect", SOUP, "--world", &broken]);
    assert!(
        damaged.contains(&broken) && damaged.contains("damaged"),
        "{damaged}"
    );
    std::fs::write(&broken, "a diary").expect("a diary");
    let other = refused(2, &["inspect", SOUP, "--world", &broken]);
    assert!(!other.contains("delete"), "{other}");
    let nowhere = folder.path("no/such/folder.world");
    let missing = refused(2, &["inspect", SOUP, "--world", &nowhere]);
    assert!(missing.contains(&nowhere), "{missing}");
}

#[test]
fn masks_say_what_they_cannot_represent_and_others_make_none() {
    let check = |method: &str| {
        json(
            0,
            &[&["check", SOUP, "--method", method], &SMALL[..]].concat(),
        )
    };
    let screen = check("mask-screen");
    assert!(
        screen["unrepresentable"].as_u64().expect("a count") >= screen["wrong"].as_u64().unwrap()
    );
    assert_eq!(screen["wrong_representable"], 0);
    assert_eq!(check("mask-alpha")["wrong"], 0);
    let half = check("half");
    assert!(half["unrepresentable"].is_null() && half["wrong_representable"].is_null());
    // Lit or not does not hang on it, and so it is not asked for in vain.
    let ambient = [
        "check",
        SOUP,
        "--method",
        "mask-alpha",
        "--shadows",
        "ambient",
    ];
    let message = refused(2, &ambient);
    assert!(message.contains("--shadows"), "{message}");
    let options = ["render", SOUP, "--shadows", "attenuated"];
    let message = refused(2, &options);
    assert!(message.contains("counter makes no mask"), "{message}");
}

#[test]
fn no_such_adapter_exits_with_3() {
    let folder = Folder::new("adapter");
    let picture = folder.path("out.png");
    let options = ["--adapter", "no-such-adapter"];
    let message = refused(
        3,
        &[&["render", SOUP, "-o", &picture][..], &SMALL, &options].concat(),
    );
    assert!(message.contains("no-such-adapter"), "{message}");
    refused(3, &[&["check", SOUP][..], &SMALL, &options].concat());
    assert!(folder.files().is_empty());
}

#[test]
fn results_go_to_a_file_as_to_standard_output() {
    let folder = Folder::new("json");
    let file = folder.path("results.json");
    let output = umbrage(&["inspect", SOUP, "--json", &file, "--quiet"]);
    assert!(output.status.success() && output.stdout.is_empty());
    let text = std::fs::read(&file).expect("the results");
    let written: Value = serde_json::from_slice(&text).expect("JSON");
    let printed = json(0, &["inspect", SOUP]);
    assert_eq!(written["unique_edges"], printed["unique_edges"]);
    // Without --quiet and --json there is a table for people.
    let table = umbrage(&["inspect", SOUP]);
    assert!(String::from_utf8_lossy(&table.stdout).contains("unique edges"));
}

/// Median frames are those after the first: nothing is built or uploaded again, unless asked for.
#[test]
fn steps_that_skip_work_are_switched_off_by_name() {
    let render = |steps: &[&str]| json(0, &[&["render", SOUP], &SMALL[..], steps].concat());
    let [every, none] = [render(&[]), render(&["--no-cull", "all"])];
    let total = |report: &Value, key: &str| report["totals"][key].as_u64().expect("a count");
    assert_eq!(total(&every, "lights_rebuilt"), 0);
    assert_eq!(total(&every, "uploaded_volume_bytes"), 0);
    assert_eq!(total(&none, "lights_rebuilt"), 5);
    assert!(total(&none, "uploaded_volume_bytes") > 0);
    assert!(total(&every, "quads_drawn") < total(&none, "quads_drawn"));
    assert_eq!(total(&none, "quads_drawn"), total(&none, "quads"));
    let some = render(&["--no-cull", "quads,cache"]);
    assert!(total(&some, "lights_rebuilt") > 0);
    let unknown = refused(2, &["render", SOUP, "--no-cull", "corners"]);
    assert!(unknown.contains("receivers"), "{unknown}");
}

#[test]
fn volumes_compares_methods_and_instructions() {
    let volumes = |with: &[&str]| json(0, &[&["volumes", SOUP, "--repeat", "1"], with].concat());
    let report = volumes(&[]);
    assert_keys(
        &report,
        "scene lights instructions threads subset_triangles serial_ms_total parallel_ms_total \
         methods lights_detail",
    );
    let quads = |report: &Value| -> Vec<(String, u64)> {
        let methods = report["methods"].as_array().expect("a list");
        let of = |m: &Value| (m["name"].to_string(), m["quads"].as_u64().expect("a count"));
        methods.iter().map(of).collect()
    };
    let count = |name: &str| {
        let all = quads(&report);
        let found = all.iter().find(|(n, _)| n.contains(&format!("\"{name}\"")));
        found.expect("a method").1
    };
    assert_eq!(count("counter"), count("counter-plain"));
    assert!(count("counter-cuts") < count("counter") && count("counter") < count("brute"));
    for instructions in ["portable", "avx2", "avx512"] {
        assert_eq!(
            quads(&report),
            quads(&volumes(&["--instructions", instructions]))
        );
    }
    refused(2, &["volumes", SOUP, "--instructions", "sse"]);
}

#[test]
fn actors_stand_in_a_scene_and_walk_with_time() {
    let man = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/actors/cesium_man.glb"
    );
    let field = "gen:field?n=8&lights=3";
    let actor = format!("{man}?at=0,1,0&turn=45&speed=0.5");
    let placed = |verb: &str, time: &str| {
        let common = ["--actor", &actor, "--time", time];
        json(0, &[&[verb, field][..], &common].concat())
    };
    let alone = json(0, &["inspect", field]);
    // Only what never moves is welded by tolerance.
    let welded = |weld: &str| {
        let inspect = ["inspect", field, "--actor", &actor, "--weld", weld];
        json(0, &inspect)["welded_vertices"]
            .as_u64()
            .expect("a count")
    };
    assert_eq!(welded("exact") - welded("1e4"), 9 * 9 - 1);
    let both = placed("inspect", "0");
    let more = both["triangles"].as_u64().unwrap() - alone["triangles"].as_u64().unwrap();
    assert_eq!(more, 4672);
    assert_ne!(
        placed("volumes", "0")["methods"][0]["quads"],
        placed("volumes", "1.3")["methods"][0]["quads"]
    );
    let size = ["--size", "64x48", "--actor", &actor, "--time", "0.7"];
    let report = json(0, &[&["check", field][..], &size].concat());
    assert_eq!(report["wrong"], 0);
    // The world of what never moves is one file, whatever walks through it.
    let folder = Folder::new("actors");
    let file = folder.path("field.world");
    for extra in [
        &[][..],
        &["--actor", &actor],
        &["--actor", &actor, "--time", "9"],
    ] {
        let common = ["--world", &file, "--size", "32x32", "--repeat", "1"];
        json(0, &[&["render", field][..], &common, extra].concat());
    }
    for (option, value, said) in [
        ("--actor", "man.glb?size=2", "known are at=X,Y,Z"),
        ("--actor", "nowhere.glb", "nowhere.glb"),
        ("--time", "noon", "expected a time in seconds"),
    ] {
        let error = refused(2, &["render", field, option, value]);
        assert!(error.contains(said), "{error}");
    }
}
