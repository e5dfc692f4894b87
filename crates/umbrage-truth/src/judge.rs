//! The judge: counts where a method's mask and the oracle differ, and why that matters.
//!
//! Takes an oracle, a view, lights and a mask; gives a [`Judgement`]. Invariant: counts are exact
//! integers, the same for any number of threads.
//!
//! Where the two differ, the pixel-light is *ambiguous* if the oracle's own verdict hangs on less
//! than the stated tolerance (see `ambiguity`), else it is *wrong*. A light that the method skipped
//! counts as lighting nothing: every lit sample in it is an error.

use umbrage_core::{Light, View};

use crate::mask::Mask;
use crate::oracle::Oracle;
use crate::rays::NearClip;

mod ambiguity;
mod verdicts;
mod worst;

pub use ambiguity::{TOLERANCE_DEPTH, TOLERANCE_PX};
pub use verdicts::{ErrorMap, Verdicts};
pub use worst::{WORST_COUNT, Worst, WrongKind};

/// How to judge.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct JudgeOptions {
    /// What the method does with surfaces before the near plane.
    pub near: NearClip,
    /// One flag a light: true if the method did not draw it. Empty: none skipped.
    pub skipped: Vec<bool>,
    /// Sideways tolerance of the eye ray, pixels.
    pub tolerance_px: f64,
}

impl Default for JudgeOptions {
    fn default() -> Self {
        Self {
            near: NearClip::default(),
            skipped: Vec::new(),
            tolerance_px: TOLERANCE_PX,
        }
    }
}

impl JudgeOptions {
    /// With this treatment of the near plane.
    pub fn with_near(mut self, near: NearClip) -> Self {
        self.near = near;
        self
    }

    /// With these lights skipped by the method.
    pub fn with_skipped(mut self, skipped: Vec<bool>) -> Self {
        self.skipped = skipped;
        self
    }

    /// With this sideways tolerance: see [`Verdicts::with_tolerance_px`].
    pub fn with_tolerance_px(mut self, tolerance_px: f64) -> Self {
        self.tolerance_px = tolerance_px;
        self
    }
}

/// Errors of one light, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightErrors {
    /// Pixels in range and facing the light, by the oracle.
    pub samples: u64,
    /// Samples where the method is wrong.
    pub wrong: u64,
    /// Samples where it differs within the tolerance.
    pub ambiguous: u64,
}

/// What [`judge()`] found. Counts are in pixel-lights.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Pixels of the image.
    pub pixels: u64,
    /// Lights of the scene, skipped ones included.
    pub lights: u32,
    /// Pixel-lights in range and facing the light, by the oracle.
    pub samples: u64,
    /// Samples where the method differs, and the oracle's verdict stands firm.
    pub wrong: u64,
    /// Of these: the method says lit, the oracle shadowed.
    pub wrong_lit: u64,
    /// Of these: the method says shadowed, the oracle lit.
    pub wrong_shadowed: u64,
    /// Samples where the method differs, and the oracle's verdict hangs on less than the tolerance.
    pub ambiguous: u64,
    /// Sideways tolerance of the eye ray, pixels.
    pub tolerance_px: f64,
    /// Tolerance along the eye ray, as a share of the distance.
    pub tolerance_depth: f64,
    /// Up to [`WORST_COUNT`] wrong samples, the firmest first, spread over tiles and lights.
    pub worst: Vec<Worst>,
    /// One entry a light.
    pub per_light: Vec<LightErrors>,
}

/// Judges a mask; [`Verdicts`] judge several of one view for the price of one. `progress` is called
/// with the pixels done and the pixels in all, from any thread and in any order.
///
/// # Panics
/// As [`Verdicts::judge`].
pub fn judge(
    oracle: &Oracle,
    view: &View,
    lights: &[Light],
    mask: &Mask,
    options: &JudgeOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Judgement {
    Verdicts::new(oracle, view, lights, options.near, progress)
        .with_tolerance_px(options.tolerance_px)
        .judge(oracle, mask, &options.skipped)
}

impl Verdicts {
    /// Judges a mask. `skipped` has one flag a light, true if the method did not draw it, or none.
    ///
    /// # Panics
    /// If the mask's size or number of lights is not that of the view and the lights, or if
    /// `skipped` is neither empty nor one flag a light: a checker must not guess.
    pub fn judge(&mut self, oracle: &Oracle, mask: &Mask, skipped: &[bool]) -> Judgement {
        self.check(mask, skipped);
        let tiles = self.errors(oracle, &says_lit(mask, skipped));
        let mut result = Judgement {
            pixels: u64::from(self.size[0]) * u64::from(self.size[1]),
            lights: self.lights.len() as u32,
            samples: 0,
            wrong: 0,
            wrong_lit: 0,
            wrong_shadowed: 0,
            ambiguous: 0,
            tolerance_px: self.tolerance_px,
            tolerance_depth: TOLERANCE_DEPTH,
            worst: Vec::new(),
            per_light: vec![LightErrors::default(); self.lights.len()],
        };
        let mut candidates = Vec::new();
        for tile in tiles {
            for (light, errors) in tile.lights {
                let sum = &mut result.per_light[light];
                sum.samples += errors.samples;
                sum.wrong += errors.wrong;
                sum.ambiguous += errors.ambiguous;
            }
            result.wrong_lit += tile.wrong_lit;
            candidates.extend(tile.first_wrong);
        }
        for errors in &result.per_light {
            result.samples += errors.samples;
            result.wrong += errors.wrong;
            result.ambiguous += errors.ambiguous;
        }
        result.wrong_shadowed = result.wrong - result.wrong_lit;
        result.worst = worst::choose(oracle, self, candidates);
        result
    }

    /// Where a mask errs that [`Verdicts::judge`] was given before; before that, nothing counts as
    /// ambiguous.
    ///
    /// # Panics
    /// As [`Verdicts::judge`].
    pub fn error_map(&self, mask: &Mask, skipped: &[bool]) -> ErrorMap {
        self.check(mask, skipped);
        self.map(says_lit(mask, skipped))
    }

    fn check(&self, mask: &Mask, skipped: &[bool]) {
        assert_eq!(mask.size, self.size, "mask and view differ in size");
        assert_eq!(
            mask.lights as usize,
            self.lights.len(),
            "mask and scene differ in lights"
        );
        assert_eq!(
            mask.words.len(),
            Mask::word_count(mask.size, mask.lights),
            "mask lacks words"
        );
        assert!(
            skipped.is_empty() || skipped.len() == self.lights.len(),
            "one skip flag a light"
        );
    }
}

fn says_lit(mask: &Mask, skipped: &[bool]) -> impl Fn(u32, u32, usize) -> bool + Sync {
    move |x, y, light| !skipped.get(light).copied().unwrap_or(false) && mask.get(x, y, light as u32)
}
