//! Exact real-time shadows from hundreds of lights, without ray-tracing hardware: a library that
//! borrows your [wgpu] device, queue, encoder and depth buffer, and leaves each light's shadow in the
//! stencil while you draw that light, or all of them in a mask texture.
//!
//! # Once
//!
//! Hand over triangles, in slices as you have them; any polygon soup will do. What stays is built
//! into a [`World`]; what moves is inserted, and moved by handle. Lights are a set with handles too.
//! Points and directions are taken from arrays, and from what turns into them (mint, glam, nalgebra).
//!
//! ```
//! use umbrage::{Casting, Light, Lights, Mesh, Pose, World};
//!
//! let floor = [[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0]];
//! let sail = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
//! let mut world = World::build(&[Mesh::new(&floor, &[0, 1, 2, 0, 2, 3])])?;
//! let boat = world.insert(
//!     &Mesh::new(&sail, &[0, 1, 2]).casting(&[Casting::Both]),
//!     &Pose::at([0.0, 1.0, 0.0]),
//! )?;
//! let mut lights = Lights::default();
//! let lamp = lights.insert(Light::point([2.0, 5.0, 1.0], 20.0))?;
//! # Ok::<(), umbrage::Error>(())
//! ```
//!
//! The renderer is created on your device, for your formats. What it cannot do is an error here.
//!
//! ```no_run
//! # use umbrage::*;
//! # fn once(adapter: &wgpu::Adapter, device: &wgpu::Device, world: &World) -> Result<(), Error> {
//! // When you open the device: adapter.features() & Shadows::features().
//! let depth_stencil = wgpu::TextureFormat::Depth32FloatStencil8;
//! let light_target = wgpu::TextureFormat::Rgba16Float;
//! let host = Host::new(depth_stencil, &[Some(light_target)]);
//! let shadows = Shadows::new(device, world, &host)?;
//! let eye = shadows.view(device)?; // one a camera, mirror, or half of a split screen
//! # Ok(())
//! # }
//! ```
//!
//! # Your depth pass
//!
//! Depth must agree with the shadow volumes to the last bit, so both come from the same WGSL over the
//! same arrays: put [`Shadows::wgsl`] before your shader, and take clip positions from
//! `umbrage_world_corner`. [`World::sources`] tells which of your triangles each one is.
//!
//! ```no_run
//! # use umbrage::*;
//! # fn pipeline(device: &wgpu::Device, shadows: &Shadows) -> wgpu::RenderPipeline {
//! let source = shadows.wgsl(0) + "
//!     struct Varying { @builtin(position) @invariant clip: vec4f, @location(0) normal: vec3f }
//!
//!     @vertex
//!     fn surface(@builtin(vertex_index) index: u32) -> Varying {
//!         let corner = umbrage_world_corner(index);
//!         return Varying(corner.clip, corner.normal);
//!     }";
//! # let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
//! #     label: None, source: wgpu::ShaderSource::Wgsl(source.into()) });
//! # let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
//! #     label: None, bind_group_layouts: &[Some(shadows.world_layout())], immediate_size: 0 });
//! device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
//!     layout: Some(&layout), // shadows.world_layout() at group 0
//!     primitive: shadows.depth_primitive(),
//!     depth_stencil: Some(shadows.depth_stencil()),
//!     // ...
//! #   label: None, fragment: None, cache: None, multiview_mask: None,
//! #   multisample: wgpu::MultisampleState::default(),
//! #   vertex: wgpu::VertexState { module: &module, entry_point: Some("surface"), buffers: &[],
//! #       compilation_options: wgpu::PipelineCompilationOptions::default() },
//! })
//! # }
//! ```
//!
//! # In a frame
//!
//! ```no_run
//! # use umbrage::*;
//! # struct Host { device: wgpu::Device, queue: wgpu::Queue, depth: wgpu::Texture,
//! #     surface_pipeline: wgpu::RenderPipeline, light_pipeline: wgpu::RenderPipeline }
//! # fn depth_pass<'e>(_: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> { todo!() }
//! # fn light_pass<'e>(_: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> { todo!() }
//! # fn frame(host: &Host, shadows: &mut Shadows, eye: &mut ShadowView, world: &mut World,
//! #     lights: &Lights, boat: Object) -> Result<(), Error> {
//! # let Host { device, queue, depth, surface_pipeline, light_pipeline } = host;
//! # let mut encoder = device.create_command_encoder(&Default::default());
//! // What moved is built again, and nothing else.
//! world.place(boat, &Pose::at([0.5, 1.0, 0.0]))?;
//! let view = View::look_at([0.0, 3.0, 8.0], [0.0, 1.0, 0.0], 1.0, 0.05, [1280, 720]);
//! let stats = shadows.prepare(device, queue, world, lights, [(&mut *eye, view)])?;
//!
//! let mut pass = depth_pass(&mut encoder); // clears to shadows.depth_clear(), and stencil 0
//! pass.set_pipeline(surface_pipeline);
//! pass.set_bind_group(0, eye.world(), &[]);
//! pass.draw(world.corners(), 0..1);
//! drop(pass);
//! shadows.find_receivers(device, &mut encoder, eye, depth)?;
//!
//! let mut pass = light_pass(&mut encoder);
//! shadows.record(&mut pass, eye, |pass, light| {
//!     // The stencil test stands: what you draw now is lit. Your pipeline has shadows.light_stencil(),
//!     // adds to the target, and places vertices with `umbrage_light_corner(index, light)`.
//!     pass.set_pipeline(light_pipeline);
//!     pass.set_bind_group(0, eye.lights(), &[]);
//!     eye.draw_light(pass, light);
//! })?;
//! # Ok(())
//! # }
//! ```
//!
//! # A mask instead
//!
//! Forward+ and deferred engines that shade all lights at once take a [`ShadowMask`]: one bit a light
//! and pixel, 32 lights a texel, in place of the light pass above.
//!
//! ```no_run
//! # use umbrage::*;
//! # fn frame(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, shadows: &Shadows,
//! #     eye: &ShadowView, depth: &wgpu::Texture, lights: &Lights) -> Result<(), Error> {
//! // Once, for Host::with_mask, and again when the target or the set of lights grows.
//! let mask = shadows.mask(device, [1280, 720], lights.slots())?;
//! // Each frame, after find_receivers.
//! shadows.record_mask(encoder, eye, depth, &mask)?;
//! // In your shader: umbrage_lit(mask, vec2i(position.xy), light)
//! let source = String::from(ShadowMask::WGSL);
//! # Ok(())
//! # }
//! ```
//!
//! # Depth, samples, viewports, several views
//!
//! [`Host`] says how your depth runs and how many samples a pixel has. [`View::viewport_at`] draws
//! into a part of a target. Several views are several [`ShadowView`]s, given to one
//! [`Shadows::prepare`] together; volumes do not depend on the eye, and are shared.
//!
//! The `examples` folder of the repository has whole programs: `host_depth` (a small deferred
//! renderer), `mask_texture` (forward+), `dynamic` (moving objects and lights).
#![forbid(unsafe_code)]

mod error;
mod host;
mod lights;
mod mask;
mod mesh;
mod shadow_view;
mod shadows;
mod stats;
mod view;
mod world;

pub use umbrage_core::Casting;
pub use wgpu;

pub use error::Error;
pub use host::Host;
pub use lights::{Light, LightId, Lights};
pub use mask::ShadowMask;
pub use mesh::Mesh;
pub use shadow_view::ShadowView;
pub use shadows::Shadows;
pub use stats::FrameStats;
pub use view::View;
pub use world::{Object, Pose, World};

/// Hosts share worlds, and record on several threads.
const _: () = {
    const fn is_send_and_sync<T: Send + Sync>() {}
    is_send_and_sync::<(World, Lights, Shadows, ShadowView, ShadowMask, Error)>();
};
