//! What a change saves, measured: lights timed with and without it, a few at a time, in turn.
//!
//! A machine that is slower for seconds, as shared ones are, is so on both sides: shares of time saved
//! come out alike from run to run, where times themselves do not.

use umbrage_core::View;
use umbrage_core::volume::BuildTimes;
use umbrage_lab::lab::Lab;
use umbrage_lab::rendering::Rendering;
use umbrage_lab::stage::{Cast, Stage, StageLight};
use umbrage_lab::timer::median;

use super::lights;
use crate::error::CliError;

/// Microseconds of drawing, and lights, after which it is the other side's turn.
const TURN_US: f64 = 50_000.0;
const FEW: usize = 32;

/// Shares of their time that lights save.
#[derive(Clone, Copy, Debug)]
pub(super) struct Saved {
    /// On the GPU.
    pub(super) drawn: f64,
    /// Built and handed over.
    pub(super) built: f64,
}

/// The scene as it is, or as it would be.
pub(super) struct Side<'a> {
    lab: &'a mut Lab,
    lights: &'a [StageLight],
    rendering: &'a mut Rendering,
    drawn: Vec<usize>,
    built: Vec<usize>,
}

impl<'a> Side<'a> {
    /// What `lab` last drew.
    pub(super) fn new(
        lab: &'a mut Lab,
        lights: &'a [StageLight],
        rendering: &'a mut Rendering,
    ) -> Self {
        let mut built = lights::built(lab);
        // What is left out need not be built.
        built.retain(|light| !lab.unshadowed.contains(light));
        Self {
            drawn: lights::drawn(lab),
            built,
            lab,
            lights,
            rendering,
        }
    }

    /// Microseconds of drawing a few lights, each so many times, and of building them and handing
    /// them over.
    fn time(
        &mut self,
        few: &[usize],
        times: &[u32],
        stage: &Stage,
        view: &View,
    ) -> Result<[f64; 2], CliError> {
        let drawn = few.iter().copied().filter(|l| self.drawn.contains(l));
        let often: Vec<(usize, u32)> = drawn.map(|light| (light, times[light])).collect();
        let built = few.iter().copied().filter(|l| self.built.contains(l));
        let built: Vec<usize> = built.collect();
        let (lab, rendering) = (&mut self.lab, &mut self.rendering);
        let costs = lab.time_lights(rendering, stage, self.lights, view, &often)?;
        let drawn_us = costs.into_iter().flatten().map(|cost| cost.total_us).sum();
        let builds = lab.build_times(stage, &built);
        let uploads = lab.upload_times(&built)?;
        let built_us = builds.iter().map(BuildTimes::total_us).chain(uploads).sum();
        Ok([drawn_us, built_us])
    }
}

impl Saved {
    /// By lights `of`, some at each turn, each drawn as often as `times` says, between the first of
    /// `sides` and the second, which has the stage cast otherwise if `cast` is given: the median of the
    /// rounds.
    pub(super) fn measure(
        sides: &mut [Side<'_>; 2],
        of: &[Vec<usize>],
        times: &[u32],
        (stage, cast): (&mut Stage, &mut Option<Cast>),
        view: &View,
        rounds: usize,
    ) -> Result<Self, CliError> {
        let mut saved = [Vec::new(), Vec::new()];
        for round in 0..rounds {
            let mut took = [[0.0; 2]; 2];
            for few in of {
                // One goes first in this round, the other in the next.
                for number in [round % 2, 1 - round % 2] {
                    if number == 1 {
                        exchange(stage, cast);
                    }
                    let us = sides[number].time(few, times, stage, view)?;
                    if number == 1 {
                        exchange(stage, cast);
                    }
                    for (sum, us) in took[number].iter_mut().zip(us) {
                        *sum += us;
                    }
                }
            }
            let [before, after] = took;
            for (saved, (before, after)) in saved.iter_mut().zip(before.iter().zip(after)) {
                saved.extend((*before > 0.0).then(|| 1.0 - after / before));
            }
        }
        let [drawn, built] = saved.map(|mut shares| median(&mut shares).unwrap_or_default());
        Ok(Self { drawn, built })
    }
}

/// Lights by turns, of what they take to draw.
pub(super) fn turns(of: &[usize], drawn_us: impl Fn(usize) -> f64) -> Vec<Vec<usize>> {
    let mut turns: Vec<Vec<usize>> = Vec::new();
    let mut sum = 0.0;
    for &light in of {
        let us = drawn_us(light);
        match turns
            .last_mut()
            .filter(|turn| turn.len() < FEW && sum + us < TURN_US)
        {
            Some(turn) => turn.push(light),
            None => {
                turns.push(vec![light]);
                sum = 0.0;
            }
        }
        sum += us;
    }
    turns
}

/// Makes a change to the stage, if it is one, or takes it back.
pub(super) fn exchange(stage: &mut Stage, cast: &mut Option<Cast>) {
    if let Some(cast) = cast {
        stage.exchange(cast);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_short_and_have_every_light_once() {
        let us = [10_000.0, 45_000.0, 1e6, 1.0, 1.0];
        let of = turns(&[0, 1, 2, 3, 4], |light| us[light]);
        assert_eq!(of, [vec![0], vec![1], vec![2], vec![3, 4]]);
        let many: Vec<usize> = (0..FEW + 1).collect();
        assert_eq!(turns(&many, |_| 1.0).len(), 2);
        assert!(turns(&[], |_| 1.0).is_empty());
    }
}
