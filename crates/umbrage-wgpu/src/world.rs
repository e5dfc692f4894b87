//! The geometry on the GPU: the fixed triangles uploaded once, objects as they change.

use std::ops::Range;

use glam::Vec3;
use umbrage_core::world::{Extent, World};
use wgpu::{BindGroup, BindGroupLayout, Buffer, Device, Queue, ShaderStages};

use crate::RenderError;
use crate::buffers::Written;
use crate::shared::buffers_layout;
use crate::split::Split;
use crate::windows::{Windows, WorldWindows};

#[derive(Debug)]
pub(crate) struct WorldBuffers {
    pub(crate) windows: WorldWindows,
    /// Tightly packed f32 triples; with residuals, two a vertex.
    positions: Split,
    /// Positions and residuals as uploaded, if there are residuals.
    both: Vec<[Vec3; 2]>,
    /// u32 pairs.
    edges: Split,
    /// u32 triples.
    triangles: Split,
    pub(crate) layout: BindGroupLayout,
    /// Bind groups of another generation are of buffers that were replaced.
    pub(crate) generation: u64,
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
    pub(crate) fn new(device: &Device, windows: WorldWindows) -> Result<Self, RenderError> {
        let split = |label, windows: Windows, item| {
            let size = windows.items().map(|items| items * item);
            Split::fixed(device, label, windows.count, size)
        };
        Ok(Self {
            positions: split(
                "umbrage positions",
                windows.positions,
                windows.vertex_bytes(),
            )?,
            both: Vec::new(),
            edges: split("umbrage edges", windows.edges, 8)?,
            triangles: split("umbrage triangles", windows.corners, 4)?,
            layout: layout(device, &windows),
            windows,
            generation: 0,
            seen: Seen::default(),
        })
    }

    /// `world.wgsl` for these windows, in bind group `group`.
    pub(crate) fn wgsl(&self, group: u32) -> String {
        let shared = include_str!("shaders/world.wgsl");
        let shared = shared.replace("UMBRAGE_WORLD_GROUP", &group.to_string());
        format!("{}\n{shared}", self.windows.wgsl(group))
    }

    /// Whether a world was uploaded.
    pub(crate) fn is_filled(&self) -> bool {
        self.seen.stamp != 0
    }

    /// What the three take.
    pub(crate) fn bytes(&self) -> u64 {
        self.buffers().map(Buffer::size).sum()
    }

    /// As the layout has them.
    fn buffers(&self) -> impl Iterator<Item = &Buffer> {
        let arrays = [&self.positions, &self.edges, &self.triangles];
        arrays.into_iter().flat_map(Split::buffers)
    }

    /// Brings the buffers up to date with the world.
    pub(crate) fn update(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<(), RenderError> {
        let written = self.write(device, queue, world);
        if written.as_ref().map_or(true, |written| written.replaced) {
            self.generation += 1;
        }
        written.map(|_| ())
    }

    /// What `world.wgsl` reads: these buffers and a view.
    pub(crate) fn bind(&self, device: &Device, view: &Buffer) -> BindGroup {
        let entries: Vec<_> = (0..)
            .zip(std::iter::once(view).chain(self.buffers()))
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
        if !self.windows.residuals && !world.residuals.is_empty() {
            return Err(RenderError::Residuals);
        }
        // Until all is written, the buffers hold no world.
        let mut seen = std::mem::take(&mut self.seen);
        if seen.fixed != world.fixed_stamp {
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
        let bytes = if self.windows.residuals {
            self.both.resize(world.positions.len(), [Vec3::ZERO; 2]);
            for v in positions.iter().cloned().flatten() {
                let residual = world.places().residual(v);
                self.both[v as usize] = [world.positions[v as usize], residual];
            }
            bytemuck::cast_slice(&self.both)
        } else {
            bytemuck::cast_slice(&world.positions)
        };
        let vertices = in_bytes(&positions, self.windows.vertex_bytes());
        written += self
            .positions
            .write_changed(device, queue, bytes, vertices)?;
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
fn layout(device: &Device, windows: &WorldWindows) -> BindGroupLayout {
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let everywhere = ShaderStages::VERTEX | ShaderStages::COMPUTE;
    let view = everywhere | ShaderStages::FRAGMENT;
    let mut types = vec![(wgpu::BufferBindingType::Uniform, view)];
    for (array, stages) in [
        (windows.positions, everywhere),
        (windows.edges, everywhere),
        (windows.corners, ShaderStages::VERTEX),
    ] {
        types.extend((0..array.count).map(|_| (storage, stages)));
    }
    buffers_layout(device, "umbrage world", types)
}

fn in_bytes(ranges: &[Range<u32>], item: usize) -> impl Iterator<Item = Range<usize>> {
    let bytes = move |r: &Range<u32>| r.start as usize * item..r.end as usize * item;
    ranges.iter().map(bytes).filter(|r| !r.is_empty())
}
