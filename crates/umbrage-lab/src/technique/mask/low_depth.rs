//! The depth that volumes count against at a lower resolution: the world once more, without a
//! surface to shade.
//!
//! Vertices are those of `primary.wgsl`, by the rules of the surface's own: the same clip positions,
//! the same triangles left out.

use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer};
use wgpu::Texture;

use crate::gbuffer::{DEPTH_STENCIL, whole};
use crate::gpu::Gpu;

/// Draws depth and nothing else.
#[derive(Debug)]
pub(super) struct LowDepth {
    pipeline: wgpu::RenderPipeline,
}

impl LowDepth {
    /// For worlds as `shadows` has them.
    pub(super) fn new(gpu: &Gpu, shadows: &ShadowRenderer) -> Self {
        let source = format!(
            "{CLIP_WGSL}\n{}\n{}",
            shadows.world_wgsl(0),
            include_str!("../../shaders/primary.wgsl")
        );
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("low depth"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("low depth"),
            bind_group_layouts: &[Some(shadows.world_bind_group_layout())],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("low depth"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                unclipped_depth: gpu.depth_clamp,
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_STENCIL,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// Clears depth and stencil, and draws so many triangles.
    pub(super) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadows: &ShadowRenderer,
        triangles: u32,
        depth: &Texture,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("low depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &whole(depth),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Store,
                }),
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, shadows.world_bind_group(), &[]);
        pass.draw(0..3 * triangles, 0..1);
    }
}
