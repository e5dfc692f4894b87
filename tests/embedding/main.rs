//! The facade as a host uses it: its examples, its masks against its callbacks and the oracle, and
//! what it refuses. Only the public API of `umbrage` draws here; the lab supplies scenes and judge.
#![allow(clippy::duplicate_mod)] // each example has the common module for itself

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code)] // its main
#[path = "../../examples/dynamic.rs"]
mod dynamic;
mod errors;
mod examples;
#[allow(dead_code)] // its main
#[path = "../../examples/headless.rs"]
mod headless;
mod host;
#[allow(dead_code)] // its main
#[path = "../../examples/host_depth.rs"]
mod host_depth;
#[allow(dead_code)] // its main
#[path = "../../examples/mask_texture.rs"]
mod mask_texture;
mod masks;
mod worlds;
