//! One pass over a mapped world: no number in it points outside, so that nothing that reads it
//! later can panic or run forever, whoever wrote the file.
//!
//! It does not prove what [`World::validate`] proves: that is for tests.

use rayon::prelude::*;

use super::SavedWorldError;
use super::layout::Section;
use crate::world::{Cluster, LANES, Node, World, is_place};

/// `mesh_triangles`: how many triangles the mesh has that `source` points into.
pub(super) fn check(world: &World, mesh_triangles: u64) -> Result<(), SavedWorldError> {
    lengths(world)?;
    let triangles = world.triangles.len() as u32;
    let positions = world.positions.len() as u32;
    let edges = world.edges.vertices.len() as u32;
    each(Section::Positions, &world.positions, |_, p| {
        is_place(p.as_dvec3())
    })?;
    each(Section::Residuals, &world.residuals, |_, p| {
        is_place(p.as_dvec3())
    })?;
    each(Section::Triangles, &world.triangles, |_, t| {
        (t[0] < positions) & (t[1] < positions) & (t[2] < positions)
    })?;
    each(Section::Source, &world.source, |_, &source| {
        u64::from(source) < mesh_triangles
    })?;
    each(Section::Edges, &world.edges.vertices, |_, e| {
        (e[0] < positions) & (e[1] < positions)
    })?;
    each(Section::Sides, &world.edges.sides, |_, sides| {
        let lanes = sides.as_flattened().iter();
        lanes.fold(true, |all, lane| all & (lane.edge() < edges))
    })?;
    each(Section::Clusters, &world.clusters, |at, cluster| {
        cluster_is_sound(cluster, triangles as usize - at * LANES)
    })?;
    let nodes = &world.bvh.nodes;
    let whole = nodes
        .first()
        .map_or((0, 0), |root| (root.first, root.count));
    if whole != (0, triangles) {
        return Err(invalid(Section::Nodes, 0));
    }
    each(Section::Nodes, nodes, |at, node| {
        node_is_sound(at, node, nodes, triangles)
    })
}

fn lengths(world: &World) -> Result<(), SavedWorldError> {
    let triangles = world.triangles.len();
    let clusters = triangles.div_ceil(LANES);
    let limit = World::MAX_TRIANGLES;
    let residuals = world.residuals.len();
    if residuals > 0 && residuals < world.positions.len() {
        return Err(invalid(Section::Residuals, residuals));
    }
    for (section, found, allowed) in [
        (Section::Triangles, triangles, 0..=limit),
        (Section::Positions, world.positions.len(), 0..=3 * limit),
        (Section::Residuals, residuals, 0..=world.positions.len()),
        (Section::Source, world.source.len(), triangles..=triangles),
        (Section::Casting, world.casting.len(), triangles..=triangles),
        (
            Section::Edges,
            world.edges.vertices.len(),
            0..=3 * triangles,
        ),
        (Section::Sides, world.edges.sides.len(), clusters..=clusters),
        (Section::Clusters, world.clusters.len(), clusters..=clusters),
        (
            Section::Planes,
            world.planes.clusters.len(),
            clusters..=clusters,
        ),
        (Section::Boxes, world.boxes.len(), clusters..=clusters),
        (Section::Nodes, world.bvh.nodes.len(), 0..=2 * triangles),
    ] {
        if !allowed.contains(&found) {
            return Err(invalid(section, found));
        }
    }
    Ok(())
}

/// Bits and partners name only the `present` first lanes.
fn cluster_is_sound(cluster: &Cluster, present: usize) -> bool {
    let present = present.min(LANES);
    let lanes = u64::MAX >> (LANES - present);
    let mut bits = cluster.casts_front | cluster.casts_back;
    let mut partner = 0;
    for side in &cluster.sides {
        bits |= side.paired | side.shared;
        partner = side.partner.iter().fold(partner, |most, &p| p.max(most));
    }
    bits & !lanes == 0 && usize::from(partner) < present
}

/// Its triangles exist; its children stand after it and part its triangles between them, so that
/// every walk ends.
fn node_is_sound(at: usize, node: &Node, nodes: &[Node], triangles: u32) -> bool {
    let end = |node: &Node| node.first.checked_add(node.count);
    if node.count == 0 || end(node).is_none_or(|end| end > triangles) {
        return false;
    }
    if node.is_leaf() {
        return true;
    }
    let (Some(first), Some(second)) = (nodes.get(at + 1), nodes.get(node.second as usize)) else {
        return false;
    };
    node.second as usize > at + 1
        && first.first == node.first
        && end(first) == Some(second.first)
        && end(second) == end(node)
}

/// Asks of every item; chunks are asked without branches, so that simple questions vectorise.
fn each<T: Sync>(
    section: Section,
    items: &[T],
    sound: impl Fn(usize, &T) -> bool + Sync,
) -> Result<(), SavedWorldError> {
    const CHUNK: usize = 1 << 14;
    let all = |(number, chunk): (usize, &[T])| {
        let numbered = (number * CHUNK..).zip(chunk);
        numbered.fold(true, |all, (at, item)| all & sound(at, item))
    };
    if items.par_chunks(CHUNK).enumerate().all(all) {
        return Ok(());
    }
    let first = items
        .iter()
        .enumerate()
        .position(|(at, item)| !sound(at, item));
    Err(invalid(section, first.unwrap_or_default()))
}

fn invalid(section: Section, item: usize) -> SavedWorldError {
    SavedWorldError::Invalid {
        section: section.name(),
        item,
    }
}
