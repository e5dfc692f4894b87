//! Draws the steps of a mask into one channel of a target.

use std::borrow::Cow;

use umbrage_core::frame::LightPlan;
use umbrage_wgpu::{CLIP_WGSL, CountStep, FaceOptions, ShadowRenderer, VolumeFaces, light_wgsl};
use wgpu::{BlendComponent, BlendFactor, BlendOperation, RenderPipeline, TextureFormat};

use super::plan::{MaskPlan, Place, Rectangle, Step};
use super::slots::SLOT_WGSL;
use crate::binding::{STORAGE, bind, buffer, layout};
use crate::gpu::Gpu;
use crate::method::{Counting, MaskBuffer};

/// Pipelines for the steps of one plan.
#[derive(Debug)]
pub(crate) struct Painter {
    plan: MaskPlan,
    steps: Vec<(Step, Drawn)>,
    layout: wgpu::BindGroupLayout,
}

/// What a step is drawn with.
#[derive(Debug)]
enum Drawn {
    Faces(VolumeFaces),
    Rectangle(RenderPipeline),
    /// By the stencil's own pipelines.
    Elsewhere,
}

impl Painter {
    /// Compiles what it takes to draw masks into targets of `format`, in passes of `shadows`.
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        plan: MaskPlan,
        format: TextureFormat,
    ) -> Self {
        let rectangles = Rectangles::new(gpu, shadows, plan, format);
        let steps = plan.mask_steps().into_iter().map(|step| {
            let drawn = match step {
                Step::Raise => Drawn::Faces(rectangles.faces(gpu, shadows, CountStep::Raise)),
                Step::Lower => Drawn::Faces(rectangles.faces(gpu, shadows, CountStep::Lower)),
                Step::Stencil => Drawn::Elsewhere,
                _ => Drawn::Rectangle(rectangles.pipeline(gpu, shadows, step)),
            };
            (step, drawn)
        });
        Self {
            plan,
            steps: steps.collect(),
            layout: rectangles.layout,
        }
    }

    /// Binds the lights' slots.
    pub(crate) fn bind(&self, gpu: &Gpu, slots: &wgpu::Buffer) -> wgpu::BindGroup {
        bind(gpu, "mask", &self.layout, [slots.as_entire_binding()])
    }

    /// Draws all steps for one light, whose mask is in `channel`, over the scissor that is set; the
    /// stencil step is left out.
    pub(crate) fn paint(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shadows: &ShadowRenderer,
        slots: &wgpu::BindGroup,
        number: usize,
        light: &LightPlan,
        channel: u32,
    ) {
        for (step, drawn) in &self.steps {
            match drawn {
                Drawn::Faces(faces) => {
                    pass.set_blend_constant(self.blend_constant(*step, channel));
                    shadows.record_faces(pass, faces, number, light);
                }
                Drawn::Rectangle(pipeline) => {
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, slots, &[]);
                    pass.set_bind_group(1, shadows.light_bind_group(), &[]);
                    shadows.draw_light(pass, number);
                }
                Drawn::Elsewhere => {}
            }
        }
    }

    /// The factor that faces change their channel by, and the one that leaves others as they are.
    fn blend_constant(&self, step: Step, channel: u32) -> wgpu::Color {
        let (ours, other) = match doubles(self.plan, step == Step::Raise) {
            true => (1.0, 0.0),
            false => (self.plan.half(), 1.0),
        };
        let at = |c| if c == channel { ours } else { other };
        wgpu::Color {
            r: at(0),
            g: at(1),
            b: at(2),
            a: at(3),
        }
    }
}

/// Whether raising or lowering the count doubles the mask; else it is halved.
fn doubles(plan: MaskPlan, raises: bool) -> bool {
    raises != (plan.of == Counting::Mask(MaskBuffer::Max))
}

/// The module and layouts that pipelines are made from.
struct Rectangles {
    plan: MaskPlan,
    format: TextureFormat,
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    pipeline_layout: wgpu::PipelineLayout,
}

