//! A skinned man walks through a lit world: at every time the mask is the oracle's, and that of the
//! same triangles built anew; only the lights he meets are built again.

mod common;

use std::path::Path;

use common::{
    Random, Site, WALK, by_profile, data, judged, lab, plain, point, skipped, staged, walk,
};
use glam::{DAffine3, DVec3, Vec3, dvec3};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{Reach, World};
use umbrage_core::{Cull, Culls, View};
use umbrage_lab::gpu::GpuError;
use umbrage_lab::lab::Lab;
use umbrage_lab::method::Method;
use umbrage_lab::stage::{Casters, Stage, StageLight};
use umbrage_scene::Scene;
use umbrage_truth::{Judgement, Mask, Oracle};

const SIZE: [u32; 2] = [200, 112];

/// Stormkeep's lower hall, with a man who is about to walk across it.
fn hall() -> (Site, View) {
    let site = Site::new(walk(), Casters::Material);
    let view = site.look(WALK[0], WALK[1], SIZE);
    (site, view)
}

/// A mask, and which lights it left out.
struct Drawn {
    mask: Mask,
    skipped: Vec<bool>,
}

impl Drawn {
    /// By a lab that is still locked.
    fn new(lab: &Lab, mask: Result<Mask, GpuError>) -> Self {
        Self {
            mask: mask.expect("the mask can be drawn and read"),
            skipped: skipped(lab),
        }
    }
}

/// The mask of the stage as it stands, on a fresh renderer.
fn fresh_mask(stage: &Stage, lights: &[StageLight], view: &View) -> Drawn {
    let mut lab = lab();
    lab.volumes = Volumes::default();
    lab.prepare(stage, lights, view, Method::Counter);
    let mask = lab.mask(stage, lights, view);
    lab.volumes = Volumes::default();
    Drawn::new(&lab, mask)
}

/// The oracle's word on a mask, with the stage as it stands.
fn judge(site: &mut Site, view: &View, drawn: &Drawn) -> Judgement {
    site.oracle = Oracle::new(&site.stage.mesh);
    judged(site, &site.lights, view, &drawn.mask, &drawn.skipped)
}

#[test]
fn a_man_walks_through_stormkeep() {
    let (mut site, view) = hall();
    assert_eq!((site.lights.len(), site.stage.actors.len()), (471, 1));
    let lights = plain(&site.lights);
    let mut builder = VolumeBuilder::new(Culls::EVERY.without(Cull::Hidden));
    let mut volumes = Volumes::default();
    builder.build(&site.stage.world, &lights, |_| true, &mut volumes);
    let mut kept = {
        let mut lab = lab();
        lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
        lab.masking(&site.stage, &view).expect("a renderer")
    };
    let actor = site.stage.actors[0].object;
    let mut masks: Vec<Mask> = Vec::new();
    for step in 0..by_profile(12, 5) {
        let before = site.stage.world.object(actor).expect("he is there").bounds;
        site.stage
            .set_time(0.31 * f64::from(step))
            .expect("he can walk");
        let after = site.stage.world.object(actor).expect("he is there").bounds;
        let reaches: Vec<Reach> = lights.iter().map(Reach::new).collect();
        let touched = reaches
            .iter()
            .filter(|reach| step > 0 && (reach.touches_box(before) || reach.touches_box(after)));
        let touched = touched.count();
        let world = &site.stage.world;
        assert_eq!(
            builder.build(world, &lights, |_| true, &mut volumes),
            touched
        );
        assert!(touched < lights.len() / 3, "{touched} are not some");

        let drawn = {
            let mut lab = lab();
            lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
            lab.volumes
                .check_closed(world)
                .expect("closed by construction");
            let mask = lab.mask_in(&mut kept, &site.stage, &site.lights, &view);
            Drawn::new(&lab, mask)
        };
        let found = judge(&mut site, &view, &drawn);
        assert_eq!(found.wrong, 0, "step {step}: worst {:?}", found.worst);
        assert!(found.samples > 50_000, "{} samples", found.samples);
        assert!(
            found.ambiguous * 1000 < found.samples,
            "{}",
            found.ambiguous
        );

        // The same triangles, built anew.
        let stage = &mut site.stage;
        let anew = World::build(&stage.world.to_mesh()).expect("a mesh");
        let walking = std::mem::replace(&mut stage.world, anew);
        let actors = std::mem::take(&mut stage.actors);
        let anew = fresh_mask(stage, &site.lights, &view);
        assert_eq!(anew.mask.words, drawn.mask.words, "step {step}");
        (stage.world, stage.actors) = (walking, actors);
        assert!(
            masks.iter().all(|m| m.words != drawn.mask.words),
            "he stands still"
        );
        masks.push(drawn.mask);
    }
}

