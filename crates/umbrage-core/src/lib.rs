//! The geometry half of Umbrage: triangles in, frame plans out. No GPU.
//!
//! Data flows one way: a [`Mesh`] becomes a [`World`](world::World) (welded vertices, unique
//! edges, BVH order); each [`Light`] queries it for a subset of triangles; signed edge counters
//! turn the subset into silhouette quads ([`volume`]); [`frame`] decides per view how each light
//! is drawn. Positions are f64: vertices are kept as two f32 ([`place`]) where one is not enough, lights
//! and eyes as they are.
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
