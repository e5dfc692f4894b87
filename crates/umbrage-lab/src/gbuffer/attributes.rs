//! What shading needs of triangles, in as many parts as it takes: each part has the attributes of
//! consecutive triangles in buffers that a binding holds, and the draws that read them.

use std::collections::BTreeMap;
use std::ops::Range;

use umbrage_wgpu::RenderError;
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages};

use crate::binding::bind;
use crate::gpu::{Gpu, GpuError};
use crate::stage::Stage;

/// Bytes of the largest attribute of a triangle: three texture coordinates.
const LARGEST: u64 = 24;

/// Consecutive triangles.
#[derive(Debug)]
pub(super) struct Part {
    triangles: Range<u32>,
    bind_group: BindGroup,
    corners: Buffer,
    normals: Buffer,
    /// A base colour texture and the corners that use it.
    batches: Vec<(BindGroup, Range<u32>)>,
}

/// All triangles of the stage, with `image` making ready a base colour texture, once each.
pub(super) fn parts(
    gpu: &Gpu,
    stage: &Stage,
    layout: &BindGroupLayout,
    image: impl Fn(Option<u32>) -> BindGroup,
) -> Result<Vec<Part>, GpuError> {
    let limits = gpu.device.limits();
    let limit = limits.max_storage_buffer_binding_size;
    let most = (limit.min(limits.max_buffer_size) / LARGEST).max(1);
    let materials: Vec<[[f32; 4]; 2]> = (stage.scene.materials.iter())
        .map(|m| [m.base_color.to_array(), [m.roughness, m.metallic, 0.0, 0.0]])
        .collect();
    let materials = storage(gpu, "materials", bytemuck::cast_slice(&materials))?;
    // Objects that are no actors have the first material, the normals of their faces, no texture.
    let surfaces = stage.surfaces();
    let mut images = BTreeMap::new();
    let step = usize::try_from(most).unwrap_or(usize::MAX);
    let mut parts = Vec::new();
    for sources in surfaces.chunks(step) {
        let first = (parts.len() * step) as u32;
        let sources: Vec<_> = sources.iter().map(|t| t.map(|t| t as usize)).collect();
        parts.push(Part::new(
            gpu,
            stage,
            (first, &sources),
            (layout, &materials),
            |i| images.entry(i).or_insert_with(|| image(i)).clone(),
        )?);
    }
    Ok(parts)
}

impl Part {
    fn new(
        gpu: &Gpu,
        stage: &Stage,
        (first, sources): (u32, &[Option<usize>]),
        (layout, materials): (&BindGroupLayout, &Buffer),
        mut image: impl FnMut(Option<u32>) -> BindGroup,
    ) -> Result<Self, GpuError> {
        let soup = &stage.soup;
        let material: Vec<u32> = (sources.iter())
            .map(|t| t.map_or(0, |t| soup.material[t]))
            .collect();
        let mut normals = vec![0u32];
        if !soup.normals.is_empty() {
            let of = |t: &Option<usize>| t.map_or([0; 3], |t| soup.normals[t].map(pack));
            normals = sources.iter().flat_map(of).collect();
        }
        let mut uvs = vec![glam::Vec2::ZERO];
        if !soup.uvs.is_empty() {
            let of = |t: &Option<usize>| t.map_or([glam::Vec2::ZERO; 3], |t| soup.uvs[t]);
            uvs = sources.iter().flat_map(of).collect();
        }
        let image_of = |i: u32| {
            let material = material[(i - first) as usize];
            stage.scene.materials[material as usize].base_color_image
        };
        let triangles = first..first + sources.len() as u32;
        let mut order: Vec<u32> = triangles.clone().collect();
        order.sort_by_key(|&t| image_of(t));
        let corners: Vec<u32> = (order.iter())
            .flat_map(|&t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let mut batches = Vec::new();
        let mut end = 0;
        for batch in order.chunk_by(|&a, &b| image_of(a) == image_of(b)) {
            let start = end;
            end += 3 * batch.len() as u32;
            batches.push((image(image_of(batch[0])), start..end));
        }
        let material = storage(gpu, "triangle materials", bytemuck::cast_slice(&material))?;
        let normals = storage(gpu, "normals", bytemuck::cast_slice(&normals))?;
        let uvs = storage(gpu, "texture coordinates", bytemuck::cast_slice(&uvs))?;
        let buffers = [&material, &normals, &uvs, materials];
        let resources = buffers.map(Buffer::as_entire_binding);
        let init = wgpu::util::BufferInitDescriptor {
            label: Some("corners"),
            contents: bytemuck::cast_slice(&corners),
            usage: BufferUsages::INDEX,
        };
        Ok(Self {
            triangles,
            bind_group: bind(gpu, "gbuffer", layout, resources),
            corners: gpu.create_buffer_init(&init),
            normals,
            batches,
        })
    }

    /// Writes the normals of triangles from number `first` on, those that it has.
    pub(super) fn write_normals(&self, gpu: &Gpu, first: u32, normals: &[u32]) {
        let end = (first + normals.len() as u32 / 3).min(self.triangles.end);
        let start = first.max(self.triangles.start);
        if start >= end {
            return;
        }
        let ours = 3 * (start - first) as usize..3 * (end - first) as usize;
        let at = u64::from(12 * (start - self.triangles.start));
        let bytes = bytemuck::cast_slice(&normals[ours]);
        gpu.queue.write_buffer(&self.normals, at, bytes);
    }

    /// Draws its triangles: attributes at bind group 0, textures at 1.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let instance = self.triangles.start..self.triangles.start + 1;
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_index_buffer(self.corners.slice(..), wgpu::IndexFormat::Uint32);
        for (image, corners) in &self.batches {
            pass.set_bind_group(1, image, &[]);
            pass.draw_indexed(corners.clone(), 0, instance.clone());
        }
    }
}

fn storage(gpu: &Gpu, label: &'static str, bytes: &[u8]) -> Result<Buffer, RenderError> {
    gpu.check_storage(label, bytes.len())?;
    let init = wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: if bytes.is_empty() { &[0; 32] } else { bytes },
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
    };
    Ok(gpu.create_buffer_init(&init))
}

/// A normal in four bytes.
pub(super) fn pack(n: glam::Vec3) -> u32 {
    let byte = |x: f32| (x.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8;
    u32::from_le_bytes([byte(n.x), byte(n.y), byte(n.z), 0])
}
