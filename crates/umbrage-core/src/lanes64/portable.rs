//! 64 lanes in plain Rust, written so that compilers find what vectors there are: comparisons give
//! bytes, and eight bytes become eight bits by one multiplication.

use super::Lanes64;
use crate::volume::Quad;
use crate::world::{BoxCluster, EdgeUse, LANES, NearLight, PlaneCluster};

/// Any processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

/// Bit i is byte i, of which each is 0 or 1.
#[inline(always)]
fn bits(bytes: &[u8; LANES]) -> u64 {
    let (eights, _) = bytes.as_chunks::<8>();
    let mut result = 0;
    for (i, eight) in eights.iter().enumerate() {
        // Byte k at bit 8k, moved by 56 - 7k, is bit k of the top byte.
        let top = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        result |= top << (8 * i);
    }
    result
}

impl Lanes64 for Portable {
    #[inline(always)]
    fn sides(self, planes: &PlaneCluster, light: &NearLight) -> (u64, u64) {
        let [x, y, z, w] = light.homogeneous;
        let (mut front, mut back) = ([0; LANES], [0; LANES]);
        for i in 0..LANES {
            let dw = planes.d[i] * w;
            let s = planes.nx[i] * x + planes.ny[i] * y + planes.nz[i] * z - dw;
            front[i] = u8::from(s > light.bound);
            back[i] = u8::from(s < -light.bound);
        }
        (bits(&front), bits(&back))
    }

    #[inline(always)]
    fn near(self, boxes: &BoxCluster, center: [f32; 3], range2: f32) -> u64 {
        let mut sums = [0.0; LANES];
        for ((min, max), center) in boxes.min.iter().zip(&boxes.max).zip(center) {
            for ((sum, min), max) in sums.iter_mut().zip(min).zip(max) {
                let side = (min - center).max(center - max).max(0.0);
                *sum += side * side;
            }
        }
        let mut near = [0; LANES];
        for i in 0..LANES {
            near[i] = u8::from(sums[i] <= range2);
        }
        bits(&near)
    }

    #[inline(always)]
    fn permute(self, mask: u64, partner: &[u8; LANES]) -> u64 {
        if mask == 0 || mask == u64::MAX {
            return mask;
        }
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