/// What the checks above would see if a step from time to positions to planes were left out.
#[test]
fn stale_actors_are_wrong() {
    let (mut site, view) = hall();
    site.stage.set_time(0.3).expect("he can walk");
    let before = fresh_mask(&site.stage, &site.lights, &view);
    assert_eq!(judge(&mut site, &view, &before).wrong, 0);
    let stale = site.stage.world.clone();
    site.stage.set_time(0.9).expect("he can walk");
    // The mask of the time before.
    let wrong = judge(&mut site, &view, &before).wrong;
    assert!(wrong > 200, "{wrong}");
    // New positions without the refit of planes, boxes and tree.
    let mut unfit = stale;
    unfit.positions = site.stage.world.positions.clone();
    let fit = std::mem::replace(&mut site.stage.world, unfit);
    let mask = fresh_mask(&site.stage, &site.lights, &view);
    let wrong = judge(&mut site, &view, &mask).wrong;
    assert!(wrong > 50, "{wrong}");
    site.stage.world = fit;
    let mask = fresh_mask(&site.stage, &site.lights, &view);
    assert_eq!(judge(&mut site, &view, &mask).wrong, 0);
}

/// Whoever skins on a GPU finds everything on the stage: from positions as bound, joints, weights and
/// matrices to the vertices and triangles of the world.
#[test]
fn the_stage_knows_its_skins() {
    let (mut site, _) = hall();
    site.stage.set_time(1.23).expect("he can walk");
    let stage = &site.stage;
    let actor = &stage.actors[0];
    let skin = stage.skinned(actor).expect("he is skinned");
    let vertices = stage.world.vertices_of(actor.object).expect("he is there");
    assert_eq!(vertices.len(), skin.mesh.positions.len());
    for (v, ours) in vertices.iter().enumerate() {
        let weighted = (skin.mesh.joints[v].iter()).zip(skin.mesh.weights[v]);
        let p = skin.mesh.positions[v].as_dvec3();
        let placed: DVec3 = weighted
            .map(|(&j, w)| skin.matrices[usize::from(j)].transform_point3(p) * f64::from(w))
            .sum();
        let expected = (placed - stage.soup.origin).as_vec3();
        let ours = stage.world.positions[ours.expect("all are used") as usize];
        assert!(ours.distance(expected) < 1e-3, "{ours} {expected}");
    }
    let object = stage.world.object(actor.object).expect("he is there");
    for t in object.extent.triangles.clone() {
        let source = stage.world.source[t as usize] as usize;
        let corners = skin.mesh.triangles[source].map(|v| vertices[v as usize]);
        assert_eq!(corners, stage.world.triangles[t as usize].map(Some));
    }
    // Seams are one again: 3,273 vertices of the file stand for fewer places.
    assert!(
        object.extent.vertices.len() < 2_600,
        "{}",
        object.extent.vertices.len()
    );
}

/// A scene in which everything moves, among lights strewn around it, at several times.
fn check_alone(name: &str, scene: Scene) {
    let mut site = Site::new(scene, Casters::Both);
    assert!(!site.stage.actors.is_empty(), "{name}");
    let root = &site.stage.world.bvh.nodes[0];
    let (low, size) = (root.min, (root.max - root.min).max(Vec3::splat(0.1)));
    let mut random = Random(5);
    let lights = (0..24).map(|_| {
        let at = low + size * random.point(Vec3::splat(-0.3), Vec3::splat(1.3));
        point(at, size.length() * random.between(0.3, 1.5))
    });
    site.lights = staged(lights);
    let middle = low + 0.5 * size;
    let eye = middle + size.length() * Vec3::new(0.5, 0.4, 1.0);
    let view = site.look(eye, middle, [120, 90]);
    for step in 0..5 {
        let time = 0.37 * f64::from(step);
        site.stage.set_time(time).expect("it can move");
        let mask = fresh_mask(&site.stage, &site.lights, &view);
        let found = judge(&mut site, &view, &mask);
        assert_eq!(found.wrong, 0, "{name} at {time}: worst {:?}", found.worst);
        assert!(found.samples > 200, "{name}: {} samples", found.samples);
    }
}

#[test]
fn a_man_alone_is_exact() {
    check_alone("the man", data("actors/cesium_man.glb"));
    // Mirrored, he is no less so.
    let mut mirrored = data("actors/cesium_man.glb");
    let rig = mirrored.rig.as_mut().expect("a rig");
    let flip = DAffine3::from_scale(dvec3(-1.0, 1.0, 1.0));
    rig.nodes[0].local = umbrage_scene::rig::Local::Matrix(flip * rig.nodes[0].local.affine());
    check_alone("his mirror image", mirrored);
}

/// Scenes of the collection, where it is: see `tests/exact.rs`.
#[test]
fn skinned_files_are_exact_as_they_move() {
    let Some(folder) = std::env::var_os("UMBRAGE_SCENES") else {
        return;
    };
    let mut checked = 0;
    let entries = Path::new(&folder).join("skinned").read_dir();
    for entry in entries.into_iter().flatten() {
        let path = entry.expect("a readable folder").path();
        if path
            .extension()
            .is_some_and(|end| end == "glb" || end == "gltf")
        {
            let scene = umbrage_scene::load(&path, &()).expect("a scene");
            check_alone(&path.display().to_string(), scene);
            checked += 1;
        }
    }
    assert!(checked > 0, "no skinned file was found");
}
