//! The geometry on the GPU: the fixed triangles uploaded once, objects as they change.

use std::ops::Range;

use umbrage_core::world::World;
use wgpu::{Buffer, BufferUsages, Device, Queue};

use crate::RenderError;
use crate::buffers::{Growing, Written};

#[derive(Debug)]
pub(crate) struct WorldBuffers {
    /// Tightly packed f32 triples.
    positions: Growing,
    /// u32 pairs.
    edges: Growing,
    /// u32 triples.
    triangles: Growing,
    /// Of the world as it was last uploaded.
    fixed_stamp: u64,
    stamp: u64,
    /// When each object was placed, and had last changed.
    objects: Vec<(u64, u64)>,
}

impl WorldBuffers {
    pub(crate) fn new(device: &Device) -> Self {
        let buffer = |label| Growing::new(device, label, BufferUsages::empty());
        Self {
            positions: buffer("umbrage positions"),
            edges: buffer("umbrage edges"),
            triangles: buffer("umbrage triangles"),
            fixed_stamp: 0,
            stamp: 0,
            objects: Vec::new(),
        }
    }

    /// Positions, edges, triangles.
    pub(crate) fn buffers(&self) -> [&Buffer; 3] {
        [&self.positions, &self.edges, &self.triangles].map(|b| &b.buffer)
    }

    /// Whether a world was uploaded.
    pub(crate) fn is_filled(&self) -> bool {
        self.stamp != 0
    }

    /// Brings the buffers up to date with the world.
    pub(crate) fn update(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<Written, RenderError> {
        if self.stamp == world.stamp {
            return Ok(Written::default());
        }
        let (mut positions, mut edges, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        if self.fixed_stamp != world.fixed_stamp {
            self.objects.clear();
            positions.push(0..world.positions.len() as u32);
            edges.push(0..world.edges.vertices.len() as u32);
            triangles.push(0..world.triangles.len() as u32);
        }
        self.objects.resize(world.objects.len(), (0, 0));
        for (seen, object) in self.objects.iter_mut().zip(&world.objects) {
            if seen.1 != object.changed {
                positions.push(object.extent.vertices.clone());
            }
            // Topology changes when an object comes or goes: one that is gone leaves padding.
            if seen.0 != object.placed {
                edges.push(object.extent.edges.clone());
                triangles.push(object.room.triangles.clone());
            }
            *seen = (object.placed, object.changed);
        }
        let mut written = Written::default();
        let bytes = bytemuck::cast_slice(&world.positions);
        written += self
            .positions
            .write_changed(device, queue, bytes, in_bytes(&positions, 12))?;
        let bytes = bytemuck::cast_slice(&world.edges.vertices);
        written += self
            .edges
            .write_changed(device, queue, bytes, in_bytes(&edges, 8))?;
        let bytes = bytemuck::cast_slice(&world.triangles);
        written += self
            .triangles
            .write_changed(device, queue, bytes, in_bytes(&triangles, 12))?;
        (self.fixed_stamp, self.stamp) = (world.fixed_stamp, world.stamp);
        Ok(written)
    }
}

fn in_bytes(ranges: &[Range<u32>], item: usize) -> impl Iterator<Item = Range<usize>> {
    let bytes = move |r: &Range<u32>| r.start as usize * item..r.end as usize * item;
    ranges.iter().map(bytes).filter(|r| !r.is_empty())
}
