//! Seeded random numbers, the same on every machine.
//!
//! Source: SplitMix64, Steele, Lea and Flood, "Fast splittable pseudorandom number generators",
//! OOPSLA 2014, figure 17.

use glam::Vec3;

/// A stream of random numbers.
pub(super) struct Rng(u64);

impl Rng {
    /// The stream of a seed and of a place in the world, so that a place does not change when
    /// the world grows.
    pub(super) fn new(seed: u64, place: [i64; 2]) -> Self {
        let mut rng = Self(seed);
        for part in place {
            rng.0 = rng.next() ^ part as u64;
        }
        rng
    }

    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 up to but not including 1.
    pub(super) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// From `low` up to `high`.
    pub(super) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// From 0 up to but not including `count`.
    pub(super) fn below(&mut self, count: u32) -> u32 {
        (((self.next() >> 32) * u64::from(count)) >> 32) as u32
    }

    /// True in one of `count` cases.
    pub(super) fn one_in(&mut self, count: u32) -> bool {
        self.below(count) == 0
    }

    /// A point in the box from `low` to `high`.
    pub(super) fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|i| self.within(low[i], high[i])))
    }
}
