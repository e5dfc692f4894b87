//! Exact real-time shadows from hundreds of lights, without ray-tracing hardware.
//!
//! Hand over triangles, build a [`World`], and for each light get a closed shadow volume from
//! whatever triangles its range touches: any polygon soup, any subset, no demands on the mesh.
//!
//! # On the CPU: lights to volumes
//!
//! ```
//! use glam::Vec3;
//! use umbrage::{Casting, Light, LightShape, Mesh, Volumes, VolumeBuilder, World};
//!
//! // One triangle, floating: an open mesh casts a closed shadow all the same.
//! let mesh = Mesh {
//!     positions: vec![Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 0.0)],
//!     triangles: vec![[0, 1, 2]],
//!     casting: vec![Casting::Both],
//! };
//! let world = World::build(&mesh)?;
//! let light = Light { position: Vec3::new(0.2, 3.0, 0.2), range: 10.0, shape: LightShape::Point };
//!
//! let mut builder = VolumeBuilder::default();
//! let mut volumes = Volumes::default();
//! builder.build(&world, &[light], |_| true, &mut volumes);
//!
//! assert_eq!(volumes.quads_of(0).len(), 3);
//! volumes.check_closed(&world).expect("closed by construction");
//! # Ok::<(), umbrage::WorldError>(())
//! ```
//!
//! Building a world takes about a second for a million triangles; [`World::save`] keeps it in a
//! file that [`World::open`] maps in milliseconds, if it is still that of the same
//! [`Mesh::fingerprint`].
//!
//! # In a frame: volumes to a shadow mask
//!
//! The host owns device, queue, encoder and depth buffer. Its depth pass computes clip positions
//! with [`CLIP_WGSL`] from the world's buffers ([`ShadowRenderer::world_buffers`]), so that depth
//! agrees with the volumes to the last bit. Then, in one pass for all lights:
//!
//! ```no_run
//! # use umbrage::*;
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue, pass: &mut wgpu::RenderPass<'_>,
//! #     renderer: &mut ShadowRenderer, world: &World, lights: &[Light], volumes: &Volumes,
//! #     view: &View) -> Result<(), RenderError> {
//! let mut plan = FramePlan::default();
//! plan.make(world, lights, volumes, view, &PlanOptions::default());
//! renderer.prepare(device, queue, view, lights, volumes, &plan)?;
//! renderer.record(pass, &plan, 0..lights.len(), |pass, light, _| {
//!     // Scissor and stencil stand ready: set the host's own light pipeline, made with
//!     // `renderer.light_depth_stencil()`, and draw light number `light` over the screen.
//! #   let _ = (pass, light);
//! });
//! # Ok(())
//! # }
//! ```
//!
//! `umbrage-lab` in the repository is such a host, a few hundred lines long.
#![forbid(unsafe_code)]

pub use umbrage_core::frame::{
    self, FramePlan, LightPath, LightPlan, PathRule, PlanOptions, Rect, SkipReason, ZFailReason,
};
pub use umbrage_core::volume::{self, VolumeBuilder, Volumes};
pub use umbrage_core::world::{
    self, ObjectError, ObjectId, Pose, SavedWorldError, World, WorldError, WorldReport,
};
pub use umbrage_core::{Casting, Cull, Culls, Fingerprint, Light, LightShape, Mesh, View};
pub use umbrage_wgpu::{
    CLIP_WGSL, Frame, LIGHT_STENCIL, LightCalls, RenderError, RendererOptions, ShadowRenderer,
    Uploaded, ViewUniform, VolumeColor, light_wgsl,
};
