//! Shadow masks: what a method said about every pixel and light. One bit each.

use umbrage_core::View;

use crate::oracle::Oracle;
use crate::rays::{EyeRays, NearClip};

/// Per light and pixel: lit or not.
///
/// Bit `light % 32` of `words[(light / 32) * width * height + y * width + x]` is 1 where the
/// method says that the light reaches the surface seen in pixel `(x, y)`; y counts down from the
/// top row. Bits of pixels that are no samples (background, out of range, facing away) are free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Number of lights.
    pub lights: u32,
    /// One plane of words for each 32 lights, row by row.
    pub words: Vec<u32>,
}

impl Mask {
    /// A mask in which nothing is lit.
    pub fn new(size: [u32; 2], lights: u32) -> Self {
        let words = vec![0; Self::word_count(size, lights)];
        Self {
            size,
            lights,
            words,
        }
    }

    /// Number of words of a mask.
    pub fn word_count(size: [u32; 2], lights: u32) -> usize {
        size[0] as usize * size[1] as usize * lights.div_ceil(32) as usize
    }

    /// Whether light `light` is said to reach pixel `(x, y)`.
    ///
    /// # Panics
    /// Outside the mask.
    #[inline]
    pub fn get(&self, x: u32, y: u32, light: u32) -> bool {
        self.words[self.index(x, y, light)] >> (light % 32) & 1 != 0
    }

    /// Says whether light `light` reaches pixel `(x, y)`.
    ///
    /// # Panics
    /// Outside the mask.
    #[inline]
    pub fn set(&mut self, x: u32, y: u32, light: u32, lit: bool) {
        let index = self.index(x, y, light);
        let bit = 1 << (light % 32);
        if lit {
            self.words[index] |= bit;
        } else {
            self.words[index] &= !bit;
        }
    }

    /// Takes over `truth` where what is seen stands before the near plane: surfaces there are clamped
    /// to one depth, and which of them is drawn is open.
    pub fn trust_before_near(
        &mut self,
        oracle: &Oracle,
        view: &View,
        clip: NearClip,
        truth: &Self,
    ) {
        let rays = EyeRays::new(view, clip);
        let near = f64::from(view.near) * (1.0 + 1e-6);
        let [width, height] = self.size;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let hit = oracle.first_hit(&rays, f64::from(x) + 0.5, f64::from(y) + 0.5);
            if hit.is_some_and(|hit| hit.distance <= near) {
                for light in 0..self.lights {
                    self.set(x, y, light, truth.get(x, y, light));
                }
            }
        }
    }

    #[inline]
    fn index(&self, x: u32, y: u32, light: u32) -> usize {
        let [width, height] = self.size;
        assert!(
            x < width && y < height && light < self.lights,
            "pixel ({x}, {y}), light {light} lie outside a mask of {width} x {height}, {} lights",
            self.lights
        );
        let (width, height) = (width as usize, height as usize);
        (light as usize / 32 * height + y as usize) * width + x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_do_not_touch_each_other() {
        let mut mask = Mask::new([3, 2], 34);
        assert_eq!(mask.words.len(), 12);
        mask.set(2, 1, 33, true);
        mask.set(2, 1, 1, true);
        assert_eq!(mask.words[5], 2);
        assert_eq!(mask.words[11], 2);
        mask.set(2, 1, 1, false);
        assert!(mask.get(2, 1, 33) && !mask.get(2, 1, 1));
        assert_eq!(mask.words.iter().map(|w| w.count_ones()).sum::<u32>(), 1);
    }

    #[test]
    #[should_panic(expected = "outside a mask")]
    fn a_column_too_far_is_not_the_next_row() {
        Mask::new([3, 2], 1).get(3, 0, 0);
    }
}
