//! `umbrage bench`: run time against error, every method on the same frames.
//!
//! Takes scenes, cameras, sizes and methods; gives a report, a row a method and view. The oracle
//! judges all methods of a view by one cast of its rays. Each view that is done is written, so what
//! ends a run early leaves a valid report of what there is. A row that fails, or an exact method that
//! is wrong, is an exit code of its own, as is what got worse than the baseline.

mod files;
mod interrupt;
mod row;
mod settings;
mod verdict;

use std::time::SystemTime;

use umbrage_core::Light;
use umbrage_lab::application::Application;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::lab::Lab;
use umbrage_lab::stage::Stage;
use umbrage_report::bench::{self, BenchReport, Machine};
use umbrage_truth::{Oracle, Verdicts};

use crate::actor::oddities;
use crate::args::BenchArgs;
use crate::error::CliError;
use crate::progress::{Bar, Steps};
use crate::setting::{lights, stage, use_threads, view};
use crate::values::NamedCamera;

use interrupt::Interrupt;
use row::{Judge, Task, measure};
pub(crate) use settings::command_line;
use settings::settings;
use verdict::verdict;

/// Measures, writes, compares.
pub(crate) fn run(args: &BenchArgs) -> Result<(), CliError> {
    // What is typed wrong should not show after an hour.
    let baseline = args.baseline.as_deref().map(bench::read).transpose()?;
    // Methods without a mask leave nothing in the shadow, whatever is asked.
    let asked: Application = args.run.shadows.into();
    let mut refused = args.methods.iter().map(|method| method.0.check(asked));
    if refused.clone().all(|answer| answer.is_err()) {
        refused.next().unwrap_or(Ok(()))?;
    }
    files::look_for(args)?;
    use_threads(&args.run);
    let interrupt = Interrupt::listen();
    let mut lab = Lab::new(Gpu::open(&args.run.adapter)?);
    lab.culls = args.run.culls();
    let mut report = BenchReport {
        command: command_line(std::env::args_os()),
        settings: settings(args),
        oracle: !args.no_oracle,
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
    if let Some(baseline) = &baseline {
        // Refuses other settings; there is nothing to compare yet.
        bench::compare(baseline, &report, args.ratio)?;
    }
    files::try_out(args, &report, &interrupt)?;
    let views = args.scenes.len() * args.cameras().len() * args.sizes.len();
    let steps = Steps::new(args.results.quiet, views * (1 + args.methods.len()));
    let mut outcome = Ok(());
    for scene in &args.scenes {
        outcome = bench_scene(scene, args, &mut lab, &steps, &interrupt, &mut report);
        if outcome.is_err() {
            break;
        }
    }
    drop(steps);
    let asked = views * args.methods.len();
    report.complete = report.rows.len() == asked;
    // What there is stays, whatever ended the run; an error alone prints nothing else.
    if outcome.is_err() && report.rows.is_empty() {
        return outcome;
    }
    let handed_over = files::hand_over(args, &report, &interrupt);
    outcome.and(handed_over)?;
    verdict(args, baseline.as_ref(), &report, asked)
}

fn bench_scene(
    scene: &str,
    args: &BenchArgs,
    lab: &mut Lab,
    steps: &Steps,
    interrupt: &Interrupt,
    report: &mut BenchReport,
) -> Result<(), CliError> {
    if interrupt.came() {
        return Ok(());
    }
    steps.now(scene, "load");
    let quiet = Bar::new(true);
    let mut stage = stage(scene, &args.world, &quiet)?;
    for oddity in oddities(&stage.scene.report) {
        steps.say(&format!("{scene}: {oddity}"));
    }
    let lights = lights(&stage, &args.lights, &args.world)?;
    let mut oracle: Option<Oracle> = None;
    for camera in args.cameras() {
        for size in &args.sizes {
            let choice = camera.as_ref().map(|camera| &camera.choice);
            let view = view(&stage, &lights, choice, size.0, args.near)?;
            if interrupt.came() {
                return Ok(());
            }
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
                let asked = args.run.shadows.into();
                lab.application = match method.0.check(asked) {
                    Ok(()) => asked,
                    Err(_) => Application::Black,
                };
                let task = Task {
                    stage: &mut stage,
                    step_s: args.play.map_or(0.0, |fps| 1.0 / f64::from(fps)),
                    lights: &lights,
                    view: &view,
                    method: method.0,
                    repeat: args.run.repeat.get(),
                    limit: args.limit,
                    interrupt,
                };
                let mut row = measure(task, lab, judge.as_mut(), (scene, &camera, size.0));
                row.lights = lights.len() as u64;
                row.triangles = stage.mesh.triangles.len() as u64;
                report.push(row);
                steps.step();
            }
            files::write(args, report, interrupt)?;
        }
    }
    Ok(())
}

/// As typed, or the name of the camera that stands in for it.
fn camera_name(camera: Option<&NamedCamera>, stage: &Stage) -> String {
    match (camera, stage.scene.cameras.first()) {
        (Some(camera), _) => camera.text.clone(),
        (None, Some(first)) => first.name.clone(),
        (None, None) => "auto".to_owned(),
    }
}
