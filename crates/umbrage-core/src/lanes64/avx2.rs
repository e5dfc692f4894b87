//! 64 lanes in AVX2: partners are looked up by a shuffle of the mask's eight bytes, kept words are
//! moved together by a table of permutations.
#![allow(unsafe_code, reason = "measured: see the head of `lanes64`")]

use std::arch::x86_64::{
    __m256, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_loadl_epi64, _mm256_add_ps, _mm256_and_si256,
    _mm256_cmp_ps, _mm256_cmpeq_epi8, _mm256_cvtepu8_epi32, _mm256_loadu_ps, _mm256_loadu_si256,
    _mm256_max_ps, _mm256_movemask_epi8, _mm256_movemask_ps, _mm256_mul_ps,
    _mm256_permutevar8x32_epi32, _mm256_set1_epi8, _mm256_set1_epi32, _mm256_set1_epi64x,
    _mm256_set1_ps, _mm256_setzero_ps, _mm256_shuffle_epi8, _mm256_srli_epi16, _mm256_storeu_si256,
    _mm256_sub_ps, _mm256_xor_si256,
};

use super::{InstructionSet, Lanes64};
use crate::volume::Quad;
use crate::world::{BoxCluster, EdgeUse, LANES, NearLight, PlaneCluster};

/// Proof that the processor has AVX2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

/// For each mask of eight words, which ones to move to the front.
const KEEP: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut kept, mut word) = (0, 0);
        while word < 8 {
            if mask >> word & 1 == 1 {
                table[mask][kept] = word as u8;
                kept += 1;
            }
            word += 1;
        }
        mask += 1;
    }
    table
};

impl Avx2 {
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        (InstructionSet::Avx2.is_allowed()
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("popcnt"))
        .then_some(Self(()))
    }

    /// As [`Avx512::run`](super::Avx512::run).
    #[inline]
    pub(crate) fn run(self, f: impl FnOnce(Self)) {
        // SAFETY: `self` exists only where `detect` found the features.
        unsafe { self.run_here(f) }
    }

    #[target_feature(enable = "avx2,popcnt")]
    fn run_here(self, f: impl FnOnce(Self)) {
        f(self);
    }
}

/// Lanes `8 * chunk` and the seven after it.
///
/// # Safety
/// AVX2; `chunk` below 8.
#[inline(always)]
unsafe fn load(lanes: &[f32; LANES], chunk: usize) -> __m256 {
    // SAFETY: the caller's: the load stays inside the array.
    unsafe { _mm256_loadu_ps(lanes.as_ptr().add(8 * chunk)) }
}

/// Squared distance along an axis from 8 boxes.
///
/// # Safety
/// AVX2; `chunk` below 8.
#[inline(always)]
unsafe fn beside2(boxes: &BoxCluster, axis: usize, chunk: usize, center: f32) -> __m256 {
    // SAFETY: the caller's.
    unsafe {
        let center = _mm256_set1_ps(center);
        let below = _mm256_sub_ps(load(&boxes.min[axis], chunk), center);
        let above = _mm256_sub_ps(center, load(&boxes.max[axis], chunk));
        let side = _mm256_max_ps(_mm256_max_ps(below, above), _mm256_setzero_ps());
        _mm256_mul_ps(side, side)
    }
}

impl Lanes64 for Avx2 {
    #[inline(always)]
    fn sides(self, planes: &PlaneCluster, light: &NearLight) -> (u64, u64) {
        // SAFETY: the features are there (see `Avx2`), and chunks stay below 8.
        unsafe {
            let [x, y, z, w] = light.homogeneous;
            let (x, y) = (_mm256_set1_ps(x), _mm256_set1_ps(y));
            let (z, w) = (_mm256_set1_ps(z), _mm256_set1_ps(w));
            let bound = _mm256_set1_ps(light.bound);
            let minus = _mm256_set1_ps(-light.bound);
            let (mut front, mut back) = (0, 0);
            for chunk in 0..LANES / 8 {
                // No fused operations: the same roundings as the portable version.
                let dw = _mm256_mul_ps(load(&planes.d, chunk), w);
                let s = _mm256_mul_ps(load(&planes.nx, chunk), x);
                let s = _mm256_add_ps(s, _mm256_mul_ps(load(&planes.ny, chunk), y));
                let s = _mm256_add_ps(s, _mm256_mul_ps(load(&planes.nz, chunk), z));
                let s = _mm256_sub_ps(s, dw);
                let is_front = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(s, bound));
                let is_back = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(s, minus));
                front |= u64::from(is_front as u8) << (8 * chunk);
                back |= u64::from(is_back as u8) << (8 * chunk);
            }
            (front, back)
        }
    }

    #[inline(always)]
    fn near(self, boxes: &BoxCluster, center: [f32; 3], range2: f32) -> u64 {
        // SAFETY: the features are there, and chunks stay below 8.
        unsafe {
            let range2 = _mm256_set1_ps(range2);
            let mut near = 0;
            for chunk in 0..LANES / 8 {
                let x = beside2(boxes, 0, chunk, center[0]);
                let y = beside2(boxes, 1, chunk, center[1]);
                let z = beside2(boxes, 2, chunk, center[2]);
                let sum = _mm256_add_ps(_mm256_add_ps(x, y), z);
                let kept = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(sum, range2));
                near |= u64::from(kept as u8) << (8 * chunk);
            }
            near
        }
    }

    #[inline(always)]
    fn permute(self, mask: u64, partner: &[u8; LANES]) -> u64 {
        // SAFETY: the features are there, and the two loads cover exactly the 64 bytes.
        unsafe {
            let bytes = _mm256_set1_epi64x(mask as i64);
            let bits = _mm256_set1_epi64x(0x8040_2010_0804_0201_u64 as i64);
            let seven = _mm256_set1_epi8(7);
            let mut result = 0;
            for half in 0..2 {
                let partner = _mm256_loadu_si256(partner.as_ptr().add(32 * half).cast());
                let byte_of = _mm256_and_si256(_mm256_srli_epi16::<3>(partner), seven);
                let byte = _mm256_shuffle_epi8(bytes, byte_of);
                let bit = _mm256_shuffle_epi8(bits, _mm256_and_si256(partner, seven));
                let set = _mm256_cmpeq_epi8(_mm256_and_si256(byte, bit), bit);
                result |= u64::from(_mm256_movemask_epi8(set) as u32) << (32 * half);
            }
            result
        }
    }

    #[inline(always)]
    fn append(self, uses: &[EdgeUse; LANES], mask: u64, flip: u32, out: &mut Vec<Quad>) {
        // Room for all lanes and for the last store, which writes 8 whatever is kept.
        out.reserve(LANES + 8);
        let mut len = out.len();
        // SAFETY: the features are there; loads stay inside 64 words and inside the table; after
        // each chunk at most 8 more words are kept, so every store stays inside the reserved room,
        // and everything below `len` has been written. `Quad` is a transparent u32.
        unsafe {
            let flip = _mm256_set1_epi32(flip as i32);
            for chunk in 0..LANES / 8 {
                let kept = (mask >> (8 * chunk)) as u8;
                let words = _mm256_loadu_si256(uses.as_ptr().add(8 * chunk).cast());
                let order = _mm_loadl_epi64(KEEP[usize::from(kept)].as_ptr().cast());
                let order = _mm256_cvtepu8_epi32(order);
                let words = _mm256_xor_si256(words, flip);
                let words = _mm256_permutevar8x32_epi32(words, order);
                _mm256_storeu_si256(out.as_mut_ptr().add(len).cast(), words);
                len += kept.count_ones() as usize;
            }
            out.set_len(len);
        }
    }
}
