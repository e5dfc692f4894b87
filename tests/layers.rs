//! Lights behind which a stencil of eight bits would wrap: drawn in parts, and right.

mod common;

use common::{EXACT, Site, by_profile, check, lab, point, room, scene_of, skipped, staged};
use glam::Vec3;
use umbrage_core::frame::LightPath;
use umbrage_core::volume::{LayerLimit, Volumes};
use umbrage_core::{Cull, Culls, Light, LightShape, View};
use umbrage_lab::heat::Heat;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::{Casters, StageLight};
use umbrage_scene::Mesh;
use umbrage_truth::Mask;

const SIZE: [u32; 2] = [120, 90];

/// A floor, and above it `sheets` level triangles, `step` metres apart; one under another, or all in
/// one place. A point below the floor is behind one layer more.
fn stack(sheets: usize, step: f32) -> Site {
    let mut mesh = Mesh {
        name: "stack".to_owned(),
        ..Mesh::default()
    };
    let level = |y: f32, far: f32| {
        [[-far, -far], [0.0, 1.5 * far], [far, -far]].map(|[x, z]| Vec3::new(x, y, z))
    };
    room::triangle(&mut mesh, level(0.0, 60.0), 0);
    for i in 0..sheets {
        room::triangle(&mut mesh, level(2.0 + step * i as f32, 2.0), 1);
    }
    Site::new(scene_of("stack", mesh), Casters::Material)
}

fn lamp() -> Light {
    point(Vec3::new(0.3, 40.0, 0.2), 200.0)
}

fn sun() -> Light {
    Light {
        shape: LightShape::Directional {
            direction: Vec3::new(0.1, -1.0, 0.07).normalize(),
        },
        ..lamp()
    }
}

/// From the side, from below, where the eye itself is behind all sheets, and from between them.
fn views(site: &Site) -> [View; 3] {
    [
        site.look(Vec3::new(9.0, 5.0, 8.0), Vec3::ZERO, SIZE),
        site.look(Vec3::new(0.2, 0.7, 0.3), Vec3::new(5.0, 0.0, 4.0), SIZE),
        site.look(Vec3::new(0.1, 2.205, 0.2), Vec3::new(6.0, 0.0, 5.0), SIZE),
    ]
}

/// What was drawn under other settings than the lab's own.
struct Drawn {
    mask: Mask,
    wrong: u64,
    samples: u64,
    /// Of each light.
    parts: Vec<usize>,
    bounds: Vec<u32>,
    paths: Vec<LightPath>,
}

fn draw(
    site: &Site,
    lights: &[StageLight],
    view: &View,
    method: Method,
    culls: Culls,
    layers: LayerLimit,
) -> Drawn {
    let (mask, skipped, volumes, paths) = {
        let mut lab = lab();
        (lab.culls, lab.layers) = (culls, layers);
        lab.prepare(&site.stage, lights, view, method);
        let mask = lab.mask(&site.stage, lights, view).expect("a mask");
        (lab.culls, lab.layers) = (Culls::EVERY, LayerLimit::STENCIL);
        let volumes = std::mem::take(&mut lab.volumes);
        let paths = lab.plan.lights.iter().map(|light| light.path).collect();
        (mask, skipped(&lab), volumes, paths)
    };
    volumes
        .check_closed(&site.stage.world)
        .expect("closed, part by part");
    let judgement = common::judged(site, lights, view, &mask, &skipped);
    Drawn {
        mask,
        wrong: judgement.wrong,
        samples: judgement.samples,
        parts: volumes
            .lights
            .iter()
            .map(|light| light.parts.len())
            .collect(),
        bounds: volumes
            .lights
            .iter()
            .map(|light| light.layers_bound)
            .collect(),
        paths,
    }
}

/// All casters: a stack hides itself but for its top.
const ALL: Culls = Culls::EVERY.without(Cull::Hidden);

#[test]
fn stacks_of_any_height_are_dark_below() {
    for (sheets, step) in [
        (254, 0.01),
        (255, 0.01),
        (256, 0.01),
        (257, 0.01),
        (512, 0.01),
        (700, 0.01),
        (256, 0.0),
    ] {
        let site = stack(sheets, step);
        for light in [lamp(), sun()] {
            let lights = staged([light]);
            for (number, view) in views(&site).iter().enumerate() {
                for method in EXACT {
                    let found = draw(&site, &lights, view, method, ALL, LayerLimit::STENCIL);
                    let what = format!(
                        "{sheets} sheets {step} m apart, view {number}, {}",
                        method.name()
                    );
                    assert_eq!(found.wrong, 0, "{what}");
                    assert!(found.samples > 1000, "{what}");
                    let layers = sheets + 1;
                    assert_eq!(found.bounds, [layers as u32], "{what}");
                    let parts = if layers > 255 {
                        layers.div_ceil(127)
                    } else {
                        0
                    };
                    assert_eq!(found.parts, [parts], "{what}");
                    if number == 1 && method == Method::Counter {
                        let eye_count = sheets as u32;
                        assert_eq!(found.paths, [LightPath::ZPass { eye_count }], "{what}");
                    }
                }
            }
        }
    }
}

/// The negative control: in one go, 256 sheets and 512 are none. And one less or more is not.
#[test]
fn undivided_stacks_wrap() {
    for (sheets, step, wraps) in [
        (256, 0.01, true),
        (512, 0.01, true),
        (256, 0.0, true),
        (257, 0.01, false),
    ] {
        let site = stack(sheets, step);
        for light in [lamp(), sun()] {
            for (number, view) in views(&site)[..2].iter().enumerate() {
                for method in EXACT {
                    let found = draw(&site, &staged([light]), view, method, ALL, LayerLimit::NONE);
                    let what = format!("{sheets} sheets, view {number}, {}", method.name());
                    assert_eq!(found.parts, [0]);
                    assert_eq!(found.wrong > 50, wraps, "{what}: {} wrong", found.wrong);
                }
            }
        }
    }
}

