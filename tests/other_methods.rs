//! Ray tracing and shadow maps before the same judge as the volumes: rays are exact, maps converge,
//! and what both keep from frame to frame follows every move.

mod common;

use common::room::{self, crate_of};
use common::{CASTERS, Site, by_profile, check, lab, plain, skipped};
use glam::{DVec3, Vec3};
use umbrage_core::View;
use umbrage_core::world::Pose;
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::run::Run;
use umbrage_lab::stage::Casters;
use umbrage_truth::{JudgeOptions, Judgement, Mask, Oracle, judge};

const SIZE: [u32; 2] = [160, 90];
const MAP: Method = Method::ShadowMap { texels: 512 };

fn bundled(world: &str) -> Site {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/data/worlds");
    Site::open(&format!("{folder}/{world}.glb"), Casters::Material)
}

fn assert_rays_exact(what: &str, site: &Site, view: &View) {
    let found = check(site, &site.lights, view, Method::RayTrace).judgement;
    assert_eq!(found.wrong, 0, "{what}: worst {:?}", found.worst);
}

#[test]
fn rays_find_the_oracles_shadows_of_every_casting_rule() {
    for casters in CASTERS {
        let mut site = Site::new(room::scene(), casters);
        site.lights = room::lights();
        for seed in 0..by_profile(6, 3) {
            let view = site.seeded_view(seed, SIZE);
            assert_rays_exact(&format!("{casters:?}, view {seed}"), &site, &view);
        }
    }
}

#[test]
fn rays_find_the_oracles_shadows_in_bundled_worlds() {
    for world in ["stormkeep", "facing_giants", "colosseum"] {
        let site = bundled(world);
        for seed in 0..by_profile(2, 1) {
            let view = site.seeded_view(seed, SIZE);
            assert_rays_exact(&format!("{world}, view {seed}"), &site, &view);
        }
    }
}

#[test]
fn maps_come_closer_to_the_oracle_the_larger_they_are() {
    let city = Site::open(
        "gen:city?triangles=6000&lights=40&seed=4&moon=1",
        Casters::Material,
    );
    let keep = bundled("stormkeep");
    let keep = ("stormkeep", keep.seeded_view(1, SIZE), keep);
    let city = ("city", city.first_camera(SIZE), city);
    for (what, view, site) in [keep, city] {
        let [floor, small, large] = [
            Method::None,
            Method::ShadowMap { texels: 256 },
            Method::ShadowMap { texels: 1024 },
        ]
        .map(|method| check(&site, &site.lights, &view, method).judgement);
        let wrong = [floor.wrong, small.wrong, large.wrong];
        // Without shadows much more is wrong: the bounds below say something.
        assert!(floor.wrong > 5 * small.wrong, "{what}: {wrong:?}");
        assert!(small.wrong * 100 < small.samples, "{what}: {wrong:?}");
        assert!(large.wrong * 3 < small.wrong * 2, "{what}: {wrong:?}");
    }
}

/// A city with a box before the eye, what draws it from frame to frame, and the judge.
struct Street {
    site: Site,
    view: View,
    id: umbrage_core::world::ObjectId,
    method: Method,
    kept: Run,
}

impl Street {
    fn new(lab: &mut Lab, method: Method) -> Self {
        let mut site = Site::open(
            "gen:city?triangles=6000&lights=40&seed=4&moon=1",
            Casters::Material,
        );
        let view = site.first_camera(SIZE);
        let ahead = view.eye + 6.0 * view.forward.as_dvec3();
        let world = &mut site.stage.world;
        let id = world.insert(&crate_of(Vec3::ONE), &Pose::at(ahead));
        lab.prepare(&site.stage, &site.lights, &view, method);
        let kept = lab.masking(&site.stage, &view).expect("a renderer");
        Self {
            id: id.expect("a box"),
            site,
            view,
            method,
            kept,
        }
    }

    fn pose(&mut self, aside: f32) {
        let aside = 6.0 * self.view.forward + aside * self.view.right;
        let at = self.view.eye + aside.as_dvec3();
        let world = &mut self.site.stage.world;
        let posed = world.pose(self.id, &Pose::at(at));
        posed.expect("it is there");
    }

    /// With what was kept of the last mask.
    fn mask(&mut self, lab: &mut Lab) -> Mask {
        let (stage, lights) = (&self.site.stage, &self.site.lights);
        lab.prepare(stage, lights, &self.view, self.method);
        let mask = lab.mask_in(&mut self.kept, stage, lights, &self.view);
        mask.expect("the mask can be drawn and read")
    }

    /// With nothing kept.
    fn fresh(&self, lab: &mut Lab) -> Mask {
        let (stage, lights) = (&self.site.stage, &self.site.lights);
        lab.prepare(stage, lights, &self.view, self.method);
        let mask = lab.mask(stage, lights, &self.view);
        mask.expect("the mask can be drawn and read")
    }

