//! The judge goes red where it must, and only there.

mod common;

use std::sync::atomic::{AtomicU64, Ordering};

use common::*;
use glam::Vec3;
use umbrage_core::{Casting, Light, Mesh, View};
use umbrage_truth::{
    EyeRays, JudgeOptions, Judgement, Mask, NearClip, Oracle, Verdict, Verdicts, WrongKind, judge,
};

fn judged(oracle: &Oracle, view: &View, lights: &[Light], mask: &Mask) -> Judgement {
    judge(
        oracle,
        view,
        lights,
        mask,
        &JudgeOptions::default(),
        &|_, _| (),
    )
}

fn own_mask(oracle: &Oracle, view: &View, lights: &[Light]) -> Mask {
    oracle.shadow_mask(view, lights, NearClip::Clamped)
}

fn inverted(mask: &Mask) -> Mask {
    Mask {
        words: mask.words.iter().map(|w| !w).collect(),
        ..mask.clone()
    }
}

fn lights_over(count: usize, half: f32, seed: u64) -> Vec<Light> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let at = random.point(half) * Vec3::new(1.0, 0.0, 1.0);
            point_light(at + Vec3::Y * (0.9 + random.unit() * 0.4), half * 0.7)
        })
        .collect()
}

#[test]
fn a_single_flipped_bit_is_one_wrong_sample() {
    let oracle = Oracle::new(&floor_and_square(Casting::Front));
    let view = looking_down([96, 64]);
    let lights = [
        sun(Vec3::new(1.0, -1.0, 0.5)),
        point_light(Vec3::new(0.0, 3.0, 0.0), 50.0),
    ];
    let mask = own_mask(&oracle, &view, &lights);
    let clean = judged(&oracle, &view, &lights, &mask);
    assert_eq!((clean.wrong, clean.ambiguous), (0, 0));
    assert!(clean.samples > 4000 && clean.worst.is_empty());

    for (x, y) in [(48, 32), (10, 40), (70, 50), (48, 44)] {
        let mut flipped = mask.clone();
        let was_lit = mask.get(x, y, 1);
        flipped.set(x, y, 1, !was_lit);
        let found = judged(&oracle, &view, &lights, &flipped);
        assert_eq!((found.wrong, found.ambiguous), (1, 0), "{x} {y}");
        assert_eq!((found.per_light[0].wrong, found.per_light[1].wrong), (0, 1));
        let worst = &found.worst[0];
        assert_eq!((worst.x, worst.y, worst.light), (x, y, 1));
        assert_eq!(worst.kind == WrongKind::Lit, !was_lit);
        assert_eq!(found.wrong_lit, u64::from(!was_lit));
        assert_eq!(found.wrong_shadowed, u64::from(was_lit));
        assert!(worst.firm_px >= found.tolerance_px);
    }
}

#[test]
fn a_shadow_one_pixel_off_is_wrong() {
    let oracle = Oracle::new(&floor_and_square(Casting::Front));
    let view = looking_down([160, 120]);
    let lights = [point_light(Vec3::new(0.0, 3.0, 0.0), 50.0)];
    let mask = own_mask(&oracle, &view, &lights);
    let mut shifted = mask.clone();
    for y in 0..120 {
        for x in 1..160 {
            shifted.set(x, y, 0, mask.get(x - 1, y, 0));
        }
    }
    let found = judged(&oracle, &view, &lights, &shifted);
    assert!(found.wrong > 40, "{found:?}");
    assert!(found.ambiguous * 10 < found.wrong, "{found:?}");
    assert!(found.wrong_lit > 0 && found.wrong_shadowed > 0);
}

