//! Advice tried out: applied in memory, what it changes counted, time predicted, and measured if asked.
//!
//! Takes a candidate; gives advice, or nothing if it would save too little or change too much of the
//! picture. With and without the change are measured in turn, in the same way as the profile.

use umbrage_core::Casting;
use umbrage_core::volume::BuildTimes;
use umbrage_lab::lab::Lab;
use umbrage_lab::picture::Lit;
use umbrage_lab::profile::GpuCost;
use umbrage_lab::stage::StageLight;
use umbrage_report::profile::{Advice, Saving};

use super::advice::Candidate;
use super::change::{Change, changed};
use super::lights;
use super::measure::{Base, work};
use super::model::Model;
use crate::error::CliError;
use crate::setting::Setting;

/// Everything trials are compared with.
pub(super) struct Trials {
    base: Base,
    /// The picture as it is.
    picture: Vec<u8>,
    model: Model,
    /// Holds the scene as it is.
    lab: Lab,
    /// Holds it changed.
    other: Lab,
    verify: bool,
}

/// Less than these parts of the ordinary frame and of building everything is not worth mentioning.
const LEAST: f64 = 0.002;
const LEAST_BUILD: f64 = 0.02;
/// Less than this part of what the lights concerned take cannot be told from noise.
const LEAST_SHARE: f64 = 0.1;

impl Trials {
    pub(super) fn new(lab: Lab, base: Base, verify: bool) -> Self {
        let mut other = Lab::new(lab.gpu().clone());
        other.culls = lab.culls;
        Self {
            picture: base.lit.exposed_rgb8(base.exposure),
            model: Model::of(&base),
            base,
            lab,
            other,
            verify,
        }
    }

    /// Advice, if the candidate is worth it. The setting is as it was after that.
    pub(super) fn try_out(
        &mut self,
        candidate: &Candidate,
        setting: &mut Setting,
    ) -> Result<Option<Advice>, CliError> {
        let built_us = match self.verify {
            true => {
                let (stage, rounds) = (&setting.stage, self.base.rounds);
                total(&self.lab.build_times(stage, &candidate.lights, rounds))
            }
            false => 0.0,
        };
        match &candidate.change {
            Change::Lights(changes) => {
                let (lights, unshadowed) = changed(&setting.lights, changes);
                self.compare(candidate, setting, lights, unshadowed, built_us)
            }
            Change::Casting(group, rule) => {
                let was = &setting.stage.mesh.casting;
                let members = group.members(&setting.stage).zip(was);
                let casting = members.map(|(is_in, was)| match (is_in, was) {
                    (false, _) | (_, Casting::None) => *was,
                    _ => *rule,
                });
                let was = setting.stage.recast(casting.collect())?;
                let advice = {
                    let lights = setting.lights.clone();
                    self.compare(candidate, setting, lights, Vec::new(), built_us)
                };
                setting.stage.recast(was)?;
                advice
            }
        }
    }

