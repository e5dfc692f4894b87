//! Skins and animations: what stands where at which time, against facts known beforehand.

mod common;

use std::path::Path;

use common::{container, floats, load_glb};
use glam::{DAffine3, DQuat, DVec3, Vec3, dvec3, vec3};
use serde_json::{Value, json};
use umbrage_scene::rig::{Local, Placement};
use umbrage_scene::{Scene, SceneError};

fn man() -> Scene {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    umbrage_scene::load(&data.join("actors/cesium_man.glb"), &()).unwrap()
}

fn positions(scene: &Scene, time_s: f64) -> Vec<Vec3> {
    let instance = &scene.instances[0];
    let mesh = &scene.meshes[instance.mesh as usize];
    let mut positions = Vec::new();
    let posed = scene.posed(time_s);
    posed.positions(instance, mesh, DVec3::ZERO, &mut positions);
    positions.iter().map(|p| p.as_vec3()).collect()
}

fn bounds(positions: &[Vec3]) -> [Vec3; 2] {
    let low = positions.iter().fold(Vec3::INFINITY, |a, b| a.min(*b));
    let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
    [low, high]
}

/// A strip of four vertices, 2 m high, that bends at its middle: the upper half follows a joint
/// at (0, 1, 0) that turns a quarter about +Z within a second, in the way asked for. `keys` are
/// angles in degrees, a second apart.
fn strip(way: &str, keys: &[f32]) -> (Value, Vec<u8>) {
    let quaternion = |degrees: f32| {
        let half = 0.5 * degrees.to_radians();
        [0.0, 0.0, half.sin(), half.cos()]
    };
    let points = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 2.0, 0.0],
    ];
    let weights = [[1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 1.0]];
    let mut values = Vec::new();
    for &key in keys {
        let value = quaternion(key);
        match way {
            "CUBICSPLINE" => values.extend([[0.0; 4], value, [0.0; 4]]),
            _ => values.push(value),
        }
    }
    let times: Vec<f32> = (0..keys.len()).map(|i| i as f32).collect();
    let bind = |y: f32| {
        [
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -y, 0.0, 1.0f32,
        ]
    };
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut add = |bytes: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
    };
    add(floats(points.as_flattened()));
    add([[0u8, 1, 0, 0]; 4].concat());
    add(floats(&weights.map(|[a, b]| [a, b, 0.0, 0.0f32]).concat()));
    add(floats(&[bind(0.0), bind(1.0)].concat()));
    add(floats(&times));
    add(floats(values.as_flattened()));
    let accessor = |view: usize, component: u32, count: usize, kind: &str| json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
    let root = json!({
        "asset": {"version": "2.0"},
        "scene": 0, "scenes": [{"nodes": [2, 0]}],
        "nodes": [
            // A skinned mesh's own node is of no account.
            {"mesh": 0, "skin": 0, "translation": [7, 7, 7], "name": "strip"},
            {"translation": [0, 1, 0]},
            {"children": [1]},
        ],
        "meshes": [{"name": "strip", "primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "mode": 5}]}],
        "skins": [{"joints": [2, 1], "inverseBindMatrices": 3}],
        "animations": [{
            "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
            "samplers": [{"input": 4, "output": 5, "interpolation": way}],
        }],
        "accessors": [
            accessor(0, 5126, 4, "VEC3"), accessor(1, 5121, 4, "VEC4"), accessor(2, 5126, 4, "VEC4"),
            accessor(3, 5126, 2, "MAT4"), accessor(4, 5126, keys.len(), "SCALAR"),
            accessor(5, 5126, values.len(), "VEC4"),
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    (root, binary)
}

fn load_strip(way: &str, keys: &[f32]) -> Scene {
    let (root, binary) = strip(way, keys);
    load_glb(&root, &binary).unwrap()
}

/// Where the strip's corners are when its joint is turned by an angle.
fn bent(degrees: f64) -> [Vec3; 4] {
    let turn = DQuat::from_rotation_z(degrees.to_radians());
    let upper = |p: DVec3| DVec3::Y + turn * (p - DVec3::Y);
    let middle = 0.5 * (DVec3::Y + upper(DVec3::Y));
    [
        DVec3::ZERO,
        middle,
        upper(2.0 * DVec3::Y),
        upper(dvec3(1.0, 2.0, 0.0)),
    ]
    .map(DVec3::as_vec3)
}

fn assert_near(found: &[Vec3], expected: &[Vec3]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!(a.distance(*b) < 1e-6, "{found:?} is not {expected:?}");
    }
}

#[test]
fn linear_rotations_take_the_great_arc_and_clips_loop() {
    let scene = load_strip("LINEAR", &[0.0, 90.0, 0.0]);
    assert_eq!(scene.report.oddities(), []);
    assert_eq!(scene.rig.as_ref().unwrap().clips[0].duration_s, 2.0);
    for (time, degrees) in [
        (0.0, 0.0),
        (0.25, 22.5),
        (1.0, 90.0),
        (1.5, 45.0),
        (2.25, 22.5), // the second round
        (-0.5, 45.0), // and the one before the first
        (f64::NAN, 0.0),
        (f64::INFINITY, 0.0),
    ] {
        assert_near(&positions(&scene, time), &bent(degrees));
    }
    assert_near(&[vec3(-1.0, 1.0, 0.0)], &positions(&scene, 1.0)[2..3]);
    // 350 degrees are minus ten, and as quaternions nearer to zero with the other sign.
    let scene = load_strip("LINEAR", &[0.0, 350.0]);
    assert_near(&positions(&scene, 0.5), &bent(-5.0));
}

#[test]
fn steps_hold_and_splines_pass_through_their_keys() {
    let scene = load_strip("STEP", &[0.0, 90.0, 30.0, 0.0]);
    for (time, degrees) in [(0.0, 0.0), (0.999, 0.0), (1.0, 90.0), (2.5, 30.0)] {
        assert_near(&positions(&scene, time), &bent(degrees));
    }
    let scene = load_strip("CUBICSPLINE", &[0.0, 90.0, 0.0]);
    for (time, degrees) in [(0.0, 0.0), (1.0, 90.0), (0.5, 45.0), (1.5, 45.0)] {
        assert_near(&positions(&scene, time), &bent(degrees));
    }
    // With flat tangents it eases in: at a quarter, the spline of quaternions is at 0.15625.
    let a = DQuat::IDENTITY;
    let b = DQuat::from_rotation_z(90f64.to_radians());
    let value = (a * (1.0 - 0.15625) + b * 0.15625).normalize();
    let (_, degrees) = value.to_axis_angle();
    assert_near(&positions(&scene, 0.25), &bent(degrees.to_degrees()));
}

#[test]
fn a_clip_waits_for_its_first_key() {
    let (mut root, mut binary) = strip("LINEAR", &[90.0, 0.0]);
    let times = root["bufferViews"][4]["byteOffset"].as_u64().unwrap() as usize;
    binary[times..times + 8].copy_from_slice(&floats(&[0.5, 2.0]));
    let scene = load_glb(&root, &binary).unwrap();
    for (time, degrees) in [(0.0, 90.0), (0.4, 90.0), (1.25, 45.0), (2.1, 90.0)] {
        assert_near(&positions(&scene, time), &bent(degrees));
    }
    // Of several, the first plays.
    let other = root["animations"][0].clone();
    root["animations"] = json!([{"channels": [], "samplers": []}, other]);
    let scene = load_glb(&root, &binary).unwrap();
    let rig = scene.rig.as_ref().unwrap();
    assert_eq!((rig.clips.len(), &rig.playing[..]), (2, &[0][..]));
    assert_near(&positions(&scene, 0.4), &bent(0.0));
}

#[test]
fn joints_default_to_identity_and_rest_is_as_bound() {
    let (mut root, binary) = strip("LINEAR", &[0.0, 90.0]);
    let scene = load_glb(&root, &binary).unwrap();
    for joint in &scene.rest().skins[0] {
        assert_eq!(*joint, DAffine3::IDENTITY);
    }
    assert_near(&scene.soup().unwrap().positions, &bent(0.0));
    root["skins"][0]
        .as_object_mut()
        .unwrap()
        .remove("inverseBindMatrices");
    let scene = load_glb(&root, &binary).unwrap();
    let [first, second] = scene.rest().skins[0][..] else {
        panic!("not two joints")
    };
    assert_eq!(
        (first.translation, second.translation),
        (DVec3::ZERO, DVec3::Y)
    );
}

#[test]
fn the_man_walks_on_the_floor_and_stays_a_man() {
    let scene = man();
    assert_eq!(scene.report.oddities(), []);
    let (mesh, rig) = (&scene.meshes[0], scene.rig.as_ref().unwrap());
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (4672, 3273));
    assert_eq!((rig.nodes.len(), rig.skins[0].joints.len()), (22, 19));
    assert_eq!((rig.clips.len(), rig.clips[0].channels.len()), (1, 57));
    assert_eq!(rig.clips[0].duration_s, 2.0);
    for (joints, weights) in mesh.joints.iter().zip(&mesh.weights) {
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!(weights.iter().all(|w| *w >= 0.0));
        assert!(joints.iter().all(|j| *j < 19));
    }
    // The file's own pose is the one it was bound in: turned upright, he is 1.5065 m high and
    // 1.1383 m from hand to hand.
    let [low, high] = bounds(&scene.soup().unwrap().positions);
    assert!(
        (high - low).distance(vec3(1.13827, 1.50655, 0.31195)) < 2e-2,
        "{low} {high}"
    );
    let still = positions(&scene, 0.0);
    for step in 0..40 {
        let time = 0.05 * f64::from(step);
        let posed = positions(&scene, time);
        let [low, high] = bounds(&posed);
        assert!(low.y > -0.06 && low.y < 0.06, "{time}: feet at {}", low.y);
        assert!((1.4..1.6).contains(&high.y), "{time}: head at {}", high.y);
        assert!((high - low).max_element() < 1.6, "{time}: {low} {high}");
        let furthest = posed.iter().zip(&still).map(|(a, b)| a.distance(*b));
        let furthest = furthest.fold(0.0, f32::max);
        assert!(step == 0 || furthest > 0.01, "{time}: he stands still");
        // A skin neither tears nor folds: no edge grows by much.
        for t in &mesh.triangles {
            for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
                let [now, then] =
                    [&posed, &mesh.positions].map(|p| p[a as usize].distance(p[b as usize]));
                assert!(
                    now < 3.0 * then + 0.04,
                    "{time}: an edge of {then} m is {now} m"
                );
            }
        }
        let again = positions(&scene, time + 2.0 * 7.0);
        let apart = posed.iter().zip(&again).map(|(a, b)| a.distance(*b));
        assert!(apart.fold(0.0, f32::max) < 1e-5);
    }
}

#[test]
fn normals_turn_with_the_skin() {
    let scene = man();
    let time = 0.7;
    let posed = scene.posed(time);
    let mut soup = scene.soup_posed(&posed, None).unwrap();
    let along = soup.triangles.iter().zip(&soup.normals).filter(|(t, n)| {
        let [a, b, c] = t.map(|v| soup.positions[v as usize]);
        let face = (b - a).cross(c - a).normalize_or_zero();
        face.dot(n[0] + n[1] + n[2]) > 0.0
    });
    assert!(along.count() > 4600);
    assert!(
        soup.normals
            .iter()
            .flatten()
            .all(|n| (n.length() - 1.0).abs() < 1e-3)
    );
    let anew = scene.soup_posed(&scene.posed(1.3), None).unwrap();
    assert_ne!(soup, anew);
    soup.repose(&scene, &scene.posed(1.3), [(0, 0..4672)].into_iter());
    assert_eq!(soup, anew);
}

#[test]
fn actors_stand_turn_and_walk_where_they_are_put() {
    let mut scene = umbrage_scene::open("gen:field?n=8&lights=2", &()).unwrap();
    let triangles = scene.soup().unwrap().triangles.len();
    let placement = Placement {
        at: dvec3(100.0, 3.0, 50.0),
        turn_rad: std::f64::consts::FRAC_PI_2,
        scale: 2.0,
        speed: 1.5,
    };
    scene.place(man(), &placement);
    scene.place(man(), &Placement::default());
    let moving = scene.moving();
    assert_eq!(moving.iter().filter(|m| **m).count(), 2);
    let [low, high] = [0.0, 4.0].map(|time| {
        let soup = scene.soup_posed(&scene.posed(time), None).unwrap();
        assert_eq!(soup.triangles.len(), triangles + 2 * 4672);
        assert_eq!(soup.origin, DVec3::ZERO);
        let range = &soup.vertices[scene.instances.len() - 2];
        let [low, high] = bounds(&soup.positions[range.start as usize..range.end as usize]);
        assert!((low.y - 3.0).abs() < 0.1 && (2.8..3.2).contains(&(high.y - low.y)));
        0.5 * (low + high)
    });
    // Turned by a quarter about +Y, his front, +Z, is +X: six metres on after two rounds.
    assert!(
        (high - low).distance(vec3(6.0, 0.0, 0.0)) < 1e-4,
        "{low} {high}"
    );
    let materials = scene.soup().unwrap().material;
    assert!(
        materials
            .iter()
            .all(|m| (*m as usize) < scene.materials.len())
    );
    // Without a rig of its own a scene moves as one piece.
    let mut field = umbrage_scene::open("gen:field?n=2&lights=0", &()).unwrap();
    let other = umbrage_scene::open("gen:field?n=2&lights=0", &()).unwrap();
    field.place(other, &placement);
    assert_eq!(field.moving(), [false, true]);
    let posed = field.posed(2.0);
    let at = posed.transform(&field.instances[1]).translation;
    assert!(at.distance(dvec3(103.0, 3.0, 50.0)) < 1e-12);
    assert!(matches!(
        field.rig.as_ref().unwrap().nodes[0].local,
        Local::Parts(_)
    ));
}

#[test]
fn lights_and_cameras_follow_their_nodes() {
    let (mut root, binary) = strip("LINEAR", &[0.0, 90.0]);
    root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot"}]}});
    root["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    let light = json!({"KHR_lights_punctual": {"light": 0}});
    root["nodes"][1]["children"] = json!([3]);
    let below = json!({"translation": [1, 0, 0], "extensions": light, "camera": 0});
    root["nodes"].as_array_mut().unwrap().push(below);
    let mut scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.lights[0].position, dvec3(1.0, 1.0, 0.0));
    scene.follow(&scene.posed(0.999_999_9));
    assert!(scene.lights[0].position.distance(dvec3(0.0, 2.0, 0.0)) < 1e-5);
    assert!(scene.lights[0].direction.distance(DVec3::NEG_Z) < 1e-5);
    assert!(scene.cameras[0].up.distance(DVec3::NEG_X) < 1e-5);
    scene.follow(&scene.posed(0.0));
    assert!(scene.lights[0].position.distance(dvec3(1.0, 1.0, 0.0)) < 1e-9);
}

#[test]
fn references_that_lead_nowhere_are_refused_by_name() {
    let (good, binary) = strip("LINEAR", &[0.0, 90.0]);
    for (pointer, value, named) in [
        ("/nodes/0/skin", json!(3), "node strip"),
        ("/skins/0/joints/1", json!(9), "skin 0"),
        ("/skins/0/joints", json!([2]), "mesh 0 (strip)"),
        ("/skins/0/inverseBindMatrices", json!(77), "skin 0"),
        ("/animations/0/channels/0/sampler", json!(1), "animation 0"),
        (
            "/animations/0/channels/0/target/node",
            json!(5),
            "animation 0",
        ),
        ("/animations/0/samplers/0/input", json!(50), "animation 0"),
        ("/animations/0/samplers/0/output", json!(50), "animation 0"),
        (
            "/meshes/0/primitives/0/attributes/JOINTS_0",
            json!(99),
            "primitive 0",
        ),
    ] {
        let mut root = good.clone();
        *root.pointer_mut(pointer).unwrap() = value;
        let error = load_glb(&root, &binary).unwrap_err();
        assert!(
            matches!(error, SceneError::Dangling { .. }),
            "{pointer}: {error}"
        );
        assert!(error.to_string().contains(named), "{pointer}: {error}");
    }
    let mut few = good.clone();
    few["accessors"][3]["count"] = json!(1);
    let error = load_glb(&few, &binary).unwrap_err();
    assert!(matches!(error, SceneError::Skin { .. }), "{error}");
}

#[test]
fn what_cannot_be_followed_is_left_out_and_counted() {
    let (good, binary) = strip("LINEAR", &[0.0, 90.0]);
    let load = |pointer: &str, value: Value| {
        let mut root = good.clone();
        *root.pointer_mut(pointer).unwrap() = value;
        load_glb(&root, &binary).unwrap()
    };
    let channel = "/animations/0/channels/0/target/path";
    assert_eq!(load(channel, json!("weights")).report.skipped_channels, 1);
    for (pointer, value) in [
        ("/accessors/5/type", json!("VEC3")),
        ("/accessors/5/count", json!(1)),
        ("/accessors/4/count", json!(1000)),
        ("/animations/0/samplers/0/interpolation", json!("BOUNCY")),
        (
            "/animations/0/samplers/0/interpolation",
            json!("CUBICSPLINE"),
        ),
        ("/animations/0/samplers/0/input", json!(0)),
        (
            "/nodes/1",
            json!({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,1,0,1]}),
        ),
    ] {
        let scene = load(pointer, value);
        assert_eq!(scene.report.skipped_channels, 1, "{pointer}");
        assert_near(&positions(&scene, 0.9), &bent(0.0));
    }
    let scene = load("/accessors/1/componentType", json!(5126));
    let report = &scene.report;
    assert_eq!((report.dropped_attributes, report.ignored_skins), (1, 1));
    assert_eq!(positions(&scene, 0.0)[0], Vec3::splat(7.0)); // where its own node puts it
    let scene = load("/scenes/0/nodes", json!([0]));
    assert_eq!(scene.report.ignored_skins, 1);
}

