//! The stencil pipelines: sides counted on depth pass, sides and caps counted on depth fail.

use std::borrow::Cow;

use umbrage_core::frame::Extrusion;
use wgpu::{
    BindGroupLayout, CompareFunction, DepthStencilState, Device, RenderPipeline, ShaderModule,
    StencilFaceState, StencilOperation, StencilState,
};

use crate::{CLIP_WGSL, RendererOptions, VOLUME_WGSL, VolumeColor, world_wgsl};

#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) zpass_sides: RenderPipeline,
    pub(crate) zfail_sides: RenderPipeline,
    pub(crate) zfail_caps: RenderPipeline,
    pub(crate) zfail_reversed_caps: RenderPipeline,
    pub(crate) clean: RenderPipeline,
    pub(crate) shared: Shared,
}

/// What all pipelines of volumes are made from.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) module: ShaderModule,
    pub(crate) layout: wgpu::PipelineLayout,
    pub(crate) depth_stencil_format: wgpu::TextureFormat,
    pub(crate) sample_count: u32,
    pub(crate) depth_clamp: bool,
    pub(crate) extrusion: Extrusion,
}

impl Shared {
    /// Constants of the vertex shaders, for volumes that end as `extrusion` says.
    pub(crate) fn constants(extrusion: Extrusion) -> [(&'static str, f64); 1] {
        let is_finite = extrusion != Extrusion::Infinite;
        [("UMBRAGE_FINITE", f64::from(u8::from(is_finite)))]
    }
}

/// When a side or cap counts.
#[derive(Clone, Copy)]
enum Counts {
    /// Where it is in front of the surface: entering (front face) +1, leaving -1.
    InFront,
    /// Where it is behind the surface: leaving (back face) +1, entering -1.
    Behind,
    /// The same for triangles taken with reversed winding.
    BehindReversed,
    /// Everywhere, to zero.
    Clean,
}

impl Pipelines {
    pub(crate) fn new(
        device: &Device,
        options: &RendererOptions<'_>,
        layouts: [&BindGroupLayout; 2],
    ) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage volume"),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(format!(
                "{CLIP_WGSL}\n{}\n{VOLUME_WGSL}",
                world_wgsl(1)
            ))),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage volume"),
            bind_group_layouts: &layouts.map(Some),
            immediate_size: 0,
        });
        let build = |label, entry, counts| {
            pipeline(device, options, &layout, &module, label, entry, counts)
        };
        Self {
            zpass_sides: build("umbrage z-pass sides", "side", Counts::InFront),
            zfail_sides: build("umbrage z-fail sides", "zfail_side", Counts::Behind),
            zfail_caps: build("umbrage z-fail caps", "cap", Counts::Behind),
            zfail_reversed_caps: build("umbrage z-fail caps", "cap", Counts::BehindReversed),
            clean: build("umbrage clean", "everywhere", Counts::Clean),
            shared: Shared {
                module,
                layout,
                depth_stencil_format: options.depth_stencil_format,
                sample_count: options.sample_count,
                depth_clamp: options.depth_clamp,
                extrusion: options.extrusion,
            },
        }
    }
}

fn pipeline(
    device: &Device,
    options: &RendererOptions<'_>,
    layout: &wgpu::PipelineLayout,
    module: &ShaderModule,
    label: &str,
    vertex_entry: &str,
    counts: Counts,
) -> RenderPipeline {
    let face = |pass_op, depth_fail_op| StencilFaceState {
        compare: CompareFunction::Always,
        fail_op: StencilOperation::Keep,
        depth_fail_op,
        pass_op,
    };
    use StencilOperation::{DecrementWrap, IncrementWrap, Keep, Zero};
    let (front, back) = match counts {
        Counts::InFront => (face(IncrementWrap, Keep), face(DecrementWrap, Keep)),
        Counts::Behind => (face(Keep, DecrementWrap), face(Keep, IncrementWrap)),
        Counts::BehindReversed => (face(Keep, IncrementWrap), face(Keep, DecrementWrap)),
        Counts::Clean => (face(Zero, Zero), face(Zero, Zero)),
    };
    let volume_color = match counts {
        Counts::Clean => VolumeColor::None,
        _ => options.volume_color,
    };
    // The pass has the host's colour targets; volumes leave them alone, but for debug views.
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let (entry_point, visible) = match volume_color {
        VolumeColor::None => ("nothing", None),
        VolumeColor::Fragments => (
            "one",
            Some(wgpu::BlendState {
                color: add,
                alpha: add,
            }),
        ),
        VolumeColor::Layers => (
            "layer",
            Some(wgpu::BlendState {
                color: add,
                alpha: add,
            }),
        ),
    };
    let targets: Vec<_> = (0..)
        .zip(options.color_formats)
        .map(|(number, format)| {
            let blend = visible.filter(|_| number == 0);
            format.map(|format| wgpu::ColorTargetState {
                format,
                blend,
                write_mask: match blend {
                    Some(_) => wgpu::ColorWrites::ALL,
                    None => wgpu::ColorWrites::empty(),
                },
            })
        })
        .collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex_entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &Shared::constants(options.extrusion),
                ..Default::default()
            },
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: None,
            unclipped_depth: options.depth_clamp,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(DepthStencilState {
            format: options.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(CompareFunction::Greater),
            stencil: StencilState {
                front,
                back,
                read_mask: 0xff,
                write_mask: 0xff,
            },
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: options.sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: (!targets.is_empty()).then(|| wgpu::FragmentState {
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
