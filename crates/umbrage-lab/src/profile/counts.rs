//! What each light draws, counted exactly: volume fragments and light samples added up in a target,
//! and summed there by a compute shader.

use std::borrow::Cow;

use bytemuck::{Pod, Zeroable};
use umbrage_core::View;
use umbrage_core::frame::bounds::Rect;
use umbrage_wgpu::VolumeColor;
use wgpu::ShaderStages;

use super::{Meter, encoder};
use crate::binding::{self, bind, buffer, layout};
use crate::gbuffer::whole;
use crate::gpu::{Gpu, GpuError};
use crate::lab::Lab;
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::readback::{read_items, read_texture, record_copy};
use crate::run::FROM_DARK;
use crate::stage::{Stage, StageLight};

/// What one light draws in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCounts {
    /// Fragments of its volume before the surface.
    pub volume_fragments: u64,
    /// Samples that its light draw covers, lit or not.
    pub light_fragments: u64,
    /// Of these, samples shaded: those that the stencil leaves.
    pub shaded_samples: u64,
    /// Of these, pixels in which its light shows: brighter by at least one step of 8-bit sRGB in
    /// black, at the picture's exposure.
    pub lit_pixels: u64,
    /// The same had it no shadows.
    pub lit_unshadowed: u64,
    /// The shortest range in metres with which no pixel gets darker by more than a step and 0.8%; 0
    /// where it does not show, and for lights without a range.
    pub range_needed_m: f64,
}

/// Counts of lights, drawn one by one.
#[derive(Debug)]
pub struct Counter {
    meter: Meter,
    unshadowed: LightPass,
    sum: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    ranges: Vec<f32>,
}

/// `struct Task` of the shader.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Task {
    x: u32,
    y: u32,
    width: u32,
    first: u32,
}

/// Sums a light.
const SUMS: usize = 8;
/// Tasks are bound at multiples of this.
const STRIDE: usize = 256;
/// Linear light to which 8-bit sRGB goes in one step from black.
const STEP: f32 = 1.0 / (255.0 * 12.92);

const SHADER: &str = "
struct Task { x: u32, y: u32, width: u32, first: u32 }
@group(0) @binding(0) var counts: texture_2d<f32>;
@group(0) @binding(1) var<uniform> task: Task;
@group(0) @binding(2) var<storage, read_write> sums: array<atomic<u32>>;

@compute @workgroup_size(64)
fn sum(@builtin(workgroup_id) row: vec3u, @builtin(local_invocation_index) lane: u32) {
    var total = vec3u(0u);
    var needed = 0.0;
    for (var x = lane; x < task.width; x += 64u) {
        let count = textureLoad(counts, vec2u(task.x + x, task.y + row.x), 0);
        total += vec3u(count.xyz);
        needed = max(needed, count.w);
    }
    if any(total != vec3u(0u)) {
        atomicAdd(&sums[task.first], total.x);
        atomicAdd(&sums[task.first + 1u], total.y);
        atomicAdd(&sums[task.first + 2u], total.z);
        atomicMax(&sums[task.first + 3u], bitcast<u32>(needed));
    }
}
";

impl Lab {
    /// A counter of what `volumes` and `plan` hold; light shows where it does at this exposure.
    pub fn counter(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        exposure: f32,
    ) -> Result<Counter, GpuError> {
        let scaled = |light: &StageLight| StageLight {
            power: light.power * (exposure / STEP),
            ..light.clone()
        };
        let lights: Vec<StageLight> = lights.iter().map(scaled).collect();
        let (draw, color) = (LightDraw::Count, VolumeColor::Fragments);
        let mut meter = self.new_meter(stage, &lights, view, draw, color)?;
        let gpu = &meter.gpu;
        let mut unshadowed = LightPass::new(gpu, &meter.run.shadows, draw, LitBy::Everything);
        let given = meter.run.technique(gpu, stage, &lights, self.frame(view));
        unshadowed.prepare(&given.1);
        let (sum, layout) = pipeline(gpu);
        Ok(Counter {
            unshadowed,
            sum,
            layout,
            ranges: lights.iter().map(|l| l.light.range).collect(),
            meter,
        })
    }
}

