//! The world's trees for rays on the GPU: one list of nodes, one list of corners.
//!
//! Nodes stand depth-first, each with the number of the node after all that is below it: a ray
//! walks the list forwards and needs no stack, and the trees of the objects simply come after the
//! fixed one. Triangles keep the world's numbers.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use umbrage_core::Casting;
use umbrage_core::world::{Layer, World};
use umbrage_wgpu::RenderError;
use wgpu::BufferUsages;

use crate::gpu::{Gpu, GpuError};

/// `struct Node` of the shader.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct RayNode {
    low: Vec3,
    next: u32,
    high: Vec3,
    leaf: u32,
}

/// Bits for the number of triangles in a leaf.
const COUNT_BITS: u32 = 6;
const MOST: u32 = (1 << COUNT_BITS) - 1;

/// Buffers that follow a world.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) nodes: wgpu::Buffer,
    pub(super) corners: wgpu::Buffer,
    stamp: u64,
    fixed: u64,
    /// Nodes of the fixed triangles.
    fixed_nodes: usize,
    lengths: [usize; 2],
}

impl Tree {
    pub(super) fn new(gpu: &Gpu, world: &World) -> Result<Self, GpuError> {
        let too_many = 1usize << (32 - COUNT_BITS);
        let corners = corners(world, 0);
        let mut nodes = Vec::new();
        push_layer(world, Layer::Fixed, &mut nodes);
        let fixed_nodes = nodes.len();
        push_layer(world, Layer::Objects, &mut nodes);
        let lengths = [nodes.len(), corners.len()];
        if nodes.is_empty() {
            nodes.push(RayNode::nothing());
        }
        if world.triangles.len() >= too_many {
            return Err(too_large("triangles to trace", corners.len() as u64, gpu).into());
        }
        Ok(Self {
            nodes: buffer(gpu, "ray nodes", bytemuck::cast_slice(&nodes))?,
            corners: buffer(gpu, "ray corners", bytemuck::cast_slice(&corners))?,
            stamp: world.stamp,
            fixed: world.fixed_stamp,
            fixed_nodes,
            lengths,
        })
    }

    /// Brings the buffers up to date; where only objects moved, no more than theirs.
    pub(super) fn update(&mut self, gpu: &Gpu, world: &World) -> Result<(), GpuError> {
        if self.stamp == world.stamp {
            return Ok(());
        }
        let mut nodes = Vec::new();
        push_layer(world, Layer::Objects, &mut nodes);
        let first = world.fixed.triangles.end as usize;
        let corners = corners(world, first);
        let lengths = [self.fixed_nodes + nodes.len(), 3 * first + corners.len()];
        if self.fixed != world.fixed_stamp || self.lengths != lengths {
            *self = Self::new(gpu, world)?;
            return Ok(());
        }
        for node in &mut nodes {
            node.next += self.fixed_nodes as u32;
        }
        let at = (self.fixed_nodes * size_of::<RayNode>()) as u64;
        gpu.queue
            .write_buffer(&self.nodes, at, bytemuck::cast_slice(&nodes));
        let at = (3 * first * size_of::<Vec4>()) as u64;
        gpu.queue
            .write_buffer(&self.corners, at, bytemuck::cast_slice(&corners));
        self.stamp = world.stamp;
        Ok(())
    }

    pub(super) fn bytes(&self) -> u64 {
        self.nodes.size() + self.corners.size()
    }
}

impl RayNode {
    /// Met by no ray.
    fn nothing() -> Self {
        Self {
            low: Vec3::splat(f32::MAX),
            next: 1,
            high: Vec3::splat(f32::MAX),
            leaf: 0,
        }
    }
}

/// Appends the nodes of a layer's trees.
fn push_layer(world: &World, layer: Layer, nodes: &mut Vec<RayNode>) {
    for root in world.roots(layer) {
        push_tree(world, root, nodes);
    }
}

fn push_tree(world: &World, root: u32, nodes: &mut Vec<RayNode>) {
    // Nodes whose last node below is not known yet, with the triangle at which it is.
    let mut open: Vec<(usize, u32)> = Vec::new();
    let from = &world.bvh.nodes[root as usize..];
    let end = from[0].range().end;
    for node in from {
        while let Some(&(at, _)) = open.last().filter(|(_, end)| *end <= node.first) {
            nodes[at].next = nodes.len() as u32;
            open.pop();
        }
        let range = node.range();
        let mut push = |leaf| {
            nodes.push(RayNode {
                low: node.min,
                next: nodes.len() as u32 + 1,
                high: node.max,
                leaf,
            });
        };
        if !node.is_leaf() {
            push(0);
            open.push((nodes.len() - 1, range.end));
            continue;
        }
        for first in range.clone().step_by(MOST as usize) {
            push(first << COUNT_BITS | (range.end - first).min(MOST));
        }
        if range.end == end {
            break;
        }
    }
    for (at, _) in open {
        nodes[at].next = nodes.len() as u32;
    }
}

/// Corners of the triangles from `first` on, and how they cast: bit 0 from the front, bit 1 from
/// the back.
fn corners(world: &World, first: usize) -> Vec<Vec4> {
    let all = world.triangles.iter().zip(world.casting.iter());
    all.skip(first)
        .flat_map(|(corners, casting)| {
            let casts = match casting {
                Casting::None => 0.0,
                Casting::Front => 1.0,
                Casting::Back => 2.0,
                Casting::Both => 3.0,
            };
            corners.map(|v| world.positions[v as usize].extend(casts))
        })
        .collect()
}

fn buffer(gpu: &Gpu, label: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer, GpuError> {
    gpu.check_storage(label, bytes.len())?;
    let nothing = [0; 48];
    Ok(gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents: if bytes.is_empty() { &nothing } else { bytes },
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
    }))
}

fn too_large(what: &'static str, needed: u64, gpu: &Gpu) -> RenderError {
    RenderError::BufferTooLarge {
        what,
        needed,
        limit_name: "max_storage_buffer_binding_size",
        limit: gpu.device.limits().max_storage_buffer_binding_size,
    }
}
