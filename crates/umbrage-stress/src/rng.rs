//! Seeded random numbers, the same on every machine.
//!
//! Takes a seed; gives a stream. Only sums, products, quotients and square roots go into what is
//! derived from it, which are exactly rounded everywhere. Source: SplitMix64, Steele, Lea and
//! Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014, figure 17.

use glam::{DVec3, Vec3};

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random(u64);

/// The numbers behind a seed and a place in its sequence, mixed.
pub fn mix(seed: u64, place: u64) -> u64 {
    let mut random = Random(seed);
    random.0 = random.bits() ^ place;
    random.bits()
}

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 up to but not including 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From `low` up to `high`.
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// From 0 up to but not including `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (((self.bits() >> 32) * count as u64) >> 32) as usize
    }

    /// From `low` to `high`, both included.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }

    /// True in one of `count` cases.
    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// One of a list that is not empty.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// Ten to a whole power from `low` to `high`, times 1 up to 10.
    pub fn decades(&mut self, low: i32, high: i32) -> f64 {
        let power = low + self.below((high - low + 1) as usize) as i32;
        let mut value = 1.0 + 9.0 * self.unit();
        for _ in 0..power.unsigned_abs() {
            value = if power > 0 {
                value * 10.0
            } else {
                value / 10.0
            };
        }
        value
    }

    /// A point of the cube of half side `half` around zero.
    pub fn point(&mut self, half: f32) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.within(-half, half)))
    }

    /// A direction of length 1, as f32 rounds it.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point(1.0);
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }

    /// Shares of three corners, none negative, together 1.
    pub fn shares(&mut self) -> DVec3 {
        let (mut u, mut v) = (self.unit(), self.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        DVec3::new(1.0 - u - v, u, v)
    }
}
