//! Files that claim more than they hold: memory is bounded by what is really there.

mod common;

use std::cell::Cell;
use std::path::Path;

use common::{Folder, TRIANGLE, load_glb, load_text, one_primitive};
use serde_json::{Value, json};
use umbrage_scene::{Disk, Files, LightKind, Scene, SceneError, light_file};

/// A file of one triangle whose material shows the image in `encoded`.
fn with_image(encoded: &[u8], copies: usize) -> (Value, Vec<u8>) {
    let (mut root, mut binary) = one_primitive(&TRIANGLE, 4);
    let view = json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": encoded.len()});
    binary.extend(encoded);
    root["buffers"][0]["byteLength"] = json!(binary.len());
    root["bufferViews"].as_array_mut().unwrap().push(view);
    let each = |item: fn(usize) -> Value| Value::Array((0..copies).map(item).collect());
    root["images"] = each(|_| json!({"bufferView": 1}));
    root["textures"] = each(|i| json!({"source": i}));
    root["materials"] =
        each(|i| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}));
    (root, binary)
}

/// A black PNG, whose pixels deflate to a thousandth.
fn png(side: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    let row = side.div_ceil(8) as usize;
    writer
        .write_image_data(&vec![0; row * side as usize])
        .unwrap();
    drop(writer);
    bytes
}

fn pixels(scene: &Scene) -> Vec<usize> {
    scene
        .images
        .iter()
        .map(|image| image.rgba8.len() / 4)
        .collect()
}

#[test]
fn an_image_that_claims_more_than_its_bytes_is_left_out() {
    let whole = png(64);
    let (root, binary) = with_image(&whole, 1);
    assert_eq!(pixels(&load_glb(&root, &binary).unwrap()), [64 * 64]);
    // Width and height in the header; its checksum is not asked before its size is.
    let mut claims = whole.clone();
    claims[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let (root, binary) = with_image(&claims, 1);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.report.unreadable_images, 1);
    assert!(scene.images.is_empty());
}

#[test]
fn a_bomb_is_left_out_and_many_small_ones_meet_the_limit() {
    let (root, binary) = with_image(&png(8200), 1);
    assert!(binary.len() < 100_000);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        (pixels(&scene), scene.report.unreadable_images),
        (vec![], 1)
    );
    // 2^22 pixels each, of which 2^26 are allowed.
    let (root, binary) = with_image(&png(2048), 20);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        (pixels(&scene).len(), scene.report.unreadable_images),
        (16, 4)
    );
}

#[test]
fn a_mesh_placed_again_and_again_meets_the_budget() {
    let points: Vec<f32> = TRIANGLE.iter().copied().cycle().take(9 * 4000).collect();
    let (mut root, binary) = one_primitive(&points, 4);
    let place = |times: usize, root: &mut Value| {
        root["nodes"] = Value::Array(vec![json!({"mesh": 0}); times]);
        root["scenes"][0]["nodes"] = Value::Array((0..times).map(|n| json!(n)).collect());
    };
    place(1000, &mut root);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.soup().unwrap().triangles.len(), 4_000_000);
    place(20_000, &mut root);
    let error = load_glb(&root, &binary).unwrap_err();
    assert!(matches!(error, SceneError::TooLarge { .. }));
    let message = error.to_string();
    assert!(
        message.contains("instance") && message.contains("test.glb"),
        "{message}"
    );
}

#[test]
fn a_sparse_accessor_without_data_meets_the_budget() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["bufferViews"] = json!([{"buffer": 0, "byteLength": 4}, {"buffer": 0, "byteLength": 12}]);
    let sparse = |count: u64, of: u64| {
        json!({"componentType": 5126, "type": "VEC3", "count": of, "sparse": {"count": count,
            "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 1}}})
    };
    root["accessors"][0] = sparse(1, 3);
    assert!(load_glb(&root, &binary).is_ok());
    root["accessors"][0] = sparse(1, 1 << 40);
    let error = load_glb(&root, &binary).unwrap_err();
    assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
    for count in [2, 1 << 40, u64::MAX] {
        root["accessors"][0] = sparse(count, 3);
        let error = load_glb(&root, &binary).unwrap_err();
        assert!(matches!(error, SceneError::Accessor { .. }), "{error}");
    }
}

/// Counts what is read of a scene and of one file beside it.
struct Counting<'a> {
    scene: &'a [u8],
    beside: &'a [u8],
    read: Cell<usize>,
}

impl Files for Counting<'_> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError> {
        if path.file_stem().is_some_and(|stem| stem == "scene") {
            return Ok(self.scene.to_vec());
        }
        assert!(path.starts_with("folder"), "{path:?}");
        self.read.set(self.read.get() + 1);
        Ok(self.beside.to_vec())
    }
}

#[test]
fn a_file_is_read_once_however_it_is_spelled() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    let uris = [
        "a.bin",
        "./a.bin",
        "%61.bin",
        "x/../a.bin",
        "././y/.././a.bin",
    ];
    let buffers = uris.iter().cycle().take(1000);
    root["buffers"] = buffers
        .map(|uri| json!({"uri": uri, "byteLength": 36}))
        .collect();
    let scene = root.to_string().into_bytes();
    let files = |scene, beside| Counting {
        scene,
        beside,
        read: Cell::new(0),
    };
    let counting = files(&scene, &binary);
    umbrage_scene::load_from(Path::new("folder/scene.gltf"), &counting, &()).unwrap();
    assert_eq!(counting.read.get(), 1);

    let libraries: String = (0..100)
        .map(|n| format!("mtllib {}a.mtl\n", "./".repeat(n)))
        .collect();
    let counting = files(libraries.as_bytes(), b"newmtl a\nKd 1 0 0\n");
    let path = Path::new("folder/scene.obj");
    let scene = umbrage_scene::load_from(path, &counting, &()).unwrap();
    assert_eq!((counting.read.get(), scene.materials.len()), (1, 1));
}

