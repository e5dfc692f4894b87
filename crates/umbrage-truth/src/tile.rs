//! Tiles: pixels that share a light list, and one memory of what shadowed them.
//!
//! Takes an oracle, a view and lights; walks every pixel-light that is not plainly out of range.
//! Invariant: what a tile finds depends on nothing outside it, so the number of threads cannot
//! change a result.

use glam::DVec3;
use umbrage_core::Light;

use crate::oracle::{Memory, Oracle, Surface, Verdict};
use crate::rays::EyeRays;

/// Pixels along a tile's side.
pub(crate) const SIDE: u32 = 16;

/// A rectangle of pixels, exclusive ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    pub(crate) x: [u32; 2],
    pub(crate) y: [u32; 2],
}

/// One pixel with a surface.
pub(crate) struct Pixel {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) surface: Surface,
}

/// All tiles of an image, row by row.
pub(crate) fn tiles(size: [u32; 2]) -> Vec<Tile> {
    let [columns, rows] = size.map(|n| n.div_ceil(SIDE));
    let span = |k: u32, end: u32| [k * SIDE, ((k + 1) * SIDE).min(end)];
    (0..rows)
        .flat_map(|row| {
            (0..columns).map(move |column| Tile {
                x: span(column, size[0]),
                y: span(row, size[1]),
            })
        })
        .collect()
}

impl Tile {
    pub(crate) fn pixel_count(&self) -> u64 {
        u64::from(self.x[1] - self.x[0]) * u64::from(self.y[1] - self.y[0])
    }

    /// A pixel's number in the tile, below `SIDE * SIDE`.
    pub(crate) fn number(&self, pixel: &Pixel) -> usize {
        ((pixel.y - self.y[0]) * SIDE + pixel.x - self.x[0]) as usize
    }

    /// Column and row of the pixel of this number.
    pub(crate) fn place(&self, number: usize) -> [u32; 2] {
        let number = number as u32;
        [self.x[0] + number % SIDE, self.y[0] + number / SIDE]
    }

    /// The tile's pixels that see a surface, row by row.
    pub(crate) fn pixels(&self, oracle: &Oracle, rays: &EyeRays) -> Vec<Pixel> {
        let mut pixels = Vec::with_capacity(self.pixel_count() as usize);
        for y in self.y[0]..self.y[1] {
            for x in self.x[0]..self.x[1] {
                let ray = rays.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                if let Some(surface) = oracle.surface(&ray, rays.min_distance) {
                    pixels.push(Pixel { x, y, surface });
                }
            }
        }
        pixels
    }
}

/// Calls `visit` with every sample: index of the light, index of the pixel, verdict.
pub(crate) fn samples(
    oracle: &Oracle,
    pixels: &[Pixel],
    lights: &[Light],
    mut visit: impl FnMut(usize, usize, Verdict),
) {
    if pixels.is_empty() {
        return;
    }
    let mut min = DVec3::INFINITY;
    let mut max = DVec3::NEG_INFINITY;
    for pixel in pixels {
        min = min.min(pixel.surface.point);
        max = max.max(pixel.surface.point);
    }
    for (index, light) in lights.iter().enumerate() {
        let position = light.position;
        let range = f64::from(light.range);
        // The distance to the box is rounded by a few ulp; 2^-40 keeps the cull conservative.
        let outside = position.distance(position.clamp(min, max)) > range * (1.0 + 1e-12);
        if outside && !light.is_directional() {
            continue;
        }
        let mut memory = Memory::default();
        for (k, pixel) in pixels.iter().enumerate() {
            let verdict = oracle.shade(&pixel.surface, light, &mut memory);
            if verdict.is_sample() {
                visit(index, k, verdict);
            }
        }
    }
}
