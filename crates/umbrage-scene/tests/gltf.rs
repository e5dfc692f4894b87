//! glTF files: what is read, what is repaired, what is refused and why.

mod common;

use common::{Folder, TRIANGLE, container, floats, load_glb, load_text, one_primitive};
use glam::{DVec3, Vec3, vec3};
use serde_json::{Value, json};
use umbrage_scene::{LightKind, SceneError};

/// Points of a zigzag of four triangles whose first faces +Z.
const STRIP: [f32; 18] = [
    0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 2.0, 0.0,
];

fn normals_z(root: &Value, binary: &[u8]) -> Vec<f32> {
    let soup = load_glb(root, binary).unwrap().soup().unwrap();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| soup.positions[v as usize]);
        (b - a).cross(c - a).z
    };
    soup.triangles.iter().map(normal).collect()
}

#[test]
fn strips_and_fans_keep_the_winding_of_their_first_triangle() {
    let (root, binary) = one_primitive(&STRIP, 5);
    assert_eq!(normals_z(&root, &binary), [1.0; 4]);
    let fan = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let (root, binary) = one_primitive(&fan, 6);
    assert_eq!(normals_z(&root, &binary), [1.0; 2]);
}

#[test]
fn points_and_lines_are_skipped_and_counted() {
    for mode in 0..4 {
        let (root, binary) = one_primitive(&STRIP, mode);
        let scene = load_glb(&root, &binary).unwrap();
        assert_eq!(
            (
                scene.meshes[0].triangles.len(),
                scene.report.skipped_primitives
            ),
            (0, 1)
        );
    }
    let (root, binary) = one_primitive(&STRIP, 7);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::Primitive { .. })
    ));
}

#[test]
fn a_mirrored_node_flips_the_winding_and_keeps_the_front() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["nodes"][0]["scale"] = json!([-1, 1, 1]);
    assert_eq!(normals_z(&root, &binary), [1.0]);
    root["nodes"][0]["scale"] = json!([-1, -1, 1]);
    assert_eq!(normals_z(&root, &binary), [1.0]);
    root["nodes"][0]["scale"] = json!([1, 1, -1]); // the mirror image faces the other way
    assert_eq!(normals_z(&root, &binary), [-1.0]);
    root["nodes"][0]["scale"] = json!([1, 0, 1]);
    assert_eq!(normals_z(&root, &binary), [0.0]);
}

#[test]
fn transforms_compose_in_f64_from_parent_to_child() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["scenes"] = json!([{"nodes": [1]}]);
    root["nodes"] = json!([
        {"mesh": 0, "translation": [0.001, 0, 0]},
        {"children": [0], "translation": [1e7, 0, 0], "rotation": [0, 0, 0, 1]},
    ]);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.instances[0].transform.translation.x, 1e7 + 0.001);
    let soup = scene.soup().unwrap();
    assert_eq!(
        soup.origin,
        DVec3::new(1e7, 0.0, 0.0) + DVec3::new(1.0, 1.0, 0.0)
    );
    let x = f64::from(soup.positions[0].x) + soup.origin.x;
    assert!((x - 1e7 - 0.001).abs() < 1e-7, "{x}");
}

#[test]
fn cycles_and_shared_children_are_refused() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["nodes"] = json!([{"children": [1]}, {"name": "loop", "children": [0]}]);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::NodeTwice { node: 0, .. })
    ));
    root["nodes"] = json!([{"children": [1, 1]}, {"mesh": 0}]);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::NodeTwice { node: 1, .. })
    ));
}

#[test]
fn a_deep_chain_of_nodes_does_not_overflow_the_stack() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    let depth = 200_000;
    let mut nodes: Vec<Value> = (1..depth).map(|n| json!({"children": [n]})).collect();
    nodes.push(json!({"mesh": 0, "name": "deepest"}));
    root["nodes"] = Value::Array(nodes);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        (scene.report.nodes, scene.instances[0].name.as_str()),
        (depth, "deepest")
    );
}

