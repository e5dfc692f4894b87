//! The lab's light draws: one rectangle a light, inside the stencil that its volume left.

use std::borrow::Cow;

use bytemuck::{Pod, Zeroable};
use umbrage::{CLIP_WGSL, LightShape, ShadowRenderer, light_wgsl};
use wgpu::util::DeviceExt as _;
use wgpu::{RenderPipeline, TextureFormat};

use crate::gbuffer::{Targets, whole};
use crate::gpu::Gpu;
use crate::stage::StageLight;

/// Where light adds up.
pub const HDR: TextureFormat = TextureFormat::Rgba16Float;

/// Where mask bits add up: 32 lights, a bit each.
pub const MASK: TextureFormat = TextureFormat::Rgba8Unorm;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct LightUniform {
    position: [f32; 3],
    range: f32,
    power: [f32; 3],
    kind: u32,
    direction: [f32; 3],
    cos_outer: f32,
    cos_inner: f32,
    unused: [f32; 3],
}

impl From<&StageLight> for LightUniform {
    fn from(l: &StageLight) -> Self {
        let (kind, direction, cos_outer) = match l.light.shape {
            LightShape::Point => (0, glam::Vec3::ZERO, -1.0),
            LightShape::Spot {
                direction,
                cos_outer,
            } => (1, direction, cos_outer),
            LightShape::Directional { direction } => (2, direction, -1.0),
        };
        Self {
            position: l.light.position.to_array(),
            range: l.light.range,
            power: l.power.to_array(),
            kind,
            direction: direction.to_array(),
            cos_outer,
            cos_inner: l.cos_inner,
            unused: [0.0; 3],
        }
    }
}

/// What a light draw writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightDraw {
    /// Reflected light, added up.
    Shade,
    /// The light's bit of the mask.
    Mark,
    /// One for each light that reaches the pixel, shadowed or not.
    Reach,
    /// One for each light drawn.
    One,
    /// Nothing but the stencil.
    Nothing,
}

impl LightDraw {
    /// Format of the colour target it needs.
    pub fn format(self) -> TextureFormat {
        match self {
            LightDraw::Mark => MASK,
            _ => HDR,
        }
    }
}

/// A pipeline for one kind of light draw.
#[derive(Debug)]
pub struct LightPass {
    pipeline: RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl LightPass {
    /// Compiles it for the stencil that `shadows` leaves.
    pub fn new(gpu: &Gpu, shadows: &ShadowRenderer, draw: LightDraw) -> Self {
        let placing = light_wgsl(1);
        let shading = include_str!("shaders/light.wgsl");
        let source = format!("{CLIP_WGSL}\n{placing}\n{shading}");
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("light"),
                source: wgpu::ShaderSource::Wgsl(Cow::Owned(source)),
            });
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let mut depth_stencil = shadows.light_depth_stencil();
        if draw == LightDraw::Reach || draw == LightDraw::One {
            for face in [
                &mut depth_stencil.stencil.front,
                &mut depth_stencil.stencil.back,
            ] {
                face.compare = wgpu::CompareFunction::Always;
            }
        }
        let layout = bind_group_layout(gpu);
        let pipeline =
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some("light"),
                    layout: Some(&gpu.device.create_pipeline_layout(
                        &wgpu::PipelineLayoutDescriptor {
                            label: Some("light"),
                            bind_group_layouts: &[
                                Some(&layout),
                                Some(shadows.light_bind_group_layout()),
                            ],
                            immediate_size: 0,
                        },
                    )),
                    vertex: wgpu::VertexState {
                        module: &module,
                        entry_point: Some("vertex"),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        buffers: &[],
                    },
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: Some(depth_stencil),
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &module,
                        entry_point: Some(match draw {
                            LightDraw::Shade => "shade",
                            LightDraw::Mark => "mark",
                            LightDraw::Reach => "reach",
                            LightDraw::One | LightDraw::Nothing => "one",
                        }),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        targets: &[Some(wgpu::ColorTargetState {
                            format: draw.format(),
                            blend: Some(wgpu::BlendState {
                                color: add,
                                alpha: add,
                            }),
                            write_mask: match draw {
                                LightDraw::Nothing => wgpu::ColorWrites::empty(),
                                _ => wgpu::ColorWrites::ALL,
                            },
                        })],
                    }),
                    multiview_mask: None,
                    cache: None,
                });
        Self { pipeline, layout }
    }

    /// Binds lights and surface for the frames to come.
    pub fn bind(
        &self,
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        lights: &[StageLight],
        targets: &Targets,
    ) -> LightBinding {
        let mut uniforms: Vec<LightUniform> = lights.iter().map(LightUniform::from).collect();
        if uniforms.is_empty() {
            uniforms.push(LightUniform::zeroed());
        }
        let buffer = gpu
            .device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("lights"),
                contents: bytemuck::cast_slice(&uniforms),
                usage: wgpu::BufferUsages::STORAGE,
            });
        let views = [&targets.albedo, &targets.normal, &targets.distance].map(whole);
        let buffers = [shadows.view_buffer(), &buffer];
        let resources = buffers
            .map(wgpu::Buffer::as_entire_binding)
            .into_iter()
            .chain(views.iter().map(wgpu::BindingResource::TextureView));
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        LightBinding(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light"),
            layout: &self.layout,
            entries: &entries,
        }))
    }

    /// Draws light `number` over the scissor that is set.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shadows: &ShadowRenderer,
        binding: &LightBinding,
        number: usize,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &binding.0, &[]);
        pass.set_bind_group(1, shadows.light_bind_group(), &[]);
        shadows.draw_light(pass, number);
    }
}

/// Lights and surface, bound.
#[derive(Debug)]
pub struct LightBinding(wgpu::BindGroup);

/// View, lights, and the three textures of the surface.
fn bind_group_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let types = [
        buffer(wgpu::BufferBindingType::Uniform),
        buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        texture,
        texture,
        texture,
    ];
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("light"),
            entries: &entries,
        })
}
