//! What each light draws, counted exactly: volume fragments and light samples added up in a target,
//! and summed there by a compute shader.

use std::borrow::Cow;

use bytemuck::{Pod, Zeroable};
use umbrage_core::View;
use umbrage_core::frame::FramePlan;
use umbrage_core::frame::bounds::Rect;
use umbrage_wgpu::{CountStep, FaceOptions, ShadowRenderer, VolumeColor, VolumeFaces};
use wgpu::ShaderStages;

use super::encoder;
use crate::binding::{self, bind, buffer, layout};
use crate::gbuffer::{texture, whole};
use crate::gpu::{Gpu, GpuError};
use crate::lab::Lab;
use crate::light_pass::{ADD, LightDraw, LightPass, LitBy};
use crate::readback::{read_items, read_texture, record_copy};
use crate::run::{FROM_DARK, Run, light_pass};
use crate::stage::{Stage, StageLight};

/// What one light draws in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCounts {
    /// Fragments of its volume before the surface.
    pub volume_fragments: u64,
    /// All fragments of its volume, those behind the surface too.
    pub volume_covered: u64,
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
    gpu: Gpu,
    plan: FramePlan,
    run: Run,
    shadowed: LightPass,
    covered: VolumeFaces,
    unshadowed: LightPass,
    target: wgpu::Texture,
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
        &self,
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
        let draw = LightDraw::Count;
        let gpu = self.gpu().clone();
        let mut run = self.run(stage, view, self.method, draw, VolumeColor::Fragments)?;
        run.shadows
            .prepare(&gpu.device, &gpu.queue, &self.frame(view))?;
        let given = run.technique(&gpu, stage, &lights, self.frame(view)).1;
        let [shadowed, unshadowed] = [LitBy::Stencil, LitBy::Everything].map(|lit_by| {
            let mut light = LightPass::new(&gpu, given.shadows, draw, lit_by);
            light.prepare(&given);
            light
        });
        let covered = covering(&gpu, &run.shadows);
        let mut encoder = encoder(&gpu);
        run.record_surface(&gpu, &mut encoder, None);
        gpu.queue.submit([encoder.finish()]);
        let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let (sum, layout) = pipeline(&gpu);
        Ok(Counter {
            target: texture(&gpu, "one light", view.size, draw.format(), usage),
            plan: self.plan.clone(),
            gpu,
            run,
            shadowed,
            covered,
            unshadowed,
            sum,
            layout,
            ranges: lights.iter().map(|l| l.light.range).collect(),
        })
    }
}

/// Adds one to red for each fragment of a volume, wherever it is.
fn covering(gpu: &Gpu, shadows: &ShadowRenderer) -> VolumeFaces {
    let red = wgpu::ColorTargetState {
        format: LightDraw::Count.format(),
        blend: Some(wgpu::BlendState {
            color: ADD,
            alpha: ADD,
        }),
        write_mask: wgpu::ColorWrites::RED,
    };
    let options = FaceOptions {
        step: CountStep::Cover,
        targets: &[Some(red)],
        stencil: wgpu::StencilFaceState::IGNORE,
    };
    shadows.faces(&gpu.device, &options)
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
        let gpu = &self.gpu;
        let scissor = |light: usize| self.plan.lights[light].scissor;
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
        let counted = whole(&self.target);
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
                volume_covered: u64::from(sums[4]),
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

    /// Draws one light into the target: its volume as far as it counts, and the light that leaves; or
    /// all that its volume covers, and the light without shadows.
    fn draw(&self, encoder: &mut wgpu::CommandEncoder, light: usize, shadowed: bool) {
        let (shadows, plan) = (&self.run.shadows, &self.plan);
        let mut pass = light_pass(encoder, &self.run.targets, &self.target, FROM_DARK);
        if shadowed {
            shadows.record_volume(&mut pass, plan, light);
        }
        shadows.record_light(&mut pass, plan, light, |pass, number, plan| {
            if shadowed {
                self.shadowed.draw(pass, shadows, number, None);
            } else {
                shadows.record_faces(pass, &self.covered, number, plan);
                self.unshadowed.draw(pass, shadows, number, None);
            }
        });
    }

    /// Volume fragments of one light at each pixel.
    pub fn overdraw(&self, light: usize) -> Result<Vec<f32>, GpuError> {
        let mut encoder = encoder(&self.gpu);
        self.draw(&mut encoder, light, true);
        self.gpu.queue.submit([encoder.finish()]);
        let first = |t: &[u8]| half::f16::from_le_bytes([t[0], t[1]]).to_f32();
        let bytes = read_texture(&self.gpu, &self.target)?;
        Ok(bytes.chunks_exact(8).map(first).collect())
    }
}
