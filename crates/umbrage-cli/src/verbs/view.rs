//! `umbrage view`: a window on the scene.

use umbrage_lab::stage::StageLight;
use umbrage_report::Table;
use umbrage_scene::Progress as _;
use umbrage_view::{Options, Screenshot, Subject};

use crate::args::WindowArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::ViewReport;
use crate::setting::Setting;
use crate::verbs::render::{drawn, milliseconds};

/// Lights named where one is not found.
const NAMED: usize = 5;

/// Loads, opens the window, and reports when it is closed.
pub(crate) fn run(args: WindowArgs) -> Result<(), CliError> {
    let Setting {
        stage,
        lights,
        view,
    } = Setting::new(&args.scene, &args.common)?;
    let (run, method) = (&args.common.run, args.common.method.0);
    let chosen = args.select.as_deref().map(|name| number(&lights, name));
    let mut options = Options::default();
    options.adapter = run.adapter.clone();
    options.method = method;
    options.culls = run.culls();
    options.application = run.shadows.into();
    options.shown = args.shown;
    options.chosen = chosen.transpose()?;
    options.screenshot = args.screenshot.map(|file| Screenshot {
        file,
        frames: args.frames.get(),
    });
    let bar = Bar::new(args.common.results.quiet);
    bar.stage("open window", 0);
    let scene = stage.scene.name.clone();
    let seen = umbrage_view::open(
        Subject {
            stage,
            lights,
            view,
        },
        options,
    )?;
    drop(bar);
    let report = ViewReport {
        scene,
        method: method.name().into_owned(),
        adapter: seen.adapter,
        size: seen.size,
        frames: seen.frames,
        frame_ms: seen.frame_ms,
    };
    args.common.results.show(&table(&report), &report)
}

/// The light of this name.
fn number(lights: &[StageLight], name: &str) -> Result<usize, CliError> {
    let found = lights.iter().position(|light| light.name == name);
    found.ok_or_else(|| {
        let some: Vec<&str> = lights.iter().take(NAMED).map(|l| &*l.name).collect();
        let (count, some) = (lights.len(), some.join(", "));
        CliError::BadInput(format!(
            "--select {name}: no light is called so; there are {count}, the first ones: {some}"
        ))
    })
}

fn table(report: &ViewReport) -> Table {
    let mut table = drawn(&report.scene, &report.method, &report.adapter, report.size);
    table
        .count("frames", report.frames)
        .row(["last frame".to_owned(), milliseconds(report.frame_ms)]);
    table
}
