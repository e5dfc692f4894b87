//! What is drawn for one light, step by step, as plain data: the recorders execute it, and its
//! passes are those of the paper's table 1.
//!
//! The paper renders a scene in passes; a deferred renderer draws the surface once, and each light
//! reads it. They map so:
//! - the scene's first pass, which lays depth: [`Step::Surface`], once for all lights;
//! - alpha buffer: the rectangle that multiplies the scene by alpha: [`Step::Light`], the light's
//!   one draw, blended with factors (destination alpha, one);
//! - screen buffer: the second pass of the scene, multiplied with the mask: [`Step::Light`] too,
//!   which reads the mask as a texture;
//! - the pass that adds an ambient term: [`Step::Ambient`], a draw for each light.

use crate::application::Application;
use crate::method::{Counting, MaskBuffer};

/// Where a mask is until it is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the alpha channel that the light adds up beside.
    Frame,
    /// In channels of a texture of its own.
    Layers,
    /// The same at a lower resolution, whose texels a light reads up to one aside of its own.
    LowLayers,
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Depth and surface, for all lights.
    Surface,
    /// The light's volume in the stencil.
    Stencil,
    /// The mask's first value, over the light's rows; the paper clears.
    Start,
    /// The volume's faces that raise the count.
    Raise,
    /// Those that lower it.
    Lower,
    /// Over the light's rows.
    Rectangle(Rectangle),
    /// The light, multiplied by the mask.
    Light,
    /// What it adds in its shadow.
    Ambient,
}

/// What a rectangle does to the mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Rectangle {
    /// Twice as much.
    Double,
    /// No more than 1.
    Clamp,
    /// One less it.
    Invert,
    /// Half a unit more.
    AddHalf,
    /// No less than half: the maximum blend equation.
    AtLeastHalf,
    /// One less twice what is missing to 1: from half and one to nothing and one. No step of the
    /// paper, whose masks by maximum attenuate and no more.
    Stretch,
    /// No more than what is lit: once more [`Rectangle::Clamp`], after all others. No step of the
    /// paper, whose alpha clamps by itself: where rounding leaves a count below zero, floats would
    /// be left at up to three times what is lit.
    Limit,
    /// Times the application's share, where the stencil says shadow. No step of the paper, in which
    /// a stencil stays at full resolution.
    Darken,
}

/// One kind of mask, and what is made of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MaskPlan {
    pub(crate) of: Counting,
    pub(crate) place: Place,
    pub(crate) application: Application,
}

impl MaskPlan {
    /// What is drawn for one light, in order.
    pub(crate) fn steps(self) -> Vec<Step> {
        use Rectangle::{AddHalf, AtLeastHalf, Clamp, Darken, Double, Invert, Limit, Stretch};
        let attenuated = self.application == Application::Attenuated;
        let last = if attenuated { AddHalf } else { Double };
        let normalise = match self.of {
            Counting::Stencil => vec![Darken],
            Counting::Mask(MaskBuffer::Screen) => vec![Double, Invert, last],
            Counting::Mask(MaskBuffer::Alpha) => vec![Clamp, Invert, last, Limit],
            Counting::Mask(MaskBuffer::Max) if attenuated => vec![AtLeastHalf, Limit],
            Counting::Mask(MaskBuffer::Max) => vec![AtLeastHalf, Stretch, Limit],
        };
        let mut steps = vec![Step::Surface];
        match self.of {
            Counting::Stencil => steps.push(Step::Stencil),
            Counting::Mask(_) => steps.extend([Step::Start, Step::Raise, Step::Lower]),
        }
        steps.extend(normalise.into_iter().map(Step::Rectangle));
        steps.push(Step::Light);
        if self.application == Application::Ambient {
            steps.push(Step::Ambient);
        }
        steps
    }

    /// The steps that make and normalise the mask.
    pub(crate) fn mask_steps(self) -> Vec<Step> {
        let mut steps = self.steps();
        steps.retain(|step| !matches!(step, Step::Surface | Step::Light | Step::Ambient));
        steps
    }

    /// The steps that apply it.
    pub(crate) fn light_steps(self) -> Vec<Step> {
        let mut steps = self.steps();
        steps.retain(|step| matches!(step, Step::Light | Step::Ambient));
        steps
    }

    /// What is left of the light in its shadow, of which the ambient term is no part.
    pub(crate) fn dark(self) -> f32 {
        match self.application {
            Application::Attenuated => 0.5,
            Application::Black | Application::Ambient => 0.0,
        }
    }

    /// The mask's first value, where `eye_count` casters stand between eye and light.
    pub(crate) fn start(self, eye_count: u32) -> f32 {
        let (lit, power) = match self.of {
            // Untouched by the stencil.
            Counting::Stencil => (1.0, 0),
            // A quarter in eight bits.
            Counting::Mask(MaskBuffer::Screen) => (64.0 / 255.0, eye_count.min(2) as i32),
            Counting::Mask(MaskBuffer::Alpha) => (0.5, eye_count.min(16) as i32),
            Counting::Mask(MaskBuffer::Max) => (1.0, -(eye_count.min(14) as i32)),
        };
        f32::min(lit * 2f32.powi(power), self.most())
    }

    /// What halving multiplies by. A half is no number of eight bits; 128 of 255 leads 255, 128 and
    /// 64 into each other whichever way products are rounded.
    pub(crate) fn half(self) -> f64 {
        match self.of {
            Counting::Mask(MaskBuffer::Screen) => 128.0 / 255.0,
            _ => 0.5,
        }
    }

