//! The number of the triangle seen at each pixel: rays start from its plane, which no rounded
//! distance can leave, and never meet the triangle itself.

use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer};
use wgpu::{TextureFormat, TextureUsages};

use crate::gbuffer::{DEPTH_STENCIL, texture, whole};
use crate::gpu::Gpu;
use crate::technique::Given;

const ID: TextureFormat = TextureFormat::R32Uint;

/// Draws the world once more, where it equals the depth that is there.
#[derive(Debug)]
pub(super) struct Primary {
    pipeline: wgpu::RenderPipeline,
}

impl Primary {
    pub(super) fn new(gpu: &Gpu, shadows: &ShadowRenderer) -> Self {
        let source = format!(
            "{CLIP_WGSL}\n{}\n{}",
            shadows.world_wgsl(0),
            include_str!("../../shaders/primary.wgsl")
        );
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("primary triangles"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let options = wgpu::PipelineCompilationOptions::default;
        Self {
            pipeline: device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("primary triangles"),
                layout: Some(
                    &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                        label: Some("primary triangles"),
                        bind_group_layouts: &[Some(shadows.world_bind_group_layout())],
                        immediate_size: 0,
                    }),
                ),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vertex"),
                    compilation_options: options(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState {
                    unclipped_depth: gpu.depth_clamp,
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_STENCIL,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(wgpu::CompareFunction::Equal),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: options(),
                    targets: &[Some(ID.into())],
                }),
                multiview_mask: None,
                cache: None,
            }),
        }
    }

    /// A target for `record`.
    pub(super) fn target(gpu: &Gpu, size: [u32; 2]) -> wgpu::Texture {
        let usage = TextureUsages::TEXTURE_BINDING;
        texture(gpu, "primary triangles", size, ID, usage)
    }

    /// Fills `target` with 1 + the triangle's number, 0 where there is none.
    pub(super) fn record(
        &self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::Texture,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("primary triangles"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &whole(target),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &whole(&given.targets.depth),
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, given.shadows.world_bind_group(), &[]);
        pass.draw(0..3 * given.stage.world.triangles.len() as u32, 0..1);
    }
}
