//! Frames: everything from lights and a view to a lit picture or a mask.

use std::time::Instant;

use glam::Vec3;
use half::f16;
use umbrage::frame::bounds::light_rect;
use umbrage::frame::{FramePlan, LightPath, PathRule, PlanOptions};
use umbrage::volume::{VolumeBuilder, Volumes};
use umbrage::{Light, RendererOptions, ShadowRenderer, View, VolumeColor};
use umbrage_truth::{Mask, NearClip};

use crate::gbuffer::{GBufferPass, Targets, texture, whole};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass};
use crate::picture::Lit;
use crate::readback::{read_buffer, read_texture};
use crate::stage::{Stage, StageLight};

/// How shadows are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Counter volumes, z-pass from the eye count, z-fail where that is ambiguous.
    #[default]
    Counter,
    /// Counter volumes with both caps, z-fail for every light.
    CounterZFail,
    /// No shadows: the floor that every frame time is compared with.
    None,
}

impl Method {
    /// All of them, with their names on the command line.
    pub const ALL: [(&'static str, Method); 3] = [
        ("counter", Method::Counter),
        ("counter-zfail", Method::CounterZFail),
        ("none", Method::None),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(_, m)| *m == self)
            .map_or("", |(name, _)| name)
    }

    /// Whether it promises the oracle's shadows: one wrong pixel-light is a failure.
    pub fn is_exact(self) -> bool {
        self != Method::None
    }
}

/// Milliseconds of one frame's stages. GPU stages are zero without timestamps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Volumes generated, on the CPU.
    pub volumes: f64,
    /// Frame planned: culling, eye counts.
    pub plan: f64,
    /// Buffers written.
    pub upload: f64,
    /// Commands recorded and submitted.
    pub record: f64,
    /// GPU: depth and surface.
    pub gpu_surface: f64,
    /// GPU: volumes and lights.
    pub gpu_lights: f64,
    /// From start to the GPU's end.
    pub frame: f64,
}

/// A device, a stage and what is needed to draw the one on the other.
#[derive(Debug)]
pub struct Lab {
    gpu: Gpu,
    /// Silhouettes and caps of the lights last given.
    pub volumes: Volumes,
    /// How the last frame drew each light.
    pub plan: FramePlan,
    /// Bytes written for the last frame.
    pub uploaded_bytes: u64,
    /// Times of the last frame.
    pub times: StageTimes,
    builder: VolumeBuilder,
    pub(crate) lights: Vec<Light>,
}

/// Everything that depends on target formats or size, for one run.
pub(crate) struct Run {
    pub(crate) targets: Targets,
    pub(crate) shadows: ShadowRenderer,
    pub(crate) surface: GBufferPass,
    pub(crate) light: LightPass,
}

