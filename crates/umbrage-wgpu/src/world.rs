//! The geometry on the GPU: the fixed triangles uploaded once, objects as they change.

use std::ops::Range;

use glam::Vec3;
use umbrage_core::world::{Extent, World};
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages, Device, Queue, ShaderStages};

use crate::RenderError;
use crate::buffers::{Growing, Written};

#[derive(Debug)]
pub(crate) struct WorldBuffers {
    /// Tightly packed f32 triples; of a world with residuals, two a vertex.
    positions: Growing,
    /// Positions and residuals of a world that has residuals, as uploaded.
    both: Vec<[Vec3; 2]>,
    /// u32 pairs.
    edges: Growing,
    /// u32 triples.
    triangles: Growing,
    pub(crate) layout: BindGroupLayout,
    /// Of these buffers and a view, for `world.wgsl`.
    pub(crate) bind_group: Option<BindGroup>,
    seen: Seen,
}

/// The world as it was last uploaded.
#[derive(Debug, Default)]
struct Seen {
    /// 0 if none was.
    stamp: u64,
    fixed: u64,
    /// Of positions, edges and triangles.
    lengths: [u32; 3],
    objects: Vec<SeenObject>,
}

#[derive(Clone, Debug, Default)]
struct SeenObject {
    placed: u64,
    changed: u64,
    room: Extent,
}

impl WorldBuffers {
    pub(crate) fn new(device: &Device) -> Self {
        let buffer = |label| Growing::new(device, label, BufferUsages::empty());
        Self {
            positions: buffer("umbrage positions"),
            both: Vec::new(),
            edges: buffer("umbrage edges"),
            triangles: buffer("umbrage triangles"),
            layout: layout(device),
            bind_group: None,
            seen: Seen::default(),
        }
    }

    /// Whether a world was uploaded.
    pub(crate) fn is_filled(&self) -> bool {
        self.seen.stamp != 0
    }

    /// f32 values a vertex.
    pub(crate) fn vertex_floats(&self) -> u32 {
        if self.both.is_empty() { 3 } else { 6 }
    }

    /// What the three take.
    pub(crate) fn bytes(&self) -> u64 {
        let arrays = [&self.positions, &self.edges, &self.triangles];
        arrays.map(|b| b.buffer.size()).iter().sum()
    }

    /// Brings the buffers up to date with the world; true if the bind group, which has `view`, is
    /// another than before.
    pub(crate) fn update(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
        view: &Buffer,
    ) -> Result<bool, RenderError> {
        let bind_group = self.bind_group.take();
        let written = self.write(device, queue, world)?;
        self.bind_group = bind_group.filter(|_| !written.replaced);
        let is_new = self.bind_group.is_none();
        if is_new {
            self.bind_group = Some(self.bind(device, view));
        }
        Ok(is_new)
    }

    fn bind(&self, device: &Device, view: &Buffer) -> BindGroup {
        let arrays = [&self.positions, &self.edges, &self.triangles].map(|b| &b.buffer);
        let entries: Vec<_> = (0..)
            .zip(std::iter::once(view).chain(arrays))
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage world"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<Written, RenderError> {
        if self.seen.stamp == world.stamp {
            return Ok(Written::default());
        }
        let lengths = [
            world.positions.len() as u32,
            world.edges.vertices.len() as u32,
            world.triangles.len() as u32,
        ];
        // Until all is written, the buffers hold no world.
        let mut seen = std::mem::take(&mut self.seen);
        if seen.fixed != world.fixed_stamp || self.both.is_empty() != world.residuals.is_empty() {
            seen = Seen::default();
        }
        let grown = |i: usize| seen.lengths[i].min(lengths[i])..lengths[i];
        let [mut positions, mut edges, mut triangles] = [0, 1, 2].map(|i| Vec::from([grown(i)]));
        seen.objects.resize(world.objects.len(), Default::default());
        for (seen, object) in seen.objects.iter_mut().zip(&world.objects) {
            if seen.changed != object.changed {
                positions.push(object.extent.vertices.clone());
            }
            // Topology changes when an object comes or goes: one that is gone leaves padding.
            if seen.placed != object.placed || seen.room != object.room {
                edges.push(object.extent.edges.clone());
                triangles.push(object.room.triangles.clone());
            }
            *seen = SeenObject {
                placed: object.placed,
                changed: object.changed,
                room: object.room.clone(),
            };
        }
        let mut written = Written::default();
        self.both.resize(world.residuals.len(), [Vec3::ZERO; 2]);
        let (bytes, item) = if world.residuals.is_empty() {
            (bytemuck::cast_slice(&world.positions), 12)
        } else {
            for v in positions.iter().cloned().flatten().map(|v| v as usize) {
                self.both[v] = [world.positions[v], world.residuals[v]];
            }
            (bytemuck::cast_slice(&self.both), 24)
        };
        written +=
            self.positions
                .write_changed(device, queue, bytes, in_bytes(&positions, item))?;
        let bytes = bytemuck::cast_slice(&world.edges.vertices);
        written += self
            .edges
            .write_changed(device, queue, bytes, in_bytes(&edges, 8))?;
        let bytes = bytemuck::cast_slice(&world.triangles);
        written += self
            .triangles
            .write_changed(device, queue, bytes, in_bytes(&triangles, 12))?;
        self.seen = Seen {
            stamp: world.stamp,
            fixed: world.fixed_stamp,
            lengths,
            objects: seen.objects,
        };
        Ok(written)
    }
}

/// What `world.wgsl` declares. Compute shaders read no triangles: with these they would pass the
/// eight storage buffers that every device has.
fn layout(device: &Device) -> BindGroupLayout {
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let everywhere = ShaderStages::VERTEX | ShaderStages::COMPUTE;
    let entries: Vec<_> = (0..)
        .zip([
            (wgpu::BufferBindingType::Uniform, everywhere),
            (storage, everywhere),
            (storage, everywhere),
            (storage, ShaderStages::VERTEX),
        ])
        .map(|(binding, (ty, visibility))| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage world"),
        entries: &entries,
    })
}

fn in_bytes(ranges: &[Range<u32>], item: usize) -> impl Iterator<Item = Range<usize>> {
    let bytes = move |r: &Range<u32>| r.start as usize * item..r.end as usize * item;
    ranges.iter().map(bytes).filter(|r| !r.is_empty())
}