    fn judged(&self, lab: &Lab, mask: &Mask) -> Judgement {
        let oracle = Oracle::new(&self.site.stage.world.to_mesh());
        let options = JudgeOptions::default()
            .with_near(lab.near_clip())
            .with_skipped(skipped(lab));
        let lights = plain(&self.site.lights);
        judge(&oracle, &self.view, &lights, mask, &options, &|_, _| ())
    }
}

#[test]
fn what_is_kept_follows_an_object_there_and_back() {
    let mut lab = lab();
    for method in [MAP, Method::RayTrace] {
        let name = method.name();
        let mut street = Street::new(&mut lab, method);
        let first = street.mask(&mut lab);
        let expected = street.judged(&lab, &first).wrong;
        assert_eq!(street.mask(&mut lab).words, first.words, "{name}, again");

        street.pose(1.5);
        assert!(street.judged(&lab, &first).wrong > 3 * expected + 50);
        let moved = street.mask(&mut lab);
        assert_eq!(moved.words, street.fresh(&mut lab).words, "{name}, moved");
        let judgement = street.judged(&lab, &moved);
        assert!(
            judgement.wrong * 200 < judgement.samples,
            "{name}: {judgement:?}"
        );

        street.pose(0.0);
        assert_eq!(street.mask(&mut lab).words, first.words, "{name}, back");

        let light = &mut street.site.lights[5].light;
        light.position += DVec3::new(0.3, 0.1, -0.2);
        let lit = street.mask(&mut lab);
        assert_eq!(lit.words, street.fresh(&mut lab).words, "{name}, light");

        let removed = street.site.stage.world.remove(street.id);
        removed.expect("it is there");
        let without = street.mask(&mut lab);
        assert_eq!(without.words, street.fresh(&mut lab).words, "{name}, gone");
    }
}

/// A cache that is not told of a move keeps the old shadows, and the judge sees it.
#[test]
fn a_stale_map_is_wrong() {
    let mut lab = lab();
    for method in [MAP, Method::RayTrace] {
        let mut street = Street::new(&mut lab, method);
        let first = street.mask(&mut lab);
        let expected = street.judged(&lab, &first).wrong;
        let stamp = street.site.stage.world.stamp;
        street.pose(1.5);
        street.site.stage.world.stamp = stamp;
        let stale = street.mask(&mut lab);
        assert!(street.judged(&lab, &stale).wrong > 3 * expected + 50);
    }
}

/// A map without one of the casters, and rays that miss one, are wrong.
#[test]
fn a_missing_caster_is_wrong() {
    let mut lab = lab();
    for method in [MAP, Method::RayTrace] {
        let mut street = Street::new(&mut lab, method);
        let expected = street.mask(&mut lab);
        let expected = street.judged(&lab, &expected).wrong;
        let oracle = Oracle::new(&street.site.stage.world.to_mesh());
        // It is seen, but casts nothing.
        let world = &mut street.site.stage.world;
        let object = world.object(street.id).expect("it is there").extent.clone();
        let triangles = object.triangles.start as usize..object.triangles.end as usize;
        world.casting.to_mut()[triangles.clone()].fill(umbrage_core::Casting::None);
        let cluster = &mut world.clusters.to_mut()[triangles.start / 64];
        (cluster.casts_front, cluster.casts_back) = (0, 0);
        let mask = street.fresh(&mut lab);
        let options = JudgeOptions::default()
            .with_near(lab.near_clip())
            .with_skipped(skipped(&lab));
        let lights = plain(&street.site.lights);
        let found = judge(&oracle, &street.view, &lights, &mask, &options, &|_, _| ());
        assert!(found.wrong > 3 * expected + 50, "{}", method.name());
    }
}

/// Frames are drawn by other batches of lights than masks are: all at once, or as many as a method's
/// buffers hold. So pictures of several hundred lights must be the counter's too.
#[test]
fn pictures_of_many_lights_agree() {
    let site = bundled("stormkeep");
    let view = site.seeded_view(1, [160, 90]);
    let mut lab = lab();
    let mut picture = |method: &str| {
        let method: Method = method.parse().expect("a method");
        lab.render(&site.stage, &site.lights, &view, method, 1)
            .expect("a picture")
            .light
    };
    let right = picture("counter");
    let differing = |light: &[Vec3]| {
        let mean = right.iter().map(|c| c.length()).sum::<f32>() / right.len() as f32;
        let far = |(a, b): &(&Vec3, &Vec3)| (**a - **b).length() > 0.02 * (mean + b.length());
        light.iter().zip(&right).filter(far).count()
    };
    let dark = differing(&picture("none"));
    assert!(dark > 500, "{dark}");
    for method in ["brute", "mask-alpha", "mask-max", "raytrace", "oracle"] {
        let found = differing(&picture(method));
        assert!(found < 20, "{method}: {found} pixels differ");
    }
    for method in ["mask-screen", "shadowmap-512", "shadowmap-2048"] {
        let found = differing(&picture(method));
        assert!(
            found < dark / 2,
            "{method}: {found} of {dark} pixels differ"
        );
    }
}
