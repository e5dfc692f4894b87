//! How a light's shader reads its mask: the texel of its pixel, or filtered from a smaller layer.

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
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let slots = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        Self {
            layout: gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some("masks"),
                    entries: &[entry(0, texture), entry(1, sampler), entry(2, slots)],
                }),
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
        include_str!("../../shaders/mask_reading.wgsl").replace("READ_MASKS", read)
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
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("masks"),
            layout: &self.layout,
            entries: &entries,
        })
    }
}
