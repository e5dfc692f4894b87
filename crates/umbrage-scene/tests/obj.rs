//! OBJ files: indices, polygons, groups, materials, and what is refused.

mod common;

use common::{Folder, load_text};
use glam::{Vec2, Vec3, Vec4};
use umbrage_scene::{AlphaMode, SceneError};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_become_triangles_of_their_winding() {
    let scene = load_text("a.obj", &format!("{SQUARE}f 1 2 3 4\nf 4 3 2 1\n")).unwrap();
    let soup = scene.soup().unwrap();
    let z = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| soup.positions[v as usize]);
        (b - a).cross(c - a).z
    };
    assert_eq!(
        soup.triangles.iter().map(z).collect::<Vec<_>>(),
        [1.0, 1.0, -1.0, -1.0]
    );
    assert!(scene.materials[0].double_sided);
}

#[test]
fn concave_polygons_are_not_covered_twice() {
    // An arrow head: the fan from its first corner would leave it.
    let scene = load_text("a.obj", "v 1 0 0\nv 0 2 0\nv -1 0 0\nv 0 1 0\nf 1 2 3 4").unwrap();
    let mesh = &scene.meshes[0];
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).z * 0.5
    };
    let areas: Vec<f32> = mesh.triangles.iter().map(area).collect();
    assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
    assert_eq!(areas.iter().sum::<f32>(), 1.0);
}

#[test]
fn negative_indices_count_backwards() {
    let scene = load_text("a.obj", &format!("{SQUARE}f -4 -3 -2\nv 9 9 9\nf -1 1 2")).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles.len(), 2);
    let first = mesh.triangles[1].map(|v| mesh.positions[v as usize]);
    assert_eq!(first, [Vec3::splat(9.0), Vec3::ZERO, Vec3::X]);
}

#[test]
fn indices_out_of_range_name_their_line() {
    for index in [
        "0",
        "5",
        "-5",
        "4294967296",
        "99999999999999999999",
        "x",
        "",
    ] {
        let scene = load_text("a.obj", &format!("{SQUARE}f 1 2 {index}/"));
        assert!(
            matches!(scene, Err(SceneError::Obj { line: 5, .. })),
            "{index}"
        );
    }
    let scene = load_text("a.obj", &format!("{SQUARE}f 1/7/7 2/7/7 3//7")).unwrap();
    assert_eq!(
        (
            scene.meshes[0].triangles.len(),
            scene.report.dropped_attributes
        ),
        (1, 5)
    );
}

#[test]
fn objects_and_groups_become_meshes() {
    let text = format!("{SQUARE}o one\ng front\nf 1 2 3\ng back\nf 1 3 4\ng empty\n");
    let scene = load_text("a.obj", &text).unwrap();
    let names: Vec<&str> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["front", "back"]);
    assert_eq!(scene.meshes[1].positions.len(), 3);
}

#[test]
fn statements_continue_over_lines_and_end_in_any_way() {
    let scene = load_text("a.obj", &format!("{SQUARE}f 1 2 \\\n3\r\nf 1 3 4")).unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    let mac = format!("{SQUARE}f 1 2 3").replace('\n', "\r");
    assert_eq!(
        load_text("a.obj", &mac).unwrap().meshes[0].triangles.len(),
        1
    );
}

#[test]
fn text_that_is_none_is_refused() {
    let folder = Folder::new();
    let utf16: Vec<u8> = SQUARE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [&utf16[..], b"\xFF\xFEv\0", b"\x7FELF\0\0"] {
        let scene = umbrage_scene::load(&folder.file("a.obj", bytes), &());
        assert!(matches!(scene, Err(SceneError::NotText { .. })));
    }
    for number in ["nan", "1e400", "inf", "one"] {
        let scene = load_text("a.obj", &format!("v 0 0 {number}"));
        assert!(
            matches!(scene, Err(SceneError::Obj { line: 1, .. })),
            "{number}"
        );
    }
}

#[test]
fn libraries_give_materials_and_missing_ones_are_counted() {
    let folder = Folder::new();
    folder.file(
        "my paints.mtl",
        b"newmtl red\nKd 1 0 0\nd 0.5\nnewmtl lamp\nKe 4 4 2\nmap_Kd gone.png",
    );
    let text = format!(
        "mtllib my paints.mtl\nmtllib gone.mtl\n{SQUARE}f 1 2 3\nusemtl red\nf 1 2 3\nusemtl lost\nf 1 2 3"
    );
    let scene = umbrage_scene::load(&folder.file("a.obj", text.as_bytes()), &()).unwrap();
    let of = |t: usize| &scene.materials[scene.meshes[0].materials[t] as usize];
    assert_eq!(of(1).base_color, Vec4::new(1.0, 0.0, 0.0, 0.5));
    assert_eq!(of(1).alpha, AlphaMode::Blend);
    assert_eq!(
        (of(0).name.as_str(), of(2).name.as_str()),
        ("default", "lost")
    );
    let report = &scene.report;
    assert_eq!(
        (
            report.missing_libraries,
            report.missing_materials,
            report.missing_images
        ),
        (1, 1, 1)
    );
}

#[test]
fn corners_without_an_attribute_get_none() {
    let attributes = "vn 0 0 2\nvn 0 0 0\nvt 0.25\n";
    let faces = "f 1 2 3\nf 1//1 2//1 3//2\nf 1/1 2/1 4/1\n";
    let scene = load_text("a.obj", &format!("{SQUARE}{attributes}{faces}")).unwrap();
    let mesh = &scene.meshes[0];
    let of = |t: usize| mesh.triangles[t].map(|v| mesh.normals[v as usize]);
    assert_eq!(of(0), [Vec3::ZERO; 3]);
    assert_eq!(of(1), [Vec3::Z, Vec3::Z, Vec3::ZERO]);
    let uvs = mesh.triangles[2].map(|v| mesh.uvs[v as usize]);
    assert_eq!(uvs, [Vec2::new(0.25, 1.0); 3]);
    assert_eq!(scene.report.oddities(), [("repaired_normals", 1)]);
}

#[test]
fn broken_statements_of_a_library_are_counted_and_the_others_kept() {
    let folder = Folder::new();
    let library = "Kd 9\nnewmtl a\nKd 1\nKe spectral x.rfl\nd\nmap_Kd\nNs abc\nnewmtl\nTr 0.5";
    folder.file("a.mtl", library.as_bytes());
    let text = format!("mtllib a.mtl\n{SQUARE}usemtl\ta\nf 1 2 3\nusemtl\nf 1 2 3");
    let scene = umbrage_scene::load(&folder.file("a.obj", text.as_bytes()), &()).unwrap();
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        (names, &scene.meshes[0].materials[..]),
        (vec!["a", ""], &[0, 1][..])
    );
    assert_eq!(scene.materials[0].base_color, Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(scene.materials[1].base_color.w, 0.5);
    assert_eq!(scene.report.oddities(), [("repaired_materials", 4)]);
}
