//! `umbrage stress`: a seeded campaign of hostile cases, counted by family.
//!
//! A wrong point or pixel-light, or a volume that is not closed, fails; the first failures are made
//! small and written, where a folder is given.

use std::time::Duration;

use umbrage_scene::Progress as _;
use umbrage_stress::campaign::{CampaignOptions, Failure, Fault, Outcome, run as campaign};
use umbrage_stress::case::SIZE;
use umbrage_stress::families::FAMILIES;
use umbrage_stress::keep::{Kept, keep};
use umbrage_stress::limits::Limit;
use umbrage_stress::masks::{DrawError, Studio};
use umbrage_stress::points;
use umbrage_truth::judge::{TOLERANCE_DEPTH, TOLERANCE_PX};

use crate::args::StressArgs;
use crate::error::CliError;
use crate::json;
use crate::progress::Bar;
use crate::report::{StressFailure, StressFamily, StressNotDrawn, StressReport};
use crate::setting::limit_threads;
use umbrage_report::{Table, grouped};

/// One case in so many is drawn where it is not said how many are.
const DRAWN_OF: u64 = 30;
/// Failures that are shrunk and written; the others are named only.
const KEPT: usize = 16;

impl From<DrawError> for CliError {
    fn from(error: DrawError) -> Self {
        match error {
            DrawError::Gpu(error) => error.into(),
            DrawError::Stage(error) => error.into(),
        }
    }
}

/// Runs the campaign, or one case of it again.
pub(crate) fn run(args: &StressArgs) -> Result<(), CliError> {
    limit_threads(args.threads);
    let options = options(args)?;
    let bar = Bar::new(args.results.quiet);
    let mut studio = match options.rendered {
        0 => None,
        _ => {
            bar.stage("open adapter", 0);
            Some(Studio::open(&args.adapter)?)
        }
    };
    bar.stage("try cases", options.cases);
    let outcome = campaign(&options, studio.as_mut(), &|done| bar.advance(done))?;
    let mut kept: Vec<Kept> = Vec::new();
    if let Some(folder) = args
        .output
        .as_deref()
        .filter(|_| !outcome.failures.is_empty())
    {
        std::fs::create_dir_all(folder).map_err(|error| CliError::file(folder, error))?;
        let failures = &outcome.failures[..outcome.failures.len().min(KEPT)];
        bar.stage("shrink failures", failures.len() as u64);
        for failure in failures {
            kept.push(keep(failure, studio.as_mut(), folder)?);
            bar.advance(kept.len() as u64);
        }
    }
    drop(bar);
    let report = report(&options, &outcome, &kept, studio.as_ref());
    args.results.show(&table(&report), &report)?;
    if args.results.shows_tables() {
        json::print(&notes(&report));
    }
    match (report.wrong, report.not_closed) {
        (0, 0) => Ok(()),
        (wrong, open) => Err(CliError::CheckFailed(format!(
            "{wrong} of {} samples are wrong, {open} volumes are not closed",
            report.samples
        ))),
    }
}

fn options(args: &StressArgs) -> Result<CampaignOptions, CliError> {
    let mut options = CampaignOptions::default();
    options.seed = args.seed;
    options.time = args.time.map(Duration::from_secs_f32);
    if let Some(id) = args.case {
        options.only = Some(id);
        options.cases = 1;
        options.families = vec![id.family];
        options.rendered = args.render.unwrap_or(1);
        return Ok(options);
    }
    options.cases = args.cases;
    options.rendered = args
        .render
        .unwrap_or(args.cases.div_ceil(DRAWN_OF))
        .min(args.cases);
    if !args.families.is_empty() {
        options.families = Vec::new();
        for name in &args.families {
            let known = umbrage_stress::families::named(name);
            let known = known.ok_or_else(|| {
                let names = umbrage_stress::families::names().join(", ");
                CliError::BadInput(format!("--family {name}: there are {names}"))
            })?;
            if !options.families.contains(&known) {
                options.families.push(known);
            }
        }
    }
    Ok(options)
}

