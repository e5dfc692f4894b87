//! Time of the oracle and the judge on a synthetic landscape:
//! `cargo run --release -p umbrage-truth --example judge_speed [cells] [lights]`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::*;
use glam::Vec3;
use umbrage_core::View;
use umbrage_truth::{JudgeOptions, Mask, NearClip, Oracle, judge};

fn main() {
    let mut arguments = std::env::args().skip(1).filter_map(|a| a.parse().ok());
    let cells = arguments.next().unwrap_or(172u32);
    let count = arguments.next().unwrap_or(256u32);
    let mesh = landscape(cells, 30.0, 100, 1);
    let view = View::look_at(
        Vec3::new(20.0, 12.0, 25.0),
        Vec3::ZERO,
        1.0,
        0.1,
        [640, 360],
    );
    let mut random = Random(2);
    let lights: Vec<_> = (0..count)
        .map(|_| {
            let at = random.point(30.0) * Vec3::new(1.0, 0.0, 1.0);
            point_light(at + Vec3::Y * (2.0 + random.unit()), 8.0)
        })
        .collect();

    let timed =
        |name: &str, start: Instant| println!("{name}: {:.3} s", start.elapsed().as_secs_f64());
    println!(
        "{} triangles, {count} lights, {} threads",
        mesh.triangles.len(),
        rayon::current_num_threads()
    );
    let start = Instant::now();
    let oracle = Oracle::new(&mesh);
    timed("build", start);
    let start = Instant::now();
    let mask = oracle.shadow_mask(&view, &lights, NearClip::Clamped);
    timed("own mask", start);
    let judged = |name: &str, mask: &Mask| {
        let start = Instant::now();
        let found = judge(
            &oracle,
            &view,
            &lights,
            mask,
            &JudgeOptions::default(),
            &|_, _| (),
        );
        timed(name, start);
        println!(
            "  samples {}, wrong {}, ambiguous {}",
            found.samples, found.wrong, found.ambiguous
        );
    };
    judged("judge, own mask", &mask);
    judged(
        "judge, all lit",
        &Mask {
            words: vec![!0; mask.words.len()],
            ..mask.clone()
        },
    );
    judged(
        "judge, inverted",
        &Mask {
            words: mask.words.iter().map(|w| !w).collect(),
            ..mask
        },
    );
}
