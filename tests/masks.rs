//! Masks instead of a stencil: right wherever they can represent the layers, wrong nowhere else, and
//! at lower resolutions only beside edges.

mod common;

use common::{
    Site, check, check_changed, judged, lab, plain, point, room, scene_of, skipped, staged,
};
use glam::Vec3;
use umbrage_core::View;
use umbrage_core::frame::{LightPath, LightPlan};
use umbrage_core::volume::Volumes;
use umbrage_lab::application::Application;
use umbrage_lab::auto_camera::auto_camera;
use umbrage_lab::gpu::GpuError;
use umbrage_lab::lab::Method;
use umbrage_lab::method::{Counting, Divisor, MaskBuffer};
use umbrage_lab::picture::Lit;
use umbrage_lab::stage::{Casters, StageLight};
use umbrage_scene::Mesh;
use umbrage_truth::{EyeRays, Mask, NearClip, Verdict};

const MASKS: [Method; 3] = [
    Method::Mask(MaskBuffer::Screen),
    Method::Mask(MaskBuffer::Alpha),
    Method::Mask(MaskBuffer::Max),
];

const APPLICATIONS: [Application; 3] = [
    Application::Black,
    Application::Ambient,
    Application::Attenuated,
];

/// A floor at height 0 and `count` slats side by side above it, two metres apart, double-sided.
fn fence(count: u16) -> Site {
    let mut mesh = Mesh {
        name: "fence".to_owned(),
        ..Mesh::default()
    };
    let far = 4.0 + 2.0 * f32::from(count);
    let floor = [
        Vec3::new(-far, 0.0, -far),
        Vec3::new(-far, 0.0, far),
        Vec3::new(far, 0.0, far),
        Vec3::new(far, 0.0, -far),
    ];
    room::quad(&mut mesh, floor, 0);
    for i in 0..count {
        let x = 2.0 * f32::from(i) - f32::from(count);
        let slat = [
            Vec3::new(x, 1.0, -2.0),
            Vec3::new(x, 1.0, 2.0),
            Vec3::new(x + 1.0, 1.0, 2.0),
            Vec3::new(x + 1.0, 1.0, -2.0),
        ];
        room::quad(&mut mesh, slat, 1);
    }
    Site::new(scene_of("fence", mesh), Casters::Material)
}

/// A lamp so high above a fence that its volumes stand side by side.
fn lamp() -> Vec<StageLight> {
    let mut lights = staged([point(Vec3::new(0.1, 500.0, 0.3), 2000.0)]);
    // Some units on the floor, well within what half floats resolve.
    lights[0].power *= 1e6;
    lights
}

/// Along a fence, just below its slats, through all volumes.
fn along(site: &Site, count: u16, size: [u32; 2]) -> View {
    let end = f32::from(count) + 1.5;
    let [eye, target] = [Vec3::new(-end, 0.95, 0.2), Vec3::new(end, 0.0, 0.1)];
    View::look_at(eye, target, 0.3, site.near(), size)
}

/// What a mask got wrong, and what it cannot represent.
struct Outcome {
    samples: u64,
    wrong: u64,
    /// Wrong where the layers can be represented.
    unexcused: u64,
    unrepresentable: u64,
    zfail: bool,
}

