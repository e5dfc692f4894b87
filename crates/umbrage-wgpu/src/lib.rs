//! Records an Umbrage frame plan into a host's wgpu render pass.
//!
//! The host owns device, queue, encoder, depth buffer and the light shading. Three phases:
//! *create* ([`ShadowRenderer::new`]), *prepare* ([`ShadowRenderer::upload_world`],
//! [`ShadowRenderer::prepare`]) and *record* ([`ShadowRenderer::find_receivers`] after the depth pass,
//! [`ShadowRenderer::record`] in the light pass).
//!
//! Requirements on the host's frame:
//! - its depth pass computes clip positions with [`CLIP_WGSL`] from what [`ShadowRenderer::world_wgsl`] reads,
//!   reversed-Z, infinite far plane, compare `Greater`, `unclipped_depth` where depth clamping is
//!   available, both sides of every triangle drawn;
//! - the pass given to `record` has that depth (read only) and a stencil that is zero.
#![forbid(unsafe_code)]

mod buffers;
mod faces;
mod host;
mod pipelines;
mod receivers;
mod renderer;
mod split;
mod windows;
mod world;

pub use buffers::{captured, check_storage};
pub use faces::{CountStep, FaceOptions, VolumeFaces};
pub use host::{Frame, RenderError, RendererOptions, Uploaded, ViewUniform, VolumeColor};
pub use receivers::{Call, LightCalls};
pub use renderer::{LIGHT_STENCIL, ShadowRenderer};
pub use windows::WorldWindows;

/// WGSL of `struct View` and `umbrage_clip`, for the host's own shaders. The layout of the
/// uniform is [`ViewUniform`].
pub const CLIP_WGSL: &str = include_str!("shaders/clip.wgsl");

/// WGSL of `umbrage_light_corner`, for the vertex shaders of the host's light draws; goes with
/// [`CLIP_WGSL`], and reads [`ShadowRenderer::light_bind_group`] at bind group number `group`.
pub fn light_wgsl(group: u32) -> String {
    include_str!("shaders/light.wgsl").replace("UMBRAGE_LIGHT_GROUP", &group.to_string())
}

const VOLUME_WGSL: &str = include_str!("shaders/volume.wgsl");
