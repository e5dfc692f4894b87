//! Flattening keeps bits, fronts and detail; writing and loading give the same scene back.

mod common;

use common::Folder;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec2, Vec3, Vec4, vec3};
use umbrage_scene::{
    AlphaMode, Camera, Image, Instance, Light, LightKind, Material, Mesh, Scene, SceneError, load,
    write,
};

fn instance(mesh: u32, transform: DAffine3) -> Instance {
    Instance {
        name: format!("instance_{mesh}"),
        mesh,
        transform,
        ..Instance::default()
    }
}

fn triangle() -> Mesh {
    Mesh {
        name: "triangle".to_owned(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
        triangles: vec![[0, 1, 2]],
        materials: vec![0],
        ..Mesh::default()
    }
}

fn scene(meshes: Vec<Mesh>, instances: Vec<Instance>) -> Scene {
    Scene {
        meshes,
        instances,
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

#[test]
fn an_identity_transform_keeps_the_bits() {
    let mut mesh = triangle();
    mesh.positions = vec![
        vec3(0.1, -0.0, 1e-42),
        vec3(-3.3, 1e30, 7.7),
        vec3(1.0, 2.0, 3.0),
    ];
    let soup = scene(vec![mesh.clone()], vec![instance(0, DAffine3::IDENTITY)])
        .soup()
        .unwrap();
    let bits = |p: &Vec3| p.to_array().map(f32::to_bits);
    assert!(
        soup.positions
            .iter()
            .map(bits)
            .eq(mesh.positions.iter().map(bits))
    );
    assert_eq!(soup.origin, DVec3::ZERO);
}

#[test]
fn a_mirror_flips_the_winding_with_its_corners_and_normals() {
    let mirror = DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
    let soup = scene(vec![triangle()], vec![instance(0, mirror)])
        .soup()
        .unwrap();
    let [a, b, c] = soup.triangles[0].map(|v| soup.positions[v as usize]);
    assert!((b - a).cross(c - a).z > 0.0);
    assert_eq!(soup.normals[0], [Vec3::Z; 3]);
    assert_eq!(soup.uvs[0], [Vec2::ZERO, Vec2::Y, Vec2::X]);
}

#[test]
fn a_far_world_gets_an_origin_in_whole_metres_and_keeps_its_detail() {
    let far = DVec3::new(1.0e6, -2.0e6, 3.3e5);
    let step = DVec3::new(0.0001, 0.0, 0.0);
    let instances = vec![
        instance(0, DAffine3::from_translation(far)),
        instance(0, DAffine3::from_translation(far + step)),
    ];
    let soup = scene(vec![triangle()], instances).soup().unwrap();
    assert_eq!(soup.origin, soup.origin.round());
    assert!((soup.origin - far).length() < 2.0);
    let moved = soup.positions[3] - soup.positions[0];
    assert!((moved.x - 0.0001).abs() < 1e-7, "{moved}");
    assert_eq!(soup.instance, [0, 1]);
}

#[test]
fn too_many_triangles_or_a_bad_index_is_refused() {
    let mut mesh = triangle();
    mesh.triangles = vec![[0, 1, 2]; 1_000_000];
    mesh.materials = vec![0; 1_000_000];
    let many = scene(vec![mesh], vec![instance(0, DAffine3::IDENTITY); 201]);
    assert!(matches!(
        many.soup(),
        Err(SceneError::TooManyTriangles {
            triangles: 201_000_000,
            ..
        })
    ));
    let mut mesh = triangle();
    mesh.triangles[0][2] = 3;
    let bad = scene(vec![mesh], vec![instance(0, DAffine3::IDENTITY)]);
    assert!(matches!(bad.soup(), Err(SceneError::Invalid { .. })));
    assert!(matches!(
        scene(vec![], vec![instance(0, DAffine3::IDENTITY)]).soup(),
        Err(SceneError::Invalid { .. })
    ));
    let huge = DAffine3::from_scale(DVec3::splat(1e300));
    assert!(
        scene(vec![triangle()], vec![instance(0, huge)])
            .soup()
            .is_err()
    );
}

#[test]
fn an_empty_scene_gives_an_empty_soup() {
    assert_eq!(Scene::default().soup().unwrap().triangles.len(), 0);
}

/// A scene with one of everything.
fn full() -> Scene {
    let materials = vec![
        Material {
            name: "glass".to_owned(),
            base_color: Vec4::new(0.1, 0.2, 0.3, 0.4),
            base_color_image: Some(0),
            emissive: vec3(0.3, 7.0, 0.0),
            alpha: AlphaMode::Blend,
            double_sided: true,
            roughness: 0.3,
            metallic: 0.7,
        },
        Material {
            name: "leaf".to_owned(),
            alpha: AlphaMode::Mask { cutoff: 0.3 },
            ..Material::default()
        },
    ];
    let lights = vec![
        Light {
            name: "spot".to_owned(),
            position: DVec3::new(1e6 + 0.1, 2.0, 3.0),
            direction: DVec3::new(0.3, -0.8, 0.1).normalize(),
            color: vec3(1.0, 0.5, 0.2),
            intensity: 12.5,
            range: Some(9.5),
            kind: LightKind::Spot {
                inner_rad: 0.2,
                outer_rad: 0.5,
            },
            ..Light::default()
        },
        Light {
            name: "sun".to_owned(),
            direction: DVec3::Z,
            kind: LightKind::Directional,
            ..Light::default()
        },
        Light {
            name: "point".to_owned(),
            ..Light::default()
        },
    ];
    let eye = DVec3::new(4.0, 5.0, 6.0);
    let camera = Camera {
        near: Some(0.25),
        ..Camera::look_at("eye", eye, DVec3::X, 0.8)
    };
    let mut bare = triangle();
    bare.normals.clear();
    bare.uvs.clear();
    bare.positions[1] = vec3(0.1, 0.2, 0.3);
    bare.triangles = vec![[0, 1, 2], [2, 1, 0], [0, 2, 1]];
    bare.materials = vec![1, 0, 1];
    let turn = DMat3::from_quat(DQuat::from_rotation_y(1.234))
        * DMat3::from_diagonal(DVec3::new(-1.0, 2.0, 0.3));
    let placed = DAffine3 {
        matrix3: turn,
        translation: DVec3::new(1e7 + 0.123_456_789, 0.1, 0.0),
    };
    Scene {
        name: "full".to_owned(),
        meshes: vec![triangle(), bare],
        instances: vec![
            instance(0, DAffine3::IDENTITY),
            instance(1, placed),
            instance(0, placed),
        ],
        materials,
        images: vec![Image {
            name: "dots".to_owned(),
            size: [2, 1],
            rgba8: vec![1, 2, 3, 4, 250, 128, 9, 255],
        }],
        lights,
        cameras: vec![camera],
        ..Scene::default()
    }
}

/// As a place comes back from a file: an f32, and an f32 on top.
fn to_48_bits(p: DVec3) -> DVec3 {
    let above = p.as_vec3().as_dvec3();
    above + (p - above).as_vec3().as_dvec3()
}

#[test]
fn writing_and_loading_gives_the_same_scene() {
    let folder = Folder::new();
    let path = folder.path().join("full.glb");
    let written = full();
    write::glb(&written, &path).unwrap();
    let read = load(&path, &()).unwrap();
    assert_eq!(read.materials, written.materials);
    assert_eq!(read.images, written.images);
    for (a, b) in read.instances.iter().zip(&written.instances) {
        let (matrix3, translation) = (b.transform.matrix3.as_mat3(), b.transform.translation);
        let transform = DAffine3 {
            matrix3: matrix3.as_dmat3(),
            translation: to_48_bits(translation),
        };
        assert_eq!(
            *a,
            Instance {
                transform,
                ..b.clone()
            }
        );
    }
    assert_eq!(read.meshes[0], written.meshes[0]);
    assert_eq!(read.meshes[1].positions, written.meshes[1].positions);
    assert_eq!(read.meshes[1].triangles, [[0, 1, 2], [0, 2, 1], [2, 1, 0]]);
    assert_eq!(read.meshes[1].materials, [1, 1, 0]);
    for (a, b) in read.lights.iter().zip(&written.lights) {
        assert!((a.direction - b.direction).length() < 1e-6); // of an f32 quaternion
        assert_eq!(a.position, to_48_bits(b.position));
        let (direction, position) = (b.direction, b.position);
        let placed = Light {
            direction,
            position,
            ..a.clone()
        };
        assert_eq!(placed, *b);
    }
    let (a, b) = (&read.cameras[0], &written.cameras[0]);
    assert!((a.forward - b.forward).length() + (a.up - b.up).length() < 1e-6);
    assert_eq!(
        (a.position, a.fovy_rad as f32, a.near),
        (b.position, b.fovy_rad as f32, b.near)
    );
    assert_eq!(read.report.oddities(), []);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "the temporary file is gone");
}

#[test]
fn an_empty_and_a_generated_scene_survive_the_round_trip() {
    let folder = Folder::new();
    for spec in [
        "gen:city?triangles=3000&lights=20&moon=1",
        "gen:field?n=6&lights=2",
        "gen:soup",
    ] {
        let path = folder.path().join("generated.glb");
        let written = umbrage_scene::open(spec, &()).unwrap();
        write::glb(&written, &path).unwrap();
        let read = load(&path, &()).unwrap();
        let [a, b] = [&written, &read].map(|s| s.soup().unwrap());
        assert_eq!(
            (a.positions, a.triangles.len()),
            (b.positions, b.triangles.len()),
            "{spec}"
        );
        assert_eq!(written.materials, read.materials);
        assert_eq!(written.lights.len(), read.lights.len());
    }
    let path = folder.path().join("empty.glb");
    write::glb(&Scene::default(), &path).unwrap();
    assert_eq!(load(&path, &()).unwrap().meshes.len(), 0);
}

#[test]
fn what_cannot_be_written_leaves_no_file() {
    let folder = Folder::new();
    let mut broken = full();
    broken.meshes[0].positions[0].x = f32::NAN;
    assert!(write::glb(&broken, &folder.path().join("a.glb")).is_err());
    let mut broken = full();
    broken.images[0].rgba8.pop();
    assert!(write::glb(&broken, &folder.path().join("a.glb")).is_err());
    assert!(write::glb(&full(), &folder.path().join("no/such/folder.glb")).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
