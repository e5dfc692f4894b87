//! Lights that are drawn in parts: where the count of each begins and ends.
//!
//! Takes a light's parts and the eye count of each; gives [`PartPlan`]s. Seven bits of the stencil count
//! a part, the eighth remembers shadows. Counting is relative: a part begins with what the one
//! before it left where there is no shadow, its *reference*, and ends with that less its own eye
//! count, modulo 128. So one draw after each part but the last does for all: where the seven bits
//! are not at the reference, it sets them to it, and the eighth bit. After the last part the light's
//! own test, which sees all eight bits, needs no such draw.

use std::ops::Range;

use crate::volume::{Chain, ChainTriangle, Part, Volumes};

/// One part of a light whose layers are too many for the stencil in one go.
///
/// Seven bits count the part, beginning where the one before it ended: at its reference. Where they
/// then are not at the part's own reference, the eighth is set, and they are set to the reference:
/// that point is in shadow, whatever the other parts say.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartPlan {
    /// The number it is drawn under: the light's own for the first part, for others one after those
    /// of all lights.
    pub number: u32,
    /// Its silhouette quads, in [`Volumes::quads`].
    pub quads: Range<u32>,
    /// As those of the light.
    pub caps: Range<u32>,
    /// As those of the light.
    pub reversed_caps: Range<u32>,
    /// Lower seven bits of the stencil where neither this part nor one before it has a shadow.
    pub reference: u8,
}

/// The parts of light number `light`, without caps. `starts`: their eye counts on the z-pass path,
/// empty on others. `extra`: the number of the next part that is not the first of its light.
pub(super) fn parts(
    light: usize,
    parts: &[Part],
    starts: &[u32],
    extra: &mut u32,
) -> Vec<PartPlan> {
    let mut reference = 0u8;
    let mut plans = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let eye_count = starts.get(i).copied().unwrap_or(0);
        reference = reference.wrapping_sub(eye_count as u8) & 0x7f;
        let number = match i {
            0 => light as u32,
            _ => *extra,
        };
        *extra += u32::from(i != 0);
        plans.push(PartPlan {
            number,
            quads: part.quads.clone(),
            caps: 0..0,
            reversed_caps: 0..0,
            reference,
        });
    }
    plans
}

/// Adds the caps of a light, or of its parts in turn; gives where those lie that are taken as wound,
/// and those taken reversed.
pub(super) fn push_caps(
    light: usize,
    volumes: &Volumes,
    parts: &mut [PartPlan],
    caps: &mut Vec<ChainTriangle>,
) -> [Range<u32>; 2] {
    [1, -1].map(|coefficient| {
        let mut push = |chain: &[Chain]| {
            let first = caps.len() as u32;
            let triangles = chain.iter().flat_map(Chain::triangles);
            caps.extend(triangles.filter(|t| t.coefficient() == coefficient));
            first..caps.len() as u32
        };
        if parts.is_empty() {
            return push(volumes.chain_of(light));
        }
        let first = push(&[]).start;
        for (plan, part) in parts.iter_mut().zip(&volumes.lights[light].parts) {
            let range = push(volumes.chain_of_part(part));
            match coefficient {
                1 => plan.caps = range,
                _ => plan.reversed_caps = range,
            }
        }
        first..push(&[]).end
    })
}
