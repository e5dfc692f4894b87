//! `umbrage bench`: run time against error, every method on the same frames.
//!
//! Takes scenes, cameras, sizes and methods; gives a report, a row a method and view. The oracle
//! judges all methods of a view by one cast of its rays. Each view that is done is written, so what
//! ends a run early leaves a valid report of what there is.

mod interrupt;
mod row;

use std::time::SystemTime;

use umbrage_core::Light;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::lab::Lab;
use umbrage_lab::stage::Stage;
use umbrage_report::bench::{self, BenchReport, Machine};
use umbrage_truth::{Oracle, Verdicts};

use crate::args::BenchArgs;
use crate::error::CliError;
use crate::json;
use crate::progress::{Bar, Steps};
use crate::setting::{lights, stage, use_threads, view};
use crate::values::NamedCamera;

use interrupt::Interrupt;
use row::{Judge, Task, measure};

/// Measures, writes, compares.
pub(crate) fn run(args: &BenchArgs) -> Result<(), CliError> {
    // What is typed wrong should not show after an hour.
    let baseline = args.baseline.as_deref().map(bench::read).transpose()?;
    for method in &args.methods {
        method.0.check(args.run.shadows.into())?;
    }
    use_threads(&args.run);
    let interrupt = Interrupt::listen();
    let mut lab = Lab::new(Gpu::open(&args.run.adapter)?);
    lab.culls = args.run.culls();
    lab.application = args.run.shadows.into();
    let mut report = BenchReport {
        command: command_line(),
        when: bench::rfc3339(SystemTime::now()),
        machine: Machine {
            adapter: lab.gpu().adapter.clone(),
            driver: lab.gpu().driver.clone(),
            threads: rayon::current_num_threads() as u32,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Machine::here()
        },
        repeat: args.run.repeat.get() as u32,
        ..BenchReport::default()
    };
    let views = args.scenes.len() * args.cameras().len() * args.sizes.len();
    let steps = Steps::new(args.results.quiet, views * (1 + args.methods.len()));
    for scene in &args.scenes {
        bench_scene(scene, args, &mut lab, &steps, &interrupt, &mut report)?;
        if interrupt.came() {
            break;
        }
    }
    drop(steps);
    report.complete = !interrupt.came();
    write(args, &report)?;
    if args.results.shows_tables() {
        json::print(&bench::terminal(&report));
        if let Some(folder) = &args.output {
            json::print(&format!("\n{}\n", folder.join("index.html").display()));
        }
    }
    if let Some(path) = &args.results.json {
        json::write(path, &report)?;
    }
    if interrupt.came() {
        let rows = report.rows.len();
        return Err(CliError::CheckFailed(format!(
            "interrupted: {rows} of {} rows were measured",
            views * args.methods.len()
        )));
    }
    match baseline {
        Some(baseline) => compare(args, &baseline, &report),
        None => Ok(()),
    }
}

fn bench_scene(
    scene: &str,
    args: &BenchArgs,
    lab: &mut Lab,
    steps: &Steps,
    interrupt: &Interrupt,
    report: &mut BenchReport,
) -> Result<(), CliError> {
    steps.now(scene, "load");
    let quiet = Bar::new(true);
    let stage = stage(scene, &args.world, &quiet)?;
    let lights = lights(&stage, &args.lights, &args.world)?;
    let mut oracle: Option<Oracle> = None;
    for camera in args.cameras() {
        for size in &args.sizes {
            let choice = camera.as_ref().map(|camera| &camera.choice);
            let view = view(&stage, &lights, choice, size.0, args.near)?;
            let mut judge = None;
            if args.no_oracle {
                steps.step();
            } else {
                steps.now(scene, "oracle");
                let oracle = oracle.get_or_insert_with(|| Oracle::new(&stage.mesh));
                let plain: Vec<Light> = lights.iter().map(|light| light.light).collect();
                let near = lab.near_clip();
                let verdicts = Verdicts::new(oracle, &view, &plain, near, &|done, all| {
                    steps.within(done as f64 / all as f64);
                });
                steps.step();
                judge = Some(Judge { oracle, verdicts });
            }
            let camera = camera_name(camera.as_ref(), &stage);
            for &method in &args.methods {
                if interrupt.came() {
                    return Ok(());
                }
                steps.now(scene, &method.to_string());
                let task = Task {
                    stage: &stage,
                    lights: &lights,
                    view: &view,
                    method: method.0,
                    repeat: args.run.repeat.get(),
                    limit: args.limit,
                    interrupt,
                };
                let mut row = measure(&task, lab, judge.as_mut(), (scene, &camera, size.0));
                row.lights = lights.len() as u64;
                row.triangles = stage.mesh.triangles.len() as u64;
                report.push(row);
                steps.step();
            }
            write(args, report)?;
        }
    }
    Ok(())
}

fn write(args: &BenchArgs, report: &BenchReport) -> Result<(), CliError> {
    args.output.as_deref().map_or(Ok(()), |folder| {
        bench::write(folder, report).map_err(|why| CliError::BadInput(why.to_string()))
    })
}

fn compare(args: &BenchArgs, baseline: &BenchReport, report: &BenchReport) -> Result<(), CliError> {
    let found = bench::compare(baseline, report, args.ratio);
    if args.results.shows_tables() {
        json::print(&format!("\n{found}"));
    }
    match found.is_worse() {
        false => Ok(()),
        true => Err(CliError::CheckFailed(format!(
            "slower or less exact than the baseline by more than a factor of {}",
            args.ratio
        ))),
    }
}

/// As typed, or the name of the camera that stands in for it.
fn camera_name(camera: Option<&NamedCamera>, stage: &Stage) -> String {
    match (camera, stage.scene.cameras.first()) {
        (Some(camera), _) => camera.text.clone(),
        (None, Some(first)) => first.name.clone(),
        (None, None) => "auto".to_owned(),
    }
}

/// How this program was called, for a shell.
fn command_line() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: String| match word.chars().all(plain) && !word.is_empty() {
        true => word,
        false => format!("'{}'", word.replace('\'', "'\\''")),
    };
    let words = std::env::args().skip(1).map(quoted);
    let words: Vec<String> = std::iter::once("umbrage".to_owned()).chain(words).collect();
    words.join(" ")
}
