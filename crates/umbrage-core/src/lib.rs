//! The geometry half of Umbrage: triangles in, frame plans out. No GPU.
//!
//! Data flows one way: a [`Mesh`] becomes a [`World`](world::World) (welded vertices, unique
//! edges, BVH order); each [`Light`] queries it for a subset of triangles; signed edge counters
//! turn the subset into silhouette quads ([`volume`]); [`frame`] decides per view how each light
//! is drawn. Positions are f64: vertices are kept as two f32 ([`place`]) where one is not enough, lights
//! and eyes as they are.
//!
//! # Lights to volumes
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use umbrage_core::volume::{VolumeBuilder, Volumes};
//! use umbrage_core::world::World;
//! use umbrage_core::{Casting, Light, LightShape, Mesh};
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
//! # Ok::<(), umbrage_core::world::WorldError>(())
//! ```
//!
//! Volumes do not depend on the eye, and are kept: the next `build` builds only lights that changed
//! or in whose range something moved. Objects are inserted with a pose, moved, and removed:
//!
//! ```
//! # use umbrage_core::volume::{VolumeBuilder, Volumes};
//! # use umbrage_core::world::{Pose, World};
//! # use umbrage_core::{Casting, Light, LightShape, Mesh};
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
//! Building a world takes about a second for a million triangles; [`World::save`](world::World::save)
//! keeps it in a file that [`World::open`](world::World::open) maps in milliseconds, if it is still
//! that of the same [`Mesh::fingerprint`].
#![deny(unsafe_code)]

pub mod cull;
mod fingerprint;
pub mod frame;
mod lanes64;
pub mod light;
pub mod mesh;
pub mod place;
mod stamp;
pub mod volume;
pub mod world;

pub use cull::{Cull, Culls};
pub use fingerprint::Fingerprint;
pub use frame::view::View;
pub use lanes64::InstructionSet;
pub use light::{Light, LightShape};
pub use mesh::{Casting, Mesh};
