//! `umbrage profile` as scripts see it, and its advice where what is right is known.

mod common;

use std::path::Path;

use common::{Folder, assert_keys, json, refused};
use glam::{DAffine3, DVec3, Vec3};
use serde_json::Value;
use umbrage_scene::{Camera, Instance, Light, Material, Mesh, Scene, write};

const WORLD: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../data/worlds/stormkeep.glb"
);

#[test]
fn every_light_is_named_and_costs_add_up() {
    let folder = Folder::new("profile");
    let out = folder.path("report");
    let report = json(
        0,
        &[
            "profile", WORLD, "--size", "160x90", "--repeat", "1", "-o", &out,
        ],
    );
    assert_keys(
        &report,
        "command when scene method adapter machine size triangles rounds how frame lights advice",
    );
    let lights = report["lights"].as_array().expect("lights");
    assert_eq!(lights.len(), 471);
    let rendered = json(0, &["render", WORLD, "--size", "160x90", "--repeat", "1"]);
    let (mut drawn, mut own) = (0, 0.0);
    let (mut in_front, mut covered) = (0, 0);
    for (light, rendered) in lights.iter().zip(rendered["lights"].as_array().unwrap()) {
        assert_keys(
            light,
            "name kind range position subset_triangles facing_triangles quads quads_drawn \
             cap_triangles path reason cached cpu_us gpu_us volume_fragments volume_covered light_fragments \
             shaded_samples lit_pixels shadowed_pixels range_needed_m frame_us frame_share",
        );
        assert_keys(
            &light["cpu_us"],
            "query facing hidden layers counters emission upload",
        );
        for key in [
            "name",
            "kind",
            "quads",
            "quads_drawn",
            "path",
            "subset_triangles",
        ] {
            assert_eq!(light[key], rendered[key], "{light}");
        }
        let count = |key: &str| light[key].as_u64().expect("a count");
        assert!(count("lit_pixels") <= count("shaded_samples"), "{light}");
        assert!(
            count("shaded_samples") <= count("light_fragments"),
            "{light}"
        );
        // Those behind surfaces count too.
        let [before, all] = ["volume_fragments", "volume_covered"].map(count);
        assert!(before <= all, "{light}");
        (in_front, covered) = (in_front + before, covered + all);
        let is_drawn = light["path"] != "skipped";
        assert_eq!(count("light_fragments") > 0, is_drawn, "{light}");
        assert!(
            !is_drawn || light["cpu_us"]["query"].as_f64() > Some(0.0),
            "{light}"
        );
        drawn += usize::from(is_drawn);
        own += light["frame_us"].as_f64().unwrap_or(0.0);
    }
    assert!(drawn > 50 && in_front > 0 && covered > in_front);
    let frame = &report["frame"];
    let sum = |key: &str| -> f64 {
        let parts = frame[key].as_array().expect("parts").iter();
        parts.map(|part| part["us"].as_f64().unwrap()).sum()
    };
    let of = |name: &str| {
        let parts = frame["parts"].as_array().unwrap();
        parts.iter().find(|part| part["name"] == name).cloned()
    };
    let whole = frame["frame_ms"].as_f64().unwrap() * 1e3;
    assert!((sum("parts") / whole - 1.0).abs() < 1e-6);
    assert!((sum("build_parts") / frame["build_us"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    assert!(of("remainder").is_some());
    if let Some(all) = of("lights, one by one") {
        assert!((all["us"].as_f64().unwrap() - own).abs() < 1.0);
    }
    for name in ["profile.json", "trace.json", "index.html"] {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
    let trace = std::fs::read(Path::new(&out).join("trace.json")).expect("a trace");
    let trace: Value = serde_json::from_slice(&trace).expect("JSON");
    assert!(trace["traceEvents"].as_array().map(Vec::len) > Some(drawn));
}

#[test]
fn what_cannot_be_profiled_is_refused() {
    let scene = "gen:soup?triangles=300&lights=4";
    let message = refused(2, &["profile", scene, "--method", "raytrace"]);
    assert!(message.contains("choose counter"), "{message}");
    refused(2, &["profile", "no/such.glb"]);
    refused(2, &["profile", scene, "-o", "/dev/null/report"]);
    refused(2, &["profile"]);
}

/// Two triangles, counter-clockwise seen from where the normal points.
fn quad(mesh: &mut Mesh, [a, b, c, d]: [Vec3; 4]) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend([a, b, c, d]);
    mesh.triangles.push([base, base + 1, base + 2]);
    mesh.triangles.push([base, base + 2, base + 3]);
    mesh.materials.extend([0; 2]);
}

/// A box seen from inside.
fn room(low: Vec3, high: Vec3) -> Mesh {
    let p = |x: usize, y: usize, z: usize| {
        let ends = [low, high];
        Vec3::new(ends[x].x, ends[y].y, ends[z].z)
    };
    let mut mesh = Mesh {
        name: "room".into(),
        ..Mesh::default()
    };
    quad(&mut mesh, [p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)]);
    quad(&mut mesh, [p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)]);
    quad(&mut mesh, [p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)]);
    quad(&mut mesh, [p(0, 0, 1), p(0, 1, 1), p(1, 1, 1), p(1, 0, 1)]);
    quad(&mut mesh, [p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)]);
    quad(&mut mesh, [p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)]);
    mesh
}