/// Draws and judges; then once more with the oracle's word wherever the layers are too many.
fn outcome(site: &Site, lights: &[StageLight], view: &View, method: Method) -> Outcome {
    let (mask, beyond, skipped, zfail, near) = {
        let mut lab = lab();
        lab.prepare(&site.stage, lights, view, method);
        let mask = lab.mask(&site.stage, lights, view).expect("a mask");
        let beyond = lab.unrepresentable(&site.stage, lights, view);
        let beyond = beyond.expect("counted").expect("has a limit");
        let is_zfail = |light: &LightPlan| matches!(light.path, LightPath::ZFail(_));
        let zfail = lab.plan.lights.iter().any(is_zfail);
        let skipped = skipped(&lab);
        lab.volumes = Volumes::default();
        (mask, beyond, skipped, zfail, lab.near_clip())
    };
    let right = site.oracle.shadow_mask(view, &plain(lights), near);
    let words = mask.words.iter().zip(&right.words).zip(&beyond.words);
    let excused = Mask {
        words: words.map(|((m, r), b)| (m & !b) | (r & b)).collect(),
        ..mask.clone()
    };
    let judgement = judged(site, lights, view, &mask, &skipped);
    Outcome {
        samples: judgement.samples,
        wrong: judgement.wrong,
        unexcused: judged(site, lights, view, &excused, &skipped).wrong,
        unrepresentable: beyond.words.iter().map(|w| u64::from(w.count_ones())).sum(),
        zfail,
    }
}

#[test]
fn two_layers_are_right_in_every_mask() {
    let site = fence(2);
    let size = [160, 120];
    let views = [
        along(&site, 2, size),
        site.look(Vec3::new(0.5, 3.0, 6.0), Vec3::ZERO, size),
        // The eye within a volume, and under both edges of a slat.
        site.look(Vec3::new(-1.4, 0.5, 0.1), Vec3::new(3.0, 0.0, 0.2), size),
    ];
    for method in MASKS {
        for view in &views {
            let found = outcome(&site, &lamp(), view, method);
            assert!(found.samples > 5_000, "{} samples", found.samples);
            let name = method.name();
            assert_eq!((found.wrong, found.unrepresentable), (0, 0), "{name}");
        }
    }
}

#[test]
fn layers_beyond_the_values_are_wrong_and_counted_as_such() {
    // The negative control: without layers beyond it the count would say nothing.
    for (method, slats) in MASKS.into_iter().zip([5, 40, 40]) {
        let site = fence(slats);
        let view = along(&site, slats, [320, 240]);
        let found = outcome(&site, &lamp(), &view, method);
        let name = method.name();
        assert!(found.wrong > 100, "{name}: {} wrong", found.wrong);
        assert_eq!(found.unexcused, 0, "{name}");
        assert!(found.unrepresentable >= found.wrong, "{name}");
        assert!(found.unrepresentable < found.samples, "{name}");
    }
}

#[test]
fn floats_count_further_than_eight_bits() {
    let site = fence(12);
    let view = along(&site, 12, [320, 240]);
    for (method, right) in MASKS.into_iter().zip([false, true, true]) {
        let found = outcome(&site, &lamp(), &view, method);
        assert_eq!(found.wrong == 0, right, "{}", method.name());
        assert_eq!(found.unrepresentable == 0, right, "{}", method.name());
    }
}

#[test]
fn from_a_side_of_a_volume_masks_count_behind_the_surface() {
    let site = fence(2);
    // Straight below the lamp's way past an edge of the second slat: on its side.
    let lights = staged([point(Vec3::new(0.0, 2.0, 0.0), 100.0)]);
    let eye = Vec3::new(1.5, 0.5, 0.25);
    let view = site.look(eye, Vec3::new(-3.0, 0.0, 0.5), [160, 120]);
    for method in MASKS {
        let found = outcome(&site, &lights, &view, method);
        let name = method.name();
        assert!(found.zfail, "{name}: not on a side");
        assert!(found.samples > 2_000, "{name}: {} samples", found.samples);
        assert_eq!(found.unexcused, 0, "{name}");
    }
    let found = outcome(&site, &lights, &view, MASKS[1]);
    assert_eq!((found.wrong, found.unrepresentable), (0, 0));
}

/// A standpoint that shows much of the site.
fn found_in(site: &Site, size: [u32; 2]) -> View {
    let stand = auto_camera(&site.stage.mesh, &plain(&site.lights), 1.0, 16.0 / 9.0);
    View::look_at(stand.eye, stand.target, 1.0, site.near(), size)
}

