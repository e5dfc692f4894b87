//! The static buffer that the vertex shader opens up: right on closed meshes, torn on others.

mod common;

use common::room::CUBOID_FACES;
use common::{Random, Site, by_profile, judged, lab, point, skipped, staged};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use umbrage_core::View;
use umbrage_lab::method::{Method, Normals};
use umbrage_lab::stage::Casters;
use umbrage_scene::{Instance, Mesh, Scene};
use umbrage_truth::{Judgement, Oracle};

const EXTRUDE: Method = Method::Extrude(Normals::Neighbours);
const SIZE: [u32; 2] = [240, 135];

/// The unit cube, fronts outside, with or without its last side.
fn cube(open: bool) -> Mesh {
    let corner = |i: u32| Vec3::from([0, 1, 2].map(|bit| (i >> bit & 1) as f32 - 0.5));
    let sides = CUBOID_FACES.into_iter().take(if open { 5 } else { 6 });
    let triangles: Vec<[u32; 3]> = sides
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh {
        name: "cube".to_owned(),
        positions: (0..8).map(corner).collect(),
        materials: vec![0; triangles.len()],
        triangles,
        ..Mesh::default()
    }
}

/// Boxes of all sizes, turned all ways, some through each other, on a slab.
fn boxes(open: bool, seed: u64) -> Site {
    let mut random = Random(seed);
    let mut scene = Scene {
        meshes: vec![cube(open), cube(false)],
        ..common::scene_of("boxes", Mesh::default())
    };
    let instance = |mesh, transform| Instance {
        mesh,
        transform,
        ..Instance::default()
    };
    let slab = DAffine3::from_translation(DVec3::new(0.0, -0.5, 0.0))
        * DAffine3::from_scale(DVec3::new(30.0, 1.0, 30.0));
    scene.instances = vec![instance(1, slab)];
    for _ in 0..40 {
        let at = random.point(Vec3::new(-9.0, 0.3, -9.0), Vec3::new(9.0, 4.0, 9.0));
        let scale = random.point(Vec3::splat(0.3), Vec3::splat(2.5));
        let axis = random.point(Vec3::NEG_ONE, Vec3::ONE).as_dvec3();
        let turn = DQuat::from_axis_angle(axis.normalize(), f64::from(random.between(0.0, 6.0)));
        let (scale, at) = (scale.as_dvec3(), at.as_dvec3());
        let transform = DAffine3::from_scale_rotation_translation(scale, turn, at);
        scene.instances.push(instance(0, transform));
    }
    let mut site = Site::new(scene, Casters::Both);
    site.lights = staged((0..12).map(|_| {
        let at = random.point(Vec3::new(-10.0, 0.5, -10.0), Vec3::new(10.0, 7.0, 10.0));
        point(at, random.between(4.0, 15.0))
    }));
    site
}

/// The judge's word, and the method's own.
fn checked(site: &Site, view: &View, method: Method) -> (Judgement, String) {
    let mut lab = lab();
    lab.prepare(&site.stage, &site.lights, view, method);
    let mask = lab.mask(&site.stage, &site.lights, view);
    let (mask, skipped, note) = (mask.expect("a mask"), skipped(&lab), lab.held.note.clone());
    drop(lab);
    let found = judged(site, &site.lights, view, &mask, &skipped);
    (found, note)
}

/// A light inside of a closed mesh leaves none of it facing: all of it goes to infinity, and all
/// else is in shadow. So these are the shadows of casters with two sides.
#[test]
fn closed_meshes_cast_the_oracles_shadows() {
    let mut samples = 0;
    for seed in 0..by_profile(12, 4) {
        let site = boxes(false, seed);
        let view = site.seeded_view(seed, SIZE);
        let (found, note) = checked(&site, &view, EXTRUDE);
        assert_eq!(found.wrong, 0, "seed {seed}: {:?}", found.worst);
        assert_eq!(note, "");
        samples += found.samples;
    }
    assert!(samples > 100_000, "{samples}");
}

#[test]
fn open_meshes_are_torn_and_the_note_says_so() {
    let site = boxes(true, 1);
    let view = site.look(Vec3::new(9.0, 8.0, 11.0), Vec3::ZERO, SIZE);
    let (found, note) = checked(&site, &view, EXTRUDE);
    assert!(found.wrong > 100, "{}", found.wrong);
    assert!(note.contains("160 of"), "{note}");
    assert_eq!(checked(&site, &view, Method::Counter).0.wrong, 0);
}

/// Normals found anew follow the skin; normals at rest, turned, do not quite.
#[test]
fn a_walking_mans_normals() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/actors/cesium_man.glb");
    let mut site = Site::open(path, Casters::Both);
    let mut random = Random(8);
    site.lights = staged((0..8).map(|_| {
        let at = random.point(Vec3::new(-2.0, 0.2, -2.0), Vec3::new(2.0, 2.5, 2.0));
        point(at, 6.0)
    }));
    let view = site.look(Vec3::new(1.2, 1.4, 2.0), Vec3::new(0.0, 0.8, 0.0), SIZE);
    let normals = [
        Normals::Neighbours,
        Normals::FaceWeights,
        Normals::VertexWeights,
    ];
    let mut wrong = [0; 3];
    for time_s in [0.3, 0.9, 1.4] {
        site.stage.set_time(time_s).expect("a pose");
        site.oracle = Oracle::new(&site.stage.mesh);
        for (sum, normals) in wrong.iter_mut().zip(normals) {
            *sum += checked(&site, &view, Method::Extrude(normals)).0.wrong;
        }
    }
    let [neighbours, face, vertex] = wrong;
    assert!(neighbours * 10 < face.min(vertex), "{wrong:?}");
    assert!(face.min(vertex) > 10, "{wrong:?}");
}
