//! 64 lanes at a time: the few operations that query, facing and counter are made of.
//!
//! Two implementations with the same results, bit for bit and in order: AVX-512 (with VBMI for
//! the byte permute) through `std::arch`, chosen at run time, and a portable one. `std::arch`
//! because no portable crate offers 64-byte permutes and register compression, which are what
//! makes the difference here.

use crate::volume::Quad;
use crate::world::{BoxCluster, EdgeUse, FILTER, LANES, LightPoint, PlaneCluster};

/// See the module.
pub(crate) trait Lanes64: Copy {
    /// Triangles proven in front of, and behind, the light's side of their plane.
    fn sides(self, planes: &PlaneCluster, light: &LightPoint) -> (u64, u64);

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
        if let Some(lanes) = crate::lanes64::Avx512::detect() {
            return lanes.run(
                #[inline(always)]
                |lanes| $function(lanes, $($argument),*),
            );
        }
        $function(crate::lanes64::Portable, $($argument),*)
    }};
}
pub(crate) use with_lanes;

/// Plain Rust.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Lanes64 for Portable {
    #[inline(always)]
    fn sides(self, planes: &PlaneCluster, light: &LightPoint) -> (u64, u64) {
        let [x, y, z, w] = light.homogeneous;
        let (mut front, mut back) = (0, 0);
        for i in 0..LANES {
            let dw = planes.d[i] * w;
            let s = planes.nx[i] * x + planes.ny[i] * y + planes.nz[i] * z - dw;
            let bound = FILTER * (light.norm1 + dw.abs());
            front |= u64::from(s > bound) << i;
            back |= u64::from(s < -bound) << i;
        }
        (front, back)
    }

    #[inline(always)]
    fn near(self, boxes: &BoxCluster, center: [f32; 3], range2: f32) -> u64 {
        let mut near = 0;
        for i in 0..LANES {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let below = boxes.min[axis][i] - center[axis];
                let above = center[axis] - boxes.max[axis][i];
                below.max(above).max(0.0)
            });
            near |= u64::from(x * x + y * y + z * z <= range2) << i;
        }
        near
    }

    #[inline(always)]
    fn permute(self, mask: u64, partner: &[u8; LANES]) -> u64 {
        let mut result = 0;
        for (i, &lane) in partner.iter().enumerate() {
            result |= (mask >> lane & 1) << i;
        }
        result
    }

    #[inline(always)]
    fn append(self, uses: &[EdgeUse; LANES], mut mask: u64, flip: u32, out: &mut Vec<Quad>) {
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            out.push(Quad(EdgeUse(uses[lane].0 ^ flip)));
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "measured: see the module's head")]
mod avx512 {
    use std::arch::x86_64::{
        _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_ps, _mm512_add_ps, _mm512_cmp_ps_mask,
        _mm512_loadu_ps, _mm512_loadu_si512, _mm512_maskz_compress_epi32, _mm512_max_ps,
        _mm512_movepi8_mask, _mm512_movm_epi8, _mm512_mul_ps, _mm512_permutexvar_epi8,
        _mm512_set1_epi32, _mm512_set1_ps, _mm512_setzero_ps, _mm512_storeu_si512, _mm512_sub_ps,
        _mm512_xor_si512,
    };

    use super::{BoxCluster, EdgeUse, FILTER, LANES, Lanes64, LightPoint, PlaneCluster, Quad};

    /// Proof that the processor has AVX-512 F, BW and VBMI.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx512(());

    impl Avx512 {
        #[inline]
        pub(crate) fn detect() -> Option<Self> {
            (is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vbmi"))
            .then_some(Self(()))
        }

        /// Compiles `f` for this processor.
        #[inline]
        pub(crate) fn run(self, f: impl FnOnce(Self)) {
            // SAFETY: `self` exists only where `detect` found the features.
            unsafe { self.run_here(f) }
        }

        #[target_feature(enable = "avx512f,avx512bw,avx512vbmi,popcnt")]
        fn run_here(self, f: impl FnOnce(Self)) {
            f(self);
        }
    }

