//! What might save time: one file a rule.
//!
//! Takes the profile's figures; gives candidates, which trials then apply. A rule looks at what is
//! seen from the view at hand, and says so: what is advised holds there.

mod casting;
mod merge;
mod moved;
mod range;
mod unseen;

use umbrage_report::grouped;
use umbrage_report::profile::AdviceKind;

use super::change::Change;
use super::measure::{Base, Work};
use crate::setting::Setting;

/// Something to try.
pub(super) struct Candidate {
    pub(super) kind: AdviceKind,
    pub(super) change: Change,
    /// Lights whose cost changes, among those drawn.
    pub(super) lights: Vec<usize>,
    /// Part of the lights' quads that must vanish for it to be worth mentioning.
    pub(super) least_quads: f64,
    /// Name of the mesh or material; empty for advice about lights.
    pub(super) of: String,
    /// The advice, from what the changed lights have to do.
    pub(super) words: Words,
}

/// Makes the advice's first sentence of what lights did before and do after.
pub(super) type Words = Box<dyn Fn(&Base, &[Work]) -> String>;

impl Candidate {
    /// Most pixels that may look different, of all there are.
    pub(super) fn may_change(&self, pixels: u64) -> u64 {
        match self.kind {
            // The same mask is promised.
            AdviceKind::SingleSided | AdviceKind::SwitchOff | AdviceKind::NoShadows => {
                pixels / 20_000
            }
            AdviceKind::ShorterRange
            | AdviceKind::Merge
            | AdviceKind::Move
            | AdviceKind::NoCasting => pixels / 200,
        }
    }

    /// In words, with what becomes of the picture.
    pub(super) fn text(&self, base: &Base, after: &[Work], changed: u64, pixels: u64) -> String {
        let seen = match changed {
            0 => "No pixel changes.".to_owned(),
            some => {
                let share = 100.0 * some as f64 / pixels as f64;
                format!("{} pixels change ({share:.2}%).", grouped(some))
            }
        };
        format!("{} {seen}", (self.words)(base, after))
    }
}

/// Lights that get advice of their own, of each kind; the others share one.
const ALONE: usize = 4;

/// All candidates, by rule.
pub(super) fn candidates(base: &Base, setting: &Setting) -> Vec<Candidate> {
    let mut all = unseen::candidates(base, setting);
    all.extend(merge::candidates(base, setting));
    all.extend(moved::candidates(base, setting));
    let taken: Vec<usize> = all.iter().flat_map(|one| one.lights.clone()).collect();
    all.extend(range::candidates(base, setting, &taken));
    all.extend(casting::candidates(base, setting));
    all
}

/// GPU time of a light, or CPU time where there is none.
fn cost(base: &Base, light: usize) -> f64 {
    let figures = &base.lights[light];
    match figures.gpu {
        Some(gpu) => gpu.total_us,
        None => figures.build.total_us(),
    }
}

/// The lights that cost most, each alone, then all others together.
fn split(base: &Base, mut lights: Vec<usize>) -> Vec<Vec<usize>> {
    lights.sort_by(|&a, &b| cost(base, b).total_cmp(&cost(base, a)));
    let others = lights.split_off(lights.len().min(ALONE));
    let mut all: Vec<Vec<usize>> = lights.into_iter().map(|light| vec![light]).collect();
    all.extend((!others.is_empty()).then_some(others));
    all
}

/// `lamp` or `12 lights (lamp_1, lamp_2, lamp_3, ...)`.
fn named(setting: &Setting, lights: &[usize]) -> String {
    let names: Vec<&str> = (lights.iter().take(3))
        .map(|&light| setting.lights[light].name.as_str())
        .collect();
    match lights.len() {
        1 => names.concat(),
        n if n > 3 => format!("{n} lights ({}, ...)", names.join(", ")),
        n => format!("{n} lights ({})", names.join(", ")),
    }
}

/// `one` for one light, else `many`.
fn verb<'a>(lights: &[usize], one: &'a str, many: &'a str) -> &'a str {
    match lights.len() {
        1 => one,
        _ => many,
    }
}