/// Sheets in one place hide none of each other: such a light is divided with every step on.
#[test]
fn sheets_in_one_place_are_divided_under_every_step() {
    let site = stack(300, 0.0);
    for view in views(&site) {
        for method in EXACT {
            let found = draw(
                &site,
                &staged([lamp(), sun()]),
                &view,
                method,
                Culls::EVERY,
                LayerLimit::STENCIL,
            );
            assert_eq!(
                (found.wrong, found.parts),
                (0, vec![3, 3]),
                "{}",
                method.name()
            );
        }
    }
}

/// Every light in parts of one layer each: as exact as whole, whatever is skipped.
#[test]
fn any_light_may_be_divided() {
    let triangles = by_profile(3000, 600);
    let site = Site::open(
        &format!("gen:soup?triangles={triangles}&lights=6&seed=4"),
        Casters::Both,
    );
    let fine = LayerLimit { whole: 1, part: 1 };
    let mut most = 0;
    for seed in 0..3 {
        let view = site.seeded_view(seed, SIZE);
        for method in EXACT {
            let of = |culls, layers| draw(&site, &site.lights, &view, method, culls, layers);
            let [divided, unculled] = [ALL, Culls::NONE].map(|culls| of(culls, fine));
            assert_eq!(divided.wrong, 0, "{} of {}", divided.wrong, divided.samples);
            assert_eq!(of(Culls::EVERY, fine).wrong, 0);
            assert_eq!(of(ALL, LayerLimit::STENCIL).wrong, 0);
            assert!(
                divided.mask == unculled.mask,
                "culled and not, {}",
                method.name()
            );
            most = most.max(divided.parts.into_iter().max().unwrap_or(0));
        }
    }
    assert!(most > 3, "at most {most} parts");
}

/// Methods that count these volumes elsewhere or otherwise.
#[test]
fn other_methods_take_parts_as_they_can() {
    let site = stack(256, 0.01);
    let lights = staged([lamp(), sun()]);
    let view = &views(&site)[1];
    for (method, parts) in [
        ("brute", 3),
        ("counter-finite", 3),
        ("mask-alpha", 0),
        ("half", 3),
    ] {
        let method: Method = method.parse().expect("a method");
        let found = draw(&site, &lights, view, method, ALL, LayerLimit::STENCIL);
        assert_eq!(found.parts, [parts; 2], "{}", method.name());
        if parts > 0 && !matches!(method, Method::LowResolution { .. }) {
            assert_eq!(found.wrong, 0, "{}", method.name());
        }
    }
}

/// Layers are counted over all parts.
#[test]
fn heat_shows_all_layers() {
    let site = stack(300, 0.01);
    let lights = staged([lamp()]);
    let view = site.look(Vec3::new(5.0, 1.5, 4.0), Vec3::new(0.0, 0.0, 0.0), SIZE);
    let mut lab = lab();
    let counts = lab.heat(&site.stage, &lights, &view, Method::Counter, Heat::Layers);
    let counts = counts.expect("a heat map");
    assert_eq!(lab.volumes.lights[0].parts.len(), 3);
    lab.volumes = Volumes::default();
    let at = |layers: f32| counts.iter().filter(|count| **count == layers).count();
    assert!(at(300.0) > 100 && at(0.0) > 100);
    assert!(counts.iter().all(|count| (0.0..=301.0).contains(count)));
}

/// Where lights with parts and without share a frame, each has its own shadow.
#[test]
fn divided_and_whole_lights_share_a_frame() {
    let site = stack(300, 0.0);
    let aside = |x: f32| point(Vec3::new(x, 6.0, 1.0), 30.0);
    let lights = staged([aside(-9.0), lamp(), aside(9.0), sun(), aside(12.0)]);
    let view = &views(&site)[0];
    let found = check(&site, &lights, view, Method::Counter);
    common::assert_exact("mixed", &found);
    let numbers: Vec<u32> = found
        .plan
        .further_parts()
        .map(|(_, part)| part.number)
        .collect();
    assert_eq!(numbers, Vec::from_iter(5..5 + numbers.len() as u32));
    assert!(!numbers.is_empty());
}

/// A divided light that is left unshadowed lights all it reaches; those about it keep their parts, and
/// their shadows to the bit.
#[test]
fn divided_lights_may_be_left_unshadowed() {
    let site = stack(300, 0.0);
    let aside = |x: f32| point(Vec3::new(x, 6.0, 1.0), 30.0);
    let lights = staged([lamp(), aside(-9.0), sun()]);
    let view = &views(&site)[0];
    let mask = |unshadowed: Vec<usize>| {
        let mut lab = lab();
        lab.unshadowed = unshadowed;
        lab.prepare(&site.stage, &lights, view, Method::Counter);
        let mask = lab.mask(&site.stage, &lights, view).expect("a mask");
        lab.unshadowed.clear();
        mask
    };
    let (whole, left) = (mask(Vec::new()), mask(vec![0]));
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let mut brightened = 0;
    for (x, y) in pixels {
        for light in [1, 2] {
            let [before, after] = [&whole, &left].map(|mask| mask.get(x, y, light));
            assert_eq!(before, after, "light {light} at {x}, {y}");
        }
        assert!(
            left.get(x, y, 0) || !whole.get(x, y, 0),
            "{x}, {y} is darker"
        );
        brightened += u32::from(left.get(x, y, 0) && !whole.get(x, y, 0));
    }
    assert!(brightened > 100, "{brightened} pixels");
}