/// A wall seen straight on, a shadow edge on it `offset_px` pixels right of the centres of
/// column 20, and a mask wrong in that column.
fn edge_beside_centres(offset_px: f32, options: &JudgeOptions) -> Judgement {
    let mut mesh = Mesh::default();
    let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let wall = |x: [f32; 2], y: f32, z: f32| {
        [p(x[0], -y, z), p(x[1], -y, z), p(x[1], y, z), p(x[0], y, z)]
    };
    let edge = -8.0 + (20.5 + offset_px) * 0.25;
    // Wider than high: its diagonal passes no pixel centre.
    quad(&mut mesh, wall([-20.0, 21.0], 20.0, 0.0), Casting::Front);
    quad(
        &mut mesh,
        wall([edge - 2.0, edge - 1.0], 30.0, 1.0),
        Casting::Front,
    );
    let view = View {
        eye: p(0.0, 0.0, 8.0).into(),
        right: Vec3::X,
        up: Vec3::Y,
        forward: Vec3::NEG_Z,
        near: 0.5,
        scale_x: 1.0,
        scale_y: 1.0,
        size: [64, 64],
    };
    let oracle = Oracle::new(&mesh);
    let lights = [sun(p(1.0, 0.0, -1.0))];
    let mut mask = own_mask(&oracle, &view, &lights);
    for y in 0..64 {
        assert_eq!(mask.get(20, y, 0), offset_px <= 0.0);
        mask.set(20, y, 0, offset_px > 0.0);
    }
    judge(&oracle, &view, &lights, &mask, options, &|_, _| ())
}

#[test]
fn the_tolerance_is_a_64th_of_a_pixel() {
    for offset in [1.0 / 256.0, -1.0 / 256.0, 1.0 / 65.0, -1.0 / 65.0] {
        let found = edge_beside_centres(offset, &JudgeOptions::default());
        assert_eq!((found.wrong, found.ambiguous), (0, 64), "{offset}");
    }
    for offset in [1.0 / 32.0, -1.0 / 32.0, 1.0 / 63.0, -1.0 / 63.0] {
        let found = edge_beside_centres(offset, &JudgeOptions::default());
        assert_eq!((found.wrong, found.ambiguous), (64, 0), "{offset}");
    }
}

#[test]
fn a_stated_tolerance_is_reported_and_reaches_no_further() {
    let stated = JudgeOptions::default().with_tolerance_px(0.25);
    for offset in [1.0 / 5.0, -1.0 / 5.0, 0.3, -0.3] {
        let found = edge_beside_centres(offset, &stated);
        assert_eq!(found.tolerance_px, 0.25);
        // The wall's diagonal is that close to one of the centres.
        let wrong = if offset.abs() > 0.25 { 63..=64 } else { 0..=0 };
        assert!(wrong.contains(&found.wrong), "{offset}: {found:?}");
        assert_eq!(found.wrong + found.ambiguous, 64);
        let usual = edge_beside_centres(offset, &JudgeOptions::default());
        assert_eq!((usual.wrong, usual.ambiguous), (64, 0), "{offset}");
    }
}

#[test]
fn an_inverted_mask_is_wrong_nearly_everywhere() {
    // Boxes stand in a fine, bumpy ground: contact shadows, concave corners, thousands of edges.
    let oracle = Oracle::new(&landscape(60, 6.0, 60, 3));
    let view = View::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::ZERO, 1.0, 0.1, [160, 120]);
    let lights = lights_over(6, 6.0, 4);
    let mask = own_mask(&oracle, &view, &lights);
    let found = judged(&oracle, &view, &lights, &inverted(&mask));
    assert_eq!(found.wrong + found.ambiguous, found.samples);
    assert!(
        found.wrong_lit > 1000 && found.wrong_shadowed > 1000,
        "{found:?}"
    );
    let share = found.ambiguous as f64 / found.samples as f64;
    // Cells of the ground are a few pixels wide here: the band along their edges is 3 %.
    assert!(share < 0.05, "{share}");
    println!("ambiguous share of an inverted mask: {share}");
}

#[test]
fn a_skipped_light_must_light_nothing() {
    let oracle = Oracle::new(&floor_and_square(Casting::Front));
    let view = looking_down([64, 48]);
    // The second light stands below the floor.
    let lights = [
        point_light(Vec3::new(0.0, 3.0, 0.0), 50.0),
        point_light(Vec3::new(0.0, -3.0, 0.0), 50.0),
    ];
    let mask = own_mask(&oracle, &view, &lights);
    let skipping = |flags: [bool; 2]| {
        let options = JudgeOptions::default().with_skipped(flags.to_vec());
        judge(&oracle, &view, &lights, &mask, &options, &|_, _| ())
    };
    assert_eq!(skipping([false, true]).wrong, 0);
    let found = skipping([true, true]);
    assert!(found.wrong_shadowed > 1000 && found.wrong_lit == 0);
    assert_eq!(found.per_light[1], Default::default());
}

