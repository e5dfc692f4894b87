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
    /// stage: the least of `rounds`.
    pub fn build_times(&mut self, stage: &Stage, of: &[usize], rounds: usize) -> Vec<BuildTimes> {
        let (builder, lights) = (&mut self.builder, &self.lights);
        let least = |&light: &usize| {
            let mut once = || builder.time_light(&stage.world, &lights[light]);
            let first = once();
            (1..rounds).fold(first, |least, _| least.least(&once()))
        };
        of.iter().map(least).collect()
    }

    /// What building all of them takes on one thread, in microseconds: the least of `rounds`.
    pub fn build_all_us(
        &mut self,
        stage: &Stage,
        of: &[usize],
        rounds: usize,
    ) -> Result<f64, GpuError> {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.map_err(|e| GpuError::Threads(e.to_string()))?;
        let lights: Vec<_> = of.iter().map(|&light| self.lights[light]).collect();
        let mut builder = VolumeBuilder::new(self.culls);
        builder.construction = self.builder.construction;
        builder.layers = self.builder.layers;
        let mut least = f64::INFINITY;
        for _ in 0..rounds {
            let start = Instant::now();
            let mut volumes = Volumes::default();
            one.install(|| builder.settle(&stage.world, &lights, |_| true, &mut volumes));
            least = least.min(start.elapsed().as_secs_f64() * 1e6);
        }
        Ok(least)
    }

    /// What handing the quads of each of the lights numbered `of` to the GPU takes on the CPU, in
    /// microseconds: the least of `rounds`.
    pub fn upload_times(&self, of: &[usize], rounds: usize) -> Result<Vec<f64>, GpuError> {
        let gpu = self.gpu();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("upload tried"),
            size: BUFFER,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut least = vec![f64::INFINITY; of.len()];
        for _ in 0..rounds {
            for (least, &light) in least.iter_mut().zip(of) {
                let bytes: &[u8] = bytemuck::cast_slice(self.volumes.quads_of(light));
                let start = Instant::now();
                for part in bytes.chunks(BUFFER as usize) {
                    gpu.queue.write_buffer(&buffer, 0, part);
                }
                *least = least.min(start.elapsed().as_secs_f64() * 1e6);
            }
            // Frees what was staged.
            gpu.queue.submit([]);
            let done = gpu.device.poll(wgpu::PollType::wait_indefinitely());
            done.map_err(|e| gpu.lost_or(GpuError::Readback(e.to_string())))?;
        }
        Ok(least)
    }
}
