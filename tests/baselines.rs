//! Other constructions and finite volumes, drawn: brute force and corrected distances are as right
//! as the counter; the classic edges and the naive distance are wrong where they should be.

mod common;

use std::path::Path;

use common::{CASTERS, Found, Site, assert_exact, by_profile, lab, point, room, staged};
use glam::Vec3;
use umbrage_core::frame::{Distance, LightPath, ZFailReason};
use umbrage_core::{Cull, Culls, View};
use umbrage_lab::auto_camera::auto_camera;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;
use umbrage_truth::Mask;

const CORRECTED: Method = Method::CounterFinite(Distance::Corrected);
const NAIVE: Method = Method::CounterFinite(Distance::Range);

fn draw(site: &Site, view: &View, method: Method) -> Found {
    common::check(site, &site.lights, view, method)
}

fn draw_with(site: &Site, view: &View, method: Method, culls: Culls) -> Mask {
    let mut lab = lab();
    lab.culls = culls;
    lab.prepare(&site.stage, &site.lights, view, method);
    let mask = lab.mask(&site.stage, &site.lights, view);
    lab.culls = Culls::EVERY;
    mask.expect("the mask can be drawn and read")
}

/// The room with lamps of short ranges, so that some eyes are inside of one and some are not.
fn lamps(casters: Casters) -> Site {
    let mut site = Site::new(room::scene(), casters);
    site.lights = staged([
        point(Vec3::new(0.3, 4.3, 0.9), 5.0),
        point(Vec3::new(-3.1, 2.2, -1.2), 3.0),
        point(Vec3::new(2.3, 1.9, 0.4), 6.0),
        point(Vec3::new(-5.5, 0.4, 3.3), 9.0),
        point(Vec3::new(3.2, 3.6, -2.9), 20.0),
    ]);
    site.lights.extend(room::lights());
    site
}

fn views(site: &Site, count: u64) -> Vec<View> {
    let size = by_profile([240, 180], [160, 120]);
    (0..count)
        .map(|seed| site.seeded_view(seed, size))
        .collect()
}

#[test]
fn brute_force_is_exact() {
    for (spec, casters) in [
        ("gen:soup?triangles=600&lights=6&seed=2", Casters::Both),
        (
            "gen:city?triangles=4000&lights=12&seed=5",
            Casters::Material,
        ),
    ] {
        let site = Site::open(spec, casters);
        for view in views(&site, 2) {
            assert_exact(spec, &draw(&site, &view, Method::Brute));
        }
    }
}

#[test]
fn corrected_distances_are_exact() {
    let [mut inside, mut beyond, mut finite, mut infinite] = [0; 4];
    for casters in CASTERS {
        let site = lamps(casters);
        for (number, view) in views(&site, by_profile(8, 4)).iter().enumerate() {
            let found = draw(&site, view, CORRECTED);
            assert_exact(&format!("{casters:?}, view {number}"), &found);
            for light in &found.plan.lights {
                inside += u32::from(matches!(light.path, LightPath::ZPass { .. }));
                let reason = ZFailReason::EyeBeyondRange;
                beyond += u32::from(light.path == LightPath::ZFail(reason));
                finite += u32::from(light.extrusion_m.is_finite());
                infinite += u32::from(light.extrusion_m.is_infinite());
            }
        }
    }
    let counts = [inside, beyond, finite, infinite];
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}

#[test]
fn corrected_distances_are_exact_in_generated_worlds() {
    for (spec, casters) in [
        ("gen:soup?triangles=1200&lights=8&seed=3", Casters::Both),
        (
            "gen:city?triangles=10000&lights=24&seed=3&moon=1",
            Casters::Material,
        ),
        ("gen:field?n=48&lights=12&seed=2", Casters::Both),
    ] {
        let site = Site::open(spec, casters);
        for view in views(&site, 2) {
            assert_exact(spec, &draw(&site, &view, CORRECTED));
        }
    }
}

#[test]
fn no_cull_changes_a_finite_mask() {
    let site = lamps(Casters::Both);
    for view in views(&site, 3) {
        let with = |culls| draw_with(&site, &view, CORRECTED, culls).words;
        let none = with(Culls::NONE);
        for step in Cull::ALL {
            assert!(with(Culls::EVERY.without(step)) == none, "all but {step:?}");
            assert!(with(Culls::NONE.with(step)) == none, "only {step:?}");
        }
    }
}

/// Vertices moved to the range leave what joins them inside of it: light falls where none should.
#[test]
fn the_naive_distance_is_wrong() {
    let site = lamps(Casters::Both);
    let mut wrong = 0;
    for view in views(&site, 4) {
        wrong += draw(&site, &view, NAIVE).judgement.wrong;
    }
    assert!(wrong > 100, "{wrong}");
}

/// On a closed two-manifold the classic is exact; the room has a screen, a sail and a fan.
#[test]
fn the_classic_breaks_where_edges_have_not_two_triangles() {
    let mut closed = Site::new(room::boxes(), Casters::Front);
    closed.lights = room::lights();
    let open = lamps(Casters::Both);
    let mut wrong = 0;
    for view in views(&closed, 3) {
        assert_exact("boxes", &draw(&closed, &view, Method::Crow));
    }
    for view in views(&open, by_profile(12, 8)) {
        let found = draw(&open, &view, Method::Crow);
        assert!(!found.closed);
        wrong += found.judgement.wrong;
    }
    assert!(wrong > 100, "{wrong}");
}

/// `UMBRAGE_SCENES=/path/to/scenes cargo test --release --test baselines -- --ignored`
#[test]
#[ignore = "needs UMBRAGE_SCENES, and minutes"]
fn scene_collection() {
    let folder = std::env::var_os("UMBRAGE_SCENES").expect("UMBRAGE_SCENES is set");
    let files = common::glb_files(&Path::new(&folder).join("gamemaps"));
    assert!(!files.is_empty(), "no gamemaps");
    let size = [640, 360];
    for path in files {
        let site = Site::open(&path.to_string_lossy(), Casters::Both);
        let stand = auto_camera(
            &site.stage.mesh,
            &common::plain(&site.lights),
            1.0,
            16.0 / 9.0,
        );
        let view = View::look_at(stand.eye, stand.target, 1.0, site.near(), size);
        for method in [Method::Brute, CORRECTED] {
            let found = draw(&site, &view, method);
            assert_exact(&format!("{}, {}", path.display(), method.name()), &found);
        }
    }
}