/// JSON that lacks what glTF demands costs the animation that it is in, or all skins, and nothing
/// else.
#[test]
fn one_broken_animation_costs_itself_and_a_broken_skin_the_skins() {
    let (mut root, binary) = strip("LINEAR", &[0.0, 90.0]);
    let good = root["animations"][0].clone();
    let mut broken = good.clone();
    broken["samplers"][0]
        .as_object_mut()
        .unwrap()
        .remove("input");
    root["animations"] = json!([broken, good]);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.report.oddities(), [("skipped_rigs", 1)]);
    assert!(scene.report.notes[0].contains("1 animations"));
    assert_near(&positions(&scene, 0.5), &bent(45.0));

    root["animations"].as_array_mut().unwrap().truncate(1);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.rig.as_ref().unwrap().skins.len(), 1);
    assert_near(&positions(&scene, 0.9), &bent(0.0));

    root["skins"][0]["joints"] = json!("all");
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.report.skipped_rigs, 2);
    assert_eq!(positions(&scene, 0.0)[0], Vec3::splat(7.0));

    // What is broken elsewhere is an error as before.
    root["meshes"] = json!(3);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::Json { .. })
    ));
}

#[test]
fn an_actors_oddities_are_the_scenes() {
    let (mut root, binary) = strip("LINEAR", &[0.0, 90.0]);
    root["animations"][0]["samplers"][0] = json!({"output": 5});
    let odd = load_glb(&root, &binary).unwrap();
    let mut scene = umbrage_scene::open("gen:field?n=2&lights=0", &()).unwrap();
    scene.place(odd, &Placement::default());
    assert_eq!(scene.report.oddities(), [("skipped_rigs", 1)]);
}