impl Lab {
    /// A lab on `gpu`.
    pub fn new(gpu: Gpu) -> Self {
        Self {
            gpu,
            volumes: Volumes::default(),
            plan: FramePlan::default(),
            uploaded_bytes: 0,
            times: StageTimes::default(),
            builder: VolumeBuilder::default(),
            lights: Vec::new(),
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Builds volumes and plan for a view. [`Lab::mask`] and [`Lab::heat`] draw what stands in
    /// `volumes` and `plan` then; a test may change them in between.
    pub fn prepare(&mut self, stage: &Stage, lights: &[StageLight], view: &View, method: Method) {
        let start = Instant::now();
        self.lights = lights.iter().map(|l| l.light).collect();
        if method == Method::None {
            self.volumes = Volumes::empty(self.lights.len());
        } else {
            let in_view = |light: &Light| !light_rect(view, light).is_empty();
            self.builder
                .build(&stage.world, &self.lights, in_view, &mut self.volumes);
        }
        self.times.volumes = ms_since(start);
        let start = Instant::now();
        let mut options = PlanOptions::default();
        if method == Method::CounterZFail || !self.gpu.depth_clamp {
            options.path = PathRule::ZFailAlways;
        }
        if method == Method::None {
            self.plan.unshadowed(&self.lights, view);
        } else {
            self.plan
                .make(&stage.world, &self.lights, &self.volumes, view, &options);
        }
        self.times.plan = ms_since(start);
    }

    pub(crate) fn run(
        &self,
        stage: &Stage,
        view: &View,
        draw: LightDraw,
        volume_color: VolumeColor,
    ) -> Result<Run, GpuError> {
        let targets = Targets::new(&self.gpu, view.size)?;
        let mut shadows = ShadowRenderer::new(
            &self.gpu.device,
            &RendererOptions {
                color_formats: &[Some(draw.format())],
                depth_stencil_format: crate::gbuffer::DEPTH_STENCIL,
                sample_count: 1,
                depth_clamp: self.gpu.depth_clamp,
                volume_color,
            },
        )?;
        shadows.upload_world(&self.gpu.device, &stage.world)?;
        let surface = GBufferPass::new(&self.gpu, stage, &shadows)?;
        let light = LightPass::new(&self.gpu, &shadows, draw);
        Ok(Run {
            targets,
            shadows,
            surface,
            light,
        })
    }

    /// Renders `repeat` frames (and one to warm up) from scratch, volumes included, and gives the
    /// last picture; `times` are medians.
    pub fn render(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
        repeat: usize,
    ) -> Result<Lit, GpuError> {
        let draw = LightDraw::Shade;
        let mut run = self.run(stage, view, draw, VolumeColor::None)?;
        let hdr_usage = wgpu::TextureUsages::COPY_SRC;
        let hdr = texture(&self.gpu, "light", view.size, draw.format(), hdr_usage);
        let binding = run
            .light
            .bind(&self.gpu, &run.shadows, lights, &run.targets);
        let timer = Timer::new(&self.gpu);
        let mut all = Vec::new();
        for _ in 0..=repeat {
            let start = Instant::now();
            self.prepare(stage, lights, view, method);
            let upload = Instant::now();
            self.uploaded_bytes = run.shadows.prepare(
                &self.gpu.device,
                &self.gpu.queue,
                view,
                &self.lights,
                &self.volumes,
                &self.plan,
            )?;
            self.times.upload = ms_since(upload);
            let record = Instant::now();
            let mut encoder =
                self.gpu
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                        label: Some("frame"),
                    });
            run.surface.record(
                &mut encoder,
                &run.targets,
                timer.as_ref().map(|t| t.writes(0)),
            );
            {
                let writes = timer.as_ref().map(|t| t.writes(2));
                let mut pass = light_pass(&mut encoder, &run.targets, &hdr, writes);
                run.shadows
                    .record(&mut pass, &self.plan, 0..usize::MAX, |pass, number, _| {
                        run.light.draw(pass, &binding, number);
                    });
            }
            if let Some(timer) = &timer {
                timer.resolve(&mut encoder);
            }
            self.gpu.queue.submit([encoder.finish()]);
            self.times.record = ms_since(record);
            self.gpu
                .device
                .poll(wgpu::PollType::wait_indefinitely())
                .map_err(|e| GpuError::Readback(e.to_string()))?;
            self.times.frame = ms_since(start);
            if let Some(timer) = &timer {
                (self.times.gpu_surface, self.times.gpu_lights) = timer.read(&self.gpu)?;
            }
            all.push(self.times);
        }
        self.times = medians(&all[1.min(repeat)..]);
        let light = read_texture(&self.gpu, &hdr)?;
        Ok(Lit {
            size: view.size,
            light: light
                .chunks_exact(8)
                .map(|t| {
                    let channel = |i| f16::from_le_bytes([t[i], t[i + 1]]).to_f32();
                    Vec3::new(channel(0), channel(2), channel(4))
                })
                .collect(),
            albedo: read_texture(&self.gpu, &run.targets.albedo)?
                .chunks_exact(4)
                .map(|t| [t[0], t[1], t[2]])
                .collect(),
            distance: read_texture(&self.gpu, &run.targets.distance)?
                .chunks_exact(4)
                .map(|t| f32::from_le_bytes([t[0], t[1], t[2], t[3]]))
                .collect(),
        })
    }

