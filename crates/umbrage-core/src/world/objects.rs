//! Objects: parts of a world that can be added, moved, deformed and removed.
//!
//! Takes meshes and rigid poses; gives the same arrays that the fixed triangles have, so that
//! query, facing, counter, eye count and renderer need not know one from the other. An object's
//! topology (edges, clusters, tree) is built once; a pose or new rest positions (see `deform`)
//! rewrite its positions, planes and boxes.
//! Its positions are transformed in f64 and rounded once, to f32 or, in a world with residuals, to 48
//! bits: those positions *are* the geometry, for CPU, GPU and oracle alike. Edges are never shared between objects: counters add up.

use std::ops::Range;

use glam::{DQuat, DVec3, Vec3};
use thiserror::Error;

use super::deform::Given;
use super::extent::Extent;
use super::stages::{self, Welded};
use super::{LANES, World, WorldError, boxes, check_input, is_place, planes};
use crate::mesh::{Casting, Mesh};
use crate::place::{Places, split};
use crate::stamp;

/// Names an object of one world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId {
    slot: u32,
    /// The stamp of its insertion: a slot that is used again gives no old name a new meaning.
    placed: u64,
}

/// Where an object stands: rotation, then translation, in metres from the world's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Of unit length, or it is made so.
    pub rotation: DQuat,
    /// World space.
    pub translation: DVec3,
}

impl Pose {
    /// No rotation.
    pub fn at(translation: DVec3) -> Self {
        Self {
            rotation: DQuat::IDENTITY,
            translation,
        }
    }
}

/// Why an object cannot be inserted, moved or removed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ObjectError {
    /// Its mesh is not one.
    #[error(transparent)]
    Mesh(#[from] WorldError),
    /// A pose with NaN, infinite or all-zero parts, or one that takes a vertex beyond
    /// [`World::MAX_COORDINATE`].
    #[error("the pose takes the object nowhere: give a finite, non-zero rotation and translation")]
    Pose,
    /// Vertices that became one when the object was inserted are to stand at different places.
    #[error(
        "vertices {first} and {second} were inserted as one and cannot part: \
         insert the object with keys that tell them apart"
    )]
    Parted {
        /// Vertex of the mesh that was inserted.
        first: u32,
        /// Another.
        second: u32,
    },
    /// A list that must have an entry a vertex has not.
    #[error("{found} {what} for {vertices} vertices: hand over one a vertex of the inserted mesh")]
    Length {
        /// "positions" or "keys".
        what: &'static str,
        /// Entries given.
        found: usize,
        /// Vertices of the mesh that was inserted.
        vertices: usize,
    },
    /// It was removed, or is of another world.
    #[error("no such object in this world: it was removed, or belongs to another world")]
    Unknown,
}

/// One slot for an object, in use or free.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its share of the arrays.
    pub extent: Extent,
    /// The slot's share, of which it may leave some unused.
    pub room: Extent,
    /// When it was inserted; 0 in a free slot.
    pub placed: u64,
    /// When it was last inserted, posed, deformed or removed.
    pub changed: u64,
    /// Lower and upper corner of its box; empty if there is none.
    pub bounds: [Vec3; 2],
    /// Where it stands.
    pub(super) pose: Pose,
    pub(super) rest: Vec<DVec3>,
    pub(super) given: Given,
}

/// Of what has no triangle: nothing touches it.
pub(crate) const EMPTY_BOX: [Vec3; 2] = [Vec3::INFINITY, Vec3::NEG_INFINITY];

/// What stands in the place of a triangle that is none: no area, and casts nothing.
pub(super) const PADDING: [u32; 3] = [0; 3];

impl World {
    /// Adds an object with positions in its own space. Its edges are its own: they cancel with none
    /// of the world's.
    pub fn insert(&mut self, mesh: &Mesh, pose: &Pose) -> Result<ObjectId, ObjectError> {
        check_input(mesh)?;
        self.insert_welded(mesh, pose, stages::weld)
    }

    /// Inserts a mesh that was checked; `weld` says which vertices are one.
    pub(super) fn insert_welded(
        &mut self,
        mesh: &Mesh,
        pose: &Pose,
        weld: impl FnOnce(&Mesh) -> Welded,
    ) -> Result<ObjectId, ObjectError> {
        let (part, welded) = World::build_welded(mesh, weld);
        #[cfg(debug_assertions)]
        if let Err(fault) = part.validate_topology() {
            panic!("World::insert broke an invariant: {fault}");
        }
        let rest: Vec<DVec3> = (0..part.positions.len() as u32)
            .map(|v| part.places().at(v))
            .collect();
        check(&rest, pose)?;
        // Padding to whole clusters included.
        let triangles = self.triangles.len() + part.triangles.len() + LANES;
        if triangles > World::MAX_TRIANGLES {
            return Err(ObjectError::Mesh(WorldError::TooManyTriangles {
                triangles,
                limit: World::MAX_TRIANGLES,
            }));
        }
        let slot = self.slot_for(&part);
        let placed = stamp::next();
        let object = &mut self.objects[slot];
        object.placed = placed;
        object.rest = rest;
        object.given = Given::new(mesh, &welded, &part);
        object.extent = object.room.begin(part.fixed.lengths());
        self.write_topology(&part, slot);
        let id = ObjectId {
            slot: slot as u32,
            placed,
        };
        self.stand(slot, pose);
        Ok(id)
    }

