//! The stencil pipelines: sides counted on depth pass, sides and caps counted on depth fail.

use std::borrow::Cow;

use umbrage_core::frame::Extrusion;
use wgpu::{
    BindGroupLayout, ColorTargetState, CompareFunction, DepthStencilState, Device, RenderPipeline,
    ShaderModule, StencilFaceState, StencilOperation, StencilState, TextureFormat,
};

use crate::{CLIP_WGSL, DepthRange, RendererOptions, VOLUME_WGSL, VolumeColor};

/// What draws volumes in passes with certain colour targets.
#[derive(Debug)]
pub struct VolumePipelines {
    /// Of lights that are drawn as a whole.
    pub(crate) whole: Counters,
    /// Of parts: seven bits count.
    pub(crate) part: Counters,
    /// Between parts; see [`PartPlan`](umbrage_core::frame::PartPlan).
    pub(crate) join: RenderPipeline,
    pub(crate) clean: RenderPipeline,
}

/// What counts volumes.
#[derive(Debug)]
pub(crate) struct Counters {
    zpass_sides: RenderPipeline,
    zfail_sides: RenderPipeline,
    /// Each with that of caps seen edge-on.
    zfail_caps: [RenderPipeline; 2],
    zfail_reversed_caps: [RenderPipeline; 2],
}

impl Counters {
    /// Of sides, on the z-pass and on the z-fail path.
    pub(crate) fn sides(&self) -> [&RenderPipeline; 2] {
        [&self.zpass_sides, &self.zfail_sides]
    }

    /// Of caps taken as wound, and reversed.
    pub(crate) fn caps(&self) -> [&[RenderPipeline]; 2] {
        [&self.zfail_caps, &self.zfail_reversed_caps]
    }
}

/// The bits of the stencil that count a part.
pub(crate) const PART_BITS: u32 = 0x7f;
/// The bit that remembers shadows of parts.
pub(crate) const SHADOW_BIT: u32 = 0x80;

/// Shaders of caps that are seen as a line, whose fragments say their own depth.
const EDGE_ON_CAP: &str = "edge_on_cap";
const EDGE_ON_DEPTH: &str = "edge_on_depth";

/// What all pipelines of volumes are made from.
#[derive(Debug)]
pub(crate) struct VolumeShader {
    pub(crate) module: ShaderModule,
    pub(crate) layout: wgpu::PipelineLayout,
    pub(crate) depth_stencil_format: wgpu::TextureFormat,
    pub(crate) sample_count: u32,
    pub(crate) depth: DepthRange,
    pub(crate) depth_clamp: bool,
    pub(crate) extrusion: Extrusion,
}