    /// Renders the shadow mask of what `volumes` and `plan` hold: the same volume draws and the
    /// same stencil test as a lit frame, with light draws that write a bit.
    pub fn mask(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<Mask, GpuError> {
        let mut run = self.run(stage, view, LightDraw::Mark, VolumeColor::None)?;
        let binding = run
            .light
            .bind(&self.gpu, &run.shadows, lights, &run.targets);
        run.shadows.prepare(
            &self.gpu.device,
            &self.gpu.queue,
            view,
            &self.lights,
            &self.volumes,
            &self.plan,
        )?;
        let usage = wgpu::TextureUsages::COPY_SRC;
        let layer = texture(
            &self.gpu,
            "mask",
            view.size,
            LightDraw::Mark.format(),
            usage,
        );
        let mut words = Vec::new();
        for first in (0..lights.len()).step_by(32) {
            let mut encoder =
                self.gpu
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                        label: Some("mask"),
                    });
            if first == 0 {
                run.surface.record(&mut encoder, &run.targets, None);
            }
            {
                let mut pass = light_pass(&mut encoder, &run.targets, &layer, None);
                run.shadows.record(
                    &mut pass,
                    &self.plan,
                    first..first + 32,
                    |pass, number, _| {
                        run.light.draw(pass, &binding, number);
                    },
                );
            }
            self.gpu.queue.submit([encoder.finish()]);
            let bytes = read_texture(&self.gpu, &layer)?;
            words.extend(
                bytes
                    .chunks_exact(4)
                    .map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])),
            );
        }
        Ok(Mask {
            size: view.size,
            lights: lights.len() as u32,
            words,
        })
    }

    /// What happens to surfaces before the near plane on this device.
    pub fn near_clip(&self) -> NearClip {
        if self.gpu.depth_clamp {
            NearClip::Clamped
        } else {
            NearClip::Clipped
        }
    }

    /// Lights drawn by each path: z-pass, z-fail, skipped.
    pub fn lights_by_path(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for light in &self.plan.lights {
            counts[match light.path {
                LightPath::ZPass { .. } => 0,
                LightPath::ZFail(_) => 1,
                LightPath::Skipped(_) => 2,
            }] += 1;
        }
        counts
    }
}

/// The pass in which all lights are drawn: depth is read only, the stencil is zero throughout
/// between lights, and was cleared with the depth.
pub(crate) fn light_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    targets: &Targets,
    color: &wgpu::Texture,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("lights"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &whole(color),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &whole(&targets.depth),
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
        }),
        timestamp_writes: timestamps,
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Begin and end of the two GPU stages.
struct Timer {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    ns: f32,
}

impl Timer {
    const QUERIES: u32 = 4;

    fn new(gpu: &Gpu) -> Option<Self> {
        let ns = gpu.timestamp_ns?;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(Self::QUERIES) * 8,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Self {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("stages"),
                ty: wgpu::QueryType::Timestamp,
                count: Self::QUERIES,
            }),
            resolved: buffer("timestamps", resolve),
            readable: buffer("timestamps, readable", wgpu::BufferUsages::MAP_READ),
            ns,
        })
    }

    fn writes(&self, first: u32) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.set, 0..Self::QUERIES, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
    }

    fn read(&self, gpu: &Gpu) -> Result<(f64, f64), GpuError> {
        let bytes = read_buffer(gpu, &self.readable)?;
        let ticks: Vec<u64> = bytes
            .chunks_exact(8)
            .map(|t| t.iter().rev().fold(0, |sum, &b| sum << 8 | u64::from(b)))
            .collect();
        let ms = |i: usize| ticks[i + 1].saturating_sub(ticks[i]) as f64 * f64::from(self.ns) / 1e6;
        Ok((ms(0), ms(2)))
    }
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn medians(all: &[StageTimes]) -> StageTimes {
    let median = |field: fn(&StageTimes) -> f64| {
        let mut values: Vec<f64> = all.iter().map(field).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    StageTimes {
        volumes: median(|t| t.volumes),
        plan: median(|t| t.plan),
        upload: median(|t| t.upload),
        record: median(|t| t.record),
        gpu_surface: median(|t| t.gpu_surface),
        gpu_lights: median(|t| t.gpu_lights),
        frame: median(|t| t.frame),
    }
}
