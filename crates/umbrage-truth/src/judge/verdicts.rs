//! The oracle's answers to one view, kept: several masks are judged by one cast of the rays.
//!
//! Takes an oracle, a view and lights; gives one bit a pixel-light for *is a sample* and one for
//! *lit*, tile by tile, with only the lights that have samples there. Whether a verdict is ambiguous
//! does not depend on the mask, so that too is found once, where a mask first differs.

use rayon::prelude::*;
use umbrage_core::{Light, View};

use super::LightErrors;
use super::ambiguity::{Neighbourhood, TOLERANCE_PX};
use super::worst::{Worst, WrongKind};
use crate::mask::Mask;
use crate::oracle::{Oracle, Verdict};
use crate::rays::{EyeRays, NearClip};
use crate::tile::{self, Pixel, SIDE, Tile};

/// Errors of one mask at each pixel, row by row: lights on which it is wrong, or ambiguous.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ErrorMap {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Wrong pixel-lights at each pixel.
    pub wrong: Vec<u16>,
    /// Ambiguous ones.
    pub ambiguous: Vec<u16>,
}

/// What the oracle says about every pixel-light of a view.
#[derive(Debug)]
pub struct Verdicts {
    pub(super) size: [u32; 2],
    pub(super) lights: Vec<Light>,
    pub(super) rays: EyeRays,
    pub(super) tolerance_px: f64,
    tiles: Vec<TileVerdicts>,
}

#[derive(Debug)]
struct TileVerdicts {
    tile: Tile,
    lights: Vec<LightVerdicts>,
}

/// One bit for each pixel of a tile.
type Bits = [u64; (SIDE * SIDE / 64) as usize];

#[derive(Clone, Debug)]
struct LightVerdicts {
    light: u32,
    sample: Bits,
    lit: Bits,
    /// Nothing until a mask differs somewhere.
    ambiguity: Option<Box<Ambiguity>>,
}

/// Where it is known whether the verdict is ambiguous, and where it is.
#[derive(Clone, Debug, Default)]
struct Ambiguity {
    known: Bits,
    ambiguous: Bits,
}

/// What one tile adds to a judgement.
#[derive(Default)]
pub(super) struct TileErrors {
    /// Lights with samples here.
    pub(super) lights: Vec<(usize, LightErrors)>,
    pub(super) wrong_lit: u64,
    /// The first wrong sample of each light.
    pub(super) first_wrong: Vec<Worst>,
}

impl Verdicts {
    /// Casts the rays. `progress` is called with the pixels done and the pixels in all, from any
    /// thread and in any order.
    pub fn new(
        oracle: &Oracle,
        view: &View,
        lights: &[Light],
        near: NearClip,
        progress: &(dyn Fn(u64, u64) + Sync),
    ) -> Self {
        let rays = EyeRays::new(view, near);
        let pixels = u64::from(view.size[0]) * u64::from(view.size[1]);
        let done = std::sync::atomic::AtomicU64::new(0);
        let tiles = tile::tiles(view.size)
            .into_par_iter()
            .map(|tile| {
                let found = TileVerdicts::new(oracle, &rays, lights, tile);
                let count = tile.pixel_count();
                let before = done.fetch_add(count, std::sync::atomic::Ordering::Relaxed);
                progress(before + count, pixels);
                found
            })
            .collect();
        Self {
            size: view.size,
            lights: lights.to_vec(),
            rays,
            tolerance_px: TOLERANCE_PX,
            tiles,
        }
    }

    /// With this sideways tolerance in place of [`TOLERANCE_PX`]: a finite length in pixels. Only
    /// for a rasteriser whose grid is known to be coarser than 1/256 pixel; judgements report it.
    pub fn with_tolerance_px(mut self, tolerance_px: f64) -> Self {
        self.tolerance_px = tolerance_px;
        for of_light in self.tiles.iter_mut().flat_map(|tile| &mut tile.lights) {
            of_light.ambiguity = None;
        }
        self
    }

    /// The oracle's own mask.
    pub fn mask(&self) -> Mask {
        let mut mask = Mask::new(self.size, self.lights.len() as u32);
        for tile in &self.tiles {
            for of_light in &tile.lights {
                for k in ones(&of_light.lit) {
                    let [x, y] = tile.tile.place(k);
                    mask.set(x, y, of_light.light, true);
                }
            }
        }
        mask
    }

    /// Where `says_lit(x, y, light)` errs, tile by tile, in their order.
    pub(super) fn errors(
        &mut self,
        oracle: &Oracle,
        says_lit: &(impl Fn(u32, u32, usize) -> bool + Sync),
    ) -> Vec<TileErrors> {
        let (rays, lights) = (&self.rays, &self.lights);
        let around = |x, y| neighbourhood(oracle, rays, [x, y], self.tolerance_px);
        self.tiles
            .par_iter_mut()
            .map(|tile| tile.errors(oracle, lights, &around, says_lit))
            .collect()
    }

