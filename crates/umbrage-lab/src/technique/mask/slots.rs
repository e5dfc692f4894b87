//! Where each light's mask is kept: a layer and a channel, and the value it starts from.

use crate::gpu::Gpu;
use bytemuck::{Pod, Zeroable};
use umbrage_core::frame::{FramePlan, LightPath};

use super::pack::Placed;
use super::plan::MaskPlan;

/// `struct Slot` of the shaders.
pub(crate) const SLOT_WGSL: &str = include_str!("../../shaders/mask_slot.wgsl");

/// One of them.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Slot {
    pub(crate) layer: u32,
    pub(crate) channel: u32,
    pub(crate) start: f32,
    /// What is left in the shadow.
    pub(crate) dark: f32,
}

impl Slot {
    /// A slot for each light of a frame's plan, those that are drawn as placed.
    pub(crate) fn all(
        frame: &FramePlan,
        plan: MaskPlan,
        placed: impl Iterator<Item = Placed>,
    ) -> Vec<Self> {
        let mut slots = vec![Self::default(); frame.lights.len().max(1)];
        for place in placed {
            let eye_count = match frame.lights[place.number].path {
                LightPath::ZPass { eye_count } => eye_count,
                _ => 0,
            };
            slots[place.number] = Self {
                layer: place.layer,
                channel: place.channel,
                start: plan.start(eye_count),
                dark: plan.dark(),
            };
        }
        slots
    }

    /// On the GPU.
    pub(crate) fn upload(gpu: &Gpu, slots: &[Self]) -> wgpu::Buffer {
        gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("mask slots"),
            contents: bytemuck::cast_slice(slots),
            usage: wgpu::BufferUsages::STORAGE,
        })
    }
}
