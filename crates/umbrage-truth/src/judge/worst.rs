//! The wrong samples to show first.
//!
//! Takes one wrong sample a tile and light; gives the firmest of them: those whose oracle verdict
//! stays the same furthest around the pixel, so that nobody can call them a matter of rounding.

use rayon::prelude::*;

use super::Verdicts;
use super::ambiguity::AROUND;
use crate::oracle::{Oracle, Verdict};

/// Largest number of wrong samples listed.
pub const WORST_COUNT: usize = 32;
/// Candidates that are measured; more are thinned out evenly.
const MEASURED: usize = 1024;
/// Listed samples of one light, as long as other lights have any.
const PER_LIGHT: usize = 4;
/// Largest radius that is tried, pixels.
const FIRMEST_PX: f64 = 8.0;

/// Which way a sample is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WrongKind {
    /// The method says lit, the oracle shadowed: a leak.
    Lit,
    /// The method says shadowed, the oracle lit.
    Shadowed,
}

/// A wrong sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Column, pixels from the left.
    pub x: u32,
    /// Row, pixels from the top.
    pub y: u32,
    /// Index of the light.
    pub light: u32,
    /// What the method got wrong.
    pub kind: WrongKind,
    /// Largest tried radius around the pixel's centre, in pixels, within which the oracle's verdict
    /// stays the same: at least the tolerance, at most 8.
    pub firm_px: f64,
}

/// The firmest of `candidates`, at most [`WORST_COUNT`], no more than a few of one light while
/// others have any.
pub(super) fn choose(oracle: &Oracle, of: &Verdicts, candidates: Vec<Worst>) -> Vec<Worst> {
    let stride = candidates.len().div_ceil(MEASURED).max(1);
    let mut measured: Vec<Worst> = candidates
        .into_par_iter()
        .step_by(stride)
        .map(|wrong| Worst {
            firm_px: firmness(oracle, of, &wrong),
            ..wrong
        })
        .collect();
    measured.sort_by(|a, b| {
        b.firm_px
            .total_cmp(&a.firm_px)
            .then_with(|| scattered(a).cmp(&scattered(b)))
    });
    let mut listed = vec![0; of.lights.len()];
    let (mut chosen, others): (Vec<Worst>, Vec<Worst>) = measured.into_iter().partition(|wrong| {
        listed[wrong.light as usize] += 1;
        listed[wrong.light as usize] <= PER_LIGHT
    });
    chosen.extend(others);
    chosen.truncate(WORST_COUNT);
    chosen
}

/// A key that scatters equally firm samples over image and lights (Fibonacci hashing).
fn scattered(wrong: &Worst) -> u64 {
    let place = u64::from(wrong.x) << 42 ^ u64::from(wrong.y) << 21 ^ u64::from(wrong.light);
    (place ^ place >> 17)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_right(29)
}

fn firmness(oracle: &Oracle, of: &Verdicts, wrong: &Worst) -> f64 {
    let light = &of.lights[wrong.light as usize];
    let verdict = match wrong.kind {
        WrongKind::Lit => Verdict::Shadowed,
        WrongKind::Shadowed => Verdict::Lit,
    };
    let (x, y) = (f64::from(wrong.x) + 0.5, f64::from(wrong.y) + 0.5);
    let mut firm = of.tolerance_px;
    while 2.0 * firm <= FIRMEST_PX {
        let radius = 2.0 * firm;
        let holds = |[dx, dy]: &[f64; 2]| {
            oracle.verdict(&of.rays, x + dx * radius, y + dy * radius, light) == verdict
        };
        if !AROUND.iter().all(holds) {
            break;
        }
        firm = radius;
    }
    firm
}
