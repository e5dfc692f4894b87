//! The pass that draws lines over the picture.

use std::borrow::Cow;

use glam::Vec3;
use umbrage_core::View;
use umbrage_lab::gbuffer::{DEPTH_STENCIL, whole};
use umbrage_lab::gpu::Gpu;

use super::{Line, Lines};

/// Width of a line in pixels.
const WIDTH_PX: f32 = 1.5;

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Uniform {
    /// Times the view's scale.
    right: Vec3,
    near: f32,
    up: Vec3,
    half_width_px: f32,
    forward: Vec3,
    unused: f32,
    /// From the eye to the anchor.
    anchor: Vec3,
    unused_too: f32,
    size: [f32; 2],
    padding: [f32; 2],
}

/// Pipelines, and the lines that were handed over last.
#[derive(Debug)]
pub(crate) struct LinePass {
    /// Drawn where nothing stands before them, and everywhere.
    pipelines: [wgpu::RenderPipeline; 2],
    uniform: wgpu::Buffer,
    binding: wgpu::BindGroup,
    vertices: Option<wgpu::Buffer>,
    count: u32,
    anchor: glam::DVec3,
}

impl LinePass {
    /// For a target of this format.
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("lines"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("lines"),
            size: size_of::<Uniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lines"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: uniform.as_entire_binding(),
            }],
        });
        let compares = [
            wgpu::CompareFunction::GreaterEqual,
            wgpu::CompareFunction::Always,
        ];
        Self {
            pipelines: compares.map(|compare| pipeline(device, &layout, format, compare)),
            uniform,
            binding,
            vertices: None,
            count: 0,
            anchor: glam::DVec3::ZERO,
        }
    }

    /// Hands over the lines to draw from now on; as many as one buffer holds.
    pub(crate) fn set(&mut self, gpu: &Gpu, lines: &Lines) {
        let most = gpu.device.limits().max_buffer_size as usize / size_of::<Line>();
        let lines_there = &lines.lines[..lines.lines.len().min(most)];
        self.anchor = lines.anchor;
        self.count = lines_there.len() as u32;
        self.vertices = (self.count > 0).then(|| {
            let bytes: &[u8] = bytemuck::cast_slice(lines_there);
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lines"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        });
    }

    /// Draws them over `target`, `through` the surfaces in `depth` or hidden by them.
    pub(crate) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        depth: &wgpu::Texture,
        view: &View,
        through: bool,
    ) {
        let Some(vertices) = &self.vertices else {
            return;
        };
        let uniform = Uniform {
            right: view.right * view.scale_x,
            near: view.near,
            up: view.up * view.scale_y,
            half_width_px: WIDTH_PX * 0.5,
            forward: view.forward,
            unused: 0.0,
            anchor: (self.anchor - view.eye).as_vec3(),
            unused_too: 0.0,
            size: view.size.map(|side| side as f32),
            padding: [0.0; 2],
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lines"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &whole(depth),
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipelines[usize::from(through)]);
        pass.set_bind_group(0, &self.binding, &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.draw(0..6, 0..self.count);
    }
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
    compare: wgpu::CompareFunction,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("lines"),
        source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(include_str!("../shaders/lines.wgsl"))),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("lines"),
        layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("lines"),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        })),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Line>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4],
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_STENCIL,
            depth_write_enabled: Some(false),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
