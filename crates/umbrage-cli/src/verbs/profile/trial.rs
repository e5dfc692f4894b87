//! Advice tried out: applied in memory, what it changes counted, time predicted, and measured if asked.
//!
//! Takes a candidate; gives advice, or nothing if it would save too little or change too much of the
//! picture.

use std::time::Instant;

use umbrage_core::Casting;
use umbrage_lab::lab::Lab;
use umbrage_lab::rendering::Rendering;
use umbrage_lab::stage::{Cast, StageLight};
use umbrage_report::profile::{Advice, Saving};

use super::advice::Candidate;
use super::change::{Change, changed};
use super::measure::{Base, Work, work};
use super::model::Model;
use super::verify::{Saved, Side, exchange, turns};
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
        let mut applied = Applied::new(&candidate.change, setting)?;
        exchange(&mut setting.stage, &mut applied.cast);
        let tried = self.draw(candidate, setting, &applied)?;
        exchange(&mut setting.stage, &mut applied.cast);
        let Some(mut tried) = tried else {
            return Ok(None);
        };
        let predicted = tried.predicted;
        let measured = match self.verify {
            true => {
                let Setting {
                    stage,
                    lights,
                    view,
                } = setting;
                let turns = turns(&candidate.lights, |light| {
                    let gpu = self.base.lights[light].gpu.unwrap_or_default();
                    gpu.total_us * f64::from(self.base.times[light])
                });
                let Base {
                    rendering,
                    times,
                    rounds,
                    ..
                } = &mut self.base;
                let with = Side::new(&mut self.other, &applied.lights, &mut tried.rendering);
                let mut sides = [Side::new(&mut self.lab, lights, rendering), with];
                let saved = Saved::measure(
                    &mut sides,
                    &turns,
                    times,
                    (stage, &mut applied.cast),
                    view,
                    *rounds,
                )?;
                let (drawn_us, built_us) = self.base.cost_of(&candidate.lights);
                Some(Saving {
                    frame_us: self.base.has_gpu_times.then_some(drawn_us * saved.drawn),
                    build_us: built_us * saved.built,
                })
            }
            false => None,
        };
        let size = setting.view.size.map(u64::from);
        let (pixels_changed, pixels) = (tried.pixels_changed, size[0] * size[1]);
        let name = |&light: &usize| setting.lights[light].name.clone();
        let ratio = |measured: f64, predicted: f64| (predicted > 0.0).then(|| measured / predicted);
        Ok(Some(Advice {
            kind: candidate.kind,
            lights: candidate.lights.iter().map(name).collect(),
            of: candidate.of.clone(),
            text: candidate.text(&self.base, &tried.after, pixels_changed, pixels),
            predicted,
            measured,
            frame_ratio: measured.and_then(|m| ratio(m.frame_us?, predicted.frame_us?)),
            build_ratio: measured.and_then(|m| ratio(m.build_us, predicted.build_us)),
            pixels_changed,
        }))
    }

    /// Draws the frame with the change, which the setting has, and predicts what it saves; nothing
    /// if that is too little, or the picture too different.
    fn draw(
        &mut self,
        candidate: &Candidate,
        setting: &Setting,
        applied: &Applied,
    ) -> Result<Option<Tried>, CliError> {
        let Setting { stage, view, .. } = setting;
        let Applied {
            lights, unshadowed, ..
        } = applied;
        let (base, other) = (&self.base, &mut self.other);
        other.unshadowed.clone_from(unshadowed);
        let mut rendering = other.begin(stage, view, base.method)?;
        other.draw(&mut rendering, stage, lights, view, Instant::now())?;
        other.read_calls(&rendering)?;
        let picture = other.lit(&rendering)?.exposed_rgb8(base.exposure);
        let pixels_changed = pixels_changed(&self.picture, &picture);
        let counter = other.counter(stage, lights, view, base.exposure)?;
        let mut after = work(other, setting, lights, &counter)?;
        drop(counter);
        for &light in unshadowed {
            // What is left out need not be built.
            let Some(work) = after.get_mut(light) else {
                continue;
            };
            (work.subset, work.casters, work.facing, work.quads) = (0, 0, 0, 0);
        }
        let of = &candidate.lights;
        let (drawn_us, built_us) = base.cost_of(of);
        let (mut drawn_after, mut built_after) = (0.0, 0.0);
        for &light in of {
            let (before, after) = (&base.lights[light], &after[light]);
            drawn_after += self.model.gpu_us(before, after).unwrap_or(0.0);
            built_after += self.model.build_us(before, after);
        }
        let predicted = Saving {
            frame_us: base.has_gpu_times.then_some(drawn_us - drawn_after),
            build_us: built_us - built_after,
        };
        let shorter = predicted.build_us > LEAST_BUILD * base.build_all_us
            && predicted.build_us > LEAST_SHARE * built_us;
        let faster = (predicted.frame_us)
            .is_some_and(|us| us > LEAST * base.frame.frame * 1e3 && us > LEAST_SHARE * drawn_us);
        let quads = |all: &mut dyn Iterator<Item = u32>| all.map(f64::from).sum::<f64>();
        let before = quads(&mut of.iter().map(|&light| base.lights[light].work.quads));
        let fewer = before - quads(&mut of.iter().map(|&light| after[light].quads));
        let too_few = candidate.least_quads > 0.0 && fewer < candidate.least_quads * before;
        let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
        let too_different = pixels_changed > candidate.may_change(pixels);
        if !(shorter || faster) || too_few || too_different {
            return Ok(None);
        }
        Ok(Some(Tried {
            rendering,
            after,
            predicted,
            pixels_changed,
        }))
    }
}

/// A change as it is made.
struct Applied {
    lights: Vec<StageLight>,
    unshadowed: Vec<usize>,
    /// How the stage casts after it, or before it while the stage has the change.
    cast: Option<Cast>,
}

impl Applied {
    fn new(change: &Change, setting: &Setting) -> Result<Self, CliError> {
        let Setting { stage, lights, .. } = setting;
        Ok(match change {
            Change::Lights(changes) => {
                let (lights, unshadowed) = changed(lights, changes);
                Self {
                    lights,
                    unshadowed,
                    cast: None,
                }
            }
            Change::Casting(group, rule) => {
                let members = group.members(stage).zip(&stage.mesh.casting);
                let casting = members.map(|(is_in, was)| match (is_in, was) {
                    (false, _) | (_, Casting::None) => *was,
                    _ => *rule,
                });
                Self {
                    lights: lights.clone(),
                    unshadowed: Vec::new(),
                    cast: Some(stage.recast(casting.collect())?),
                }
            }
        })
    }
}

/// A change that was drawn and is worth it.
struct Tried {
    rendering: Rendering,
    /// What each light has to do.
    after: Vec<Work>,
    predicted: Saving,
    pixels_changed: u64,
}

/// Pixels that differ from the picture as it is by more than two steps.
fn pixels_changed(before: &[u8], after: &[u8]) -> u64 {
    let pixels = before.chunks_exact(3).zip(after.chunks_exact(3));
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
    pixels.filter(differs).count() as u64
}
