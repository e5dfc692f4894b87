//! CPU time of each light's volume, built from nothing and handed to the GPU.

use std::time::Instant;

use umbrage_core::volume::{BuildTimes, VolumeBuilder, Volumes};

use crate::gpu::GpuError;
use crate::lab::Lab;
use crate::stage::Stage;

/// Size of the buffer that uploads are tried with.
const BUFFER: u64 = 1 << 20;

impl Lab {
    /// What each of the lights numbered `of`, among those last prepared, takes to build, stage by
    /// stage.
    pub fn build_times(&mut self, stage: &Stage, of: &[usize]) -> Vec<BuildTimes> {
        let (builder, lights) = (&mut self.builder, &self.lights);
        let one = |&light: &usize| builder.time_light(&stage.world, &lights[light]);
        of.iter().map(one).collect()
    }

    /// What building all of them takes on one thread, in microseconds.
    pub fn build_all_us(&mut self, stage: &Stage, of: &[usize]) -> Result<f64, GpuError> {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.map_err(|e| GpuError::Threads(e.to_string()))?;
        let lights: Vec<_> = of.iter().map(|&light| self.lights[light]).collect();
        let mut builder = VolumeBuilder::new(self.culls);
        builder.construction = self.builder.construction;
        builder.layers = self.builder.layers;
        let mut settle = || {
            let start = Instant::now();
            let mut volumes = Volumes::default();
            one.install(|| builder.settle(&stage.world, &lights, |_| true, &mut volumes));
            start.elapsed().as_secs_f64() * 1e6
        };
        // The first time finds no scratch memory yet.
        settle();
        Ok(settle())
    }

    /// What handing the quads of each of the lights numbered `of` to the GPU takes on the CPU, in
    /// microseconds.
    pub fn upload_times(&self, of: &[usize]) -> Result<Vec<f64>, GpuError> {
        let gpu = self.gpu();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("upload tried"),
            size: BUFFER,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let upload = |&light: &usize| {
            let bytes: &[u8] = bytemuck::cast_slice(self.volumes.quads_of(light));
            let start = Instant::now();
            for part in bytes.chunks(BUFFER as usize) {
                gpu.queue.write_buffer(&buffer, 0, part);
            }
            start.elapsed().as_secs_f64() * 1e6
        };
        let times = of.iter().map(upload).collect();
        // Frees what was staged.
        gpu.queue.submit([]);
        let done = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        done.map_err(|e| gpu.lost_or(GpuError::Readback(e.to_string())))?;
        Ok(times)
    }
}
