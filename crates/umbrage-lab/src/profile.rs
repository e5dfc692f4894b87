//! What each light of a frame costs, measured apart from ordinary frames, which stay as they are.
//!
//! Takes what a lab has prepared; gives, light by light, GPU time ([`Lab::time_lights`]), what it draws
//! ([`Counter::count`]) and CPU time ([`Lab::build_times`]). On a GPU that draws tile by tile, software
//! included, a timestamp inside a pass says little; so each light has passes of its own, timed from
//! outside, in which it is drawn several times over, as lights are drawn in a frame one after the
//! other; what the further times take counts.

mod building;
mod counts;
mod timing;

use crate::gpu::Gpu;
#[cfg(doc)]
use crate::lab::Lab;

pub use counts::{Counter, LightCounts};
pub use timing::GpuCost;

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("profile"),
        })
}
