//! The judge: counts where a method's mask and the oracle differ, and why that matters.
//!
//! Takes an oracle, a view, lights and a mask; gives a [`Judgement`]. Invariant: counts are exact
//! integers, the same for any number of threads.
//!
//! Where the two differ, the pixel-light is *ambiguous* if the oracle's own verdict hangs on less
//! than the stated tolerance (see `ambiguity`), else it is *wrong*. A light that the method skipped
//! counts as lighting nothing: every lit sample in it is an error.

use rayon::prelude::*;
use umbrage_core::{Light, View};

use crate::mask::Mask;
use crate::oracle::{Oracle, Verdict};
use crate::rays::{EyeRays, NearClip};
use crate::tile;

mod ambiguity;
mod worst;

use ambiguity::Neighbourhood;
pub use ambiguity::{TOLERANCE_DEPTH, TOLERANCE_PX};
pub use worst::{WORST_COUNT, Worst, WrongKind};

/// How to judge.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct JudgeOptions {
    /// What the method does with surfaces before the near plane.
    pub near: NearClip,
    /// One flag a light: true if the method did not draw it. Empty: none skipped.
    pub skipped: Vec<bool>,
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

/// What one tile adds.
#[derive(Default)]
struct TileErrors {
    /// Lights with samples here.
    lights: Vec<(usize, LightErrors)>,
    wrong_lit: u64,
    /// The first wrong sample of each light.
    first_wrong: Vec<Worst>,
}

/// Judges a mask. `progress` is called with the pixels done and the pixels in all, from any
/// thread and in any order.
///
/// # Panics
/// If the mask's size or number of lights is not that of the view and the lights, or if
/// `options.skipped` is neither empty nor one flag a light: a checker must not guess.
pub fn judge(
    oracle: &Oracle,
    view: &View,
    lights: &[Light],
    mask: &Mask,
    options: &JudgeOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Judgement {
    assert_eq!(mask.size, view.size, "mask and view differ in size");
    assert_eq!(
        mask.lights as usize,
        lights.len(),
        "mask and scene differ in lights"
    );
    assert_eq!(
        mask.words.len(),
        Mask::word_count(mask.size, mask.lights),
        "mask lacks words"
    );
    let skipped = &options.skipped;
    assert!(
        skipped.is_empty() || skipped.len() == lights.len(),
        "one skip flag a light"
    );

    let rays = EyeRays::new(view, options.near);
    let method_lit = |x, y, light: usize| {
        !skipped.get(light).copied().unwrap_or(false) && mask.get(x, y, light as u32)
    };
    let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
    let done = std::sync::atomic::AtomicU64::new(0);
    let tiles: Vec<TileErrors> = tile::tiles(view.size)
        .into_par_iter()
        .map(|tile| {
            let errors = judge_tile(oracle, &rays, lights, &tile, &method_lit);
            let count = tile.pixel_count();
            let before = done.fetch_add(count, std::sync::atomic::Ordering::Relaxed);
            progress(before + count, pixels);
            errors
        })
        .collect();

    let mut result = Judgement {
        pixels,
        lights: lights.len() as u32,
        samples: 0,
        wrong: 0,
        wrong_lit: 0,
        wrong_shadowed: 0,
        ambiguous: 0,
        tolerance_px: TOLERANCE_PX,
        tolerance_depth: TOLERANCE_DEPTH,
        worst: Vec::new(),
        per_light: vec![LightErrors::default(); lights.len()],
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
    result.worst = worst::choose(oracle, &rays, lights, candidates);
    result
}

fn judge_tile(
    oracle: &Oracle,
    rays: &EyeRays,
    lights: &[Light],
    tile: &tile::Tile,
    method_lit: &impl Fn(u32, u32, usize) -> bool,
) -> TileErrors {
    let pixels = tile.pixels(oracle, rays);
    let mut around: Vec<Option<Box<Neighbourhood>>> = Vec::new();
    around.resize_with(pixels.len(), || None);
    let mut errors = TileErrors::default();
    tile::samples(oracle, &pixels, lights, |light, k, verdict| {
        if errors.lights.last().is_none_or(|last| last.0 != light) {
            errors.lights.push((light, LightErrors::default()));
        }
        let Some((_, of_light)) = errors.lights.last_mut() else {
            return;
        };
        of_light.samples += 1;
        let pixel = &pixels[k];
        let kind = match (method_lit(pixel.x, pixel.y, light), verdict) {
            (true, Verdict::Shadowed) => WrongKind::Lit,
            (false, Verdict::Lit) => WrongKind::Shadowed,
            _ => return,
        };
        let near =
            around[k].get_or_insert_with(|| Box::new(Neighbourhood::of(oracle, rays, pixel)));
        if near.is_ambiguous(oracle, &lights[light], verdict) {
            of_light.ambiguous += 1;
            return;
        }
        of_light.wrong += 1;
        errors.wrong_lit += u64::from(kind == WrongKind::Lit);
        if of_light.wrong == 1 {
            let (x, y, light) = (pixel.x, pixel.y, light as u32);
            errors.first_wrong.push(Worst {
                x,
                y,
                light,
                kind,
                firm_px: 0.0,
            });
        }
    });
    errors
}