/// Small quads in a grid at height `y`, facing down.
fn leaves(y: f32, count: usize) -> Mesh {
    let mut mesh = Mesh {
        name: "leaves".into(),
        ..Mesh::default()
    };
    for i in 0..count {
        let (x, z) = ((i % 40) as f32, (i / 40) as f32);
        let at = Vec3::new(-1.8 + 0.09 * x, y, -1.8 + 0.09 * z);
        let (right, far) = (0.05 * Vec3::X, 0.05 * Vec3::Z);
        quad(&mut mesh, [at, at + right, at + right + far, at + far]);
    }
    mesh
}

/// A lamp in a room four metres wide, seen from within, and what else there is.
fn scene(range: f32, more: Vec<Mesh>) -> Scene {
    let mut meshes = vec![room(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0))];
    meshes.extend(more);
    let instances = (0..meshes.len() as u32).map(|mesh| Instance {
        name: format!("node_{mesh}"),
        mesh,
        transform: DAffine3::IDENTITY,
        ..Instance::default()
    });
    Scene {
        instances: instances.collect(),
        meshes,
        materials: vec![Material::default()],
        lights: vec![Light {
            name: "the lamp".into(),
            position: DVec3::new(0.1, 1.5, 0.05),
            intensity: 20.0,
            range: Some(range),
            ..Light::default()
        }],
        cameras: vec![Camera::look_at(
            "door",
            DVec3::new(1.7, 1.6, 1.8),
            DVec3::new(-0.6, 0.6, -1.0),
            1.0,
        )],
        ..Scene::default()
    }
}

/// A block on the floor whose shadow is seen.
fn block() -> Mesh {
    let inside = room(Vec3::new(-1.2, 0.01, -1.2), Vec3::new(-0.2, 1.2, -0.4));
    let outwards = |[a, b, c]: &[u32; 3]| [*a, *c, *b];
    Mesh {
        name: "block".into(),
        triangles: inside.triangles.iter().map(outwards).collect(),
        ..inside
    }
}

fn advice(scene: &Scene, name: &str, more: &[&str]) -> Vec<Value> {
    let folder = Folder::new(name);
    let file = folder.path("scene.glb");
    write::glb(scene, Path::new(&file)).expect("a scene");
    let fixed = ["profile", &file, "--size", "160x120", "--repeat", "2"];
    let report = json(0, &[&fixed, more].concat());
    report["advice"].as_array().expect("advice").clone()
}

#[test]
fn a_lamp_that_reaches_far_through_walls_is_told_to_reach_less() {
    // What stands outside is within its range, and casts.
    let mut outside = leaves(20.0, 1600);
    for p in &mut outside.positions {
        *p = Vec3::new(p.x * 9.0, p.y - 8.0, p.z * 9.0);
    }
    let all = advice(
        &scene(40.0, vec![block(), outside]),
        "profile-range",
        &["--verify"],
    );
    let range = all.iter().find(|one| one["kind"] == "shorter_range");
    let range = range.unwrap_or_else(|| panic!("{all:?}"));
    assert_eq!(range["lights"][0], "the lamp");
    let text = range["text"].as_str().unwrap();
    assert!(text.contains("range 40 m could be"), "{text}");
    for of in ["predicted", "measured"] {
        assert_keys(&range[of], "frame_us build_us");
    }
    assert!(
        range["predicted"]["build_us"].as_f64() > Some(0.0),
        "{range}"
    );
    assert!(range["build_ratio"].is_number(), "{range}");
}

#[test]
fn leaves_whose_shadows_nobody_sees_are_told_to_cast_none() {
    // Quads that matter to no visible surface are drawn all the same.
    let options = ["--no-cull", "quads,hidden"];
    let scene = scene(3.6, vec![block(), leaves(2.9, 1600)]);
    let all = advice(&scene, "profile-leaves", &options);
    let casting: Vec<&Value> = (all.iter())
        .filter(|one| one["kind"] == "no_casting" && one["of"] == "leaves")
        .collect();
    assert_eq!(casting.len(), 1, "{all:?}");
    let text = casting[0]["text"].as_str().unwrap();
    assert!(text.contains("% of the quads of 1 lights"), "{text}");
}

