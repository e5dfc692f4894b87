//! Where an object's share of the world's arrays lies.
//!
//! Takes a part built as a world of its own; finds it a slot, a free one or a new one at the end of
//! all arrays, and writes there, renumbered, what no pose changes. Invariant: a slot's triangles
//! begin with a cluster, and its room never shrinks.

use glam::{DVec3, Vec3};

use super::array::Array;
use super::deform::Given;
use super::extent::Extent;
use super::objects::{EMPTY_BOX, Object, PADDING, Pose};
use super::{LANES, Node, World};
use crate::mesh::Casting;

impl World {
    /// A free slot that holds `part` without much waste, or a new one at the end of the arrays.
    pub(super) fn slot_for(&mut self, part: &World) -> usize {
        let needed = part.fixed.lengths();
        let fits = |object: &Object| {
            let room = object.room.lengths();
            object.placed == 0 && (0..4).all(|i| needed[i] <= room[i] && room[i] <= 2 * needed[i])
        };
        if let Some(slot) = self.objects.iter().position(fits) {
            return slot;
        }
        let clusters = self.clusters.len();
        self.triangles.to_mut().resize(clusters * LANES, PADDING);
        self.source.to_mut().resize(clusters * LANES, u32::MAX);
        self.casting
            .to_mut()
            .resize(clusters * LANES, Casting::None);
        let after = |length: usize, more: usize| length as u32..(length + more) as u32;
        let room = Extent {
            vertices: after(self.positions.len(), part.positions.len()),
            triangles: after(self.triangles.len(), part.triangles.len()),
            edges: after(self.edges.vertices.len(), part.edges.vertices.len()),
            nodes: after(self.bvh.nodes.len(), part.bvh.nodes.len()),
        };
        self.positions
            .to_mut()
            .resize(room.vertices.end as usize, Vec3::ZERO);
        if self.keeps_residuals {
            let residuals = self.residuals.to_mut();
            residuals.resize(room.vertices.end as usize, Vec3::ZERO);
        }
        self.triangles
            .to_mut()
            .resize(room.triangles.end as usize, PADDING);
        self.source
            .to_mut()
            .resize(room.triangles.end as usize, u32::MAX);
        self.casting
            .to_mut()
            .resize(room.triangles.end as usize, Casting::None);
        self.edges
            .vertices
            .to_mut()
            .resize(room.edges.end as usize, [0; 2]);
        self.edges
            .sides
            .to_mut()
            .extend_from_slice(&part.edges.sides);
        self.clusters.to_mut().extend_from_slice(&part.clusters);
        let planes = self.planes.clusters.to_mut();
        planes.extend_from_slice(&part.planes.clusters);
        self.boxes.to_mut().extend_from_slice(&part.boxes);
        self.bvh.nodes.to_mut().extend_from_slice(&part.bvh.nodes);
        self.objects.push(Object {
            extent: room.begin([0; 4]),
            room,
            placed: 0,
            changed: 0,
            bounds: EMPTY_BOX,
            pose: Pose::at(DVec3::ZERO),
            rest: Vec::new(),
            given: Given::default(),
        });
        self.objects.len() - 1
    }

    /// Copies what no pose changes, renumbered.
    pub(super) fn write_topology(&mut self, part: &World, slot: usize) {
        let extent = &self.objects[slot].extent;
        let [vertex, triangle, edge, node] = extent.starts();
        let from = |start: u32| start as usize;
        let corners = part.triangles.iter().map(|t| t.map(|v| v + vertex));
        write(&mut self.triangles, from(triangle), corners);
        write(
            &mut self.source,
            from(triangle),
            part.source.iter().copied(),
        );
        let casting = part.casting.iter().copied();
        write(&mut self.casting, from(triangle), casting);
        let ends = part.edges.vertices.iter().map(|e| e.map(|v| v + vertex));
        write(&mut self.edges.vertices, from(edge), ends);
        let cluster = from(triangle) / LANES;
        let sides = part.edges.sides.iter();
        let sides = sides.map(|sides| sides.map(|side| side.map(|u| u.renumbered(edge))));
        write(&mut self.edges.sides, cluster, sides);
        write(&mut self.clusters, cluster, part.clusters.iter().copied());
        let nodes = part.bvh.nodes.iter().map(|n| Node {
            first: n.first + triangle,
            second: if n.is_leaf() { 0 } else { n.second + node },
            ..*n
        });
        write(&mut self.bvh.nodes, from(node), nodes);
    }
}

/// Writes items one after the other from place `first` on.
fn write<T: Clone>(array: &mut Array<T>, first: usize, items: impl Iterator<Item = T>) {
    for (to, item) in array.to_mut()[first..].iter_mut().zip(items) {
        *to = item;
    }
}