#[test]
fn thread_count_changes_nothing() {
    let oracle = Oracle::new(&landscape(30, 6.0, 12, 9));
    let view = View::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::ZERO, 1.0, 0.1, [120, 90]);
    let lights = lights_over(40, 6.0, 8);
    let all_dark = Mask::new(view.size, 40);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let oracle = Oracle::new(&landscape(30, 6.0, 12, 9));
            let largest = AtomicU64::new(0);
            let found = judge(
                &oracle,
                &view,
                &lights,
                &all_dark,
                &JudgeOptions::default(),
                &|done, all| {
                    assert_eq!(all, 120 * 90);
                    largest.fetch_max(done, Ordering::Relaxed);
                },
            );
            assert_eq!(largest.into_inner(), 120 * 90);
            (found, own_mask(&oracle, &view, &lights))
        })
    };
    let one = run(1);
    assert_eq!(one.0.worst.len(), umbrage_truth::judge::WORST_COUNT);
    assert_eq!(one, run(5));
    assert_eq!(own_mask(&oracle, &view, &lights), one.1);
}

#[test]
fn the_mask_says_what_the_verdicts_say() {
    // Tiles cull lights and remember blockers; single verdicts do neither.
    let oracle = Oracle::new(&landscape(20, 6.0, 12, 21));
    let view = View::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::ZERO, 1.0, 0.1, [50, 37]);
    let mut lights = lights_over(34, 3.0, 22);
    lights[7] = sun(Vec3::new(0.3, -0.5, 0.2));
    let mask = own_mask(&oracle, &view, &lights);
    let rays = EyeRays::new(&view, NearClip::Clamped);
    for (k, light) in lights.iter().enumerate() {
        for y in 0..37 {
            for x in 0..50 {
                let (at_x, at_y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let verdict = oracle.verdict(&rays, at_x, at_y, light);
                assert_eq!(mask.get(x, y, k as u32), verdict == Verdict::Lit);
            }
        }
    }
}

#[test]
fn kept_verdicts_judge_as_new_ones_do() {
    let oracle = Oracle::new(&landscape(20, 6.0, 12, 31));
    let view = View::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::ZERO, 1.0, 0.1, [70, 41]);
    let lights = lights_over(40, 5.0, 32);
    let right = own_mask(&oracle, &view, &lights);
    let mut wrong = right.clone();
    wrong.words.iter_mut().step_by(3).for_each(|w| *w = !*w);
    let dark = Mask::new(view.size, 40);
    let mut kept = Verdicts::new(&oracle, &view, &lights, NearClip::Clamped, &|_, _| ());
    let options = JudgeOptions::default();
    // The second round meets verdicts whose ambiguity is known.
    for mask in [&right, &wrong, &dark, &wrong] {
        let found = kept.judge(&oracle, mask, &[]);
        let anew = judge(&oracle, &view, &lights, mask, &options, &|_, _| ());
        assert_eq!(found, anew);
        let map = kept.error_map(mask, &[]);
        let sum = |counts: &[u16]| counts.iter().map(|&c| u64::from(c)).sum::<u64>();
        assert_eq!(sum(&map.wrong), found.wrong);
        assert_eq!(sum(&map.ambiguous), found.ambiguous);
    }
    assert_eq!(kept.judge(&oracle, &right, &[]).wrong, 0);
    assert!(kept.judge(&oracle, &wrong, &[]).wrong > 1000);
}

#[test]
#[should_panic(expected = "differ in size")]
fn a_mask_of_another_size_is_refused() {
    let oracle = Oracle::new(&floor_and_square(Casting::Front));
    judged(
        &oracle,
        &looking_down([64, 48]),
        &[],
        &Mask::new([48, 64], 0),
    );
}