#[test]
fn a_count_below_zero_leaves_the_bits_of_other_lights_alone() {
    let site = fence(2);
    let view = site.look(
        Vec3::new(-1.4, 0.5, 0.1),
        Vec3::new(3.0, 0.0, 0.2),
        [160, 120],
    );
    let lights = [lamp(), lamp(), lamp()].concat();
    for method in MASKS {
        let right = check(&site, &lights, &view, method).mask;
        let short = check_changed(&site, &lights, &view, method, |lab| {
            let path = &mut lab.plan.lights[1].path;
            assert_eq!(*path, LightPath::ZPass { eye_count: 1 });
            *path = LightPath::ZPass { eye_count: 0 };
        });
        let differ = right.words.iter().zip(&short.mask.words);
        let (ours, others) = differ.fold((0, 0), |(ours, others), (a, b)| {
            (ours | ((a ^ b) & 2), others | ((a ^ b) & !2))
        });
        let name = method.name();
        assert_eq!(ours, 2, "{name}: the control: the count must be wrong");
        assert_eq!(others, 0, "{name}");
    }
}

#[test]
fn the_room_and_a_bundled_world_are_right_where_the_layers_fit() {
    let room = Site::new(room::scene(), Casters::Both);
    let lights = staged([
        point(Vec3::new(0.3, 4.3, 0.9), 30.0),
        point(Vec3::new(-4.1, 2.2, 1.3), 30.0),
        point(Vec3::new(5.2, 0.7, 3.3), 30.0),
    ]);
    let view = room.look(
        Vec3::new(6.5, 4.2, 5.1),
        Vec3::new(-1.0, 0.5, -0.5),
        [160, 120],
    );
    let keep = Site::open("data/worlds/stormkeep.glb", Casters::Material);
    let found = found_in(&keep, [128, 72]);
    for (site, lights, view) in [(&room, &lights, &view), (&keep, &keep.lights, &found)] {
        for method in MASKS {
            let found = outcome(site, lights, view, method);
            let name = method.name();
            assert_eq!(found.unexcused, 0, "{name}");
            assert!(found.unrepresentable >= found.wrong, "{name}");
            if method != MASKS[0] {
                assert_eq!(found.wrong, 0, "{name}");
            }
        }
    }
    let screen = outcome(&keep, &keep.lights, &found, MASKS[0]);
    assert!(
        screen.wrong > 0,
        "the control: three values are too few here"
    );
}

/// Every method at a lower resolution.
fn low_methods() -> Vec<(Method, u32)> {
    let all = Method::ALL.into_iter();
    all.filter_map(|method| match method {
        Method::LowResolution { divisor, .. } => Some((method, divisor.pixels())),
        _ => None,
    })
    .collect()
}

/// Verdicts of all pixels on one light, row by row.
fn verdicts(site: &Site, view: &View, light: &StageLight, near: NearClip) -> Vec<Verdict> {
    let rays = EyeRays::new(view, near);
    let [width, height] = view.size.map(u64::from);
    let at = |i: u64| {
        let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        site.oracle.verdict(&rays, x, y, &light.light)
    };
    (0..width * height).map(at).collect()
}

/// Wrong pixels of one light: all, and those around which the oracle says the same everywhere.
fn wrong_near_and_far(
    mask: &Mask,
    light: u32,
    verdicts: &[Verdict],
    distance: i64,
) -> (usize, usize) {
    let [width, height] = mask.size.map(i64::from);
    let (mut all, mut far) = (0, 0);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let verdict = verdicts[(y * width + x) as usize];
        let said = mask.get(x as u32, y as u32, light);
        if !verdict.is_sample() || said == (verdict == Verdict::Lit) {
            continue;
        }
        all += 1;
        let rows = (y - distance).max(0)..(y + distance + 1).min(height);
        let columns = (x - distance).max(0)..(x + distance + 1).min(width);
        let mut around = rows.flat_map(|y| columns.clone().map(move |x| (y, x)));
        let same = around.all(|(y, x)| verdicts[(y * width + x) as usize] == verdict);
        far += usize::from(same);
    }
    (all, far)
}

