//! How a light's shader reads its mask: the texel of its pixel, or filtered from a smaller layer.

use super::slots::SLOT_WGSL;
use crate::binding::{STORAGE, bind, buffer, layout, texture};
use crate::gpu::Gpu;

/// How lights read their masks.
#[derive(Debug)]
pub(crate) struct MaskReading {
    pub(crate) layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
}

impl MaskReading {
    /// For any stack of layers.
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let types = [
            texture(
                wgpu::TextureSampleType::Float { filterable: true },
                wgpu::TextureViewDimension::D2Array,
            ),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            buffer(STORAGE),
        ];
        Self {
            layout: layout(gpu, "masks", wgpu::ShaderStages::FRAGMENT, types),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("masks"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
        }
    }

    /// The shader's part for masks at full resolution, or at a lower one.
    pub(crate) fn wgsl(divisor: u32) -> String {
        let read = match divisor {
            1 => "textureLoad(masks, vec2i(pixel), slot.layer, 0)",
            _ => "textureSampleLevel(masks, mask_sampler, uv, slot.layer, 0.0)",
        };
        let reading = include_str!("../../shaders/mask_reading.wgsl");
        format!("{SLOT_WGSL}\n{}", reading.replace("READ_MASKS", read))
    }

    /// Binds a stack of layers and the lights' slots in it.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        masks: &wgpu::Texture,
        slots: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let view = masks.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        let resources = [
            wgpu::BindingResource::TextureView(&view),
            wgpu::BindingResource::Sampler(&self.sampler),
            slots.as_entire_binding(),
        ];
        bind(gpu, "masks", &self.layout, resources)
    }
}
