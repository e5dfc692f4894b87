//! Times of a frame's stages, on the CPU and by GPU timestamps.

use std::time::Instant;

use crate::gpu::{Gpu, GpuError};
use crate::readback::read_items;

/// Milliseconds of one frame's stages. GPU stages are zero without timestamps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Volumes brought up to date, on the CPU.
    pub volumes: f64,
    /// The same in the first frame, when nothing was there.
    pub volumes_first: f64,
    /// Frame planned: culling, eye counts.
    pub plan: f64,
    /// Buffers written.
    pub upload: f64,
    /// Commands recorded and submitted.
    pub record: f64,
    /// GPU: depth and surface.
    pub gpu_surface: f64,
    /// GPU: receivers found.
    pub gpu_receivers: f64,
    /// GPU: shadows and lights.
    pub gpu_lights: f64,
    /// From start to the GPU's end.
    pub frame: f64,
    /// The same of the first frame, in which all that is kept is made.
    pub frame_first: f64,
}

impl StageTimes {
    /// The GPU's part.
    pub fn gpu(&self) -> f64 {
        self.gpu_surface + self.gpu_receivers + self.gpu_lights
    }
}

/// Begin and end of spans of an encoder's work, by two timestamps each.
#[derive(Debug)]
pub(crate) struct Timer {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    ns: f32,
}

impl Timer {
    /// For so many spans; none without timestamps.
    pub(crate) fn new(gpu: &Gpu, spans: u32) -> Option<Self> {
        let ns = gpu.timestamp_ns?;
        let count = 2 * spans;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(count) * 8,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Self {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer("timestamps", resolve),
            readable: buffer("timestamps, readable", wgpu::BufferUsages::MAP_READ),
            ns,
        })
    }

    pub(crate) fn writes(&self, first: u32) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    pub(crate) fn compute_writes(&self, first: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// The time at which what was recorded so far is done, into query `index`.
    pub(crate) fn mark(&self, encoder: &mut wgpu::CommandEncoder, index: u32) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("timestamp"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.set,
                beginning_of_pass_write_index: None,
                end_of_pass_write_index: Some(index),
            }),
        });
    }

    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.set, 0..self.set.count(), &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
    }

    /// Milliseconds of each span.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<Vec<f64>, GpuError> {
        let ticks: Vec<u64> = read_items(gpu, &self.readable)?;
        let ms = |t: &[u64]| t[1].saturating_sub(t[0]) as f64 * f64::from(self.ns) / 1e6;
        Ok(ticks.chunks_exact(2).map(ms).collect())
    }
}

pub(crate) fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// The middle of sorted values, or halfway between the two in the middle; null without values.
pub fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    let lower = values[(values.len() - 1) / 2];
    Some(lower + (upper - lower) * 0.5)
}

/// The median of each stage; of what frames take that begin with nothing, none.
pub fn medians(all: &[StageTimes]) -> StageTimes {
    let of = |field: fn(&StageTimes) -> f64| {
        let mut values: Vec<f64> = all.iter().map(field).collect();
        median(&mut values).unwrap_or_default()
    };
    StageTimes {
        volumes: of(|t| t.volumes),
        volumes_first: 0.0,
        plan: of(|t| t.plan),
        upload: of(|t| t.upload),
        record: of(|t| t.record),
        gpu_surface: of(|t| t.gpu_surface),
        gpu_receivers: of(|t| t.gpu_receivers),
        gpu_lights: of(|t| t.gpu_lights),
        frame: of(|t| t.frame),
        frame_first: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_count_is_halfway() {
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(&mut [9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&mut []), None);
        let times = [1.0, 4.0].map(|frame| StageTimes {
            frame,
            ..StageTimes::default()
        });
        assert_eq!(medians(&times).frame, 2.5);
    }
}