#[test]
fn lower_resolutions_are_wrong_beside_edges_and_nowhere_else() {
    let site = Site::new(room::scene(), Casters::Both);
    let lights = staged([
        point(Vec3::new(0.3, 4.3, 0.9), 30.0),
        point(Vec3::new(5.2, 2.7, 3.3), 30.0),
    ]);
    // No side is a multiple of four, or of two.
    let view = site.look(
        Vec3::new(6.5, 4.2, 5.1),
        Vec3::new(-1.0, 0.5, -0.5),
        [197, 151],
    );
    let near = lab().near_clip();
    let verdicts: Vec<_> = lights
        .iter()
        .map(|light| verdicts(&site, &view, light, near))
        .collect();
    let mut by_divisor = [0; 5];
    for (method, divisor) in low_methods() {
        let name = method.name();
        let of_screen = matches!(
            method,
            Method::LowResolution {
                of: Counting::Mask(MaskBuffer::Screen),
                ..
            }
        );
        let mask = check(&site, &lights, &view, method).mask;
        let (mut all, mut far) = (0, 0);
        for (number, verdicts) in (0..).zip(&verdicts) {
            let found = wrong_near_and_far(&mask, number, verdicts, 2 * i64::from(divisor));
            all += found.0;
            far += found.1;
        }
        let samples = verdicts.iter().flatten().filter(|v| v.is_sample()).count();
        assert!(all > 0, "{name}: the control: a lower resolution must show");
        assert!(all < samples / 10, "{name}: {all} of {samples} wrong");
        // Three values are too few for some pixels here, at any resolution.
        if !of_screen {
            assert_eq!(far, 0, "{name}: of {all} wrong");
            by_divisor[divisor as usize] = all;
        }
    }
    assert!(by_divisor[2] < by_divisor[4], "{by_divisor:?}");
}

#[test]
fn every_size_has_a_lower_resolution() {
    let site = fence(2);
    for size in [[1, 1], [2, 1], [3, 5], [5, 3], [7, 9], [64, 1]] {
        for (method, _) in low_methods() {
            let view = along(&site, 2, size);
            let found = check(&site, &lamp(), &view, method);
            assert_eq!(found.mask.size, size, "{}", method.name());
        }
    }
}

fn rendered(site: &Site, view: &View, method: Method, application: Application) -> Lit {
    picture(site, &lamp(), view, method, application)
}

fn picture(
    site: &Site,
    lights: &[StageLight],
    view: &View,
    method: Method,
    application: Application,
) -> Lit {
    let mut lab = lab();
    lab.application = application;
    let lit = lab.render(&site.stage, lights, view, method, 1);
    lab.application = Application::Black;
    lab.volumes = Volumes::default();
    lit.unwrap_or_else(|error| panic!("{}: {error}", method.name()))
}

/// Pixels in which two pictures differ by more than `share` of the second's brightest.
fn differing(a: &[Vec3], b: &[Vec3], share: f32) -> usize {
    let bright = b.iter().map(|c| c.max_element()).fold(0.0, f32::max);
    let differ = |(a, b): &(&Vec3, &Vec3)| (**a - **b).abs().max_element() > share * bright;
    a.iter().zip(b).filter(differ).count()
}