    impl Lanes64 for Avx512 {
        #[inline(always)]
        fn sides(self, planes: &PlaneCluster, light: &LightPoint) -> (u64, u64) {
            // SAFETY: the features are there (see `Avx512`), and each load of 16 lanes stays
            // inside an array of 64.
            unsafe {
                let [x, y, z, w] = light.homogeneous.map(|c| _mm512_set1_ps(c));
                let (norm1, filter) = (_mm512_set1_ps(light.norm1), _mm512_set1_ps(FILTER));
                let (mut front, mut back) = (0, 0);
                for chunk in 0..LANES / 16 {
                    let load = |a: &[f32; LANES]| _mm512_loadu_ps(a.as_ptr().add(16 * chunk));
                    // No fused operations: the same roundings as the portable version.
                    let dw = _mm512_mul_ps(load(&planes.d), w);
                    let s = _mm512_mul_ps(load(&planes.nx), x);
                    let s = _mm512_add_ps(s, _mm512_mul_ps(load(&planes.ny), y));
                    let s = _mm512_add_ps(s, _mm512_mul_ps(load(&planes.nz), z));
                    let s = _mm512_sub_ps(s, dw);
                    let bound = _mm512_mul_ps(filter, _mm512_add_ps(norm1, _mm512_abs_ps(dw)));
                    let minus = _mm512_sub_ps(_mm512_setzero_ps(), bound);
                    front |= u64::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(s, bound)) << (16 * chunk);
                    back |= u64::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(s, minus)) << (16 * chunk);
                }
                (front, back)
            }
        }

        #[inline(always)]
        fn near(self, boxes: &BoxCluster, center: [f32; 3], range2: f32) -> u64 {
            // SAFETY: the features are there, and each load of 16 lanes stays inside an array of
            // 64.
            unsafe {
                let center = center.map(|c| _mm512_set1_ps(c));
                let range2 = _mm512_set1_ps(range2);
                let zero = _mm512_setzero_ps();
                let mut near = 0;
                for chunk in 0..LANES / 16 {
                    let load = |a: &[f32; LANES]| _mm512_loadu_ps(a.as_ptr().add(16 * chunk));
                    let [x, y, z] = [0, 1, 2].map(|axis| {
                        let below = _mm512_sub_ps(load(&boxes.min[axis]), center[axis]);
                        let above = _mm512_sub_ps(center[axis], load(&boxes.max[axis]));
                        let side = _mm512_max_ps(_mm512_max_ps(below, above), zero);
                        _mm512_mul_ps(side, side)
                    });
                    let sum = _mm512_add_ps(_mm512_add_ps(x, y), z);
                    let kept = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(sum, range2);
                    near |= u64::from(kept) << (16 * chunk);
                }
                near
            }
        }

        #[inline(always)]
        fn permute(self, mask: u64, partner: &[u8; LANES]) -> u64 {
            // SAFETY: the features are there, and the load covers exactly the 64 bytes.
            unsafe {
                let partner = _mm512_loadu_si512(partner.as_ptr().cast());
                _mm512_movepi8_mask(_mm512_permutexvar_epi8(partner, _mm512_movm_epi8(mask)))
            }
        }

        #[inline(always)]
        fn append(self, uses: &[EdgeUse; LANES], mask: u64, flip: u32, out: &mut Vec<Quad>) {
            // Room for all lanes and for the last store, which writes 16 whatever is kept.
            out.reserve(LANES + 16);
            let mut len = out.len();
            // SAFETY: the features are there; loads stay inside 64 words; after each chunk at
            // most 16 more words are kept, so every store stays inside the reserved room, and
            // everything below `len` has been written. `Quad` is a transparent u32.
            unsafe {
                let flip = _mm512_set1_epi32(flip as i32);
                for chunk in 0..LANES / 16 {
                    let kept = (mask >> (16 * chunk)) as u16;
                    let words = _mm512_loadu_si512(uses.as_ptr().add(16 * chunk).cast());
                    let words = _mm512_maskz_compress_epi32(kept, _mm512_xor_si512(words, flip));
                    _mm512_storeu_si512(out.as_mut_ptr().add(len).cast(), words);
                    len += kept.count_ones() as usize;
                }
                out.set_len(len);
            }
        }
    }
}
