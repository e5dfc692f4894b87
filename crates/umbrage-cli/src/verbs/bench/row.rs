//! One method in one view: timed, judged, pictured.

use umbrage_core::View;
use umbrage_core::frame::LightPath;
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::picture::Lit;
use umbrage_lab::stage::{Stage, StageLight};
use umbrage_report::bench::{BenchRow, Difference, DifferenceError, Picture};
use umbrage_truth::{ErrorMap, Oracle, Verdicts};

use super::interrupt::Interrupt;
use crate::error::CliError;

/// What is to be measured.
pub(super) struct Task<'a> {
    pub(super) stage: &'a mut Stage,
    /// Seconds by which time runs on from frame to frame.
    pub(super) step_s: f64,
    pub(super) lights: &'a [StageLight],
    pub(super) view: &'a View,
    pub(super) method: Method,
    /// Frames timed, after one that warms up.
    pub(super) repeat: usize,
    /// Seconds after which no further frame is begun, if one was timed.
    pub(super) limit: f32,
    pub(super) interrupt: &'a Interrupt,
}

/// What the oracle knows of the view.
pub(super) struct Judge<'a> {
    pub(super) oracle: &'a Oracle,
    pub(super) verdicts: Verdicts,
}

/// Measures a row; a method that fails gives one that says why.
pub(super) fn measure(
    mut task: Task<'_>,
    lab: &mut Lab,
    judge: Option<&mut Judge<'_>>,
    place: (&str, &str, [u32; 2]),
) -> BenchRow {
    let mut row = BenchRow::new(&task.method.name(), place);
    row.exact = task.method.is_exact();
    if let Err(why) = fill(&mut task, lab, judge, &mut row) {
        row.failed = Some(why.to_string());
    }
    row
}

fn fill(
    task: &mut Task<'_>,
    lab: &mut Lab,
    judge: Option<&mut Judge<'_>>,
    row: &mut BenchRow,
) -> Result<(), CliError> {
    let (lights, view, method) = (task.lights, task.view, task.method);
    let begin_s = task.stage.time_s;
    // What another method left is not this one's.
    lab.forget();
    let lit = lab.render_moving(task.stage, lights, view, method, |stage, frames| {
        let spent: f64 = frames.iter().skip(1).map(|frame| frame.frame / 1e3).sum();
        let late = frames.len() > 1 && (spent > f64::from(task.limit) || task.interrupt.came());
        stage.set_time(begin_s + task.step_s * frames.len() as f64)?;
        Ok::<bool, CliError>(frames.len() <= task.repeat && !late)
    });
    // The oracle judges the moment it knows.
    task.stage.set_time(begin_s)?;
    let (lit, stage) = (lit?, &*task.stage);
    let timed: Vec<f64> = lab.frames[1..].iter().map(|frame| frame.frame).collect();
    row.set_frame_times(&timed);
    row.first_frame_ms = Some(lab.times.frame_first);
    row.build_ms = method.recipe().map(|_| match task.step_s > 0.0 {
        true => lab.times.volumes,
        false => lab.times.volumes_first,
    });
    row.gpu_ms = lab.gpu().timestamp_ns.map(|_| lab.times.gpu());
    row.gpu_bytes = Some(lab.gpu_bytes());
    row.note = lab.held.note.clone();
    if timed.len() < task.repeat {
        let cause = match task.interrupt.came() {
            true => "interrupted",
            false => "for time",
        };
        row.add_note(&format!(
            "{} of {} frames, {cause}",
            timed.len(),
            task.repeat
        ));
    }
    let Some(Judge { oracle, verdicts }) = judge else {
        return Ok(());
    };
    if task.interrupt.came() {
        row.add_note("not judged, interrupted");
        return Ok(());
    }
    let lit = match task.step_s > 0.0 {
        // The last frame shows a later moment than the oracle knows.
        true => lab.render(stage, lights, view, method, 0)?,
        false => lit,
    };
    lab.prepare(stage, lights, view, method);
    let mask = lab.mask(stage, lights, view)?;
    let skipped: Vec<bool> = (0..lights.len())
        .map(|light| matches!(lab.path(light), LightPath::Skipped(_)))
        .collect();
    let found = verdicts.judge(oracle, &mask, &skipped);
    row.set_errors(found.wrong, found.ambiguous, found.samples);
    let map = verdicts.error_map(&mask, &skipped);
    match difference(&lit, &map) {
        Ok(picture) => row.difference = Some(picture),
        Err(why) => row.add_note(&why.to_string()),
    }
    Ok(())
}

fn difference(lit: &Lit, map: &ErrorMap) -> Result<Picture, DifferenceError> {
    let grey: Vec<f32> = lit
        .to_rgb8()
        .chunks_exact(3)
        .map(|rgb| {
            let [r, g, b] = [rgb[0], rgb[1], rgb[2]].map(f32::from);
            (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0
        })
        .collect();
    let wide = |counts: &[u16]| {
        counts
            .iter()
            .map(|&count| u32::from(count))
            .collect::<Vec<_>>()
    };
    Difference::new(map.size, &grey, &wide(&map.wrong), &wide(&map.ambiguous))?.picture()
}
