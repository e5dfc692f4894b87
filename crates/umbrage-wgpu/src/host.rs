//! What a host hands over and gets back: options, frames, errors.

use bytemuck::{Pod, Zeroable};
use thiserror::Error;
use umbrage_core::cull::Culls;
use umbrage_core::frame::{Extrusion, FramePlan};
use umbrage_core::place::split;
use umbrage_core::volume::Volumes;
use umbrage_core::{Light, View};
use wgpu::TextureFormat;

use crate::{DepthRange, WorldWindows};

/// What the host's frame looks like.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RendererOptions<'a> {
    /// Colour targets of the pass given to [`ShadowRenderer::record`](crate::ShadowRenderer::record).
    pub color_formats: &'a [Option<TextureFormat>],
    /// Its depth-stencil format; must have a stencil.
    pub depth_stencil_format: TextureFormat,
    /// Its sample count.
    pub sample_count: u32,
    /// Which way its depth runs.
    pub depth: DepthRange,
    /// Whether the device has `DEPTH_CLIP_CONTROL`, and the host's depth pass uses it.
    pub depth_clamp: bool,
    /// As in the options of the plans to come. Made for infinite volumes, a renderer extrudes every
    /// plan's to infinity, which is as right; made for finite ones, it goes by the plan.
    pub extrusion: Extrusion,
    /// What volumes write to the first colour target: nothing, but for debug views.
    pub volume_color: VolumeColor,
    /// In how many windows the worlds to come are: [`WorldWindows::of`] tells what a world needs.
    pub windows: WorldWindows,
}

impl<'a> RendererOptions<'a> {
    /// For these formats, one sample a pixel, reversed depth without clamping, infinite volumes that
    /// write no colour, and worlds of one window an array.
    pub fn new(
        depth_stencil_format: TextureFormat,
        color_formats: &'a [Option<TextureFormat>],
    ) -> Self {
        Self {
            color_formats,
            depth_stencil_format,
            sample_count: 1,
            depth: DepthRange::Reversed,
            depth_clamp: false,
            extrusion: Extrusion::Infinite,
            volume_color: VolumeColor::None,
            windows: WorldWindows::default(),
        }
    }
}

/// What volumes add to the first colour target, which must then be blendable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeColor {
    /// Nothing.
    #[default]
    None,
    /// One to red a fragment that passes the depth test: overdraw.
    Fragments,
    /// One a front face and minus one a back face that passes the depth test: on the z-pass path,
    /// with the eye count added, the casters between the surface and the light, if no cull left any
    /// out.
    Layers,
}

/// Why the renderer cannot do what it is asked.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum RenderError {
    /// The depth-stencil format has no stencil.
    #[error("{0:?} has no stencil: create the depth buffer as Depth32FloatStencil8")]
    NoStencil(TextureFormat),
    /// A buffer would pass a device limit.
    #[error(
        "{what} need {needed} bytes, more than this device's {limit_name} of {limit}: request a \
         device with a higher limit, or draw fewer lights, a smaller picture or a smaller world"
    )]
    BufferTooLarge {
        /// Which buffer.
        what: &'static str,
        /// Bytes needed.
        needed: u64,
        /// What the device calls the limit.
        limit_name: &'static str,
        /// Bytes the device allows.
        limit: u64,
    },
    /// The world would take more storage buffers than can be bound at once.
    #[error(
        "the world, in windows of at most {window} bytes, takes {needed} storage buffers in one \
         shader stage, more than this device's {limit_name} of {limit}: request a device with a \
         higher limit or larger bindings, or draw a smaller world"
    )]
    TooManyWindows {
        /// Bindings needed, those beside the world included.
        needed: u32,
        /// What the device calls the limit.
        limit_name: &'static str,
        /// Bindings the device allows.
        limit: u32,
        /// Bytes that a binding may have.
        window: u64,
    },
    /// The world needs more windows than the renderer was made for.
    #[error(
        "{what} have outgrown the {windows} windows that this renderer was made for: make a new \
         one with the WorldWindows of the world"
    )]
    WorldOutgrown {
        /// Which array.
        what: &'static str,
        /// Windows that there are.
        windows: usize,
    },
    /// The world has residuals, and the renderer was made for one that f32 holds.
    #[error(
        "this renderer was made for worlds that f32 holds, and this world has residuals: make a \
         new one with the WorldWindows of the world"
    )]
    Residuals,
    /// The device has no memory left.
    #[error("no GPU memory for {what} of {bytes} bytes: draw less, or free some")]
    NoMemory {
        /// Which buffer.
        what: &'static str,
        /// Its size.
        bytes: u64,
    },
    /// `prepare` before `upload_world`.
    #[error("no world was uploaded: call upload_world first")]
    NoWorld,
}

/// What is drawn in one frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Frame<'a> {
    /// The eye.
    pub view: &'a View,
    /// As given to the volume builder.
    pub lights: &'a [Light],
    /// Their volumes.
    pub volumes: &'a Volumes,
    /// How each is drawn; made from the three above.
    pub plan: &'a FramePlan,
    /// Which steps skip work on the GPU.
    pub culls: Culls,
}

impl<'a> Frame<'a> {
    /// With every step that skips work.
    pub fn new(
        view: &'a View,
        lights: &'a [Light],
        volumes: &'a Volumes,
        plan: &'a FramePlan,
    ) -> Self {
        Self {
            view,
            lights,
            volumes,
            plan,
            culls: Culls::EVERY,
        }
    }
}

/// Bytes that one [`ShadowRenderer::prepare`](crate::ShadowRenderer::prepare) handed to the queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Uploaded {
    /// Quads and caps.
    pub volume_bytes: u64,
    /// The view, the lights' positions and distances of extrusion, and their scissors and ranges of quads.
    pub other_bytes: u64,
}

/// The uniform behind `struct View` of [`CLIP_WGSL`](crate::CLIP_WGSL).
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ViewUniform {
    eye: [f32; 3],
    scale_x: f32,
    right: [f32; 3],
    scale_y: f32,
    up: [f32; 3],
    near: f32,
    forward: [f32; 3],
    size: [f32; 2],
    origin: [f32; 2],
    reversed: u32,
    eye_residual: [f32; 3],
    padding: f32,
}

impl ViewUniform {
    /// Of a view whose upper left pixel is `origin` of its target.
    pub(crate) fn new(view: &View, origin: [u32; 2], depth: DepthRange) -> Self {
        let [eye, eye_residual] = split(view.eye);
        Self {
            eye: eye.to_array(),
            scale_x: view.scale_x,
            right: view.right.to_array(),
            scale_y: view.scale_y,
            up: view.up.to_array(),
            near: view.near,
            forward: view.forward.to_array(),
            size: view.size.map(|side| side as f32),
            origin: origin.map(|side| side as f32),
            reversed: u32::from(depth == DepthRange::Reversed),
            eye_residual: eye_residual.to_array(),
            padding: 0.0,
        }
    }
}