fn report(
    options: &CampaignOptions,
    outcome: &Outcome,
    kept: &[Kept],
    studio: Option<&Studio>,
) -> StressReport {
    let total = outcome.total();
    let families = options.families.iter().zip(&outcome.families);
    let failures = outcome.failures.iter().enumerate();
    let limits = Limit::ALL.into_iter().zip(total.left_out);
    StressReport {
        cases: total.cases,
        rendered: total.rendered,
        samples: total.points + total.pixels,
        wrong: total.wrong,
        ambiguous: total.ambiguous,
        closed: total.open == 0,
        not_closed: total.open,
        uncounted: total.uncounted,
        point_samples: total.points,
        pixel_samples: total.pixels,
        seed: options.seed,
        tolerance: points::TOLERANCE,
        tolerance_px: TOLERANCE_PX,
        tolerance_depth: TOLERANCE_DEPTH,
        size: SIZE,
        adapter: studio.map(|studio| studio.adapter().to_owned()),
        ended_early: outcome.ended_early,
        families: families
            .map(|(&family, tally)| StressFamily {
                name: FAMILIES[family].name,
                about: FAMILIES[family].about,
                cases: tally.cases,
                rendered: tally.rendered,
                samples: tally.points + tally.pixels,
                wrong: tally.wrong,
                ambiguous: tally.ambiguous,
                closed: tally.open == 0,
                not_closed: tally.open,
            })
            .collect(),
        not_drawn: limits
            .filter(|(_, lights)| *lights > 0)
            .map(|(limit, lights)| StressNotDrawn {
                name: limit.name(),
                reason: limit.reason(),
                lights,
            })
            .collect(),
        failures: failures
            .map(|(n, failure)| told(failure, kept.get(n)))
            .collect(),
    }
}

fn told(failure: &Failure, kept: Option<&Kept>) -> StressFailure {
    StressFailure {
        case: failure.id.to_string(),
        fault: match &failure.fault {
            Fault::Volume(fault) => format!("{fault:?}"),
            Fault::Mask(fault) => format!(
                "{} pixel-lights of {} are wrong in view {}, the firmest at {:?} under light {}",
                fault.wrong,
                fault.method.name(),
                fault.view,
                fault.pixel,
                fault.light
            ),
        },
        again: format!("umbrage stress --case {}", failure.id),
        file: kept.map(|kept| kept.file.display().to_string()),
        triangles: kept.map(|kept| kept.triangles as u64),
        check: kept.and_then(|kept| kept.command.clone()),
    }
}

fn table(report: &StressReport) -> Table {
    let mut table = Table::default();
    table.row([
        "family",
        "cases",
        "rendered",
        "samples",
        "wrong",
        "ambiguous",
        "not closed",
    ]);
    let counts =
        |name: &str, counts: [u64; 6]| std::iter::once(name.to_owned()).chain(counts.map(grouped));
    for f in &report.families {
        let of = [
            f.cases,
            f.rendered,
            f.samples,
            f.wrong,
            f.ambiguous,
            f.not_closed,
        ];
        table.row(counts(f.name, of));
    }
    let r = report;
    let of = [
        r.cases,
        r.rendered,
        r.samples,
        r.wrong,
        r.ambiguous,
        r.not_closed,
    ];
    table.row(counts("all", of));
    table
}

/// What has no columns.
fn notes(report: &StressReport) -> String {
    let mut notes = String::new();
    let mut line = |text: String| {
        notes += &text;
        notes.push('\n');
    };
    for left_out in &report.not_drawn {
        let (name, lights) = (left_out.name, grouped(left_out.lights));
        line(format!(
            "not drawn, {name}, {lights} lights: {}",
            left_out.reason
        ));
    }
    if report.ended_early {
        line("time ran out".to_owned());
    }
    for failure in report.failures.iter().take(KEPT) {
        line(format!("{}: {}", failure.case, failure.fault));
        line(format!("  {}", failure.again));
        match (&failure.check, &failure.file) {
            (Some(check), _) => line(format!("  {check}")),
            (None, Some(file)) => line(format!(
                "  {file} (its masks are right: use the line above)"
            )),
            (None, None) => {}
        }
    }
    notes
}

#[cfg(test)]
mod tests {
    use umbrage_stress::campaign::Tally;

    use super::*;

    #[test]
    fn the_table_has_a_row_for_each_family_and_one_for_all() {
        let options = CampaignOptions::default();
        let outcome = Outcome {
            families: vec![
                Tally {
                    cases: 2,
                    ..Tally::default()
                };
                FAMILIES.len()
            ],
            ..Outcome::default()
        };
        let text = table(&report(&options, &outcome, &[], None)).to_string();
        assert_eq!(text.lines().count(), FAMILIES.len() + 2);
        assert!(text.contains(&grouped(2 * FAMILIES.len() as u64)), "{text}");
    }
}