    /// Moves an object.
    pub fn pose(&mut self, id: ObjectId, pose: &Pose) -> Result<(), ObjectError> {
        let slot = self.slot_of(id)?;
        check(&self.objects[slot].rest, pose)?;
        self.stand(slot, pose);
        Ok(())
    }

    /// Brings everything that depends on positions in step with rest positions and pose, which were
    /// checked.
    pub(super) fn stand(&mut self, slot: usize, pose: &Pose) {
        let object = &mut self.objects[slot];
        object.pose = *pose;
        let rotation = pose.rotation.normalize();
        let posed = object.rest.iter().map(|p| placed(rotation, pose, *p));
        let first = object.extent.vertices.start as usize;
        let positions = &mut self.positions.to_mut()[first..];
        if self.keeps_residuals {
            let residuals = &mut self.residuals.to_mut()[first..];
            for ((p, r), at) in positions.iter_mut().zip(residuals).zip(posed) {
                [*p, *r] = split(at);
            }
        } else {
            for (p, at) in positions.iter_mut().zip(posed) {
                [*p, _] = split(at);
            }
        }
        self.refit(slot);
        self.stamp = stamp::next();
        self.objects[slot].changed = self.stamp;
    }

    /// Takes an object out. Its share of the arrays waits for another of its size.
    pub fn remove(&mut self, id: ObjectId) -> Result<(), ObjectError> {
        let slot = self.slot_of(id)?;
        let object = &mut self.objects[slot];
        object.rest.clear();
        object.given = Given::default();
        object.placed = 0;
        object.bounds = EMPTY_BOX;
        self.stamp = stamp::next();
        object.changed = self.stamp;
        let triangles = as_usize(&object.room.triangles);
        object.extent = object.room.begin([0; 4]);
        self.triangles.to_mut()[triangles.clone()].fill(PADDING);
        self.casting.to_mut()[triangles].fill(Casting::None);
        Ok(())
    }

    /// The object's present share of the arrays.
    pub fn object(&self, id: ObjectId) -> Result<&Object, ObjectError> {
        self.slot_of(id).map(|slot| &self.objects[slot])
    }

    /// All triangles as they stand, objects in their poses: for an oracle, or to build a world
    /// anew.
    pub fn to_mesh(&self) -> Mesh {
        let real = |t: &usize| self.triangles[*t] != PADDING;
        let kept: Vec<usize> = (0..self.triangles.len()).filter(real).collect();
        Mesh {
            positions: self.positions.to_vec(),
            residuals: self.residuals.to_vec(),
            triangles: kept.iter().map(|&t| self.triangles[t]).collect(),
            casting: kept.iter().map(|&t| self.casting[t]).collect(),
        }
    }

    pub(super) fn slot_of(&self, id: ObjectId) -> Result<usize, ObjectError> {
        match self.objects.get(id.slot as usize) {
            Some(object) if object.placed == id.placed => Ok(id.slot as usize),
            _ => Err(ObjectError::Unknown),
        }
    }

    /// Planes, boxes and tree from the positions of an object.
    fn refit(&mut self, slot: usize) {
        let extent = self.objects[slot].extent.clone();
        let triangles = as_usize(&extent.triangles);
        for (i, chunk) in self.triangles[triangles.clone()].chunks(LANES).enumerate() {
            let cluster = triangles.start / LANES + i;
            let places = Places {
                positions: &self.positions,
                residuals: &self.residuals,
            };
            self.planes.clusters.to_mut()[cluster] = planes::plane_cluster(places, chunk);
            self.boxes.to_mut()[cluster] = boxes::box_cluster(places, chunk);
        }
        for i in as_usize(&extent.nodes).rev() {
            let node = self.bvh.nodes[i];
            let (min, max) = if node.is_leaf() {
                let bounds = node.range().map(|t| self.bounds(t));
                bounds.fold((EMPTY_BOX[0], EMPTY_BOX[1]), |(min, max), [low, high]| {
                    (min.min(low), max.max(high))
                })
            } else {
                let [a, b] = [self.bvh.nodes[i + 1], self.bvh.nodes[node.second as usize]];
                (a.min.min(b.min), a.max.max(b.max))
            };
            let node = &mut self.bvh.nodes.to_mut()[i];
            (node.min, node.max) = (min, max);
        }
        let root = extent.nodes.clone().next();
        let root = root.map(|root| &self.bvh.nodes[root as usize]);
        self.objects[slot].bounds = root.map_or(EMPTY_BOX, |root| [root.min, root.max]);
    }
}

fn as_usize(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

fn placed(rotation: DQuat, pose: &Pose, p: DVec3) -> DVec3 {
    rotation * p + pose.translation
}

pub(super) fn check(rest: &[DVec3], pose: &Pose) -> Result<(), ObjectError> {
    let rotation = pose.rotation.normalize();
    let finite = rotation.is_finite()
        && pose.translation.is_finite()
        && rest.iter().all(|p| is_place(placed(rotation, pose, *p)));
    finite.then_some(()).ok_or(ObjectError::Pose)
}