#[test]
fn pictures_are_the_counters_and_attenuated_ones_half_way_to_no_shadows() {
    let site = fence(2);
    let view = site.look(Vec3::new(0.5, 3.0, 6.0), Vec3::ZERO, [96, 72]);
    let black = Application::Black;
    let counter = rendered(&site, &view, Method::Counter, black).light;
    let lit = rendered(&site, &view, Method::None, black).light;
    let half_way: Vec<Vec3> = counter
        .iter()
        .zip(&lit)
        .map(|(c, l)| (c + l) / 2.0)
        .collect();
    assert!(differing(&counter, &lit, 0.1) > 100, "there are shadows");
    for method in MASKS {
        let name = method.name();
        let [black, ambient, attenuated] =
            APPLICATIONS.map(|a| rendered(&site, &view, method, a).light);
        // White is 254 of 255 in the paper's eight bits.
        assert_eq!(differing(&black, &counter, 0.006), 0, "{name}");
        assert_eq!(differing(&attenuated, &half_way, 0.006), 0, "{name}");
        let more = |(a, b): &(&Vec3, &Vec3)| a.cmpgt(**b).all();
        let reached = lit.iter().filter(|l| **l != Vec3::ZERO).count();
        let brighter = ambient.iter().zip(&black).filter(more).count();
        assert!(
            brighter >= reached,
            "{name}: {brighter} of {reached} have ambient light"
        );
        let added: Vec<Vec3> = ambient.iter().zip(&counter).map(|(a, c)| a - c).collect();
        let in_shadow = (0..counter.len()).filter(|&i| counter[i] == Vec3::ZERO);
        let in_shadow = in_shadow.filter(|&i| lit[i] != Vec3::ZERO);
        assert!(in_shadow.clone().count() > 100, "{name}");
        assert!(
            in_shadow.clone().all(|i| added[i].min_element() > 0.0),
            "{name}"
        );
    }
}

#[test]
fn lower_resolutions_attenuate_too() {
    let site = fence(2);
    let view = site.look(Vec3::new(0.5, 3.0, 6.0), Vec3::ZERO, [96, 72]);
    let lit = rendered(&site, &view, Method::None, Application::Black).light;
    for (method, _) in low_methods() {
        let name = method.name();
        let [black, _, attenuated] = APPLICATIONS.map(|a| rendered(&site, &view, method, a).light);
        let half_way: Vec<Vec3> = black.iter().zip(&lit).map(|(b, l)| (b + l) / 2.0).collect();
        assert!(
            differing(&black, &lit, 0.1) > 100,
            "{name}: there are shadows"
        );
        assert_eq!(differing(&attenuated, &half_way, 0.006), 0, "{name}");
    }
}

/// A leaning post within the range of a light at the origin, in front of a wall far beyond it, and
/// plates beside the light, each too wide to be hidden by those before it. Seen from [`beside_the_post`],
/// the wall beside the post is seen through the plates' volumes: in them all if `half_size` is 0.5,
/// and out of them again if it is 0.2.
fn post_before_a_wall(plates: u8, half_size: f32) -> Site {
    let mut mesh = Mesh {
        name: "post".to_owned(),
        ..Mesh::default()
    };
    let upright = |x: f32, [low, high]: [f32; 2], half: f32, lean: f32| {
        let corner = |y: f32, z: f32| Vec3::new(x, y, z);
        [
            corner(-half, low),
            corner(-half, high),
            corner(half, high + lean),
            corner(half, low + lean),
        ]
    };
    room::quad(&mut mesh, upright(-4.0, [3.4, 4.0], 3.0, 0.8), 1);
    room::quad(&mut mesh, upright(-30.0, [-60.0, 60.0], 60.0, 0.0), 1);
    for i in 0..plates {
        let x = 1.0 + 0.05 * f32::from(i);
        let half = half_size * (x + 0.05 * f32::from(i));
        room::quad(&mut mesh, upright(-x, [-half, half], half, 0.0), 1);
    }
    Site::new(scene_of("post", mesh), Casters::Material)
}

fn beside_the_post(site: &Site) -> View {
    let [eye, target] = [Vec3::new(4.0, 0.0, 8.0), Vec3::new(-4.0, 0.0, 4.0)];
    site.look(eye, target, [331, 247])
}

