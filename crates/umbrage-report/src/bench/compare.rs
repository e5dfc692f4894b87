//! Two runs side by side: what got slower, less exact, or was lost.
//!
//! Takes an earlier report, a later one with the same settings, and the ratio beyond which a
//! difference counts; gives one [`Change`] for each row of either, matched by scene, method, size
//! and camera. Machines differ and are noisy, so times are compared as multiples of the floor of
//! the same run (`times_none`) where both have it. That hides what slows the floor too, so on the
//! same processor and adapter the floor's own milliseconds are judged, with twice the excess
//! allowed: absolute times are noisier. Invariant: an exact method with anything wrong is a
//! regression, whatever the ratio and whatever the baseline had.

mod table;
#[cfg(test)]
mod tests;

use thiserror::Error;

use super::{BenchReport, BenchRow, Machine};

/// What two times were compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Frame time as a multiple of `none`'s in the same run: machines drop out.
    TimesNone,
    /// Frame time in milliseconds: for one machine only.
    FrameMs,
}

/// In what a row is worse than it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regression {
    /// Time grew beyond the ratio.
    Slower,
    /// More is wrong, beyond the ratio.
    LessExact,
    /// A method that promises none has wrong ones.
    PromiseBroken,
    /// It had figures, and fails now.
    Fails,
    /// The baseline judged it, this run judges others, and it promises that none is wrong.
    NotJudged,
    /// Lights or triangles are others: its figures say nothing about the baseline's.
    OtherWorkload,
    /// It was in the baseline, and is not in this run.
    Missing,
}

/// Why two runs cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "the baseline was run with other settings: `{before}`, now `{now}`; run both with the same, or make a new baseline"
)]
pub struct OtherSettings {
    /// Of the baseline.
    pub before: String,
    /// Of the later run.
    pub now: String,
}

/// One row, before and now.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Of the row.
    pub scene: String,
    /// Of the row.
    pub method: String,
    /// Of the row.
    pub size: [u32; 2],
    /// Of the row.
    pub camera: String,
    /// How time was compared, before and now; null where either has none.
    pub time: Option<(Measure, f64, f64)>,
    /// How many times as long as before it may take.
    pub allowed: f64,
    /// Wrong pixel-lights before and now; null where the oracle was not asked.
    pub wrong: [Option<u64>; 2],
    /// Whether the baseline has no such row.
    pub new: bool,
    /// In what it is worse; empty for most.
    pub regressions: Vec<Regression>,
}

/// A later run against an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Beyond which more time, or more wrong ones, count as worse: 1.1 allows a tenth more.
    pub ratio: f64,
    /// Whether the floor's own milliseconds are judged: processor and adapter are known and equal.
    pub same_machine: bool,
    /// Whether the later run asked the oracle.
    pub judged: bool,
    /// Rows of the baseline in its order, then new ones.
    pub changes: Vec<Change>,
}

/// Compares `now` with `baseline`; see [`Comparison::ratio`].
///
/// # Errors
/// Settings that differ. Those that a report does not have, since an older version wrote it, are
/// taken to be the same.
pub fn compare(
    baseline: &BenchReport,
    now: &BenchReport,
    ratio: f64,
) -> Result<Comparison, OtherSettings> {
    let settings = [&baseline.settings, &now.settings];
    if settings[0] != settings[1] && settings.iter().all(|known| !known.is_empty()) {
        let [before, now] = settings.map(String::clone);
        return Err(OtherSettings { before, now });
    }
    let rules = Rules {
        ratio,
        same_machine: is_same_machine(&baseline.machine, &now.machine),
        judged: now.oracle,
    };
    let find = |report: &BenchReport, wanted: &BenchRow| -> Option<BenchRow> {
        let mut rows = report.rows.iter();
        rows.find(|row| is_same(row, wanted)).cloned()
    };
    let old = baseline.rows.iter().map(|before| match find(now, before) {
        Some(row) => rules.change(Some(before), &row),
        None => Change {
            wrong: [before.wrong, None],
            regressions: vec![Regression::Missing],
            ..rules.change(None, before)
        },
    });
    let new = now.rows.iter().filter(|row| find(baseline, row).is_none());
    let new = new.map(|row| Change {
        new: true,
        ..rules.change(None, row)
    });
    Ok(Comparison {
        ratio,
        same_machine: rules.same_machine,
        judged: rules.judged,
        changes: old.chain(new).collect(),
    })
}