fn pipeline(gpu: &Gpu) -> (wgpu::ComputePipeline, wgpu::BindGroupLayout) {
    let float = wgpu::TextureSampleType::Float { filterable: false };
    let types = [
        binding::texture(float, wgpu::TextureViewDimension::D2),
        buffer(wgpu::BufferBindingType::Uniform),
        buffer(wgpu::BufferBindingType::Storage { read_only: false }),
    ];
    let layout = layout(gpu, "sums", ShaderStages::COMPUTE, types);
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("sums"),
            source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(SHADER)),
        });
    let pipeline_layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("sums"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
    let pipeline = gpu
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("sums"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("sum"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
    (pipeline, layout)
}

impl Counter {
    /// What each of the lights numbered `lights` draws.
    pub fn count(&self, lights: &[usize]) -> Result<Vec<LightCounts>, GpuError> {
        let mut counts = Vec::with_capacity(lights.len());
        for lights in lights.chunks(128) {
            counts.extend(self.chunk(lights)?);
        }
        Ok(counts)
    }

    fn chunk(&self, lights: &[usize]) -> Result<Vec<LightCounts>, GpuError> {
        let gpu = &self.meter.gpu;
        let scissor = |light: usize| self.meter.plan.lights[light].scissor;
        let mut tasks = vec![0u8; (2 * lights.len() * STRIDE).max(STRIDE)];
        for (place, task) in tasks.chunks_exact_mut(STRIDE).enumerate() {
            let Some(&light) = lights.get(place / 2) else {
                break;
            };
            let Rect { x, y, width, .. } = scissor(light);
            let first = (place * SUMS / 2) as u32;
            let of = Task { x, y, width, first };
            task[..size_of::<Task>()].copy_from_slice(bytemuck::bytes_of(&of));
        }
        let tasks = gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("sum tasks"),
            contents: &tasks,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let sums = gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("sums"),
            contents: &vec![0; (lights.len() * SUMS * 4).max(4)],
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        });
        let counted = whole(&self.meter.target);
        let mut encoder = encoder(gpu);
        for (i, &light) in lights.iter().enumerate() {
            if scissor(light).is_empty() {
                continue;
            }
            for shadowed in [true, false] {
                self.draw(&mut encoder, light, shadowed);
                let task = wgpu::BufferBinding {
                    buffer: &tasks,
                    offset: ((2 * i + usize::from(!shadowed)) * STRIDE) as u64,
                    size: wgpu::BufferSize::new(size_of::<Task>() as u64),
                };
                let resources = [
                    wgpu::BindingResource::TextureView(&counted),
                    wgpu::BindingResource::Buffer(task),
                    sums.as_entire_binding(),
                ];
                let bound = bind(gpu, "sums", &self.layout, resources);
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("sums"),
                    timestamp_writes: None,
                });
                pass.set_pipeline(&self.sum);
                pass.set_bind_group(0, &bound, &[]);
                pass.dispatch_workgroups(scissor(light).height, 1, 1);
            }
        }
        let readable = record_copy(gpu, &mut encoder, &sums);
        gpu.queue.submit([encoder.finish()]);
        let sums: Vec<u32> = read_items(gpu, &readable)?;
        let counts = lights.iter().zip(sums.chunks_exact(SUMS));
        Ok(counts
            .map(|(&light, sums)| LightCounts {
                volume_fragments: u64::from(sums[0]),
                shaded_samples: u64::from(sums[1]),
                lit_pixels: u64::from(sums[2]),
                range_needed_m: match self.ranges[light] {
                    range if range.is_finite() => {
                        f64::from(f32::from_bits(sums[3])) * f64::from(range)
                    }
                    _ => 0.0,
                },
                light_fragments: u64::from(sums[5]),
                lit_unshadowed: u64::from(sums[6]),
            })
            .collect())
    }

    /// Draws one light into the target; its volume only with its shadows.
    fn draw(&self, encoder: &mut wgpu::CommandEncoder, light: usize, shadowed: bool) {
        let Meter { run, plan, .. } = &self.meter;
        let mut pass = self.meter.pass(encoder, FROM_DARK, None);
        if shadowed {
            self.meter.record_volume(&mut pass, light);
            self.meter.record_light(&mut pass, light);
        } else {
            run.shadows
                .record_light(&mut pass, plan, light, |pass, number, _| {
                    self.unshadowed.draw(pass, &run.shadows, number, None);
                });
        }
    }

    /// Volume fragments of one light at each pixel.
    pub fn overdraw(&self, light: usize) -> Result<Vec<f32>, GpuError> {
        let mut encoder = encoder(&self.meter.gpu);
        self.draw(&mut encoder, light, true);
        self.meter.gpu.queue.submit([encoder.finish()]);
        let first = |t: &[u8]| half::f16::from_le_bytes([t[0], t[1]]).to_f32();
        let bytes = read_texture(&self.meter.gpu, &self.meter.target)?;
        Ok(bytes.chunks_exact(8).map(first).collect())
    }
}