#[test]
fn masks_of_a_lower_resolution_are_normalised_beyond_the_receivers() {
    let mut lights = staged([point(Vec3::ZERO, 10.0)]);
    lights[0].power *= 1e3;
    let shadowed = post_before_a_wall(6, 0.5);
    let crossed = post_before_a_wall(1, 0.2);
    let mut failures = Vec::new();
    for (method, _) in low_methods() {
        let name = method.name();
        for (site, is_lit) in [(&shadowed, false), (&crossed, true)] {
            let view = beside_the_post(site);
            let picture = |method| picture(site, &lights, &view, method, Application::Black).light;
            let (lit, found) = (picture(Method::None), picture(method));
            let bright = lit.iter().map(|l| l.max_element()).fold(0.0, f32::max);
            // Not a number is too bright as well.
            let is_within = |f: Vec3, l: Vec3| (f - l).cmple(Vec3::splat(0.01 * bright)).all();
            let pixels = found.iter().zip(&lit);
            let brighter = pixels.filter(|(f, l)| !is_within(**f, **l)).count();
            let other = if is_lit {
                differing(&found, &lit, 0.01)
            } else {
                0
            };
            if brighter + other > 0 {
                failures.push(format!(
                    "{name}: {brighter} brighter, {other} other than lit"
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn who_makes_no_mask_cannot_apply_it() {
    let site = fence(1);
    let view = along(&site, 1, [16, 16]);
    let mut lab = lab();
    lab.application = Application::Attenuated;
    let refused = lab.render(&site.stage, &lamp(), &view, Method::Counter, 1);
    lab.application = Application::Black;
    assert!(matches!(refused, Err(GpuError::NoMask(_))), "{refused:?}");
}

#[test]
fn what_masks_hold_is_bounded_and_reported() {
    let site = fence(2);
    let lights = staged((0..70).map(|i| point(Vec3::new(i as f32 * 0.1, 50.0, 0.3), 200.0)));
    let view = along(&site, 2, [640, 480]);
    let mut lab = lab();
    for (method, most) in [
        (MASKS[0], 32 << 20),
        (MASKS[1], 0),
        (
            Method::LowResolution {
                of: Counting::Stencil,
                divisor: Divisor::Half,
            },
            48 << 20,
        ),
    ] {
        lab.prepare(&site.stage, &lights, &view, method);
        lab.mask(&site.stage, &lights, &view).expect("a mask");
        let held = lab.held.gpu_bytes;
        assert!(held <= most, "{}: {held} bytes", method.name());
        assert_eq!(held == 0, most == 0, "{}", method.name());
    }
    lab.volumes = Volumes::default();
}

#[test]
fn a_second_renderer_is_counted_where_masks_have_one() {
    let site = Site::open("data/worlds/stormkeep.glb", Casters::Material);
    let view = found_in(&site, [128, 72]);
    let mut lab = lab();
    let mut frame = |method| {
        lab.prepare(&site.stage, &site.lights, &view, method);
        lab.mask(&site.stage, &site.lights, &view).expect("a mask");
        let lights = 0..site.lights.len();
        let planned = lab.plan.drawn().map(|(_, light)| light.quads.len()).sum();
        let drawn: u32 = lights.map(|i| lab.quads_drawn(i)).sum();
        (lab.uploaded, [planned, drawn as usize], lab.held.gpu_bytes)
    };
    let (one, counter, _) = frame(Method::Counter);
    let half = Method::LowResolution {
        of: Counting::Stencil,
        divisor: Divisor::Half,
    };
    let (both, low, bytes) = frame(half);
    assert!(one.volume_bytes > 0 && one.other_bytes > 0);
    assert_eq!(both.volume_bytes, 2 * one.volume_bytes);
    assert_eq!(both.other_bytes, 2 * one.other_bytes);
    // The quads that are drawn are those of the lower resolution, which leaves out as many.
    assert_eq!(low[0], counter[0]);
    assert!(counter[1] < counter[0] && low[1] < low[0], "{low:?}");
    assert!(low[1].abs_diff(counter[1]) < counter[1] / 4, "{low:?}");
    let world = &site.stage.world;
    let edges = size_of_val(&world.edges.vertices[..]) + size_of_val(&world.positions[..]);
    let triangles = size_of_val(&world.triangles[..]);
    assert!(bytes as usize > edges + triangles + 8 * low[0], "{bytes}");
    lab.volumes = Volumes::default();
}
