//! What a run reads and writes, tried before anything is measured.
//!
//! What is typed wrong should not show after an hour: scenes are looked for, and the report is
//! written while it is still empty.

use std::fs::Metadata;
use std::path::Path;

use umbrage_report::bench::{self, BenchReport};
use umbrage_scene::{Disk, light_file};

use super::interrupt::Interrupt;
use crate::args::BenchArgs;
use crate::error::CliError;
use crate::json;
use crate::values::LightChoice;

/// Looks for every file that is to be read.
pub(super) fn look_for(args: &BenchArgs) -> Result<(), CliError> {
    if let Some(file) = args.world.file.as_deref().filter(|_| args.scenes.len() > 1) {
        let scenes = args.scenes.len();
        let why = format!("--world holds one scene, and {scenes} are given; bench them one by one");
        return Err(CliError::file(file, why));
    }
    let actors = args.world.actors.iter().map(|actor| &actor.file);
    for scene in args.scenes.iter().chain(actors) {
        umbrage_scene::find(scene)?;
    }
    match &args.lights {
        LightChoice::File(path) => Ok(light_file::read(path, &Disk).map(|_| ())?),
        _ => Ok(()),
    }
}

/// Writes the empty report wherever it is to go, but for what would see it twice.
pub(super) fn try_out(
    args: &BenchArgs,
    report: &BenchReport,
    interrupt: &Interrupt,
) -> Result<(), CliError> {
    write(args, report, interrupt)?;
    // A pipe or a device would be handed two documents.
    match args.results.json.as_deref().filter(|path| is_file(path)) {
        Some(path) => write_json(path, report, interrupt),
        None => Ok(()),
    }
}

/// Whether `path` is, or will be, a file rather than standard output, a pipe or a device.
fn is_file(path: &Path) -> bool {
    let may_be = |there: Metadata| there.is_file() || there.is_dir();
    !json::is_stdout(path) && path.metadata().map_or(true, may_be)
}

fn write_json(path: &Path, report: &BenchReport, interrupt: &Interrupt) -> Result<(), CliError> {
    // Who reads a pipe may never do so, and the program should still end.
    let _whole = is_file(path).then(|| interrupt.writing());
    json::write(path, report)
}

/// Writes the report's folder.
pub(super) fn write(
    args: &BenchArgs,
    report: &BenchReport,
    interrupt: &Interrupt,
) -> Result<(), CliError> {
    let _whole = interrupt.writing();
    args.output.as_deref().map_or(Ok(()), |folder| {
        bench::write(folder, report).map_err(|why| CliError::BadInput(why.to_string()))
    })
}

/// Writes and prints all there is.
pub(super) fn hand_over(
    args: &BenchArgs,
    report: &BenchReport,
    interrupt: &Interrupt,
) -> Result<(), CliError> {
    let written = write(args, report, interrupt);
    if args.results.shows_tables() {
        json::print(&bench::terminal(report));
        if let Some(folder) = &args.output {
            json::print(&format!("\n{}\n", folder.join("index.html").display()));
        }
    }
    if let Some(path) = &args.results.json {
        write_json(path, report, interrupt)?;
    }
    written
}
