//! `umbrage profile`: what each light costs, why, and what would make it cheaper.
//!
//! Takes a scene and a view. The ordinary frame is timed first, undisturbed; then every light is
//! built, drawn and counted one by one. A cost model is fitted to these figures; advice is what the
//! model says would save time, tried out in memory: what it changes is counted exactly, only time
//! is predicted, unless `--verify` measures that as well.

mod advice;
mod change;
mod lights;
mod measure;
mod model;
mod pictures;
mod rows;
mod trial;
mod verify;

use std::time::SystemTime;

use umbrage_lab::gpu::Gpu;
use umbrage_lab::lab::Lab;
use umbrage_report::bench::{Machine, rfc3339};
use umbrage_report::profile::{self, Pictures, ProfileReport};
use umbrage_report::{Table, grouped};

use crate::args::ProfileArgs;
use crate::error::CliError;
use crate::json;
use crate::progress::Steps;
use crate::setting::Setting;

use measure::Base;
use trial::Trials;

/// With `--verify` there are so many times the rounds.
const PATIENCE: usize = 3;

/// Measures, advises, writes.
pub(crate) fn run(args: &ProfileArgs) -> Result<(), CliError> {
    let common = &args.common;
    let method = common.method.0;
    if !lights::is_drawn_light_by_light(method) {
        return Err(CliError::BadInput(format!(
            "--method {method}: profile takes lights apart that count volumes in the stencil one by \
             one; choose counter, counter-zfail, counter-finite, brute or crow",
            method = method.name()
        )));
    }
    if let Some(folder) = &args.output {
        // What is typed wrong should not show after an hour.
        profile::write(folder, &ProfileReport::default())
            .map_err(|why| CliError::BadInput(why.to_string()))?;
    }
    let mut setting = Setting::new(&args.scene, common)?;
    let mut lab = Lab::new(Gpu::open(&common.run.adapter)?);
    lab.culls = common.run.culls();
    let steps = Steps::new(common.results.quiet, 4);
    let begun = SystemTime::now();
    // What is compared is measured alike.
    let rounds = match args.verify {
        true => PATIENCE * common.run.repeat.get(),
        false => common.run.repeat.get(),
    };
    steps.now(&args.scene, "measure lights");
    let mut base = Base::measure(&mut lab, &setting, method, rounds)?;
    steps.step();
    let mut report = ProfileReport {
        command: command_line(),
        when: rfc3339(begun),
        scene: setting.stage.scene.name.clone(),
        method: method.name().into_owned(),
        adapter: lab.gpu().adapter.clone(),
        machine: Machine {
            adapter: lab.gpu().adapter.clone(),
            driver: lab.gpu().driver.clone(),
            threads: rayon::current_num_threads() as u32,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Machine::here()
        },
        size: setting.view.size,
        triangles: setting.stage.mesh.triangles.len() as u64,
        rounds: rounds as u32,
        how: rows::how(&base),
        frame: rows::frame(&base),
        lights: rows::lights(&base, &setting),
        advice: Vec::new(),
        pictures: Pictures::default(),
    };
    if args.output.is_some() {
        steps.now(&args.scene, "pictures");
        report.pictures = pictures::pictures(&lab, &mut base, &setting, &report)?;
    }
    steps.step();
    steps.now(&args.scene, "advice");
    let candidates = advice::candidates(&base, &setting);
    let mut trials = Trials::new(lab, base, args.verify);
    for (place, candidate) in candidates.iter().enumerate() {
        steps.within(place as f64 / candidates.len() as f64);
        report
            .advice
            .extend(trials.try_out(candidate, &mut setting)?);
    }
    report.advice.sort_by(|a, b| {
        let weight = |one: &profile::Advice| one.predicted.weight_us();
        weight(b).total_cmp(&weight(a))
    });
    steps.step();
    if let Some(folder) = &args.output {
        profile::write(folder, &report).map_err(|why| CliError::BadInput(why.to_string()))?;
    }
    drop(steps);
    if common.results.shows_tables() {
        json::print(&in_words(&report));
        if let Some(folder) = &args.output {
            json::print(&format!("\n{}\n", folder.join("index.html").display()));
        }
    }
    let file = common.results.json.as_deref();
    file.map_or(Ok(()), |path| json::write(path, &report))
}

/// Lights in the table; the files have all of them.
const LISTED: usize = 12;

/// The frame, the lights that cost most, and the advice.
fn in_words(report: &ProfileReport) -> String {
    let mut table = Table::default();
    let ms = |us: f64| format!("{:.3} ms", us / 1e3);
    table.row(["scene", &report.scene]);
    table.row(["adapter", &report.adapter]);
    let frame = &report.frame;
    for (name, us, parts) in [
        ("frame", frame.frame_ms * 1e3, &frame.parts),
        ("all volumes anew", frame.build_us, &frame.build_parts),
    ] {
        table.row([name.to_owned(), ms(us)]);
        for part in parts {
            let share = format!("{:.1}%", 100.0 * part.share);
            table.row([format!("  {}", part.name), ms(part.us), share]);
        }
    }
    let mut lights = Table::default();
    lights.row([
        "light",
        "GPU us",
        "volume",
        "light",
        "build us",
        "quads",
        "lit pixels",
        "path",
    ]);
    for light in rows::costliest(&report.lights).into_iter().take(LISTED) {
        let light = &report.lights[light];
        let us = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |us| format!("{us:.0}"));
        lights.row([
            light.name.clone(),
            us(light.gpu_us.map(|gpu| gpu.total())),
            us(light.gpu_us.map(|gpu| gpu.volume)),
            us(light.gpu_us.map(|gpu| gpu.light)),
            us(Some(light.cpu_us.total())),
            grouped(light.quads_drawn),
            grouped(light.lit_pixels),
            light.path.clone(),
        ]);
    }
    let mut text = format!("{table}\n{lights}");
    for advice in &report.advice {
        text += &format!("\n- {}", rows::in_words(advice));
    }
    text + "\n"
}

fn command_line() -> String {
    crate::verbs::bench::command_line(std::env::args_os())
}