/// What grows from nothing shows its front once it is there, mirrored or not.
#[test]
fn what_has_no_size_at_rest_is_wound_as_it_first_has_one() {
    let (mut root, mut binary) = strip("LINEAR", &[0.0; 3]);
    let output = root["bufferViews"][5]["byteOffset"].as_u64().unwrap() as usize;
    root["nodes"] = json!([{"mesh": 0, "scale": [0, 0, 0]}]);
    root["scenes"][0]["nodes"] = json!([0]);
    root["skins"] = json!([]);
    root["animations"][0]["channels"][0]["target"] = json!({"node": 0, "path": "scale"});
    root["accessors"][5]["type"] = json!("VEC3");
    for x in [1.0f32, -1.0] {
        // Nothing, still nothing, and then something.
        let keys = [[0.0; 3], [0.0; 3], [x, 1.0, 1.0]];
        binary[output..output + 36].copy_from_slice(&floats(keys.as_flattened()));
        let scene = load_glb(&root, &binary).unwrap();
        let mut soup = scene.soup().unwrap();
        soup.repose(&scene, &scene.posed(1.75), std::iter::once((0, 0..2)));
        let [a, b, c] = soup.triangles[0].map(|v| soup.positions[v as usize]);
        let front = (b - a).cross(c - a).z;
        // As it would be without a mirror: the strip's first triangle has its corners on one line.
        let [d, e, f] = soup.triangles[1].map(|v| soup.positions[v as usize]);
        let other = (e - d).cross(f - d).z;
        assert_eq!(front, 0.0);
        assert!(other > 0.0, "{x}: {other}");
    }
}