    /// Where a mask that was judged errs.
    pub(super) fn map(&self, says_lit: impl Fn(u32, u32, usize) -> bool) -> ErrorMap {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let mut map = ErrorMap {
            size: self.size,
            wrong: vec![0; pixels],
            ambiguous: vec![0; pixels],
        };
        for tile in &self.tiles {
            for of_light in &tile.lights {
                for k in ones(&of_light.sample) {
                    let [x, y] = tile.tile.place(k);
                    if says_lit(x, y, of_light.light as usize) != has(&of_light.lit, k) {
                        let ambiguity = of_light.ambiguity.as_ref();
                        let counts = match ambiguity.is_some_and(|a| has(&a.ambiguous, k)) {
                            true => &mut map.ambiguous,
                            false => &mut map.wrong,
                        };
                        let count = &mut counts[(y * self.size[0] + x) as usize];
                        *count = count.saturating_add(1);
                    }
                }
            }
        }
        map
    }
}

impl TileVerdicts {
    fn new(oracle: &Oracle, rays: &EyeRays, lights: &[Light], tile: Tile) -> Self {
        let pixels = tile.pixels(oracle, rays);
        let mut found: Vec<LightVerdicts> = Vec::new();
        tile::samples(oracle, &pixels, lights, |light, k, verdict| {
            if found.last().is_none_or(|last| last.light != light as u32) {
                found.push(LightVerdicts {
                    light: light as u32,
                    sample: Bits::default(),
                    lit: Bits::default(),
                    ambiguity: None,
                });
            }
            if let Some(of_light) = found.last_mut() {
                let k = tile.number(&pixels[k]);
                set(&mut of_light.sample, k);
                if verdict == Verdict::Lit {
                    set(&mut of_light.lit, k);
                }
            }
        });
        Self {
            tile,
            lights: found,
        }
    }

    fn errors(
        &mut self,
        oracle: &Oracle,
        lights: &[Light],
        surroundings: &impl Fn(u32, u32) -> Option<Box<Neighbourhood>>,
        says_lit: &impl Fn(u32, u32, usize) -> bool,
    ) -> TileErrors {
        let tile = self.tile;
        let mut around: Vec<Option<Box<Neighbourhood>>> = Vec::new();
        around.resize_with((SIDE * SIDE) as usize, || None);
        let mut errors = TileErrors::default();
        for found in &mut self.lights {
            let light = found.light as usize;
            let mut of_light = LightErrors::default();
            for k in ones(&found.sample) {
                of_light.samples += 1;
                let [x, y] = tile.place(k);
                let lit = has(&found.lit, k);
                if says_lit(x, y, light) == lit {
                    continue;
                }
                let (kind, verdict) = match lit {
                    false => (WrongKind::Lit, Verdict::Shadowed),
                    true => (WrongKind::Shadowed, Verdict::Lit),
                };
                let ambiguity = found.ambiguity.get_or_insert_default();
                if !has(&ambiguity.known, k) {
                    set(&mut ambiguity.known, k);
                    if around[k].is_none() {
                        around[k] = surroundings(x, y);
                    }
                    let near = around[k].as_ref();
                    if near.is_some_and(|n| n.is_ambiguous(oracle, &lights[light], verdict)) {
                        set(&mut ambiguity.ambiguous, k);
                    }
                }
                if has(&ambiguity.ambiguous, k) {
                    of_light.ambiguous += 1;
                    continue;
                }
                of_light.wrong += 1;
                errors.wrong_lit += u64::from(kind == WrongKind::Lit);
                if of_light.wrong == 1 {
                    errors.first_wrong.push(Worst {
                        x,
                        y,
                        light: found.light,
                        kind,
                        firm_px: 0.0,
                    });
                }
            }
            errors.lights.push((light, of_light));
        }
        errors
    }
}

/// Around a pixel that sees a surface.
fn neighbourhood(
    oracle: &Oracle,
    rays: &EyeRays,
    [x, y]: [u32; 2],
    tolerance_px: f64,
) -> Option<Box<Neighbourhood>> {
    let ray = rays.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let surface = oracle.surface(&ray, rays.min_distance)?;
    let pixel = Pixel { x, y, surface };
    let found = Neighbourhood::of(oracle, rays, &pixel, tolerance_px);
    Some(Box::new(found))
}

fn has(bits: &Bits, k: usize) -> bool {
    bits[k / 64] >> (k % 64) & 1 == 1
}

fn set(bits: &mut Bits, k: usize) {
    bits[k / 64] |= 1 << (k % 64);
}

/// Numbers of the bits that are 1, ascending.
fn ones(bits: &Bits) -> impl Iterator<Item = usize> + use<> {
    let bits = *bits;
    (0..bits.len()).flat_map(move |word| {
        let mut left = bits[word];
        std::iter::from_fn(move || {
            let bit = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (bit < 64).then_some(word * 64 + bit)
        })
    })
}