#[test]
fn a_count_beyond_the_data_is_refused_before_allocation() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    for count in [4u64, 1 << 40, u64::MAX] {
        root["accessors"][0]["count"] = json!(count);
        assert!(matches!(
            load_glb(&root, &binary),
            Err(SceneError::Accessor { accessor: 0, .. })
        ));
    }
    // Without a buffer view the elements are zeros, and only the budget bounds them.
    root["accessors"][0]
        .as_object_mut()
        .unwrap()
        .remove("bufferView");
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::TooLarge { .. })
    ));
    root["accessors"][0]["count"] = json!(3);
    assert_eq!(
        load_glb(&root, &binary).unwrap().meshes[0].positions,
        [Vec3::ZERO; 3]
    );
}

#[test]
fn geometry_named_again_and_again_meets_the_budget() {
    let points: Vec<f32> = TRIANGLE.iter().copied().cycle().take(9 * 4000).collect();
    let (mut root, binary) = one_primitive(&points, 4);
    let mesh = root["meshes"][0].clone();
    root["meshes"] = Value::Array(vec![mesh; 6000]);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::TooLarge { .. })
    ));
}

#[test]
fn an_index_out_of_range_names_mesh_and_primitive() {
    let (mut root, mut binary) = one_primitive(&TRIANGLE, 4);
    binary.extend([0, 1, 3, 0]);
    root["meshes"][0]["primitives"][0]["indices"] = json!(1);
    root["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"}));
    let views = root["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 36, "byteLength": 3}));
    root["buffers"][0]["byteLength"] = json!(40);
    let error = load_glb(&root, &binary).unwrap_err().to_string();
    assert!(
        error.contains("shape") && error.contains("index 2 names vertex 3"),
        "{error}"
    );
    binary[38] = 2;
    assert_eq!(
        load_glb(&root, &binary).unwrap().meshes[0].triangles,
        [[0, 1, 2]]
    );
}

#[test]
fn sparse_values_replace_those_they_name() {
    let (mut root, mut binary) = one_primitive(&TRIANGLE, 4);
    binary.extend([2, 0, 0, 0]);
    binary.extend(floats(&[0.0, 5.0, 0.0]));
    let views = root["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 36, "byteLength": 1}));
    views.push(json!({"buffer": 0, "byteOffset": 40, "byteLength": 12}));
    root["buffers"][0]["byteLength"] = json!(52);
    root["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2},
    });
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        scene.meshes[0].positions,
        [Vec3::ZERO, Vec3::X, vec3(0.0, 5.0, 0.0)]
    );
    binary[36] = 3;
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::Accessor { .. })
    ));
}

#[test]
fn interleaved_and_quantized_positions_are_read() {
    let mut binary = Vec::new();
    for corner in [[0i16, 0, 0], [32767, 0, 0], [0, 32767, 0]] {
        binary.extend(corner.iter().flat_map(|c| c.to_le_bytes()));
        binary.extend([0xAA; 6]); // something else between
    }
    let (mut root, _) = one_primitive(&TRIANGLE, 4);
    root["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    root["accessors"][0]["componentType"] = json!(5122);
    root["accessors"][0]["normalized"] = json!(true);
    root["bufferViews"][0] = json!({"buffer": 0, "byteLength": 36, "byteStride": 12});
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    root["bufferViews"][0]["byteStride"] = json!(2);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::Accessor { .. })
    ));
}

#[test]
fn a_position_that_is_not_finite_names_its_vertex() {
    let mut points = TRIANGLE;
    points[4] = f32::NAN;
    let (root, binary) = one_primitive(&points, 4);
    let error = load_glb(&root, &binary);
    assert!(matches!(
        error,
        Err(SceneError::NonFiniteVertex { vertex: 1, .. })
    ));
}

