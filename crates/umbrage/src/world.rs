//! The geometry: what stays, and objects that come, move and go.

use std::ops::Range;
use std::path::Path;

use glam::{DQuat, DVec3, Vec3};
use umbrage_core::world::{self as core, ObjectId, SavedWorldError};

use crate::mesh::joined;
use crate::{Casting, Error, Mesh};

/// All triangles that cast or receive shadows.
///
/// What it is built from stays; objects are inserted, moved, deformed and removed by handle, at the
/// cost of what they are made of, not of the world. Positions are in metres, f64 where they are
/// handed over one by one.
///
/// ```
/// use umbrage::{Mesh, Pose, World};
///
/// let floor = [[-5.0, 0.0, 5.0], [5.0, 0.0, 5.0], [0.0, 0.0, -5.0]];
/// let kite = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut world = World::build(&[Mesh::new(&floor, &[0, 1, 2])])?;
/// let object = world.insert(&Mesh::new(&kite, &[0, 1, 2]), &Pose::at([0.0, 2.0, 0.0]))?;
/// world.place(object, &Pose::at([0.0, 3.0, 0.0]))?;
/// world.remove(object)?;
/// assert!(world.remove(object).is_err()); // no panic, and no other object
/// # Ok::<(), umbrage::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) core: core::World,
}

/// Names an object of one world. Handles of removed objects are refused, also when others take their
/// place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Object(ObjectId);

/// Where an object stands: rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Pose {
    /// World space, in metres.
    pub position: [f64; 3],
    /// A quaternion x, y, z, w, of any length but zero.
    pub rotation: [f64; 4],
}

impl Pose {
    /// Here, without rotation.
    pub fn at(position: impl Into<[f64; 3]>) -> Self {
        Self {
            position: position.into(),
            rotation: [0.0, 0.0, 0.0, 1.0],
        }
    }

    /// Here, turned by a quaternion x, y, z, w.
    pub fn new(position: impl Into<[f64; 3]>, rotation: impl Into<[f64; 4]>) -> Self {
        Self {
            position: position.into(),
            rotation: rotation.into(),
        }
    }

    fn to_core(self) -> core::Pose {
        core::Pose {
            rotation: DQuat::from_array(self.rotation),
            translation: DVec3::from(self.position),
        }
    }
}

impl World {
    /// Welds vertices, finds edges, builds the tree: about a second for a million triangles. `meshes`
    /// may be none.
    ///
    /// # Errors
    /// Indices or casting rules that do not fit, positions that are not finite or beyond 2^60 m.
    pub fn build(meshes: &[Mesh<'_>]) -> Result<Self, Error> {
        let core = core::World::build(&joined(meshes)?)?;
        Ok(Self { core })
    }

    /// As [`World::build`], kept in a file: the first call writes it, later ones map it in
    /// milliseconds for as long as the meshes stay the same. A file that is none of ours is never
    /// overwritten.
    ///
    /// # Errors
    /// As [`World::build`]; a file that cannot be read or written, or is something else.
    pub fn cached(path: &Path, meshes: &[Mesh<'_>]) -> Result<Self, Error> {
        let mesh = joined(meshes)?;
        let fingerprint = mesh.fingerprint();
        match core::World::open(path, fingerprint) {
            Ok(core) => return Ok(Self { core }),
            Err(SavedWorldError::Io(e)) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(error @ (SavedWorldError::Io(_) | SavedWorldError::NotASavedWorld)) => {
                return Err(error.into());
            }
            // Old, cut short or damaged: building is the repair.
            Err(_) => {}
        }
        let core = core::World::build(&mesh)?;
        core.save(path, fingerprint)?;
        Ok(Self { core })
    }

    /// Adds an object with positions in its own space.
    ///
    /// # Errors
    /// As [`World::build`]; a pose that is none.
    pub fn insert(&mut self, mesh: &Mesh<'_>, pose: &Pose) -> Result<Object, Error> {
        let mesh = joined(std::slice::from_ref(mesh))?;
        Ok(Object(self.core.insert(&mesh, &pose.to_core())?))
    }

    /// Adds an object that will [deform](World::deform). `keys`, one a vertex, say which vertices
    /// always move alike: those of a skin by their joints and weights.
    ///
    /// # Errors
    /// As [`World::insert`]; keys that are not one a vertex.
    pub fn insert_deforming(
        &mut self,
        mesh: &Mesh<'_>,
        keys: &[u32],
        pose: &Pose,
    ) -> Result<Object, Error> {
        let mesh = joined(std::slice::from_ref(mesh))?;
        let id = (self.core).insert_deforming(&mesh, keys, &pose.to_core())?;
        Ok(Object(id))
    }

    /// Moves an object.
    ///
    /// # Errors
    /// A handle that is not valid, a pose that is none.
    pub fn place(&mut self, object: Object, pose: &Pose) -> Result<(), Error> {
        Ok(self.core.pose(object.0, &pose.to_core())?)
    }

    /// Gives an object new positions in its own space, one for each vertex that it was inserted with.
    ///
    /// # Errors
    /// A handle that is not valid, positions that are not finite, vertices that were one and are to
    /// part.
    pub fn deform(&mut self, object: Object, positions: &[[f32; 3]]) -> Result<(), Error> {
        let positions: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        Ok(self.core.deform(object.0, &positions)?)
    }

    /// Takes an object out.
    ///
    /// # Errors
    /// A handle that is not valid.
    pub fn remove(&mut self, object: Object) -> Result<(), Error> {
        Ok(self.core.remove(object.0)?)
    }

    /// Corners to draw for the whole world: pass the range to `draw`, and the vertex index to
    /// `umbrage_world_corner` of [`Shadows::wgsl`](crate::Shadows::wgsl).
    pub fn corners(&self) -> Range<u32> {
        0..3 * self.core.triangles.len() as u32
    }

    /// The same for one object, or for what the world was built from.
    ///
    /// # Errors
    /// A handle that is not valid.
    pub fn corners_of(&self, object: Option<Object>) -> Result<Range<u32>, Error> {
        let extent = match object {
            Some(object) => &self.core.object(object.0)?.extent,
            None => &self.core.fixed,
        };
        let triangles = &extent.triangles;
        Ok(3 * triangles.start..3 * triangles.end)
    }

    /// For each triangle in the order in which it is drawn, its number in the mesh that it came with:
    /// to bring materials, normals and texture coordinates into the same order. Triangles of the
    /// meshes that the world was built from are numbered through. Objects begin at a third of
    /// [`World::corners_of`], and leave gaps, of whose entries nothing is drawn.
    pub fn sources(&self) -> &[u32] {
        &self.core.source
    }

    /// Everything as it stands, objects in their poses: positions, triangles, casting rules.
    pub fn snapshot(&self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>, Vec<Casting>) {
        let mesh = self.core.to_mesh();
        let places = (0..mesh.positions.len() as u32).map(|v| mesh.places().at(v).to_array());
        (places.collect(), mesh.triangles, mesh.casting)
    }
}
