//! Volumes drawn in two halves, for hosts that count elsewhere than in the stencil: the faces that
//! raise the count of casters before a surface, and those that lower it, each with a blend and
//! stencil state of the host's own.
//!
//! Takes a plan's light; draws the same quads and caps as [`ShadowRenderer::record`], in the same
//! places and with the same depth test. On the z-pass path front faces raise and back faces lower,
//! where they are in front of the surface; on the z-fail path it is the other way round, where they
//! are not. Raising minus lowering faces, plus the eye count of a z-pass light, is the stencil's
//! count.

use umbrage_core::frame::LightPlan;
use wgpu::{
    ColorTargetState, CompareFunction, DepthBiasState, DepthStencilState, Device, Face, RenderPass,
    RenderPipeline, StencilFaceState, StencilState,
};

use crate::ShadowRenderer;
use crate::pipelines::VolumeShader;

/// Which faces of volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountStep {
    /// Those that raise the count by one.
    Raise,
    /// Those that lower it by one.
    Lower,
    /// All of them, before the surface and behind it: what there is to rasterise. For measuring.
    Cover,
}

/// What faces do where they count.
#[derive(Clone, Copy, Debug)]
pub struct FaceOptions<'a> {
    /// Which faces.
    pub step: CountStep,
    /// The pass's colour targets. Fragments are 1 in all channels; what becomes of that is up to
    /// blend state and blend constant.
    pub targets: &'a [Option<ColorTargetState>],
    /// What becomes of the stencil. Faces that do not count there fail the depth test.
    pub stencil: StencilFaceState,
}

/// Pipelines that draw one half of volumes, for [`ShadowRenderer::record_faces`].
#[derive(Debug)]
pub struct VolumeFaces {
    zpass_sides: RenderPipeline,
    zfail_sides: RenderPipeline,
    zfail_caps: RenderPipeline,
    zfail_reversed_caps: RenderPipeline,
}

impl ShadowRenderer {
    /// Pipelines for passes that have this renderer's depth-stencil format and sample count, and
    /// the colour targets of `options`.
    pub fn faces(&self, device: &Device, options: &FaceOptions<'_>) -> VolumeFaces {
        let shader = self.shared().shader();
        let [fronts, backs] = [Face::Back, Face::Front].map(Some);
        let [in_front, behind, behind_reversed] = match options.step {
            CountStep::Raise => [fronts, backs, fronts],
            CountStep::Lower => [backs, fronts, backs],
            CountStep::Cover => [None; 3],
        };
        let [nearer, not_nearer] = match options.step {
            CountStep::Cover => [CompareFunction::Always; 2],
            _ => [shader.depth.nearer(), shader.depth.not_nearer()],
        };
        let build =
            |entry, culled, compare| pipeline(device, shader, options, entry, culled, compare);
        VolumeFaces {
            zpass_sides: build("side", in_front, nearer),
            zfail_sides: build("zfail_side", behind, not_nearer),
            zfail_caps: build("cap", behind, not_nearer),
            zfail_reversed_caps: build("cap", behind_reversed, not_nearer),
        }
    }

    /// Draws these faces of light number `number`, of whose plan `light` is, over the scissor that
    /// is set.
    pub fn record_faces(
        &self,
        pass: &mut RenderPass<'_>,
        faces: &VolumeFaces,
        number: usize,
        light: &LightPlan,
    ) {
        let sides = [&faces.zpass_sides, &faces.zfail_sides];
        let caps = [&faces.zfail_caps, &faces.zfail_reversed_caps].map(std::slice::from_ref);
        self.view().draw_volume(pass, number, light, sides, caps);
    }
}

fn pipeline(
    device: &Device,
    shader: &VolumeShader,
    options: &FaceOptions<'_>,
    entry_point: &str,
    culled: Option<Face>,
    depth_compare: CompareFunction,
) -> RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("umbrage faces"),
        layout: Some(&shader.layout),
        vertex: wgpu::VertexState {
            module: &shader.module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &shader.constants(),
                ..Default::default()
            },
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: culled,
            unclipped_depth: shader.depth_clamp,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(DepthStencilState {
            format: shader.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(depth_compare),
            stencil: StencilState {
                front: options.stencil,
                back: options.stencil,
                read_mask: 0xff,
                write_mask: 0xff,
            },
            bias: DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: shader.sample_count,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: &shader.module,
            entry_point: Some("one"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: options.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
