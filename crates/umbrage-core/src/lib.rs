//! The geometry half of Umbrage: triangles in, frame plans out. No GPU.
//!
//! Data flows one way: a [`Mesh`] becomes a [`World`](world::World) (welded vertices, unique
//! edges, BVH order); each [`Light`] queries it for a subset of triangles; signed edge counters
//! turn the subset into silhouette quads ([`volume`]); [`frame`] decides per view how each light
//! is drawn. Positions are f32, relative to one f64 world origin.
#![deny(unsafe_code)]

pub mod cull;
mod fingerprint;
pub mod frame;
mod lanes64;
pub mod light;
pub mod mesh;
mod stamp;
pub mod volume;
pub mod world;

pub use cull::{Cull, Culls};
pub use fingerprint::Fingerprint;
pub use frame::view::View;
pub use lanes64::InstructionSet;
pub use light::{Light, LightShape};
pub use mesh::{Casting, Mesh};
