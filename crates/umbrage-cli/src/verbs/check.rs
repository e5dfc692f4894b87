//! `umbrage check`: a method's masks against the oracle's, counted.
//!
//! An exact method fails by one wrong pixel-light, one whose mask represents so many layers by one
//! among those that it represents; others are counted only.

use umbrage_core::Light;
use umbrage_core::frame::LightPath;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::lab::Lab;
use umbrage_scene::Progress as _;
use umbrage_truth::{Mask, Oracle, Verdicts};

use crate::args::{CheckArgs, Shadows};
use crate::error::CliError;
use crate::progress::Bar;
use crate::report::{CheckReport, LightLayers, LightsByPath, WorstPixel};
use crate::setting::Setting;
use crate::verbs::render::{drawn, in_parts};
use umbrage_report::Table;

/// Loads, draws masks, judges them; a wrong pixel-light fails a method that promises there is none.
pub(crate) fn run(args: &CheckArgs) -> Result<(), CliError> {
    if args.common.run.shadows != Shadows::Black {
        let why = "--shadows: check judges where light is, which does not hang on what masks leave \
                   in the shadow; leave the option out";
        return Err(CliError::BadInput(why.to_owned()));
    }
    let setting = Setting::new(&args.scene, &args.common)?;
    let report = check(&setting, args)?;
    args.common.results.show(&table(&report), &report)?;
    verdict(&report, args.common.method.0.is_exact())
}

/// Fails if a pixel-light is wrong that the method promised.
fn verdict(report: &CheckReport, is_exact: bool) -> Result<(), CliError> {
    let samples = report.samples;
    match (report.wrong, report.wrong_representable) {
        (wrong @ 1.., _) if is_exact => Err(CliError::CheckFailed(format!(
            "{wrong} of {samples} pixel-lights are wrong"
        ))),
        (_, Some(wrong @ 1..)) => Err(CliError::CheckFailed(format!(
            "{wrong} of {samples} pixel-lights are wrong whose layers the mask can represent"
        ))),
        _ => Ok(()),
    }
}

/// A mask that says what `truth` says where it cannot represent the layers.
fn excused(mask: &Mask, unrepresentable: &Mask, truth: &Mask) -> Mask {
    let words = mask.words.iter().zip(&unrepresentable.words);
    let words = words.zip(&truth.words);
    Mask {
        words: words
            .map(|((said, beyond), truth)| said & !beyond | truth & beyond)
            .collect(),
        ..*mask
    }
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
    let note = lab.held.note.clone();
    let unrepresentable = lab.unrepresentable(stage, lights, view)?;
    bar.stage("build oracle", 0);
    let oracle = Oracle::new(&stage.mesh);
    bar.stage("judge", u64::from(view.size[0]) * u64::from(view.size[1]));
    let plain: Vec<Light> = lights.iter().map(|light| light.light).collect();
    let skipped = |light| matches!(lab.path(light), LightPath::Skipped(_));
    let skipped: Vec<bool> = (0..lights.len()).map(skipped).collect();
    let mut verdicts = Verdicts::new(&oracle, view, &plain, lab.near_clip(), &|done, _| {
        bar.advance(done);
    });
    let found = verdicts.judge(&oracle, &mask, &skipped);
    let wrong_representable = unrepresentable.as_ref().map(|beyond| {
        let rest = excused(&mask, beyond, &verdicts.mask());
        verdicts.judge(&oracle, &rest, &skipped).wrong
    });
    let [zpass, zfail, left_out] = lab.lights_by_path().map(|count| count as u64);
    let worst = found.worst.iter().map(|worst| WorstPixel {
        x: worst.x,
        y: worst.y,
        light: lights[worst.light as usize].name.clone(),
    });
    let volumes = lab.volumes.lights.iter().zip(&skipped);
    let layers: Vec<(u64, u64, bool)> = volumes
        .map(|(volume, &skipped)| {
            let parts = volume.parts.len().max(1) as u64;
            (u64::from(volume.layers_bound), parts, skipped)
        })
        .collect();
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
        wrong_representable,
        tolerance_px: found.tolerance_px,
        tolerance_depth: found.tolerance_depth,
        closed: lab.volumes.check_closed(&stage.world).is_ok(),
        worst: worst.collect(),
        lights_by_path: LightsByPath {
            zpass,
            zfail,
            skipped: left_out,
        },
        lights_split: layers
            .iter()
            .filter(|light| light.1 > 1 && !light.2)
            .count() as u64,
        layers: layers
            .into_iter()
            .zip(lights)
            .map(|((layers_bound, parts, _), light)| LightLayers {
                name: light.name.clone(),
                layers_bound,
                parts,
            })
            .collect(),
        note,
    })
}

fn ones(word: &u32) -> u64 {
    u64::from(word.count_ones())
}

fn table(report: &CheckReport) -> Table {
    let mut table = drawn(&report.scene, &report.method, &report.adapter, report.size);
    table
        .count("pixels", report.pixels)
        .count("lights", report.lights)
        .count("  z-pass", report.lights_by_path.zpass)
        .count("  z-fail", report.lights_by_path.zfail)
        .count("  skipped", report.lights_by_path.skipped);
    if report.lights_split > 0 {
        table.row(["  in parts".to_owned(), in_parts(report.lights_split)]);
    }
    table
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
    if let Some(wrong) = report.wrong_representable {
        table.count("  wrong elsewhere", wrong);
    }
    if !report.note.is_empty() {
        table.row(["note", &report.note]);
    }
    for worst in &report.worst {
        table.row([
            format!("wrong at {}, {}", worst.x, worst.y),
            worst.light.clone(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_promised_and_is_wrong_fails() {
        let report = |wrong, wrong_representable| CheckReport {
            wrong,
            wrong_representable,
            ..CheckReport::default()
        };
        for (wrong, representable, is_exact, passes) in [
            (0, None, true, true),
            (1, None, true, false),
            (9, None, false, true),
            (9, Some(0), false, true),
            (9, Some(1), false, false),
        ] {
            let verdict = verdict(&report(wrong, representable), is_exact);
            assert_eq!(verdict.is_ok(), passes, "{wrong} {representable:?}");
        }
    }

    #[test]
    fn only_what_lies_beyond_the_mask_is_excused() {
        let mask = |word| Mask {
            size: [1, 1],
            lights: 4,
            words: vec![word],
        };
        // Wrong at lights 0 and 3; of these only 3 lies beyond.
        let said = excused(&mask(0b0101), &mask(0b1010), &mask(0b1100));
        assert_eq!(said, mask(0b1101));
    }
}