    fn most(self) -> f32 {
        match self.of {
            Counting::Mask(MaskBuffer::Alpha) => 32768.0,
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Application::{Ambient, Attenuated, Black};

    /// Passes of the scene and rectangles, as the paper counts them, and the rectangles that are no
    /// step of the paper.
    fn passes(of: MaskBuffer, place: Place, application: Application) -> [usize; 3] {
        let plan = MaskPlan {
            of: Counting::Mask(of),
            place,
            application,
        };
        let [mut scene, mut rectangles, mut ours] = [0; 3];
        for step in plan.steps() {
            use Rectangle::{Darken, Limit, Stretch};
            match (step, place) {
                (Step::Surface | Step::Ambient, _) => scene += 1,
                (Step::Light, Place::Layers | Place::LowLayers) => scene += 1,
                (Step::Rectangle(Stretch | Limit | Darken), _) => ours += 1,
                (Step::Rectangle(_), _) | (Step::Light, Place::Frame) => rectangles += 1,
                (Step::Stencil | Step::Start | Step::Raise | Step::Lower, _) => {}
            }
        }
        [scene, rectangles, ours]
    }

    #[test]
    fn passes_are_those_of_table_1_and_what_floats_take_besides() {
        use MaskBuffer::{Alpha, Max, Screen};
        let applications = [Black, Ambient, Attenuated];
        let alpha = applications.map(|a| passes(Alpha, Place::Frame, a));
        assert_eq!(alpha, [[1, 4, 1], [2, 4, 1], [1, 4, 1]]);
        let screen = applications.map(|a| passes(Screen, Place::Layers, a));
        assert_eq!(screen, [[2, 3, 0], [3, 3, 0], [2, 3, 0]]);
        // In brackets there: with the maximum blend equation, which attenuates and no more.
        assert_eq!(passes(Max, Place::Frame, Attenuated), [1, 2, 1]);
        assert_eq!(passes(Max, Place::Layers, Attenuated), [2, 1, 1]);
        assert_eq!(passes(Max, Place::Frame, Black), [1, 2, 2]);
        assert_eq!(passes(Max, Place::Frame, Ambient), [2, 2, 2]);
    }

    /// The arithmetic of a plan on one value, as the blend equations have it.
    fn value(plan: MaskPlan, eye_count: u32, raised: u32, lowered: u32) -> f32 {
        let Counting::Mask(buffer) = plan.of else {
            unreachable!()
        };
        let eight_bits = buffer == MaskBuffer::Screen;
        let stored = |v: f32| match eight_bits {
            true => (v.clamp(0.0, 1.0) * 255.0).round() / 255.0,
            false => half::f16::from_f32(v).to_f32(),
        };
        let mut v = stored(plan.start(eye_count));
        for step in plan.steps() {
            let (times, raises) = match step {
                Step::Raise => (raised, true),
                Step::Lower => (lowered, false),
                _ => (0, false),
            };
            for _ in 0..times {
                let doubles = raises != (buffer == MaskBuffer::Max);
                v = stored(if doubles {
                    v * 2.0
                } else {
                    v * plan.half() as f32
                });
            }
            if let Step::Rectangle(rectangle) = step {
                v = stored(match rectangle {
                    Rectangle::Double => 2.0 * v,
                    Rectangle::Clamp | Rectangle::Limit => v.min(1.0),
                    Rectangle::Invert => 1.0 - v,
                    Rectangle::AddHalf => v + 0.5,
                    Rectangle::AtLeastHalf => v.max(0.5),
                    Rectangle::Stretch => v - (1.0 - v),
                    Rectangle::Darken => unreachable!(),
                });
            }
        }
        v
    }

    #[test]
    fn values_are_right_for_all_layers_that_can_be_represented() {
        for buffer in [MaskBuffer::Screen, MaskBuffer::Alpha, MaskBuffer::Max] {
            for application in [Black, Ambient, Attenuated] {
                let plan = MaskPlan {
                    of: Counting::Mask(buffer),
                    place: Place::Frame,
                    application,
                };
                for eye in 0..=buffer.layers() {
                    for raised in 0..=buffer.layers() - eye {
                        for lowered in 0..=eye + raised {
                            let wanted = if eye + raised == lowered {
                                1.0
                            } else {
                                plan.dark()
                            };
                            let found = value(plan, eye, raised, lowered);
                            assert!(
                                (found - wanted).abs() <= 1.0 / 255.0,
                                "{plan:?}: {eye} + {raised} - {lowered} gives {found}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_count_below_zero_is_no_brighter_than_lit() {
        for buffer in [MaskBuffer::Screen, MaskBuffer::Alpha, MaskBuffer::Max] {
            for application in [Black, Ambient, Attenuated] {
                let plan = MaskPlan {
                    of: Counting::Mask(buffer),
                    place: Place::Frame,
                    application,
                };
                for (eye, lowered) in [(0, 1), (0, 2), (1, 2), (0, 20)] {
                    let found = value(plan, eye, 0, lowered);
                    assert!((0.0..=1.0).contains(&found), "{plan:?}: {found}");
                }
            }
        }
    }

    /// The negative control: one layer more than the values are enough for.
    #[test]
    fn a_layer_too_many_is_lit() {
        let plan = MaskPlan {
            of: Counting::Mask(MaskBuffer::Screen),
            place: Place::Layers,
            application: Black,
        };
        assert!(value(plan, 0, 3, 2) > 0.9);
        assert!(value(plan, 1, 2, 2) > 0.9);
    }
}
