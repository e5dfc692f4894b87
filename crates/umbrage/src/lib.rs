//! Exact real-time shadows from hundreds of lights, without ray-tracing hardware.
//!
//! Hand over triangles, build a [`World`], and for each light get a closed shadow volume from
//! whatever triangles its range touches: any polygon soup, any subset, no demands on the mesh.
//!
//! # On the CPU: lights to volumes
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use umbrage::{Casting, Light, LightShape, Mesh, Volumes, VolumeBuilder, World};
//!
//! // One triangle, floating: an open mesh casts a closed shadow all the same.
//! let mesh = Mesh {
//!     positions: vec![Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 0.0)],
//!     triangles: vec![[0, 1, 2]],
//!     casting: vec![Casting::Both],
//!     ..Mesh::default()
//! };
//! let world = World::build(&mesh)?;
//! let light = Light { position: DVec3::new(0.2, 3.0, 0.2), range: 10.0, shape: LightShape::Point };
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
//! Volumes do not depend on the eye, and are kept: the next `build` builds only lights that changed
//! or in whose range something moved. Objects are inserted with a pose, moved, and removed:
//!
//! ```
//! # use umbrage::*;
//! # use glam::{DVec3, Vec3};
//! # let mut world = World::build(&Mesh::default())?;
//! # let mesh = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z], triangles: vec![[0, 2, 1]],
//! #     casting: vec![Casting::Both], ..Mesh::default() };
//! # let lights = [Light { position: DVec3::Y, range: 5.0, shape: LightShape::Point }; 3];
//! # let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
//! let door = world.insert(&mesh, &Pose::at(DVec3::ZERO))?;
//! assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 3);
//! builder.settle(&world, &lights, |_| true, &mut volumes); // leave out hidden casters now
//! assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 0);
//! world.pose(door, &Pose::at(DVec3::new(40.0, 0.0, 0.0)))?;
//! assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 3); // it was near them
//! world.remove(door)?;
//! assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 0); // and then far away
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Building a world takes about a second for a million triangles; [`World::save`] keeps it in a
//! file that [`World::open`] maps in milliseconds, if it is still that of the same
//! [`Mesh::fingerprint`].
//!
//! # In a frame: volumes to a shadow mask
//!
//! The host owns device, queue, encoder and depth buffer. Its depth pass computes clip positions
//! with [`CLIP_WGSL`] from what [`ShadowRenderer::world_wgsl`] reads ([`ShadowRenderer::world_bind_group`]), so that
//! depth agrees with the volumes to the last bit. Then, in one pass for all lights:
//!
//! ```no_run
//! # use umbrage::*;
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder,
//! #     depth: &wgpu::TextureView, renderer: &mut ShadowRenderer, world: &World, lights: &[Light],
//! #     volumes: &Volumes, view: &View, light_pipeline: &wgpu::RenderPipeline)
//! #     -> Result<(), RenderError> {
//! # fn your_depth_pass(_: &mut wgpu::CommandEncoder) {}
//! # fn your_light_pass(_: &mut wgpu::CommandEncoder) -> wgpu::RenderPass<'_> { todo!() }
//! let (mut plan, culls) = (FramePlan::default(), Culls::EVERY);
//! plan.make(world, lights, volumes, view, &PlanOptions::default());
//! renderer.upload_world(device, queue, world)?; // what changed of it, if anything
//! let frame = Frame { view, lights, volumes, plan: &plan, culls };
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
//!
//! `umbrage-lab` in the repository is such a host, a few hundred lines long.
#![forbid(unsafe_code)]

pub use umbrage_core::frame::{
    self, Distance, Extrusion, FramePlan, LightPath, LightPlan, PathRule, PlanOptions, Rect,
    SkipReason, ZFailReason,
};
pub use umbrage_core::place;
pub use umbrage_core::volume::{self, Construction, VolumeBuilder, Volumes};
pub use umbrage_core::world::{
    self, ObjectError, ObjectId, Pose, SavedWorldError, World, WorldError, WorldReport,
};
pub use umbrage_core::{Casting, Cull, Culls, Fingerprint, Light, LightShape, Mesh, View};
pub use umbrage_wgpu::{
    CLIP_WGSL, Call, CountStep, FaceOptions, Frame, LIGHT_STENCIL, LightCalls, RenderError,
    RendererOptions, ShadowRenderer, Uploaded, ViewUniform, VolumeColor, VolumeFaces, WorldWindows,
    captured, check_storage, light_wgsl,
};
