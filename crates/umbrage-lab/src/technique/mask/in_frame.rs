//! `mask-alpha` and `mask-max`: masks in the alpha channel of the target that light adds up in, all
//! lights in one pass.
//!
//! A light's mask starts over the last one's, is counted and normalised in alpha, and the light is
//! drawn with blend factors (destination alpha, one). The target is a half float. Masks for the
//! judge are drawn by the same steps; their bits add up beside alpha in a target of their own, from
//! which they are copied.

use std::ops::Range;

use umbrage_wgpu::ShadowRenderer;

use super::lighting::Lighting;
use super::pack::Placed;
use super::painter::Painter;
use super::plan::{MaskPlan, Place};
use super::slots::Slot;
use crate::application::Application;
use crate::gbuffer::{texture, whole};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LitBy, MASK, WIDE_MASK};
use crate::method::{Counting, MaskBuffer};
use crate::run::{FROM_DARK, light_pass};
use crate::technique::{Given, Technique};

/// The alpha channel.
const ALPHA: u32 = 3;

/// Counts in alpha, lights by it.
#[derive(Debug)]
pub(crate) struct InFrame {
    plan: MaskPlan,
    painter: Painter,
    lighting: Lighting,
    slots: Option<wgpu::BindGroup>,
    /// From wide mask bits to mask bits, where such are drawn.
    narrow: Option<wgpu::RenderPipeline>,
}

impl InFrame {
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        buffer: MaskBuffer,
        application: Application,
    ) -> Self {
        let plan = MaskPlan {
            of: Counting::Mask(buffer),
            place: Place::Frame,
            application,
        };
        Self {
            plan,
            painter: Painter::new(gpu, shadows, plan, WIDE_MASK),
            lighting: Lighting::new(gpu, shadows, plan, draw, LitBy::Alpha),
            slots: None,
            narrow: (draw == LightDraw::Mark).then(|| narrow(gpu)),
        }
    }
}

impl Technique for InFrame {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lighting.prepare(given);
        let drawn = given.plan.drawn().map(|(number, _)| Placed {
            number,
            batch: 0,
            layer: 0,
            channel: ALPHA,
        });
        let slots = Slot::all(given.plan, self.plan, drawn);
        let slots = Slot::upload(given.gpu, &slots);
        self.slots = Some(self.painter.bind(given.gpu, &slots));
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        let Some(slots) = &self.slots else {
            return Ok(());
        };
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let bits = self
            .narrow
            .as_ref()
            .map(|_| texture(given.gpu, "mask bits", given.view.size, WIDE_MASK, usage));
        let drawn_to = bits.as_ref().unwrap_or(target);
        let mut pass = light_pass(encoder, given.targets, drawn_to, FROM_DARK);
        let drawn = given.plan.drawn().filter(|(i, _)| lights.contains(i));
        for (number, light) in drawn.filter(|(_, light)| !light.scissor.is_empty()) {
            let s = light.scissor;
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            let shadows = given.shadows;
            self.painter
                .paint(&mut pass, shadows, slots, number, light, ALPHA);
            self.lighting.draw(&mut pass, shadows, number, None);
        }
        drop(pass);
        if let (Some(narrow), Some(bits)) = (&self.narrow, &bits) {
            record_narrow(given.gpu, encoder, narrow, bits, target);
        }
        Ok(())
    }
}

const NARROW_WGSL: &str = "
@group(0) @binding(0) var wide: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let bits = vec3u(textureLoad(wide, vec2i(position.xy), 0).rgb);
    return unpack4x8unorm(bits.x | (bits.y << 11u) | (bits.z << 22u));
}
";

/// From eleven bits a channel to eight.
fn narrow(gpu: &Gpu) -> wgpu::RenderPipeline {
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("mask bits"),
            source: wgpu::ShaderSource::Wgsl(NARROW_WGSL.into()),
        });
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("mask bits"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(MASK.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
}

fn record_narrow(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
    bits: &wgpu::Texture,
    target: &wgpu::Texture,
) {
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("mask bits"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&whole(bits)),
        }],
    });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("mask bits"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &whole(target),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: FROM_DARK,
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.draw(0..3, 0..1);
}
