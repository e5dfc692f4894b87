//! GPU time of each light, by timestamps at the bounds of its passes.

use super::{Meter, encoder};
use crate::gpu::GpuError;
use crate::readback::read_items;
use crate::run::FROM_DARK;

/// GPU time of one light, in microseconds, without that of an empty pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuCost {
    /// Its volume, counted in the stencil.
    pub volume_us: f64,
    /// Its light draw, and the stencil cleaned.
    pub light_us: f64,
}

impl Default for GpuCost {
    /// Nothing was measured yet: more than anything.
    fn default() -> Self {
        Self {
            volume_us: f64::INFINITY,
            light_us: f64::INFINITY,
        }
    }
}

impl GpuCost {
    /// Volume and light.
    pub fn total_us(&self) -> f64 {
        self.volume_us + self.light_us
    }
}

/// Lights an encoder: their timestamps fit one query set.
const CHUNK: usize = 256;
/// Empty passes before them.
const EMPTY: usize = 8;

impl Meter {
    /// Draws each of the lights numbered `lights` once, one after the other, and keeps in `least`,
    /// their costs in the same order, the least of what was there and what it took: what disturbs a
    /// measurement only adds to it. Says whether the device has timestamps; without, nothing is done.
    pub fn round(&mut self, lights: &[usize], least: &mut [GpuCost]) -> Result<bool, GpuError> {
        let Some(ns) = self.gpu.timestamp_ns else {
            return Ok(false);
        };
        for (lights, least) in lights.chunks(CHUNK).zip(least.chunks_mut(CHUNK)) {
            let us = self.chunk(lights, f64::from(ns) / 1e3)?;
            let empty = us[..EMPTY].iter().copied().fold(f64::INFINITY, f64::min);
            let net = |us: f64| (us - empty).max(0.0);
            for (cost, us) in least.iter_mut().zip(us[EMPTY..].chunks_exact(2)) {
                cost.volume_us = cost.volume_us.min(net(us[0]));
                cost.light_us = cost.light_us.min(net(us[1]));
            }
        }
        Ok(true)
    }

    /// Microseconds of the empty passes, then of volume and light of each light.
    fn chunk(&self, lights: &[usize], tick_us: f64) -> Result<Vec<f64>, GpuError> {
        let device = &self.gpu.device;
        let passes = EMPTY + 2 * lights.len();
        let queries = 2 * passes as u32;
        let set = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("profile"),
            ty: wgpu::QueryType::Timestamp,
            count: queries,
        });
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(queries) * 8,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = buffer("profile timestamps", resolve);
        let readable = buffer("profile timestamps", wgpu::BufferUsages::MAP_READ);
        let mut encoder = encoder(&self.gpu);
        drop(self.pass(&mut encoder, FROM_DARK, None));
        for number in 0..passes {
            let timestamps = wgpu::RenderPassTimestampWrites {
                query_set: &set,
                beginning_of_pass_write_index: Some(2 * number as u32),
                end_of_pass_write_index: Some(2 * number as u32 + 1),
            };
            let mut pass = self.pass(&mut encoder, wgpu::LoadOp::Load, Some(timestamps));
            match number.checked_sub(EMPTY).map(|i| (lights[i / 2], i % 2)) {
                None => {}
                Some((light, 0)) => self.record_volume(&mut pass, light),
                Some((light, _)) => self.record_light(&mut pass, light),
            }
        }
        encoder.resolve_query_set(&set, 0..queries, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &readable, 0, readable.size());
        self.gpu.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = read_items(&self.gpu, &readable)?;
        let took = |t: &[u64]| t[1].saturating_sub(t[0]) as f64 * tick_us;
        Ok(ticks.chunks_exact(2).map(took).collect())
    }
}
