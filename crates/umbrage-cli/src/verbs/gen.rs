//! `umbrage gen`: a generated world as a .glb file.

use umbrage_scene::{Progress, write};

use crate::args::GenArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::GenReport;
use umbrage_report::Table;

/// Generates and writes.
pub(crate) fn run(args: &GenArgs) -> Result<(), CliError> {
    let extension = args
        .output
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    if extension.as_deref() != Some("glb") {
        return Err(CliError::file(
            &args.output,
            "the output is binary glTF: name it .glb",
        ));
    }
    let name = args.world.strip_prefix("gen:").unwrap_or(&args.world);
    let bar = Bar::new(args.results.quiet);
    let scene = umbrage_scene::open(&format!("gen:{name}"), &bar)?;

    bar.stage("write", 0);
    write::glb(&scene, &args.output)?;
    let bytes = args
        .output
        .metadata()
        .map_err(|error| CliError::file(&args.output, error))?;
    drop(bar);

    let report = GenReport {
        scene: scene.name.clone(),
        file: args.output.display().to_string(),
        bytes: bytes.len(),
        triangles: scene.flattened_triangles(),
        lights: scene.lights.len() as u64,
    };
    let mut table = Table::default();
    table.row(["file", &report.file]);
    table.count("bytes", report.bytes);
    table
        .count("triangles", report.triangles)
        .count("lights", report.lights);
    args.results.show(&table, &report)
}
