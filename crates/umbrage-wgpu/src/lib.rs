//! Records an Umbrage frame plan into a host's wgpu render pass.
//!
//! The host owns device, queue, encoder, depth buffer and the light shading. Three phases:
//! *create* ([`ShadowRenderer::new`]), *prepare* ([`ShadowRenderer::upload_world`],
//! [`ShadowRenderer::prepare`]) and *record* ([`ShadowRenderer::find_receivers`] after the depth pass,
//! [`ShadowRenderer::record`] in the light pass).
//!
//! A [`ShadowRenderer`] is for one view a submission. Hosts with several keep one
//! [`SharedShadows`], with pipelines, world and silhouettes, and one [`ViewShadows`] a view.
//!
//! Requirements on the host's frame:
//! - its depth pass takes clip positions from `umbrage_world_corner` of
//!   [`ShadowRenderer::world_wgsl`], compares with [`DepthRange::nearer`], has `unclipped_depth`
//!   where depth clamping is available, and draws both sides of every triangle;
//! - the pass given to `record` has that depth (read only) and a stencil that is zero.
//!
//! ```no_run
//! # use umbrage_core::frame::{FramePlan, PlanOptions};
//! # use umbrage_core::{Light, View, volume::Volumes, world::World};
//! # use umbrage_wgpu::{Frame, RenderError, ShadowRenderer};
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder,
//! #     depth: &wgpu::TextureView, renderer: &mut ShadowRenderer, world: &World, lights: &[Light],
//! #     volumes: &Volumes, view: &View, light_pipeline: &wgpu::RenderPipeline)
//! #     -> Result<(), RenderError> {
//! # fn your_depth_pass(_: &mut wgpu::CommandEncoder) {}
//! # fn your_light_pass(_: &mut wgpu::CommandEncoder) -> wgpu::RenderPass<'_> { todo!() }
//! let mut plan = FramePlan::default();
//! plan.make(world, lights, volumes, view, &PlanOptions::default());
//! renderer.upload_world(device, queue, world)?; // what changed of it, if anything
//! let frame = Frame::new(view, lights, volumes, &plan);
//! renderer.prepare(device, queue, &frame)?;
//! your_depth_pass(encoder);
//! renderer.find_receivers(device, encoder, depth, None);
//! let mut pass = your_light_pass(encoder);
//! renderer.record(&mut pass, &plan, 0..lights.len(), |pass, light, _| {
//!     // Scissor and stencil stand ready. Your pipeline has `renderer.light_depth_stencil()`, and
//!     // places its vertices with `umbrage_light_corner` of `light_wgsl`.
//!     pass.set_pipeline(light_pipeline);
//!     pass.set_bind_group(0, renderer.light_bind_group(), &[]);
//!     renderer.draw_light(pass, light);
//! });
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

mod buffers;
mod depth;
mod faces;
mod host;
mod pipelines;
mod receivers;
mod record;
mod renderer;
mod shared;
mod split;
mod view;
mod windows;
mod world;

pub use buffers::{captured, check_storage};
pub use depth::DepthRange;
pub use faces::{CountStep, FaceOptions, VolumeFaces};
pub use host::{Frame, RenderError, RendererOptions, Uploaded, VolumeColor};
pub use pipelines::VolumePipelines;
pub use receivers::{Call, LightCalls};
pub use renderer::ShadowRenderer;
pub use shared::{LIGHT_STENCIL, SharedShadows};
pub use view::ViewShadows;
pub use windows::WorldWindows;

/// WGSL of `struct View` and `umbrage_clip`, for the host's own shaders.
pub const CLIP_WGSL: &str = include_str!("shaders/clip.wgsl");

/// WGSL of `umbrage_light_corner`, for the vertex shaders of the host's light draws; goes with
/// [`CLIP_WGSL`], and reads [`ShadowRenderer::light_bind_group`] at bind group number `group`.
pub fn light_wgsl(group: u32) -> String {
    include_str!("shaders/light.wgsl").replace("UMBRAGE_LIGHT_GROUP", &group.to_string())
}

const VOLUME_WGSL: &str = include_str!("shaders/volume.wgsl");
