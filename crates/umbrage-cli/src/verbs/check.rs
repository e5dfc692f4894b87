//! `umbrage check`: a method's masks against the oracle's, counted.

use umbrage_core::Light;
use umbrage_core::frame::LightPath;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::lab::Lab;
use umbrage_scene::Progress as _;
use umbrage_truth::{JudgeOptions, Oracle, judge};

use crate::args::CheckArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::{CheckReport, LightsByPath, WorstPixel};
use crate::setting::Setting;
use umbrage_report::Table;

/// Loads, draws masks, judges them; a wrong pixel-light fails an exact method.
pub(crate) fn run(args: &CheckArgs) -> Result<(), CliError> {
    let setting = Setting::new(&args.scene, &args.common)?;
    let report = check(&setting, args)?;
    args.common.results.show(&table(&report), &report)?;
    if report.wrong > 0 && args.common.method.0.is_exact() {
        let (wrong, samples) = (report.wrong, report.samples);
        return Err(CliError::CheckFailed(format!(
            "{wrong} of {samples} pixel-lights are wrong"
        )));
    }
    Ok(())
}

/// Draws the masks and compares them.
fn check(setting: &Setting, args: &CheckArgs) -> Result<CheckReport, CliError> {
    let Setting {
        stage,
        lights,
        view,
    } = setting;
    let run = &args.common.run;
    let method = args.common.method.0;
    let bar = Bar::new(args.common.results.quiet);
    bar.stage("open adapter", 0);
    let mut lab = Lab::new(Gpu::open(&run.adapter)?);
    lab.culls = run.culls();
    bar.stage("draw masks", 0);
    lab.prepare(stage, lights, view, method);
    let mask = lab.mask(stage, lights, view)?;
    let unrepresentable = lab.unrepresentable(stage, lights, view)?;
    bar.stage("build oracle", 0);
    let oracle = Oracle::new(&stage.mesh);
    bar.stage("judge", u64::from(view.size[0]) * u64::from(view.size[1]));
    let plain: Vec<Light> = lights.iter().map(|light| light.light).collect();
    let skipped = |light| matches!(lab.path(light), LightPath::Skipped(_));
    let options = JudgeOptions::default()
        .with_near(lab.near_clip())
        .with_skipped((0..lights.len()).map(skipped).collect());
    let found = judge(&oracle, view, &plain, &mask, &options, &|done, _| {
        bar.advance(done);
    });
    let [zpass, zfail, skipped] = lab.lights_by_path().map(|count| count as u64);
    let worst = found.worst.iter().map(|worst| WorstPixel {
        x: worst.x,
        y: worst.y,
        light: lights[worst.light as usize].name.clone(),
    });
    Ok(CheckReport {
        scene: stage.scene.name.clone(),
        method: method.name().into_owned(),
        adapter: lab.gpu().adapter.clone(),
        size: view.size,
        pixels: found.pixels,
        lights: lights.len() as u64,
        samples: found.samples,
        wrong: found.wrong,
        ambiguous: found.ambiguous,
        unrepresentable: unrepresentable.map(|bits| bits.words.iter().map(ones).sum()),
        tolerance_px: found.tolerance_px,
        tolerance_depth: found.tolerance_depth,
        closed: lab.volumes.check_closed(&stage.world).is_ok(),
        worst: worst.collect(),
        lights_by_path: LightsByPath {
            zpass,
            zfail,
            skipped,
        },
    })
}

fn ones(word: &u32) -> u64 {
    u64::from(word.count_ones())
}

fn table(report: &CheckReport) -> Table {
    let mut table = Table::default();
    let size = report.size;
    table
        .row(["scene", &report.scene])
        .row(["method", &report.method])
        .row(["adapter", &report.adapter])
        .row(["size".to_owned(), format!("{}x{}", size[0], size[1])])
        .count("pixels", report.pixels)
        .count("lights", report.lights)
        .count("  z-pass", report.lights_by_path.zpass)
        .count("  z-fail", report.lights_by_path.zfail)
        .count("  skipped", report.lights_by_path.skipped)
        .count("pixel-lights", report.samples)
        .count("  wrong", report.wrong)
        .count("  ambiguous", report.ambiguous)
        .row([
            "volumes",
            if report.closed {
                "closed"
            } else {
                "NOT CLOSED"
            },
        ]);
    if let Some(unrepresentable) = report.unrepresentable {
        table.count("layers beyond the mask", unrepresentable);
    }
    for worst in &report.worst {
        table.row([
            format!("wrong at {}, {}", worst.x, worst.y),
            worst.light.clone(),
        ]);
    }
    table
}
