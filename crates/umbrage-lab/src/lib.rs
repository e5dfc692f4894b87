//! A host like a user's: a small deferred renderer around Umbrage, for pictures, checks and
//! benchmarks. It owns the device; the library only borrows it.
#![forbid(unsafe_code)]

pub mod actors;
pub mod application;
pub mod auto_camera;
mod binding;
pub mod camera;
pub mod gbuffer;
pub mod gpu;
pub mod heat;
pub mod lab;
pub mod light_pass;
pub mod method;
pub mod picture;
pub mod profile;
pub mod readback;
pub mod rendering;
pub mod run;
pub mod saved_world;
pub mod seeded_lights;
pub mod spans;
pub mod stage;
pub mod technique;
pub mod timer;

pub use umbrage_core::{Cull, Culls};
pub use umbrage_wgpu::{RenderError, Uploaded, WorldWindows};
