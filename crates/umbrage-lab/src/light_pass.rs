//! The lab's light draws: where the light reaches, lit by what the method found.

use std::borrow::Cow;

use bytemuck::{Pod, Zeroable};
use umbrage_core::LightShape;
use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer, light_wgsl};
use wgpu::{RenderPipeline, TextureFormat};

use crate::gbuffer::whole;
use crate::gpu::Gpu;
use crate::stage::StageLight;
use crate::technique::Given;

/// Where light adds up.
pub const HDR: TextureFormat = TextureFormat::Rgba16Float;

/// Where mask bits add up: 32 lights, a bit each.
pub const MASK: TextureFormat = TextureFormat::Rgba8Unorm;

/// Where mask bits add up beside an alpha channel in use: 32 lights in red, green and blue, eleven
/// each, which is what a half float's integers hold.
pub(crate) const WIDE_MASK: TextureFormat = HDR;

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
    residual: [f32; 3],
    padding: f32,
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
        let [position, residual] = l.light.position_f32();
        Self {
            position: position.to_array(),
            residual: residual.to_array(),
            padding: 0.0,
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
    /// What reaches its shadow too, added up.
    Ambient,
    /// The light's bit of the mask.
    Mark,
    /// One for each light that reaches the pixel, shadowed or not.
    Reach,
    /// One for each light drawn.
    One,
    /// One to green for each light drawn, and where its light shows one to blue, and to alpha what
    /// part of its range is needed for that.
    Count,
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

    fn entry_point(self) -> &'static str {
        match self {
            LightDraw::Shade => "shade",
            LightDraw::Ambient => "ambient",
            LightDraw::Mark => "mark",
            LightDraw::Reach => "reach",
            LightDraw::Count => "count",
            LightDraw::One | LightDraw::Nothing => "one",
        }
    }
}

/// What decides which of the pixels that a light reaches are lit by it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LitBy<'a> {
    /// The stencil that the light's volume left.
    Stencil,
    /// A stencil test of the technique's own.
    StencilTest(wgpu::StencilFaceState),
    /// The alpha that stands in the target: light is multiplied by it, and leaves it alone. Bits
    /// of a mask, of which alpha is then no part, are drawn as [`LightDraw::Mark`] says for
    /// [`WIDE_MASK`].
    Alpha,
    /// Nothing: all are.
    Everything,
    /// A shader: `fn visibility(light: u32, pixel: vec2f) -> f32`, 0 in shadow, 1 lit, with its
    /// resources in bind group 2. It may use what stands in `light.wgsl`.
    Shader {
        wgsl: &'a str,
        layout: &'a wgpu::BindGroupLayout,
    },
}

/// A pipeline for one kind of light draw, and what it reads in the frame at hand.
#[derive(Debug)]
pub(crate) struct LightPass {
    pipeline: RenderPipeline,
    layout: wgpu::BindGroupLayout,
    binding: Option<wgpu::BindGroup>,
}