#[test]
fn lights_travel_along_minus_z_of_their_node() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    root["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4]}]);
    let node = |light: u32| json!({"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": light}}});
    root["nodes"] = json!([{"mesh": 0}, node(0), node(1), node(2), node(3)]);
    root["nodes"][1]["rotation"] = json!([-half, 0, 0, half]); // -Z turned to -Y
    root["nodes"][1]["translation"] = json!([1e6, 2, 3]);
    root["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "range": 0, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
        {"type": "point", "intensity": -3, "color": [2, 0, 0]},
        {"type": "directional"},
        {"type": "area"},
    ]}});
    let scene = load_glb(&root, &binary).unwrap();
    let names: Vec<&str> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["lamp", "lamp_2", "lamp_3"]);
    let spot = &scene.lights[0];
    assert!((spot.direction - DVec3::NEG_Y).length() < 1e-15);
    assert_eq!(spot.position, DVec3::new(1e6, 2.0, 3.0));
    assert_eq!(spot.range, None);
    assert_eq!(
        spot.kind,
        LightKind::Spot {
            inner_rad: 0.2,
            outer_rad: 0.4
        }
    );
    assert_eq!(
        (scene.lights[1].intensity, scene.lights[1].color),
        (0.0, Vec3::X)
    );
    assert_eq!(scene.lights[2].direction, DVec3::NEG_Z);
    let report = &scene.report;
    assert_eq!(
        (
            report.skipped_lights,
            report.renamed_lights,
            report.repaired_lights
        ),
        (1, 2, 3)
    );
}

#[test]
fn only_nodes_of_the_default_scene_are_loaded() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["nodes"] = json!([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}]);
    root["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    root["scene"] = json!(1);
    assert_eq!(load_glb(&root, &binary).unwrap().instances[0].name, "b");
    root.as_object_mut().unwrap().remove("scene");
    assert_eq!(load_glb(&root, &binary).unwrap().instances[0].name, "a");
    root.as_object_mut().unwrap().remove("scenes");
    assert_eq!(load_glb(&root, &binary).unwrap().instances.len(), 2);
    root["scene"] = json!(7);
    root["scenes"] = json!([{}]);
    assert!(matches!(
        load_glb(&root, &binary),
        Err(SceneError::Dangling { index: 7, .. })
    ));
}

#[test]
fn required_extensions_that_change_geometry_are_refused_by_name() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    for name in [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "EXT_mesh_gpu_instancing",
    ] {
        root["extensionsRequired"] = json!([name]);
        let error = load_glb(&root, &binary).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
    root["extensionsRequired"] = json!(["KHR_lights_punctual", "KHR_materials_unlit"]);
    assert!(load_glb(&root, &binary).is_ok());
}

#[test]
fn buffers_may_be_data_or_files_beside_the_scene_and_must_be_whole() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    let folder = Folder::new();
    folder.file("a b.bin", &binary);
    root["buffers"][0]["uri"] = json!("a%20b.bin");
    let load = |root: &Value| {
        umbrage_scene::load(&folder.file("test.gltf", root.to_string().as_bytes()), &())
    };
    assert_eq!(load(&root).unwrap().meshes[0].positions[1], Vec3::X);
    for (uri, length) in [
        ("a%20b.bin", 37),
        ("gone.bin", 36),
        ("/dev/zero", 36),
        ("https://x.org/b", 36),
        (".", 36),
    ] {
        root["buffers"][0] = json!({"uri": uri, "byteLength": length});
        assert!(
            matches!(load(&root), Err(SceneError::Buffer { buffer: 0, .. })),
            "{uri}"
        );
    }
    let zeros = "A".repeat(48);
    root["buffers"][0] =
        json!({"uri": format!("data:application/octet-stream;base64,{zeros}"), "byteLength": 36});
    assert_eq!(load(&root).unwrap().meshes[0].positions, [Vec3::ZERO; 3]);
}

