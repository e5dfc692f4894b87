//! What a frame is drawn with, kept from frame to frame: targets, passes, the shadow renderer, the
//! technique.

use glam::Vec3;
use half::f16;
use umbrage_wgpu::{Frame, LightCalls, ShadowRenderer};

use crate::gbuffer::{GBufferPass, Targets, depth_only, whole};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::LightDraw;
use crate::method::Method;
use crate::picture::Lit;
use crate::readback::{read_items, read_texture, record_copy};
use crate::stage::{Stage, StageLight};
use crate::technique::{Given, Technique};
use crate::timer::Timer;

/// Everything that depends on target formats or size.
#[derive(Debug)]
pub struct Run {
    pub(crate) targets: Targets,
    pub(crate) shadows: ShadowRenderer,
    pub(crate) surface: GBufferPass,
    pub(crate) technique: Box<dyn Technique>,
    /// Whose technique it is.
    pub(crate) method: Method,
    /// What its lights leave in the targets.
    pub(crate) draw: LightDraw,
    /// What triangles `surface` knows.
    pub(crate) built: Vec<u64>,
}

impl Run {
    /// Whether triangles came or went since the last call.
    pub(crate) fn rebuilt(&mut self, stage: &Stage) -> bool {
        let built = stage.world.topology();
        std::mem::replace(&mut self.built, built.clone()) != built
    }

    /// Depth and surface, and what of it each light can be seen to light.
    pub(crate) fn record_surface(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        timer: Option<&Timer>,
    ) {
        self.surface.record(
            encoder,
            &self.shadows,
            &self.targets,
            timer.map(|t| t.writes(0)),
        );
        let depth = depth_only(&self.targets.depth);
        let writes = timer.map(|t| t.compute_writes(2));
        self.shadows
            .find_receivers(&gpu.device, encoder, &depth, writes);
    }

    /// The technique, and what it is given.
    pub(crate) fn technique<'a>(
        &'a mut self,
        gpu: &'a Gpu,
        stage: &'a Stage,
        lights: &'a [StageLight],
        frame: Frame<'a>,
    ) -> (&'a mut dyn Technique, Given<'a>) {
        let given = Given {
            gpu,
            stage,
            lights,
            view: frame.view,
            plan: frame.plan,
            frame,
            targets: &self.targets,
            shadows: &self.shadows,
        };
        (&mut *self.technique, given)
    }
}

/// What was drawn of each light, or nothing where receivers were not looked for: the light by the
/// run's renderer, its volume by the technique's own if it has one.
pub(crate) fn read_calls(gpu: &Gpu, run: &Run) -> Result<Vec<LightCalls>, GpuError> {
    let mut calls = calls_of(gpu, &run.shadows)?;
    if let Some((own, _)) = run.technique.own_renderer() {
        for (call, own) in calls.iter_mut().zip(calls_of(gpu, own)?) {
            *call = LightCalls {
                light: call.light,
                ..own
            };
        }
    }
    Ok(calls)
}

fn calls_of(gpu: &Gpu, shadows: &ShadowRenderer) -> Result<Vec<LightCalls>, GpuError> {
    let Some(windows) = shadows.calls() else {
        return Ok(Vec::new());
    };
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("calls"),
        });
    let readable: Vec<wgpu::Buffer> = windows
        .map(|calls| record_copy(gpu, &mut encoder, calls))
        .collect();
    gpu.queue.submit([encoder.finish()]);
    let mut all: Vec<LightCalls> = Vec::new();
    for window in &readable {
        let more: Vec<LightCalls> = read_items(gpu, window)?;
        all.resize(all.len().max(more.len()), LightCalls::default());
        for (sum, window) in all.iter_mut().zip(more) {
            let sides = sum.sides.vertex_count + window.sides.vertex_count;
            let caps = sum.caps.vertex_count + window.caps.vertex_count;
            let reversed = sum.reversed_caps.vertex_count + window.reversed_caps.vertex_count;
            *sum = window;
            sum.sides.vertex_count = sides;
            sum.caps.vertex_count = caps;
            sum.reversed_caps.vertex_count = reversed;
        }
    }
    Ok(all)
}

/// The picture whose light is in `hdr`.
pub(crate) fn read_lit(gpu: &Gpu, run: &Run, hdr: &wgpu::Texture) -> Result<Lit, GpuError> {
    let light = read_texture(gpu, hdr)?;
    Ok(Lit {
        size: run.targets.size,
        light: light
            .chunks_exact(8)
            .map(|t| {
                let channel = |i| f16::from_le_bytes([t[i], t[i + 1]]).to_f32();
                Vec3::new(channel(0), channel(2), channel(4))
            })
            .collect(),
        albedo: read_texture(gpu, &run.targets.albedo)?
            .chunks_exact(4)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
        distance: read_texture(gpu, &run.targets.distance)?
            .chunks_exact(4)
            .map(|t| f32::from_le_bytes([t[0], t[1], t[2], t[3]]))
            .collect(),
    })
}

/// A target that no light was added to yet.
pub(crate) const FROM_DARK: wgpu::LoadOp<wgpu::Color> =
    wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);

/// A pass in which lights are drawn: depth is read only, the stencil is zero throughout between
/// lights, and was cleared with the depth.
pub(crate) fn light_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    targets: &Targets,
    color: &wgpu::Texture,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPass<'e> {
    stencil_pass(encoder, targets, color, load, wgpu::LoadOp::Load)
}

/// The same with a stencil that begins as `stencil` says.
pub(crate) fn stencil_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    targets: &Targets,
    color: &wgpu::Texture,
    load: wgpu::LoadOp<wgpu::Color>,
    stencil: wgpu::LoadOp<u32>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("lights"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &whole(color),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load,
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &whole(&targets.depth),
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations {
                load: stencil,
                store: wgpu::StoreOp::Store,
            }),
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}
