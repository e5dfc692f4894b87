//! Moving objects in a lit world: what is kept from frame to frame, on the CPU and on the GPU, draws
//! what a fresh start draws, and that is the oracle's mask.

mod common;

use common::room::crate_of;
use common::{Random, Site, by_profile, lab, skipped};
use glam::{DQuat, DVec3, Vec3};
use umbrage_core::Light;
use umbrage_core::world::{ObjectId, Pose, Reach};
use umbrage_lab::Uploaded;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;
use umbrage_truth::{JudgeOptions, Oracle, judge};

const SIZE: [u32; 2] = [200, 120];

fn pose(random: &mut Random, low: Vec3, high: Vec3) -> Pose {
    let turn = f64::from(random.between(0.0, 6.0));
    Pose {
        rotation: DQuat::from_axis_angle(DVec3::new(0.3, 0.9, -0.3).normalize(), turn),
        translation: random.point(low, high).as_dvec3(),
    }
}

#[test]
fn a_kept_frame_equals_a_fresh_one_and_the_oracles() {
    let mut site = Site::open(
        "gen:city?triangles=6000&lights=40&seed=4&moon=1",
        Casters::Material,
    );
    let view = site.first_camera(SIZE);
    let at = site.lights[1].light.position.as_vec3();
    let (low, high) = (at - Vec3::new(9.0, 6.0, 9.0), at + Vec3::new(9.0, 1.0, 9.0));
    let mut random = Random(6);
    let mut objects: Vec<ObjectId> = Vec::new();
    let mut lab = lab();
    lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
    let mut kept = lab.masking(&site.stage, &view).expect("a renderer");
    let mut fewer = 0;
    for step in 0..by_profile(24, 10) {
        // Come, move, go: and move a lamp now and then.
        let world = &mut site.stage.world;
        match step % 6 {
            0 | 1 => {
                let half = random.point(Vec3::splat(0.1), Vec3::splat(0.9));
                let at = pose(&mut random, low, high);
                objects.push(world.insert(&crate_of(half), &at).expect("a box"));
            }
            5 => world.remove(objects.remove(0)).expect("it is there"),
            _ => {
                let at = pose(&mut random, low, high);
                let number = (random.bits() % objects.len() as u64) as usize;
                world.pose(objects[number], &at).expect("it is there");
            }
        }
        if step % 4 == 3 {
            site.lights[5].light.position += DVec3::new(0.3, 0.1, -0.2);
        }

        lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
        let rebuilt = lab.volumes.lights.iter().filter(|l| !l.cached).count();
        fewer += usize::from(rebuilt * 2 < site.lights.len());
        let ours = lab
            .mask_in(&mut kept, &site.stage, &site.lights, &view)
            .expect("the mask can be drawn and read");
        let fresh = lab
            .mask(&site.stage, &site.lights, &view)
            .expect("the mask can be drawn and read");
        assert_eq!(ours.words, fresh.words, "step {step}");

        let oracle = Oracle::new(&site.stage.world.to_mesh());
        let lights: Vec<Light> = site.lights.iter().map(|l| l.light).collect();
        let options = JudgeOptions::default()
            .with_near(lab.near_clip())
            .with_skipped(skipped(&lab));
        let found = judge(&oracle, &view, &lights, &ours, &options, &|_, _| ());
        assert_eq!(found.wrong, 0, "step {step}: worst {:?}", found.worst);
        assert!(found.samples > 3_000);
        lab.volumes
            .check_closed(&site.stage.world)
            .expect("closed by construction");

        // Again, with nothing changed: nothing of any volume is uploaded, nothing built.
        lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
        assert!(lab.volumes.lights.iter().all(|l| l.cached || l.stamp == 0));
        let again = lab
            .mask_in(&mut kept, &site.stage, &site.lights, &view)
            .expect("the mask can be drawn and read");
        assert_eq!(again.words, ours.words);
        let Uploaded { volume_bytes, .. } = lab.uploaded;
        assert_eq!(volume_bytes, 0);
    }
    assert!(fewer > 0, "a moved box rebuilds most lights at every step");
}

/// The oracle sees objects where they stand: one frame's mask is wrong for the next.
#[test]
fn a_mask_of_before_the_move_is_wrong_after_it() {
    let mut site = Site::open(
        "gen:city?triangles=6000&lights=40&seed=4&moon=1",
        Casters::Material,
    );
    let view = site.first_camera(SIZE);
    let ahead = view.eye.as_vec3() + 6.0 * view.forward;
    let lights: Vec<Light> = site.lights.iter().map(|l| l.light).collect();
    let world = &mut site.stage.world;
    let id = world
        .insert(&crate_of(Vec3::ONE), &Pose::at(ahead.as_dvec3()))
        .expect("a box");
    let bounds = world.object(id).expect("it is there").bounds;
    assert!(lights.iter().any(|l| Reach::new(l).touches_box(bounds)));
    let mut lab = lab();
    lab.prepare(&site.stage, &site.lights, &view, Method::Counter);
    let mask = lab
        .mask(&site.stage, &site.lights, &view)
        .expect("the mask can be drawn and read");
    let options = JudgeOptions::default().with_near(lab.near_clip());
    let wrong = |site: &Site| {
        let oracle = Oracle::new(&site.stage.world.to_mesh());
        judge(&oracle, &view, &lights, &mask, &options, &|_, _| ()).wrong
    };
    assert_eq!(wrong(&site), 0);
    let aside = (ahead + 1.5 * view.right).as_dvec3();
    site.stage
        .world
        .pose(id, &Pose::at(aside))
        .expect("it is there");
    assert!(wrong(&site) > 50);
}