/// The negative control: a lamp that fits its room, and a block whose shadow is seen.
#[test]
fn a_scene_in_order_gets_no_advice() {
    let all = advice(&scene(3.6, vec![block()]), "profile-control", &[]);
    assert!(all.is_empty(), "{all:?}");
}

#[test]
fn lights_that_show_nowhere_and_lights_at_one_place_are_found() {
    let mut scene = scene(3.6, vec![block(), leaves(-0.5, 1600)]);
    let lamp = scene.lights[0].clone();
    scene.lights.push(Light {
        name: "twin".into(),
        ..lamp.clone()
    });
    // Below the floor: what is seen is within its range, and in shadow.
    scene.lights.push(Light {
        name: "cellar".into(),
        position: DVec3::new(0.0, -1.0, 0.0),
        ..lamp
    });
    let all = advice(&scene, "profile-unseen", &["--casters", "both"]);
    let of = |kind: &str| -> Vec<&Value> { all.iter().filter(|one| one["kind"] == kind).collect() };
    assert_eq!(of("switch_off").len(), 1, "{all:?}");
    assert_eq!(of("switch_off")[0]["lights"][0], "cellar");
    assert_eq!(of("merge").len(), 1, "{all:?}");
}

/// Closed boxes in a grid between lamp and floor, seen from outside.
fn crates(count: usize) -> Mesh {
    let mut mesh = Mesh {
        name: "crates".into(),
        ..Mesh::default()
    };
    for i in 0..count {
        let low = Vec3::new(
            -1.5 + 0.2 * (i % 15) as f32,
            0.4,
            -1.5 + 0.2 * (i / 15) as f32,
        );
        let one = room(low, low + 0.1);
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(one.positions);
        let outwards = |[a, b, c]: [u32; 3]| [a, c, b].map(|v| v + base);
        mesh.triangles
            .extend(one.triangles.into_iter().map(outwards));
        mesh.materials.extend(one.materials);
    }
    mesh
}

#[test]
fn closed_boxes_that_cast_from_both_sides_are_told_to_cast_from_one() {
    let mut crates = crates(225);
    crates.materials.fill(1);
    let mut scene = scene(3.6, vec![crates]);
    scene.materials.push(Material {
        name: "wood".into(),
        double_sided: true,
        ..Material::default()
    });
    // Their far sides cast as well, though near ones hide them.
    let all = advice(&scene, "profile-sides", &["--no-cull", "quads,hidden"]);
    let single: Vec<&Value> = (all.iter())
        .filter(|one| one["kind"] == "single_sided")
        .collect();
    assert_eq!(single.len(), 1, "{all:?}");
    assert_eq!(
        (&single[0]["of"], &single[0]["pixels_changed"]),
        (&"wood".into(), &0.into())
    );
    scene.materials[1].double_sided = false;
    let all = advice(&scene, "profile-one-side", &["--no-cull", "quads,hidden"]);
    assert!(
        all.iter().all(|one| one["kind"] != "single_sided"),
        "{all:?}"
    );
}

#[test]
fn a_lamp_in_line_with_an_edge_and_the_eye_is_told_to_move() {
    let (lamp, edge) = (DVec3::new(0.0, 2.5, 0.0), DVec3::new(1.0, 1.5, 0.0));
    let inside = room(Vec3::new(0.25, 1.0, -0.5), Vec3::new(1.0, 1.5, 0.5));
    let shelf = Mesh {
        name: "shelf".into(),
        triangles: inside
            .triangles
            .iter()
            .map(|&[a, b, c]| [a, c, b])
            .collect(),
        ..inside
    };
    // Below the floor, for caps and no shadows.
    let mut scene = scene(3.6, vec![shelf, leaves(-0.5, 1600)]);
    scene.lights[0].position = lamp;
    let options = ["--casters", "both", "--no-cull", "hidden,quads"];
    for (beyond, wanted) in [(1.75, 1), (1.8, 0)] {
        let eye = lamp + (edge - lamp) * DVec3::new(1.75, beyond, 1.0);
        let target = DVec3::new(-1.0, 0.2, -1.0);
        scene.cameras[0] = Camera::look_at("door", eye, target, 1.0);
        let all = advice(&scene, "profile-move", &options);
        let moves: Vec<&Value> = all.iter().filter(|one| one["kind"] == "move").collect();
        assert_eq!(moves.len(), wanted, "{beyond}: {all:?}");
        if let Some(one) = moves.first() {
            assert!(
                one["text"]
                    .as_str()
                    .unwrap()
                    .contains("an edge, the light and the eye")
            );
        }
    }
}