impl VolumeShader {
    pub(crate) fn new(
        device: &Device,
        options: &RendererOptions<'_>,
        layouts: [&BindGroupLayout; 2],
        world_wgsl: &str,
    ) -> Self {
        Self {
            module: device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("umbrage volume"),
                source: wgpu::ShaderSource::Wgsl(Cow::Owned(format!(
                    "{CLIP_WGSL}\n{world_wgsl}\n{VOLUME_WGSL}"
                ))),
            }),
            layout: device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("umbrage volume"),
                bind_group_layouts: &layouts.map(Some),
                immediate_size: 0,
            }),
            depth_stencil_format: options.depth_stencil_format,
            sample_count: options.sample_count,
            depth: options.depth,
            depth_clamp: options.depth_clamp,
            extrusion: options.extrusion,
        }
    }

    /// Constants of the vertex shaders.
    pub(crate) fn constants(&self) -> [(&'static str, f64); 1] {
        let is_finite = self.extrusion != Extrusion::Infinite;
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
    /// Where the bits of a part are not at the reference: they are set to it, and the shadow bit.
    Join,
}

impl VolumePipelines {
    pub(crate) fn new(
        device: &Device,
        shader: &VolumeShader,
        color_formats: &[Option<TextureFormat>],
        volume_color: VolumeColor,
    ) -> Self {
        let build = |label, entry, counts, bits| {
            let is_edge_on = entry == EDGE_ON_CAP;
            let volume_color = match counts {
                Counts::Clean | Counts::Join => VolumeColor::None,
                _ if is_edge_on => VolumeColor::None,
                _ => volume_color,
            };
            let (fragment, targets) = targets(color_formats, volume_color);
            let fragment = if is_edge_on { EDGE_ON_DEPTH } else { fragment };
            let stencil = stencil(counts, bits);
            pipeline(device, shader, label, [entry, fragment], stencil, &targets)
        };
        let caps = |counts, bits| {
            ["cap", EDGE_ON_CAP].map(|entry| build("umbrage z-fail caps", entry, counts, bits))
        };
        let counters = |bits| Counters {
            zpass_sides: build("umbrage z-pass sides", "side", Counts::InFront, bits),
            zfail_sides: build("umbrage z-fail sides", "zfail_side", Counts::Behind, bits),
            zfail_caps: caps(Counts::Behind, bits),
            zfail_reversed_caps: caps(Counts::BehindReversed, bits),
        };
        Self {
            whole: counters(0xff),
            part: counters(PART_BITS),
            join: build("umbrage join", "everywhere", Counts::Join, 0xff),
            clean: build("umbrage clean", "everywhere", Counts::Clean, 0xff),
        }
    }
}

fn stencil(counts: Counts, write_mask: u32) -> StencilState {
    let face = |pass_op, depth_fail_op| StencilFaceState {
        compare: CompareFunction::Always,
        fail_op: StencilOperation::Keep,
        depth_fail_op,
        pass_op,
    };
    use StencilOperation::{DecrementWrap, IncrementWrap, Keep, Replace, Zero};
    let (front, back) = match counts {
        Counts::InFront => (face(IncrementWrap, Keep), face(DecrementWrap, Keep)),
        Counts::Behind => (face(Keep, DecrementWrap), face(Keep, IncrementWrap)),
        Counts::BehindReversed => (face(Keep, IncrementWrap), face(Keep, DecrementWrap)),
        Counts::Clean => (face(Zero, Zero), face(Zero, Zero)),
        Counts::Join => {
            let join = StencilFaceState {
                compare: CompareFunction::NotEqual,
                ..face(Replace, Replace)
            };
            (join, join)
        }
    };
    let read_mask = match counts {
        Counts::Join => PART_BITS,
        _ => 0xff,
    };
    StencilState {
        front,
        back,
        read_mask,
        write_mask,
    }
}

/// The fragment shader, and the pass's colour targets: volumes leave them alone, but for debug views.
fn targets(
    color_formats: &[Option<TextureFormat>],
    volume_color: VolumeColor,
) -> (&'static str, Vec<Option<ColorTargetState>>) {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let add = wgpu::BlendState {
        color: add,
        alpha: add,
    };
    let (entry_point, visible) = match volume_color {
        VolumeColor::None => ("nothing", None),
        VolumeColor::Fragments => ("one_in_red", Some(add)),
        VolumeColor::Layers => ("layer", Some(add)),
    };
    let target = |(number, format): (usize, &Option<TextureFormat>)| {
        let blend = visible.filter(|_| number == 0);
        format.map(|format| ColorTargetState {
            format,
            blend,
            write_mask: match blend {
                Some(_) => wgpu::ColorWrites::ALL,
                None => wgpu::ColorWrites::empty(),
            },
        })
    };
    let targets = color_formats.iter().enumerate().map(target).collect();
    (entry_point, targets)
}

fn pipeline(
    device: &Device,
    shader: &VolumeShader,
    label: &str,
    [vertex_entry, fragment_entry]: [&str; 2],
    stencil: StencilState,
    targets: &[Option<ColorTargetState>],
) -> RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&shader.layout),
        vertex: wgpu::VertexState {
            module: &shader.module,
            entry_point: Some(vertex_entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &shader.constants(),
                ..Default::default()
            },
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: None,
            unclipped_depth: shader.depth_clamp,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(DepthStencilState {
            format: shader.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(shader.depth.nearer()),
            stencil,
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: shader.sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: (fragment_entry == EDGE_ON_DEPTH || !targets.is_empty()).then(|| {
            wgpu::FragmentState {
                module: &shader.module,
                entry_point: Some(fragment_entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets,
            }
        }),
        multiview_mask: None,
        cache: None,
    })
}