#[test]
fn of_many_joints_the_four_heaviest_stay() {
    let (mut root, mut binary) = strip("LINEAR", &[0.0, 90.0]);
    let start = binary.len();
    binary.extend([[1u8, 0, 1, 0]; 4].concat());
    binary.extend([[255u8, 0, 102, 51]; 4].concat());
    root["buffers"][0]["byteLength"] = json!(binary.len());
    for (i, normalized) in [(0, false), (1, true)] {
        let view = json!({"buffer": 0, "byteOffset": start + 16 * i, "byteLength": 16});
        root["bufferViews"].as_array_mut().unwrap().push(view);
        let accessor = json!({"bufferView": 6 + i, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": normalized});
        root["accessors"].as_array_mut().unwrap().push(accessor);
    }
    let attributes = &mut root["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = json!(6);
    attributes["WEIGHTS_1"] = json!(7);
    let scene = load_glb(&root, &binary).unwrap();
    let mesh = &scene.meshes[0];
    // The second vertex follows 0.5, 0.5, 1, 0.4 and 0.2: the last is lost, and the sum is 2.4.
    assert_eq!(mesh.joints[1], [1, 0, 1, 1]);
    let expected = [1.0, 0.5, 0.5, 0.4].map(|w: f32| w / 2.4);
    for (a, b) in mesh.weights[1].iter().zip(expected) {
        assert!((a - b).abs() < 1e-6, "{:?}", mesh.weights[1]);
    }
    assert_eq!(scene.report.dropped_influences, 1);
    assert_eq!(scene.report.repaired_weights, 4);
}

/// Every file with one byte changed is a scene or an error, never a panic, at any time.
#[test]
fn damaged_rigs_do_no_harm() {
    let (root, binary) = strip("CUBICSPLINE", &[0.0, 90.0, 45.0]);
    let whole = container(&root, &binary);
    let folder = common::Folder::new();
    let mut seed = 1u64;
    for round in 0..1500 {
        let mut bytes = whole.clone();
        for _ in 0..=round % 3 {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(99);
            let at = 20 + (seed >> 33) as usize % (bytes.len() - 20);
            bytes[at] = match seed >> 60 {
                0..8 => b'0' + (seed >> 40) as u8 % 10,
                _ => (seed >> 40) as u8,
            };
        }
        let path = folder.file("damaged.glb", &bytes);
        if let Ok(scene) = umbrage_scene::load(&path, &()) {
            let _ = scene.soup();
            let _ = scene.soup_posed(&scene.posed(0.7), None);
        }
    }
}
