//! `umbrage render`: a lit picture with the shadows of all lights, and what each light cost.

use umbrage_core::frame::LightPath;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::heat::false_colours;
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::picture::write_png;
use umbrage_scene::Progress as _;
use umbrage_truth::Mask;

use crate::args::RenderArgs;
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::{LightReport, PathTaken, RenderReport, RenderTotals};
use crate::setting::Setting;
use umbrage_report::{Table, grouped};

/// Lights in the table; the JSON has all of them.
const LISTED: usize = 12;

/// Loads, draws, writes pictures, reports.
pub(crate) fn run(args: &RenderArgs) -> Result<(), CliError> {
    let setting = Setting::new(&args.scene, &args.common)?;
    let report = draw(&setting, args)?;
    args.common.results.show(&table(&report), &report)
}

/// Draws the frames and writes `--output` and `--mask-out`.
fn draw(setting: &Setting, args: &RenderArgs) -> Result<RenderReport, CliError> {
    let Setting {
        stage,
        lights,
        view,
    } = setting;
    let run = &args.common.run;
    let bar = Bar::new(args.common.results.quiet);
    bar.stage("open adapter", 0);
    let mut lab = Lab::new(Gpu::open(&run.adapter)?);
    lab.culls = run.culls();
    lab.application = run.shadows.into();
    bar.stage("draw", 0);
    let method = args.common.method.0;
    let lit = lab.render(stage, lights, view, method, run.repeat.get())?;
    let report = report(&lab, setting, method);
    if let Some(path) = &args.output {
        let rgb8 = match args.heatmap {
            None => lit.to_rgb8(),
            Some(heatmap) => {
                let counts = lab.heat(stage, lights, view, method, heatmap.into())?;
                false_colours(&counts)
            }
        };
        write_png(path, view.size, &rgb8)?;
    }
    if let Some(folder) = &args.mask_out {
        std::fs::create_dir_all(folder).map_err(|why| CliError::file(folder, why))?;
        let mask = lab.mask(stage, lights, view)?;
        bar.stage("write masks", lights.len() as u64);
        for (number, light) in (0..).zip(lights) {
            let path = folder.join(format!("{number:04}_{}.png", file_name(&light.name)));
            write_png(&path, view.size, &mask_rgb8(&mask, number))?;
            bar.advance(u64::from(number));
        }
    }
    Ok(report)
}

fn report(lab: &Lab, setting: &Setting, method: Method) -> RenderReport {
    let reports = setting.lights.iter().zip(&lab.volumes.lights);
    let lights: Vec<LightReport> = reports
        .enumerate()
        .map(|(number, (light, volume))| LightReport {
            name: light.name.clone(),
            kind: light.kind().to_owned(),
            range: (!light.light.is_directional()).then_some(light.light.range),
            subset_triangles: u64::from(volume.subset_triangles),
            facing_triangles: u64::from(volume.facing_triangles),
            quads: volume.quads.len() as u64,
            quads_drawn: u64::from(lab.quads_drawn(number)),
            cap_triangles: lab.plan.cap_triangles(number) as u64,
            layers_bound: u64::from(volume.layers_bound),
            parts: volume.parts.len().max(1) as u64,
            path: match lab.path(number) {
                LightPath::ZPass { .. } => PathTaken::Zpass,
                LightPath::ZFail(_) => PathTaken::Zfail,
                LightPath::Skipped(_) => PathTaken::Skipped,
            },
            reason: lab.path(number).reason().to_owned(),
            cached: volume.cached,
            build_us: f64::from(volume.build_us),
            gpu_us: None,
        })
        .collect();
    let times = &lab.times;
    let stages = [
        ("volumes", times.volumes),
        ("volumes_first", times.volumes_first),
        ("plan", times.plan),
        ("upload", times.upload),
        ("record", times.record),
        ("gpu_surface", times.gpu_surface),
        ("gpu_receivers", times.gpu_receivers),
        ("gpu_lights", times.gpu_lights),
        ("frame_first", times.frame_first),
    ];
    RenderReport {
        scene: setting.stage.scene.name.clone(),
        method: method.name().into_owned(),
        adapter: lab.gpu().adapter.clone(),
        size: setting.view.size,
        frame_ms: times.frame,
        stages_ms: stages.map(|(name, ms)| (name.to_owned(), ms)).into(),
        gpu_bytes: lab.gpu_bytes(),
        note: lab.held.note.clone(),
        totals: RenderTotals::of(&lights, lab.uploaded),
        lights,
    }
}

/// White where the light reaches the surface.
fn mask_rgb8(mask: &Mask, light: u32) -> Vec<u8> {
    let [width, height] = mask.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels
        .flat_map(|(x, y)| [if mask.get(x, y, light) { 255 } else { 0 }; 3])
        .collect()
}

/// A light's name without what a file name cannot hold.
fn file_name(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    name.chars().take(64).map(plain).collect()
}

/// The frame, its stages, and the lights with the most quads.
fn table(report: &RenderReport) -> Table {
    let totals = &report.totals;
    let mut table = drawn(&report.scene, &report.method, &report.adapter, report.size);
    table.row(["frame".to_owned(), milliseconds(report.frame_ms)]);
    for (stage, ms) in &report.stages_ms {
        table.row([format!("  {stage}"), milliseconds(*ms)]);
    }
    table
        .count("lights", report.lights.len() as u64)
        .count("  rebuilt", totals.lights_rebuilt)
        .count("  cached", totals.lights_cached)
        .count("  skipped", totals.lights_skipped);
    if totals.lights_split > 0 {
        table.row(["  in parts".to_owned(), in_parts(totals.lights_split)]);
    }
    table
        .count("subset triangles", totals.subset_triangles)
        .count("facing triangles", totals.facing_triangles)
        .count("quads", totals.quads)
        .count("polygons", totals.polygons)
        .count("  quads drawn", totals.quads_drawn)
        .count("  cap triangles", totals.cap_triangles)
        .count("uploaded bytes", totals.uploaded_bytes)
        .count("  of volumes", totals.uploaded_volume_bytes)
        .count("bytes on the GPU", report.gpu_bytes);
    if !report.note.is_empty() {
        table.row(["note", &report.note]);
    }
    let mut costly: Vec<&LightReport> = report
        .lights
        .iter()
        .filter(|light| light.path != PathTaken::Skipped)
        .collect();
    costly.sort_by_key(|light| std::cmp::Reverse(light.quads_drawn + light.cap_triangles));
    for light in costly.iter().take(LISTED) {
        let polygons = grouped(light.quads_drawn + light.cap_triangles);
        table.row([
            format!("light {}", light.name),
            format!("{polygons} polygons"),
        ]);
    }
    table
}

/// What became of lights with more layers than the stencil holds.
pub(crate) fn in_parts(lights: u64) -> String {
    let lights = grouped(lights);
    format!("{lights}: behind 256 casters or more the stencil would wrap; counted part by part")
}

/// A table that begins with what was drawn, how, on what and how large.
pub(super) fn drawn(scene: &str, method: &str, adapter: &str, [width, height]: [u32; 2]) -> Table {
    let mut table = Table::default();
    table
        .row(["scene", scene])
        .row(["method", method])
        .row(["adapter", adapter])
        .row(["size".to_owned(), format!("{width}x{height}")]);
    table
}

pub(super) fn milliseconds(ms: f64) -> String {
    format!("{ms:.2} ms")
}