impl Comparison {
    /// Whether any row is.
    pub fn is_worse(&self) -> bool {
        self.worse().next().is_some()
    }

    /// Rows that are.
    pub fn worse(&self) -> impl Iterator<Item = &Change> {
        self.changes
            .iter()
            .filter(|change| !change.regressions.is_empty())
    }
}

fn is_same(a: &BenchRow, b: &BenchRow) -> bool {
    (&a.scene, &a.method, a.size, &a.camera) == (&b.scene, &b.method, b.size, &b.camera)
}

/// Only what is known can be the same.
fn is_same_machine(a: &Machine, b: &Machine) -> bool {
    let known = !a.cpu.is_empty() && !a.adapter.is_empty();
    known && (&a.cpu, &a.adapter) == (&b.cpu, &b.adapter)
}

/// Older versions wrote neither lights nor triangles, which reads as no triangles.
fn is_other_workload(before: &BenchRow, now: &BenchRow) -> bool {
    let known = before.triangles > 0 && now.triangles > 0;
    known && (before.lights, before.triangles) != (now.lights, now.triangles)
}

/// What all rows are held to.
struct Rules {
    ratio: f64,
    same_machine: bool,
    judged: bool,
}

impl Rules {
    fn change(&self, before: Option<&BenchRow>, now: &BenchRow) -> Change {
        let time = before.and_then(|before| self.time(before, now));
        Change {
            scene: now.scene.clone(),
            method: now.method.clone(),
            size: now.size,
            camera: now.camera.clone(),
            time,
            allowed: self.allowed(now),
            wrong: [before.and_then(|before| before.wrong), now.wrong],
            new: false,
            regressions: self.regressions(before, now, time),
        }
    }

    fn regressions(
        &self,
        before: Option<&BenchRow>,
        now: &BenchRow,
        time: Option<(Measure, f64, f64)>,
    ) -> Vec<Regression> {
        let mut found = Vec::new();
        if now.breaks_promise() {
            found.push(Regression::PromiseBroken);
        }
        let Some(before) = before else {
            return found;
        };
        let had_figures = before.frame_ms.is_some() && before.failed.is_none();
        if had_figures && (now.failed.is_some() || now.frame_ms.is_none()) {
            found.push(Regression::Fails);
        }
        if is_other_workload(before, now) {
            found.push(Regression::OtherWorkload);
            return found;
        }
        if time.is_some_and(|(_, before, is)| is > before * self.allowed(now)) {
            found.insert(0, Regression::Slower);
        }
        match (before.wrong, now.wrong) {
            (Some(was), Some(is)) if !now.exact && is as f64 > was as f64 * self.ratio => {
                found.push(Regression::LessExact);
            }
            (Some(_), None) if now.exact && self.judged && now.failed.is_none() => {
                found.push(Regression::NotJudged);
            }
            _ => (),
        }
        found
    }

    /// By the floor of the same run where both have it; the floor, by the clock where that can be.
    fn time(&self, before: &BenchRow, now: &BenchRow) -> Option<(Measure, f64, f64)> {
        match (before.times_none, now.times_none) {
            (Some(was), Some(is)) if !(now.is_floor() && self.same_machine) => {
                Some((Measure::TimesNone, was, is))
            }
            _ => Some((Measure::FrameMs, before.frame_ms?, now.frame_ms?)),
        }
    }

    fn allowed(&self, now: &BenchRow) -> f64 {
        match now.is_floor() {
            true => 1.0 + 2.0 * (self.ratio - 1.0),
            false => self.ratio,
        }
    }
}