#[test]
fn missing_images_are_counted_and_orthographic_cameras_skipped() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    root["textures"] = json!([{"source": 0}]);
    root["images"] = json!([{"uri": "gone.png"}]);
    root["cameras"] = json!([{"type": "orthographic"}, {"perspective": {"yfov": 1.0}}]);
    root["nodes"] = json!([{"mesh": 0, "camera": 0, "children": [1]}, {"camera": 1}]);
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        (scene.report.missing_images, scene.report.skipped_cameras),
        (1, 1)
    );
    assert_eq!(scene.materials[0].base_color_image, None);
    assert_eq!(
        (scene.cameras.len(), scene.cameras[0].forward),
        (1, DVec3::NEG_Z)
    );
}

/// Every file cut short at every length, and with every byte replaced, gives a scene or an error.
#[test]
fn damaged_files_never_panic() {
    let (root, binary) = one_primitive(&TRIANGLE, 5);
    let whole = container(&root, &binary);
    let folder = Folder::new();
    for length in 0..whole.len() {
        assert!(umbrage_scene::load(&folder.file("cut.glb", &whole[..length]), &()).is_err());
    }
    for at in 0..whole.len() {
        for value in [0, b'9', b'"', 0xFF] {
            let mut damaged = whole.clone();
            damaged[at] = value;
            let scene = umbrage_scene::load(&folder.file("damaged.glb", &damaged), &());
            let _ = scene.and_then(|scene| scene.soup());
        }
    }
}

#[test]
fn other_versions_and_formats_are_refused_with_the_remedy() {
    let old = load_text("old.gltf", r#"{"asset": {"version": "1.0"}}"#);
    assert!(matches!(old, Err(SceneError::Version { .. })));
    let error = load_text("scene.fbx", "").unwrap_err().to_string();
    assert!(error.contains(".glb, .gltf and .obj"), "{error}");
    assert!(matches!(
        load_text("list.gltf", &"[".repeat(100_000)),
        Err(SceneError::Json { .. })
    ));
}

#[test]
fn chunks_of_unknown_type_are_skipped_and_lengths_are_not_trusted() {
    let (root, binary) = one_primitive(&TRIANGLE, 4);
    let whole = container(&root, &binary);
    let folder = Folder::new();
    let load = |bytes: &[u8]| umbrage_scene::load(&folder.file("chunks.glb", bytes), &());
    let at = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    for at in [at, whole.len()] {
        let mut more = whole.clone();
        more.splice(at..at, *b"\x04\0\0\0MOREabcd");
        let length = more.len() as u32;
        more[8..12].copy_from_slice(&length.to_le_bytes());
        let scene = load(&more).unwrap();
        assert_eq!(scene.meshes[0].triangles.len(), 1);
        assert_eq!(scene.report.oddities(), [("ignored_chunks", 1)]);
    }
    for length in [0, 11, 12, u32::MAX] {
        let mut wrong = whole.clone();
        wrong[8..12].copy_from_slice(&length.to_le_bytes());
        assert!(matches!(load(&wrong), Err(SceneError::Container { .. })));
    }
}

#[test]
fn fields_that_no_scene_needs_may_be_absent() {
    let (mut root, binary) = one_primitive(&TRIANGLE, 4);
    root["animations"] = json!([{"channels": [{"target": {}}]}]);
    root["materials"] = json!([{"normalTexture": {}}]);
    root["meshes"]
        .as_array_mut()
        .unwrap()
        .extend([json!({}), json!({"primitives": [{}]})]);
    root["scenes"].as_array_mut().unwrap().push(json!({}));
    root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{}]}});
    root["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    let scene = load_glb(&root, &binary).unwrap();
    assert_eq!(
        (scene.meshes.len(), scene.meshes[0].triangles.len()),
        (3, 1)
    );
    let oddities = [("skipped_primitives", 1), ("skipped_lights", 1)];
    assert_eq!(scene.report.oddities(), oddities);
}