impl LightPass {
    /// Compiles it for the passes that `shadows` records into.
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        lit_by: LitBy<'_>,
    ) -> Self {
        let add = match lit_by {
            LitBy::Alpha => wgpu::BlendComponent {
                src_factor: wgpu::BlendFactor::DstAlpha,
                ..ADD
            },
            _ => ADD,
        };
        let add = wgpu::BlendState {
            color: add,
            alpha: add,
        };
        let (format, entry_point) = match (lit_by, draw) {
            (LitBy::Alpha, LightDraw::Mark) => (WIDE_MASK, "mark_wide"),
            _ => (draw.format(), draw.entry_point()),
        };
        let layout = bind_group_layout(gpu);
        let (visibility, visibility_layout) = match lit_by {
            LitBy::Shader { wgsl, layout } => (wgsl, Some(layout)),
            _ => (ALL_VISIBLE, None),
        };
        let placing = light_wgsl(1);
        let shading = include_str!("shaders/light.wgsl");
        let source = format!("{CLIP_WGSL}\n{placing}\n{shading}\n{visibility}");
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("light"),
                source: wgpu::ShaderSource::Wgsl(Cow::Owned(source)),
            });
        let depth_stencil = match lit_by {
            LitBy::Stencil => shadows.light_depth_stencil(),
            LitBy::StencilTest(face) => wgpu::DepthStencilState {
                stencil: wgpu::StencilState {
                    front: face,
                    back: face,
                    ..shadows.light_depth_stencil().stencil
                },
                ..shadows.light_depth_stencil()
            },
            _ => wgpu::DepthStencilState {
                stencil: wgpu::StencilState::default(),
                ..shadows.light_depth_stencil()
            },
        };
        let mut layouts = vec![Some(&layout), Some(shadows.light_bind_group_layout())];
        layouts.extend(visibility_layout.map(Some));
        let pipeline =
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some("light"),
                    layout: Some(&gpu.device.create_pipeline_layout(
                        &wgpu::PipelineLayoutDescriptor {
                            label: Some("light"),
                            bind_group_layouts: &layouts,
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
                        entry_point: Some(entry_point),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        targets: &[Some(wgpu::ColorTargetState {
                            format,
                            blend: Some(add),
                            write_mask: match (draw, lit_by) {
                                (LightDraw::Nothing, _) => wgpu::ColorWrites::empty(),
                                (_, LitBy::Alpha) => wgpu::ColorWrites::COLOR,
                                _ => wgpu::ColorWrites::ALL,
                            },
                        })],
                    }),
                    multiview_mask: None,
                    cache: None,
                });
        Self {
            pipeline,
            layout,
            binding: None,
        }
    }

    /// Binds lights and surface for the frame at hand.
    pub(crate) fn prepare(&mut self, given: &Given<'_>) {
        let mut uniforms: Vec<LightUniform> = given.lights.iter().map(LightUniform::from).collect();
        if uniforms.is_empty() {
            uniforms.push(LightUniform::zeroed());
        }
        let device = &given.gpu.device;
        let buffer = given
            .gpu
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("lights"),
                contents: bytemuck::cast_slice(&uniforms),
                usage: wgpu::BufferUsages::STORAGE,
            });
        let targets = given.targets;
        let views = [&targets.albedo, &targets.normal, &targets.distance].map(whole);
        let buffers = [given.shadows.view_buffer(), &buffer];
        let resources = buffers
            .map(wgpu::Buffer::as_entire_binding)
            .into_iter()
            .chain(views.iter().map(wgpu::BindingResource::TextureView));
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        self.binding = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light"),
            layout: &self.layout,
            entries: &entries,
        }));
    }

    /// Records the volumes of the plan's lights numbered `lights`, if it has any, and after each
    /// the light. `visibility` is what the shader of [`LitBy::Shader`] reads.
    pub(crate) fn record(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        given: &Given<'_>,
        lights: std::ops::Range<usize>,
        visibility: Option<&wgpu::BindGroup>,
    ) {
        let (shadows, plan) = (given.shadows, given.plan);
        shadows.record(pass, plan, lights, |pass, number, _| {
            self.draw(pass, shadows, number, visibility);
        });
    }

    /// Draws one light over the scissor that is set.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shadows: &ShadowRenderer,
        number: usize,
        visibility: Option<&wgpu::BindGroup>,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, self.binding.as_ref(), &[]);
        pass.set_bind_group(1, shadows.light_bind_group(), &[]);
        if visibility.is_some() {
            pass.set_bind_group(2, visibility, &[]);
        }
        shadows.draw_light(pass, number);
    }
}

/// Adds to what is there.
pub(crate) const ADD: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// For who leaves the decision to the stencil, or to nobody.
const ALL_VISIBLE: &str = "fn visibility(light: u32, pixel: vec2f) -> f32 { return 1.0; }";

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
