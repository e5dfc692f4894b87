//! Objects whose vertices move one by one: skins, ropes, flags.
//!
//! Takes one position for each vertex of the mesh that was inserted; rewrites positions, planes and
//! boxes as a pose does. Topology stays: vertices that welding joined must stay at one place. Equal
//! positions say nothing about that (the lips of a closed mouth touch), so whoever inserts an object
//! that will deform says by keys which vertices move alike. Invariant: vertices are one only if
//! both position and key are equal.

use std::collections::HashMap;

use glam::DVec3;

use super::objects::{ObjectError, ObjectId, Pose};
use super::stages::{self, Welded};
use super::{World, check_input, check_positions, objects};
use crate::mesh::Mesh;

/// How the vertices of the mesh that was inserted became those of the object.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Given {
    /// For each vertex of the mesh, one for all that are one with it; itself if no triangle uses it.
    first: Vec<u32>,
    /// For each vertex of the object, one of the mesh.
    vertex: Vec<u32>,
}

impl Given {
    /// `part` is the world that was built of `mesh`.
    pub(super) fn new(mesh: &Mesh, welded: &Welded, part: &World) -> Self {
        const UNSEEN: u32 = u32::MAX;
        let mut first: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        // What no triangle uses may go anywhere: it stands for no other.
        let mut class = vec![UNSEEN; first.len()];
        for &v in mesh.triangles.iter().flatten() {
            let place = &mut class[welded.vertex[v as usize] as usize];
            if *place == UNSEEN {
                *place = v;
            }
            first[v as usize] = *place;
        }
        let mut vertex = vec![0; part.positions.len()];
        for (corners, &source) in part.triangles.iter().zip(part.source.iter()) {
            for (&ours, &theirs) in corners.iter().zip(&mesh.triangles[source as usize]) {
                vertex[ours as usize] = first[theirs as usize];
            }
        }
        Self { first, vertex }
    }
}

impl World {
    /// As [`World::insert`], for an object that will deform: vertices are one only if they have equal
    /// positions and equal `keys`, one a vertex. Give vertices that always move alike one key: those of
    /// a skin by their joints and weights. Edges between vertices that are not one are open, and cast
    /// no less exact shadows for it, only more quads.
    pub fn insert_deforming(
        &mut self,
        mesh: &Mesh,
        keys: &[u32],
        pose: &Pose,
    ) -> Result<ObjectId, ObjectError> {
        check_input(mesh)?;
        check_length("keys", keys.len(), mesh.positions.len())?;
        self.insert_welded(mesh, pose, |mesh| weld_by_key(mesh, keys))
    }

    /// Gives an object new rest positions (`Vec3` or `DVec3`), one for each vertex of the mesh that was inserted, in the
    /// object's own space; its pose stays. Where they are those it has, nothing is done, and nothing
    /// near it is built again. Refused, and nothing changed, if vertices that became one are to part.
    pub fn deform<P: Copy + PartialEq + Into<DVec3>>(
        &mut self,
        id: ObjectId,
        positions: &[P],
    ) -> Result<(), ObjectError> {
        let slot = self.slot_of(id)?;
        let object = &self.objects[slot];
        let given = &object.given;
        check_length("positions", positions.len(), given.first.len())?;
        check_positions(positions.iter().map(|&p| p.into()))?;
        let mut pairs = (0..).zip(&given.first);
        let parted = pairs.find(|&(v, &first)| positions[v] != positions[first as usize]);
        if let Some((second, &first)) = parted {
            return Err(ObjectError::Parted {
                first,
                second: second as u32,
            });
        }
        let rest = given.vertex.iter().map(|&v| positions[v as usize].into());
        let rest: Vec<DVec3> = rest.collect();
        if rest == object.rest {
            return Ok(());
        }
        let pose = object.pose;
        objects::check(&rest, &pose)?;
        self.objects[slot].rest = rest;
        self.stand(slot, &pose);
        Ok(())
    }

    /// The vertex of [`World::positions`] that each vertex of the inserted mesh became; none for one
    /// that no triangle uses.
    pub fn vertices_of(&self, id: ObjectId) -> Result<Vec<Option<u32>>, ObjectError> {
        let object = self.object(id)?;
        let given = &object.given;
        let mut became = vec![None; given.first.len()];
        for (ours, &theirs) in (object.extent.vertices.start..).zip(&given.vertex) {
            became[theirs as usize] = Some(ours);
        }
        let all = given.first.iter().map(|&first| became[first as usize]);
        Ok(all.collect())
    }
}

/// Joins vertices of equal positions and keys.
fn weld_by_key(mesh: &Mesh, keys: &[u32]) -> Welded {
    let mut vertex = stages::weld(mesh).vertex;
    let mut seen: HashMap<(u32, u32), u32> = HashMap::new();
    for (v, (place, &key)) in (0..).zip(vertex.iter_mut().zip(keys)) {
        *place = *seen.entry((*place, key)).or_insert(v);
    }
    Welded {
        kept: stages::kept(mesh, &vertex),
        count: seen.len(),
        vertex,
    }
}

fn check_length(what: &'static str, found: usize, vertices: usize) -> Result<(), ObjectError> {
    if found == vertices {
        return Ok(());
    }
    Err(ObjectError::Length {
        what,
        found,
        vertices,
    })
}
