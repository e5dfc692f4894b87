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
        __m512, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_ps, _mm512_add_ps,
        _mm512_cmp_ps_mask, _mm512_loadu_ps, _mm512_loadu_si512, _mm512_maskz_compress_epi32,
        _mm512_max_ps, _mm512_movepi8_mask, _mm512_movm_epi8, _mm512_mul_ps,
        _mm512_permutexvar_epi8, _mm512_set1_epi32, _mm512_set1_ps, _mm512_setzero_ps,
        _mm512_storeu_si512, _mm512_sub_ps, _mm512_xor_si512,
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
        fn sides(self, planes: &PlaneCluster, light: &LightPoint) -> (u64, u64) {
            // SAFETY: the features are there (see `Avx512`), and each load of 16 lanes stays
            // inside an array of 64.
            unsafe {
                let [x, y, z, w] = light.homogeneous;
                let (x, y) = (_mm512_set1_ps(x), _mm512_set1_ps(y));
                let (z, w) = (_mm512_set1_ps(z), _mm512_set1_ps(w));
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
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// Where the processor has AVX-512, both versions give the same bits in the same order.
    #[test]
    fn both_versions_agree() {
        let Some(wide) = Avx512::detect() else { return };
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
            };
            let boxes = BoxCluster {
                min: [lanes(), lanes(), lanes()],
                max: [lanes(), lanes(), lanes()],
            };
            let light = LightPoint {
                homogeneous: [1.5, -0.25, 3.0, 1.0],
                norm1: 4.75,
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
