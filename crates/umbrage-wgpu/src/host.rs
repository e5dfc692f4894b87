//! What a host hands over and gets back: options, frames, errors.

use bytemuck::{Pod, Zeroable};
use thiserror::Error;
use umbrage_core::cull::Culls;
use umbrage_core::frame::{Extrusion, FramePlan};
use umbrage_core::place::split;
use umbrage_core::volume::Volumes;
use umbrage_core::{Light, View};
use wgpu::TextureFormat;

/// What the host's frame looks like.
#[derive(Clone, Debug)]
pub struct RendererOptions<'a> {
    /// Colour targets of the pass given to [`ShadowRenderer::record`](crate::ShadowRenderer::record).
    pub color_formats: &'a [Option<TextureFormat>],
    /// Its depth-stencil format; must have a stencil.
    pub depth_stencil_format: TextureFormat,
    /// Its sample count.
    pub sample_count: u32,
    /// Whether the device has `DEPTH_CLIP_CONTROL`, and the host's depth pass uses it.
    pub depth_clamp: bool,
    /// As in the options of the plans to come. Made for infinite volumes, a renderer extrudes every
    /// plan's to infinity, which is as right; made for finite ones, it goes by the plan.
    pub extrusion: Extrusion,
    /// What volumes write to the first colour target: nothing, but for debug views.
    pub volume_color: VolumeColor,
}

/// What volumes add to the first colour target, which must then be blendable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeColor {
    /// Nothing.
    #[default]
    None,
    /// One a fragment that passes the depth test: overdraw.
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
        "{what} need {needed} bytes; this device binds at most {limit}: \
         request a higher max_storage_buffer_binding_size, or split the world"
    )]
    BufferTooLarge {
        /// Which buffer.
        what: &'static str,
        /// Bytes needed.
        needed: u64,
        /// Bytes the device allows.
        limit: u64,
    },
    /// `prepare` before `upload_world`.
    #[error("no world was uploaded: call upload_world first")]
    NoWorld,
}

/// What is drawn in one frame.
#[derive(Clone, Copy, Debug)]
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

/// Bytes that one [`ShadowRenderer::prepare`](crate::ShadowRenderer::prepare) handed to the queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uploaded {
    /// Quads and caps.
    pub volume_bytes: u64,
    /// The view, the lights' positions and distances of extrusion, and their scissors and ranges of quads.
    pub other_bytes: u64,
}

/// The uniform behind `struct View` of [`CLIP_WGSL`](crate::CLIP_WGSL).
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ViewUniform {
    eye: [f32; 3],
    scale_x: f32,
    right: [f32; 3],
    scale_y: f32,
    up: [f32; 3],
    near: f32,
    forward: [f32; 3],
    width: f32,
    height: f32,
    vertex_floats: u32,
    unused: [f32; 2],
    eye_residual: [f32; 3],
    padding: f32,
}

impl ViewUniform {
    /// `vertex_floats`: f32 values of a vertex in the buffer of positions.
    pub(crate) fn new(view: &View, vertex_floats: u32) -> Self {
        let [eye, eye_residual] = split(view.eye);
        Self {
            eye: eye.to_array(),
            scale_x: view.scale_x,
            right: view.right.to_array(),
            scale_y: view.scale_y,
            up: view.up.to_array(),
            near: view.near,
            forward: view.forward.to_array(),
            width: view.size[0] as f32,
            height: view.size[1] as f32,
            vertex_floats,
            unused: [0.0; 2],
            eye_residual: eye_residual.to_array(),
            padding: 0.0,
        }
    }
}
