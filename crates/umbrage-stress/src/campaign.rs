//! A campaign: so many cases of so many families, counted.
//!
//! Takes options and, where masks are to be drawn, a [`Studio`]; gives counts by family and the
//! failures. Cases are checked on all threads in batches, and drawn one after the other; each
//! depends on its seed alone and counts are summed in the order of the cases, so the outcome is the
//! same whatever the number of threads.

use std::ops::AddAssign;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::case::CaseId;
use crate::families::FAMILIES;
use crate::limits::Limit;
use crate::masks::{DrawError, MaskFault, MaskReport, Studio};
use crate::points::{self, PointFault, PointReport};
use crate::rng::mix;

/// What to try.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CampaignOptions {
    /// Seeds the seeds of the cases.
    pub seed: u64,
    /// How many cases, dealt to the families in turn.
    pub cases: u64,
    /// How many of them are drawn, spread evenly over each family.
    pub rendered: u64,
    /// Indices into [`FAMILIES`].
    pub families: Vec<usize>,
    /// No case is begun later.
    pub time: Option<Duration>,
    /// This one case, of the one family that `families` then names.
    pub only: Option<CaseId>,
}

impl Default for CampaignOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            cases: 2000,
            rendered: 0,
            families: (0..FAMILIES.len()).collect(),
            time: None,
            only: None,
        }
    }
}

/// Counts of one family, or of all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Cases checked.
    pub cases: u64,
    /// Of these, drawn.
    pub rendered: u64,
    /// Counts at points that were compared.
    pub points: u64,
    /// Pixel-lights that were judged.
    pub pixels: u64,
    /// Points and pixel-lights that are wrong.
    pub wrong: u64,
    /// Points and pixel-lights whose verdict hangs on less than the tolerance.
    pub ambiguous: u64,
    /// Points for which no ray could be counted.
    pub uncounted: u64,
    /// Volumes that are not closed.
    pub open: u64,
    /// Lights left out of masks, by the order of [`Limit::ALL`].
    pub left_out: [u64; Limit::ALL.len()],
}

impl Tally {
    fn add_points(&mut self, report: &PointReport) {
        self.cases += 1;
        self.points += report.samples;
        self.wrong += report.wrong;
        self.ambiguous += report.ambiguous;
        self.uncounted += report.uncounted;
        self.open += report.open;
    }

    fn add_masks(&mut self, report: &MaskReport) {
        self.rendered += u64::from(report.masks > 0);
        self.pixels += report.samples;
        self.wrong += report.wrong;
        self.ambiguous += report.ambiguous;
        for (sum, count) in self.left_out.iter_mut().zip(report.left_out) {
            *sum += count;
        }
    }

    /// Whether nothing is wrong or open.
    pub fn is_clean(&self) -> bool {
        self.wrong == 0 && self.open == 0
    }
}

impl AddAssign<&Tally> for Tally {
    fn add_assign(&mut self, other: &Tally) {
        for (sum, part) in [
            (&mut self.cases, other.cases),
            (&mut self.rendered, other.rendered),
            (&mut self.points, other.points),
            (&mut self.pixels, other.pixels),
            (&mut self.wrong, other.wrong),
            (&mut self.ambiguous, other.ambiguous),
            (&mut self.uncounted, other.uncounted),
            (&mut self.open, other.open),
        ]
        .into_iter()
        .chain(self.left_out.iter_mut().zip(other.left_out))
        {
            *sum += part;
        }
    }
}

/// What went wrong in a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Of its volumes.
    Volume(PointFault),
    /// Of its masks.
    Mask(MaskFault),
}

/// A case that failed.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Which.
    pub id: CaseId,
    /// How, first.
    pub fault: Fault,
}

/// What a campaign found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// One for each of the options' families.
    pub families: Vec<Tally>,
    /// In the order of the cases.
    pub failures: Vec<Failure>,
    /// Whether time ran out.
    pub ended_early: bool,
}

impl Outcome {
    /// All families together.
    pub fn total(&self) -> Tally {
        let mut total = Tally::default();
        for family in &self.families {
            total += family;
        }
        total
    }
}

/// Cases that are checked between two looks at the clock.
const BATCH: u64 = 256;

/// Runs a campaign. `progress` is called with the cases done.
///
/// # Errors
/// What the device says.
pub fn run(
    options: &CampaignOptions,
    mut studio: Option<&mut Studio>,
    progress: &dyn Fn(u64),
) -> Result<Outcome, DrawError> {
    let start = Instant::now();
    let is_over = || options.time.is_some_and(|time| start.elapsed() >= time);
    let families = &options.families[..];
    let mut outcome = Outcome {
        families: vec![Tally::default(); families.len()],
        ..Outcome::default()
    };
    let count = if families.is_empty() {
        0
    } else {
        options.cases
    };
    let mut first = 0;
    while first < count {
        if is_over() {
            outcome.ended_early = true;
            break;
        }
        let batch = first..(first + BATCH).min(count);
        let reports: Vec<(CaseId, PointReport)> = batch
            .clone()
            .into_par_iter()
            .map(|number| {
                let id = case_id(options, number);
                (id, points::check(&id.make()))
            })
            .collect();
        for (number, (id, report)) in batch.clone().zip(reports) {
            let at = (number % families.len() as u64) as usize;
            outcome.families[at].add_points(&report);
            if let Some(fault) = report.fault {
                let fault = Fault::Volume(fault);
                outcome.failures.push(Failure { id, fault });
            }
            let wanted = is_rendered(options, number) && !is_over();
            if let Some(studio) = studio.as_deref_mut().filter(|_| wanted) {
                let report = studio.check(&id.make())?;
                outcome.families[at].add_masks(&report);
                if let Some(fault) = report.fault {
                    let fault = Fault::Mask(fault);
                    outcome.failures.push(Failure { id, fault });
                }
            }
            progress(number + 1);
        }
        first = batch.end;
    }
    Ok(outcome)
}

/// The case with a number.
pub fn case_id(options: &CampaignOptions, number: u64) -> CaseId {
    options.only.unwrap_or_else(|| CaseId {
        family: options.families[(number % options.families.len() as u64) as usize],
        seed: mix(options.seed, number),
    })
}

/// Whether the case with a number is drawn: `rendered` of all cases, evenly spread over each family.
fn is_rendered(options: &CampaignOptions, number: u64) -> bool {
    let (cases, families) = (options.cases, options.families.len() as u64);
    // Family after family.
    let family = number % families;
    let before = (cases / families) * family + family.min(cases % families);
    let place = u128::from(before + number / families);
    let share = |place: u128| place * u128::from(options.rendered.min(cases)) / u128::from(cases);
    share(place + 1) > share(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_are_drawn_as_were_asked_for_some_of_each_family() {
        for (cases, rendered) in [(1000, 40), (100, 100), (61, 7), (10, 50), (5, 0)] {
            let options = CampaignOptions {
                cases,
                rendered,
                ..CampaignOptions::default()
            };
            let drawn = |n: &u64| is_rendered(&options, *n);
            let drawn: Vec<u64> = (0..cases).filter(drawn).collect();
            assert_eq!(drawn.len() as u64, rendered.min(cases));
            if cases == 1000 {
                for family in 0..FAMILIES.len() as u64 {
                    let of_it = |n: &&u64| **n % FAMILIES.len() as u64 == family;
                    assert!((2..=3).contains(&drawn.iter().filter(of_it).count()));
                }
            }
        }
    }
}