#[test]
fn a_polygon_of_a_hundred_thousand_corners_has_no_busy_vertex() {
    let corners = 100_000;
    let place = |i: usize| (i as f64 / corners as f64 * std::f64::consts::TAU).sin_cos();
    let vertices = (0..corners).map(|i| format!("v {} {} 0\n", place(i).1, place(i).0));
    let face = (1..=corners).map(|i| format!(" {i}"));
    let text: String = vertices.chain(["f".to_owned()]).chain(face).collect();
    let scene = load_text("a.obj", &text).unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), corners - 2);
    assert_eq!(scene.meshes[0].positions.len(), corners);
    let mut busy = vec![0; corners];
    let corners = scene.meshes[0].triangles.iter().flatten();
    corners.for_each(|&v| busy[v as usize] += 1);
    assert!(busy.into_iter().all(|triangles| triangles <= 40));
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| scene.meshes[0].positions[v as usize].as_dvec3());
        (b - a).cross(c - a).z * 0.5
    };
    let area: f64 = scene.meshes[0].triangles.iter().map(area).sum();
    assert!((area - std::f64::consts::PI).abs() < 1e-3, "{area}");
}

#[test]
fn empty_files_and_folders_say_what_they_are() {
    let folder = Folder::new();
    let load = |path: &Path| umbrage_scene::load(path, &());
    let empty = load(&folder.file("a.glb", b""));
    assert!(matches!(empty, Err(SceneError::Container { .. })));
    let empty = load(&folder.file("a.gltf", b""));
    assert!(matches!(empty, Err(SceneError::Json { .. })));
    let scene = load(&folder.file("a.obj", b"")).unwrap();
    assert_eq!(scene.soup().unwrap().triangles.len(), 0);
    let directory = folder.path().join("folder.glb");
    std::fs::create_dir(&directory).unwrap();
    assert!(matches!(load(&directory), Err(SceneError::NotAFile { .. })));
    assert!(matches!(
        light_file::read(&directory, &Disk),
        Err(SceneError::NotAFile { .. })
    ));
    let odd = folder.file("\u{fc} %20 #'\".obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
    assert_eq!(load(&odd).unwrap().meshes[0].triangles.len(), 1);
}

#[test]
fn lights_out_of_bounds_are_clamped_and_counted() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    let mut load = |light: Value| {
        root["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
        let scene = load_glb(&root, &binary).unwrap();
        (scene.lights[0].clone(), scene.report.repaired_lights)
    };
    for range in [json!(0), json!(-1), json!(-0.0), json!(1e39)] {
        let (light, repaired) = load(json!({"type": "point", "range": range}));
        assert_eq!((light.range, repaired), (None, 1), "{range}");
    }
    for (intensity, kept) in [(-1.0, 0.0), (1e39, f32::MAX), (-1e39, 0.0)] {
        let (light, repaired) = load(json!({"type": "point", "intensity": intensity}));
        assert_eq!((light.intensity, repaired), (kept, 1));
    }
    let zero = load(json!({"type": "point", "intensity": 0}));
    assert_eq!((zero.0.intensity, zero.1), (0.0, 0));
    for cone in [[0.5, 0.5], [0.0, 1e39], [-1.0, -2.0], [7.0, 0.3]] {
        let [inner, outer] = cone;
        let spot = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        let (light, repaired) = load(json!({"type": "spot", "spot": spot}));
        let LightKind::Spot {
            inner_rad,
            outer_rad,
        } = light.kind
        else {
            panic!("{light:?}")
        };
        assert!(0.0 <= inner_rad && inner_rad < outer_rad && outer_rad < 1.6);
        assert!(repaired > 0, "{cone:?}");
    }
}

#[test]
fn a_light_file_repairs_nothing() {
    let folder = Folder::new();
    for (key, value) in [
        ("range", "0"),
        ("range", "-1"),
        ("range", "1e39"),
        ("intensity", "-1"),
        ("intensity", "1e39"),
        ("color", "[2, 0, 0]"),
        ("position", "[1e39, 0, 0]"),
        ("direction", "[0, 0, 0]"),
        ("outer_deg", "91"),
        ("inner_deg", "45"),
    ] {
        let mut light = json!({"name": "lamp", "type": "spot", "position": [0, 0, 0],
            "direction": [0, -1, 0]});
        let read = |light: &Value| {
            let file = folder.file("lights.json", json!([light]).to_string().as_bytes());
            light_file::read(&file, &Disk)
        };
        assert_eq!(read(&light).unwrap().len(), 1);
        light[key] = serde_json::from_str(value).unwrap();
        let message = read(&light).unwrap_err().to_string();
        for part in [
            "lights.json",
            "light 0 (\"lamp\")",
            key,
            "correct the light file",
        ] {
            assert!(message.contains(part), "{message}");
        }
    }
    let text = r#"[{"type": "directional", "direction": [1e300, 0, 0]}]"#;
    let lights = light_file::read(&folder.file("far.json", text.as_bytes()), &Disk).unwrap();
    assert_eq!(lights[0].direction, glam::DVec3::X);
}
