//! 64 lanes at a time: the few operations that query, facing and counter are made of.
//!
//! Three implementations with the same results, bit for bit and in order: AVX-512 (with VBMI for the
//! byte permute) and AVX2 through `std::arch`, chosen at run time, and a portable one. `std::arch`
//! because no portable crate offers byte permutes and register compression, which are what makes
//! the difference here.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

use std::sync::atomic::{AtomicU8, Ordering};

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;

use crate::volume::Quad;
use crate::world::{BoxCluster, EdgeUse, LANES, NearLight, PlaneCluster};

/// What volumes are computed with; results are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum InstructionSet {
    /// What every processor has.
    Portable,
    /// x86-64 of 2013 and later.
    Avx2,
    /// x86-64 with AVX-512 F, BW and VBMI.
    Avx512,
}

static LIMIT: AtomicU8 = AtomicU8::new(InstructionSet::Avx512 as u8);

impl InstructionSet {
    /// All, the plainest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The one in use: the best that this processor has and [`InstructionSet::limit`] allows.
    pub fn in_use() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if Avx512::detect().is_some() {
                return Self::Avx512;
            }
            if Avx2::detect().is_some() {
                return Self::Avx2;
            }
        }
        Self::Portable
    }

    /// Uses none better than this from now on, in the whole process: for measurements.
    pub fn limit(self) {
        LIMIT.store(self as u8, Ordering::Relaxed);
    }

    #[cfg(target_arch = "x86_64")]
    #[inline]
    fn is_allowed(self) -> bool {
        LIMIT.load(Ordering::Relaxed) >= self as u8
    }
}

/// See the module.
pub(crate) trait Lanes64: Copy {
    /// Triangles proven in front of, and behind, the light's side of their plane.
    fn sides(self, planes: &PlaneCluster, light: &NearLight) -> (u64, u64);

    /// The boxes whose distance from `center` is at most the root of `range2`.
    fn near(self, boxes: &BoxCluster, center: [f32; 3], range2: f32) -> u64;

    /// Bit i of the result is bit `partner[i]` of `mask`.
    fn permute(self, mask: u64, partner: &[u8; LANES]) -> u64;

    /// Appends the uses of the set lanes, direction bits flipped if `flip` is 1.
    fn append(self, uses: &[EdgeUse; LANES], mask: u64, flip: u32, out: &mut Vec<Quad>);
}

/// Runs a function with the best lanes this processor has.
macro_rules! with_lanes {
    ($function:ident($($argument:expr),*)) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(lanes) = crate::lanes64::Avx512::detect() {
                return lanes.run(
                    #[inline(always)]
                    |lanes| $function(lanes, $($argument),*),
                );
            }
            if let Some(lanes) = crate::lanes64::Avx2::detect() {
                return lanes.run(
                    #[inline(always)]
                    |lanes| $function(lanes, $($argument),*),
                );
            }
        }
        $function(crate::lanes64::Portable, $($argument),*)
    }};
}
pub(crate) use with_lanes;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::world::LANES;

    /// What the processor has gives the same bits in the same order.
    #[test]
    fn all_versions_agree() {
        if let Some(wide) = Avx512::detect() {
            agrees(wide);
        }
        if let Some(wide) = Avx2::detect() {
            agrees(wide);
        }
    }

    fn agrees(wide: impl Lanes64) {
        let mut state = 7u64;
        let mut random = move || {
            state = state
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(0x1405_7b7e_f767_814f);
            state >> 20
        };
        for _ in 0..500 {
            let mut number = || (random() % 4097) as f32 / 512.0 - 4.0;
            let mut lanes = || std::array::from_fn::<f32, LANES, _>(|_| number());
            let planes = PlaneCluster {
                nx: lanes(),
                ny: lanes(),
                nz: lanes(),
                d: lanes(),
                center: [0.0; 3],
                radius: 0.0,
                unused: [0.0; 12],
            };
            let boxes = BoxCluster {
                min: [lanes(), lanes(), lanes()],
                max: [lanes(), lanes(), lanes()],
            };
            let light = NearLight {
                homogeneous: [1.5, -0.25, 3.0, 1.0],
                bound: 0.125,
            };
            assert_eq!(wide.sides(&planes, &light), Portable.sides(&planes, &light));
            let near = |r| {
                (
                    wide.near(&boxes, [0.5; 3], r),
                    Portable.near(&boxes, [0.5; 3], r),
                )
            };
            for (a, b) in [near(0.5), near(4.0), near(20.0), near(f32::INFINITY)] {
                assert_eq!(a, b);
            }
            let partner = std::array::from_fn::<u8, LANES, _>(|_| (random() % 64) as u8);
            let uses = std::array::from_fn::<EdgeUse, LANES, _>(|_| EdgeUse(random() as u32));
            let mask = random() << 20 ^ random();
            assert_eq!(
                wide.permute(mask, &partner),
                Portable.permute(mask, &partner)
            );
            for flip in [0, 1] {
                let (mut a, mut b) = (vec![Quad::default()], vec![Quad::default()]);
                wide.append(&uses, mask, flip, &mut a);
                Portable.append(&uses, mask, flip, &mut b);
                assert_eq!(a, b);
            }
        }
    }
}