    /// `lights` on the stage as it is now against the base, in which the candidate's took
    /// `built_us` to build just now.
    fn compare(
        &mut self,
        candidate: &Candidate,
        setting: &Setting,
        lights: Vec<StageLight>,
        unshadowed: Vec<usize>,
        built_us: f64,
    ) -> Result<Option<Advice>, CliError> {
        let Setting { stage, view, .. } = setting;
        let (base, other) = (&self.base, &mut self.other);
        other.unshadowed.clone_from(&unshadowed);
        let lit = other.render_while(stage, &lights, view, base.method, |_| false)?;
        let pixels_changed = self.pixels_changed(&lit);
        let other = &mut self.other;
        let counter = other.counter(stage, &lights, view, base.exposure)?;
        let mut after = work(other, setting, &lights, &counter)?;
        drop(counter);
        for &light in &unshadowed {
            // What is left out need not be built.
            let Some(work) = after.get_mut(light) else {
                continue;
            };
            (work.subset, work.casters, work.facing, work.quads) = (0, 0, 0, 0);
        }
        let of = &candidate.lights;
        let mut predicted = Saving {
            frame_us: base.has_gpu_times.then_some(0.0),
            build_us: 0.0,
        };
        for &light in of {
            let (before, after) = (&base.lights[light], &after[light]);
            if let (Some(sum), Some(gpu)) = (&mut predicted.frame_us, before.gpu) {
                let left = self.model.gpu_us(before, after).unwrap_or(0.0);
                *sum += gpu.total_us() - left;
            }
            let built = before.build.total_us() + before.upload_us;
            predicted.build_us += built - self.model.build_us(before, after);
        }
        let (mut drawn_us, mut built_in_us) = (0.0, 0.0);
        for figures in of.iter().map(|&light| &base.lights[light]) {
            drawn_us += figures.gpu.map_or(0.0, |gpu| gpu.total_us());
            built_in_us += figures.build.total_us();
        }
        let shorter = predicted.build_us > LEAST_BUILD * base.build_all_us
            && predicted.build_us > LEAST_SHARE * built_in_us;
        let faster = (predicted.frame_us)
            .is_some_and(|us| us > LEAST * base.frame.frame * 1e3 && us > LEAST_SHARE * drawn_us);
        let quads = |all: &mut dyn Iterator<Item = u32>| all.map(f64::from).sum::<f64>();
        let before = quads(&mut of.iter().map(|&light| base.lights[light].work.quads));
        let fewer = before - quads(&mut of.iter().map(|&light| after[light].quads));
        let too_few = candidate.least_quads > 0.0 && fewer < candidate.least_quads * before;
        if !(shorter || faster) || too_few {
            return Ok(None);
        }
        let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
        if pixels_changed > candidate.may_change(pixels) {
            return Ok(None);
        }
        let measured = match self.verify {
            true => Some(self.measure(of, setting, (&lights, &unshadowed), built_us)?),
            false => None,
        };
        let text = candidate.text(&self.base, &after, pixels_changed, pixels);
        let ratio = |measured: f64, predicted: f64| (predicted > 0.0).then(|| measured / predicted);
        Ok(Some(Advice {
            kind: candidate.kind,
            lights: of
                .iter()
                .map(|&light| setting.lights[light].name.clone())
                .collect(),
            of: candidate.of.clone(),
            text,
            predicted,
            measured,
            frame_ratio: measured.and_then(|m| ratio(m.frame_us?, predicted.frame_us?)),
            build_ratio: measured.and_then(|m| ratio(m.build_us, predicted.build_us)),
            pixels_changed,
        }))
    }

    /// Pixels that differ from the picture as it is by more than two steps.
    fn pixels_changed(&self, lit: &Lit) -> u64 {
        let now = lit.exposed_rgb8(self.base.exposure);
        let pixels = self.picture.chunks_exact(3).zip(now.chunks_exact(3));
        let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
        pixels.filter(differs).count() as u64
    }

    /// What the lights take as they are and as they would be, round by round in turn.
    fn measure(
        &mut self,
        of: &[usize],
        setting: &Setting,
        (changed, unshadowed): (&[StageLight], &[usize]),
        built_us: f64,
    ) -> Result<Saving, CliError> {
        let Setting { stage, view, .. } = setting;
        let mut meter = self.other.meter(stage, changed, view)?;
        let drawn = lights::drawn(&self.other);
        let still: Vec<usize> = of.iter().copied().filter(|l| drawn.contains(l)).collect();
        let mut before = vec![GpuCost::default(); of.len()];
        let mut after = vec![GpuCost::default(); still.len()];
        for _ in 0..self.base.gpu_rounds {
            self.base.meter.round(of, &mut before)?;
            meter.round(&still, &mut after)?;
        }
        let built = lights::built(&self.other);
        let is_built = |light: &usize| built.contains(light) && !unshadowed.contains(light);
        let still: Vec<usize> = of.iter().copied().filter(is_built).collect();
        let rounds = self.base.rounds;
        let uploaded = |times: Vec<f64>| times.iter().sum::<f64>();
        let built_after = total(&self.other.build_times(stage, &still, rounds));
        let uploads = uploaded(self.lab.upload_times(of, rounds)?)
            - uploaded(self.other.upload_times(&still, rounds)?);
        let drawn = |costs: &[GpuCost]| costs.iter().map(GpuCost::total_us).sum::<f64>();
        Ok(Saving {
            frame_us: self
                .base
                .has_gpu_times
                .then(|| drawn(&before) - drawn(&after)),
            build_us: built_us - built_after + uploads,
        })
    }
}

fn total(times: &[BuildTimes]) -> f64 {
    times.iter().map(BuildTimes::total_us).sum()
}
