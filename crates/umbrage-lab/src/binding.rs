//! Bind groups whose bindings are numbered in order, and their layouts.

use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, BindingType, BufferBindingType, ShaderStages,
};

use crate::gpu::Gpu;

/// Of these types.
pub(crate) fn layout<const N: usize>(
    gpu: &Gpu,
    label: &str,
    visibility: ShaderStages,
    types: [BindingType; N],
) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

/// Of these resources.
pub(crate) fn bind<const N: usize>(
    gpu: &Gpu,
    label: &str,
    layout: &BindGroupLayout,
    resources: [BindingResource<'_>; N],
) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

/// A whole buffer.
pub(crate) fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// Read only.
pub(crate) const STORAGE: BufferBindingType = BufferBindingType::Storage { read_only: true };

/// All of a texture, not filtered.
pub(crate) fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> BindingType {
    BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
    }
}
