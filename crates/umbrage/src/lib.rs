//! Exact real-time shadows from hundreds of lights, without ray-tracing hardware.
#![forbid(unsafe_code)]

pub use umbrage_core::{frame, light, mesh, volume, world};
pub use umbrage_core::{Casting, Light, LightShape, Mesh, View};
pub use umbrage_wgpu as wgpu_renderer;
pub use umbrage_wgpu::{CLIP_WGSL, RenderError, RendererOptions, ShadowRenderer, ViewUniform, VolumeColor};
