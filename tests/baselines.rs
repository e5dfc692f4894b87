//! Other constructions and finite volumes, drawn: brute force and corrected distances are as right
//! as the counter; the classic edges and the naive distance are wrong where they should be.

mod common;

use std::path::Path;

use common::{
    CASTERS, EXACT, Found, Site, assert_exact, by_profile, lab, point, room, skipped, staged,
};
use glam::Vec3;
use umbrage_core::frame::{Distance, Extrusion, LightPath, ZFailReason};
use umbrage_core::volume::{Construction, Volumes};
use umbrage_core::{Cull, Culls, View};
use umbrage_lab::auto_camera::auto_camera;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;

const CORRECTED: Extrusion = Extrusion::Finite(Distance::Corrected);
const NAIVE: Extrusion = Extrusion::Finite(Distance::Range);

/// How a mask is drawn.
#[derive(Clone, Copy, Debug)]
struct Way {
    construction: Construction,
    extrusion: Extrusion,
    culls: Culls,
    method: Method,
}

impl Way {
    fn new(construction: Construction, extrusion: Extrusion, method: Method) -> Self {
        Self {
            construction,
            extrusion,
            culls: Culls::EVERY,
            method,
        }
    }
}

fn draw(site: &Site, view: &View, way: Way) -> Found {
    let (mask, plan, skipped, closed) = {
        let mut lab = lab();
        (lab.construction, lab.extrusion) = (way.construction, way.extrusion);
        lab.culls = way.culls;
        lab.prepare(&site.stage, &site.lights, view, way.method);
        let mask = lab.mask(&site.stage, &site.lights, view);
        let closed = lab.volumes.check_closed(&site.stage.world).is_ok();
        (lab.construction, lab.extrusion) = (Construction::Counter, Extrusion::Infinite);
        (lab.culls, lab.volumes) = (Culls::EVERY, Volumes::default());
        let mask = mask.expect("the mask can be drawn and read");
        (mask, lab.plan.clone(), skipped(&lab), closed)
    };
    Found {
        judgement: common::judged(site, &site.lights, view, &mask, &skipped),
        skipped,
        mask,
        plan,
        closed,
    }
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
            for method in EXACT {
                let way = Way::new(Construction::Brute, Extrusion::Infinite, method);
                assert_exact(&format!("{spec}, {way:?}"), &draw(&site, &view, way));
            }
        }
    }
}

#[test]
fn corrected_distances_are_exact() {
    let [mut inside, mut beyond, mut finite, mut infinite] = [0; 4];
    for casters in CASTERS {
        let site = lamps(casters);
        for (number, view) in views(&site, by_profile(8, 4)).iter().enumerate() {
            for method in EXACT {
                let way = Way::new(Construction::Counter, CORRECTED, method);
                let found = draw(&site, view, way);
                assert_exact(&format!("{casters:?}, view {number}, {way:?}"), &found);
                for light in &found.plan.lights {
                    inside += u32::from(matches!(light.path, LightPath::ZPass { .. }));
                    let reason = ZFailReason::EyeBeyondRange;
                    beyond += u32::from(light.path == LightPath::ZFail(reason));
                    finite += u32::from(light.extrusion_m.is_finite());
                    infinite += u32::from(light.extrusion_m.is_infinite());
                }
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
            for construction in [Construction::Counter, Construction::Brute] {
                for method in EXACT {
                    let way = Way::new(construction, CORRECTED, method);
                    assert_exact(&format!("{spec}, {way:?}"), &draw(&site, &view, way));
                }
            }
        }
    }
}

#[test]
fn no_cull_changes_a_finite_mask() {
    let site = lamps(Casters::Both);
    for view in views(&site, 3) {
        let with = |culls| {
            let way = Way::new(Construction::Counter, CORRECTED, Method::Counter);
            draw(&site, &view, Way { culls, ..way }).mask.words
        };
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
        for method in EXACT {
            let way = Way::new(Construction::Counter, NAIVE, method);
            wrong += draw(&site, &view, way).judgement.wrong;
        }
    }
    assert!(wrong > 500, "{wrong}");
}

/// On a closed two-manifold the classic is exact; the room has a screen, a sail and a fan.
#[test]
fn the_classic_breaks_where_edges_have_not_two_triangles() {
    let classic = |site: &Site, view: &View, method| {
        let way = Way::new(Construction::Crow, Extrusion::Infinite, method);
        draw(site, view, way)
    };
    let mut closed = Site::new(room::boxes(), Casters::Front);
    closed.lights = room::lights();
    let open = lamps(Casters::Both);
    let mut wrong = 0;
    for method in EXACT {
        for view in views(&closed, 3) {
            assert_exact("boxes", &classic(&closed, &view, method));
        }
        for view in views(&open, 3) {
            let found = classic(&open, &view, method);
            assert!(!found.closed);
            wrong += found.judgement.wrong;
        }
    }
    assert!(wrong > 500, "{wrong}");
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
        for method in EXACT {
            for (construction, extrusion) in [
                (Construction::Brute, Extrusion::Infinite),
                (Construction::Counter, CORRECTED),
            ] {
                let way = Way::new(construction, extrusion, method);
                let found = draw(&site, &view, way);
                assert_exact(&format!("{}, {way:?}", path.display()), &found);
            }
        }
    }
}
