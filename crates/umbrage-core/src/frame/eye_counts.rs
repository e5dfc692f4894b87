//! Eye counts that are kept from plan to plan.
//!
//! Takes volumes and how to count; counts again where eye or volume changed. A volume in parts has a
//! count for each, and is ambiguous if one of them is.

use glam::DVec3;

use super::eye_count::EyeCount;
use crate::volume::{LightVolume, Part};

/// Eye counts of the last plan, by the stamp of each light's volume.
#[derive(Clone, Debug, Default)]
pub(super) struct EyeCounts {
    eye: Option<DVec3>,
    lights: Vec<Known>,
}

/// The eye counts of one volume.
#[derive(Clone, Debug)]
struct Known {
    stamp: u64,
    count: EyeCount,
    /// Of each part, if the volume has any.
    parts: Vec<u32>,
}

impl EyeCounts {
    /// Forgets what is not of this eye.
    pub(super) fn look_from(&mut self, eye: DVec3, lights: usize) {
        if self.eye != Some(eye) {
            self.lights.clear();
            self.eye = Some(eye);
        }
        self.lights.resize_with(lights, || Known {
            stamp: 0,
            count: EyeCount::Ambiguous,
            parts: Vec::new(),
        });
    }

    /// Counts once for each eye and volume: a light's parts one by one, so that each knows where
    /// it starts.
    pub(super) fn of(
        &mut self,
        light: usize,
        volume: &LightVolume,
        count: impl Fn(&Part) -> EyeCount,
    ) -> EyeCount {
        let known = &mut self.lights[light];
        if known.stamp == volume.stamp && volume.stamp != 0 {
            return known.count;
        }
        known.stamp = volume.stamp;
        known.parts.clear();
        if volume.parts.is_empty() {
            known.count = count(&Part {
                quads: volume.quads.clone(),
                chain: volume.chain.clone(),
            });
            return known.count;
        }
        known.count = EyeCount::Exact(0);
        for part in &volume.parts {
            match (count(part), known.count) {
                (EyeCount::Exact(casters), EyeCount::Exact(before)) => {
                    known.parts.push(casters);
                    known.count = EyeCount::Exact(before + casters);
                }
                _ => known.count = EyeCount::Ambiguous,
            }
        }
        known.count
    }

    /// Of a light's parts, as last counted.
    pub(super) fn of_parts(&self, light: usize) -> &[u32] {
        &self.lights[light].parts
    }
}