impl Rectangles {
    fn new(gpu: &Gpu, shadows: &ShadowRenderer, plan: MaskPlan, format: TextureFormat) -> Self {
        let device = &gpu.device;
        let stage = wgpu::ShaderStages::VERTEX;
        let layout = layout(gpu, "mask", stage, [buffer(STORAGE)]);
        let placing = light_wgsl(1);
        let shading = include_str!("../../shaders/mask.wgsl");
        let source = format!("{CLIP_WGSL}\n{placing}\n{SLOT_WGSL}\n{shading}");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("mask"),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(source)),
        });
        let layouts = [Some(&layout), Some(shadows.light_bind_group_layout())];
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mask"),
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        Self {
            plan,
            format,
            module,
            pipeline_layout,
            layout,
        }
    }

    /// A target in which `blend` changes the mask, and nothing changes what is beside it.
    fn target(&self, blend: Option<BlendComponent>) -> wgpu::ColorTargetState {
        wgpu::ColorTargetState {
            format: self.format,
            blend: blend.map(|component| wgpu::BlendState {
                color: component,
                alpha: component,
            }),
            write_mask: match self.plan.place {
                Place::Frame => wgpu::ColorWrites::ALPHA,
                Place::Layers | Place::LowLayers => wgpu::ColorWrites::ALL,
            },
        }
    }

    /// Doubling is d + d * constant, halving d * constant: the constant tells the channels apart.
    fn faces(&self, gpu: &Gpu, shadows: &ShadowRenderer, step: CountStep) -> VolumeFaces {
        let src_factor = match doubles(self.plan, step == CountStep::Raise) {
            true => BlendFactor::Dst,
            false => BlendFactor::Zero,
        };
        let blend = add(src_factor, BlendFactor::Constant);
        let options = FaceOptions {
            step,
            targets: &[Some(self.target(Some(blend)))],
            stencil: wgpu::StencilFaceState::IGNORE,
        };
        shadows.faces(&gpu.device, &options)
    }

    fn pipeline(&self, gpu: &Gpu, shadows: &ShadowRenderer, step: Step) -> RenderPipeline {
        use BlendFactor::{Dst, One, OneMinusDst, OneMinusSrc, Zero};
        let equation = |operation| BlendComponent {
            src_factor: One,
            dst_factor: One,
            operation,
        };
        let (entry_point, blend) = match step {
            // Alpha has the last light's mask; a layer is 1 where no light was yet.
            Step::Start if self.plan.place == Place::Frame => ("start", None),
            Step::Rectangle(Rectangle::Double) => ("one", Some(add(Dst, One))),
            Step::Rectangle(Rectangle::Invert) => ("one", Some(add(OneMinusDst, OneMinusSrc))),
            Step::Rectangle(Rectangle::AddHalf) => ("half_of_one", Some(add(One, One))),
            Step::Rectangle(Rectangle::Clamp | Rectangle::Limit) => {
                ("at_most_one", Some(equation(BlendOperation::Min)))
            }
            Step::Rectangle(Rectangle::AtLeastHalf) => {
                ("half_of_one", Some(equation(BlendOperation::Max)))
            }
            Step::Rectangle(Rectangle::Stretch) => {
                let blend = BlendComponent {
                    src_factor: OneMinusDst,
                    ..equation(BlendOperation::ReverseSubtract)
                };
                ("one", Some(blend))
            }
            Step::Rectangle(Rectangle::Darken) => ("dark", Some(add(Dst, Zero))),
            _ => ("start", Some(add(Dst, Zero))),
        };
        let counted = self.plan.of != Counting::Stencil;
        let whole_rows = counted && self.plan.place == Place::LowLayers;
        let mut depth_stencil = shadows.light_depth_stencil();
        if step == Step::Rectangle(Rectangle::Darken) {
            depth_stencil.stencil.front.compare = wgpu::CompareFunction::NotEqual;
            depth_stencil.stencil.back.compare = wgpu::CompareFunction::NotEqual;
        } else {
            depth_stencil.stencil = wgpu::StencilState::default();
        }
        gpu.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("mask"),
                layout: Some(&self.pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &self.module,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("whole_rows", f64::from(u8::from(whole_rows)))],
                        ..wgpu::PipelineCompilationOptions::default()
                    },
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(depth_stencil),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(self.target(blend))],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}

fn add(src_factor: BlendFactor, dst_factor: BlendFactor) -> BlendComponent {
    BlendComponent {
        src_factor,
        dst_factor,
        operation: BlendOperation::Add,
    }
}
