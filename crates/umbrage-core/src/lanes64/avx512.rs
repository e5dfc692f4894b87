//! 64 lanes in AVX-512: masks are registers, kept words are compressed by one instruction, and a
//! byte permute (VBMI) looks up all 64 partners.
#![allow(unsafe_code, reason = "measured: see the head of `lanes64`")]

use std::arch::x86_64::{
    __m512, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_add_ps, _mm512_cmp_ps_mask, _mm512_loadu_ps,
    _mm512_loadu_si512, _mm512_maskz_compress_epi32, _mm512_max_ps, _mm512_movepi8_mask,
    _mm512_movm_epi8, _mm512_mul_ps, _mm512_permutexvar_epi8, _mm512_set1_epi32, _mm512_set1_ps,
    _mm512_setzero_ps, _mm512_storeu_si512, _mm512_sub_ps, _mm512_xor_si512,
};

use super::{InstructionSet, Lanes64};
use crate::volume::Quad;
use crate::world::{BoxCluster, EdgeUse, LANES, NearLight, PlaneCluster};

/// Proof that the processor has AVX-512 F, BW and VBMI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx512 {
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        (InstructionSet::Avx512.is_allowed()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512vbmi"))
        .then_some(Self(()))
    }

    /// Compiles `f` for this processor. What `f` calls must be inlined down to the
    /// intrinsics, closures too: a call in between, such as that of an array's `map`, is
    /// compiled without the features and makes each of them a call.
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

/// Squared distance along an axis from 16 boxes.
///
/// # Safety
/// AVX-512 F; `chunk` below 4.
#[inline(always)]
unsafe fn beside2(boxes: &BoxCluster, axis: usize, chunk: usize, center: f32) -> __m512 {
    // SAFETY: the caller's: each load of 16 lanes stays inside an array of 64.
    unsafe {
        let center = _mm512_set1_ps(center);
        let min = _mm512_loadu_ps(boxes.min[axis].as_ptr().add(16 * chunk));
        let max = _mm512_loadu_ps(boxes.max[axis].as_ptr().add(16 * chunk));
        let (below, above) = (_mm512_sub_ps(min, center), _mm512_sub_ps(center, max));
        let side = _mm512_max_ps(_mm512_max_ps(below, above), _mm512_setzero_ps());
        _mm512_mul_ps(side, side)
    }
}

impl Lanes64 for Avx512 {
    #[inline(always)]
    fn sides(self, planes: &PlaneCluster, light: &NearLight) -> (u64, u64) {
        // SAFETY: the features are there (see `Avx512`), and each load of 16 lanes stays
        // inside an array of 64.
        unsafe {
            let [x, y, z, w] = light.homogeneous;
            let (x, y) = (_mm512_set1_ps(x), _mm512_set1_ps(y));
            let (z, w) = (_mm512_set1_ps(z), _mm512_set1_ps(w));
            let bound = _mm512_set1_ps(light.bound);
            let minus = _mm512_set1_ps(-light.bound);
            let (mut front, mut back) = (0, 0);
            for chunk in 0..LANES / 16 {
                let load = |a: &[f32; LANES]| _mm512_loadu_ps(a.as_ptr().add(16 * chunk));
                // No fused operations: the same roundings as the portable version.
                let dw = _mm512_mul_ps(load(&planes.d), w);
                let s = _mm512_mul_ps(load(&planes.nx), x);
                let s = _mm512_add_ps(s, _mm512_mul_ps(load(&planes.ny), y));
                let s = _mm512_add_ps(s, _mm512_mul_ps(load(&planes.nz), z));
                let s = _mm512_sub_ps(s, dw);
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
            let range2 = _mm512_set1_ps(range2);
            let mut near = 0;
            for chunk in 0..LANES / 16 {
                let x = beside2(boxes, 0, chunk, center[0]);
                let y = beside2(boxes, 1, chunk, center[1]);
                let z = beside2(boxes, 2, chunk, center[2]);
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
