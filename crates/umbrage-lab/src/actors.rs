//! Actors: the instances of a scene that move, each an object of the stage's world.
//!
//! Takes a scene with a rig, flattened; inserts an object for each instance that is skinned or hangs
//! on a node that moves, and brings positions, normals and objects in step with a time. Invariant:
//! the positions in `soup`, in `mesh` (which the oracle sees) and in the world's object (which CPU
//! and GPU see) are the same f32, rounded once.

use std::collections::HashMap;
use std::ops::Range;

use glam::{DAffine3, Vec3};
use umbrage_core::Mesh;
use umbrage_core::world::{ObjectId, Pose, World};
use umbrage_scene::Scene;

use crate::stage::{Stage, StageError};

/// An instance on the move.
#[derive(Clone, Debug, PartialEq)]
pub struct Actor {
    /// Index into [`Scene::instances`].
    pub instance: u32,
    /// Its object in the stage's world, whose space is the world's.
    pub object: ObjectId,
    /// Its share of the positions of `soup` and `mesh`: the vertices of its mesh, in their order.
    pub vertices: Range<u32>,
    /// Its share of the triangles of `soup` and `mesh`. The source of a triangle of its object
    /// counts from the first of them.
    pub triangles: Range<u32>,
}

/// What a skin needs to be computed anew elsewhere, on a GPU say.
#[derive(Clone, Copy, Debug)]
pub struct Skinned<'a> {
    /// Positions as bound, four joints and weights a vertex.
    pub mesh: &'a umbrage_scene::Mesh,
    /// One a joint, at the stage's time: from positions as bound to world space, from which the
    /// stage's origin is still to be subtracted.
    pub matrices: &'a [DAffine3],
}

impl Stage {
    /// The skin of an actor at the stage's time; none for one that moves in one piece.
    /// [`World::vertices_of`] its object says which vertex of the world each vertex of the mesh is.
    pub fn skinned(&self, actor: &Actor) -> Option<Skinned<'_>> {
        let instance = self.scene.instances.get(actor.instance as usize)?;
        let mesh = self.scene.meshes.get(instance.mesh as usize)?;
        let matrices = self.posed.joints(instance).filter(|_| mesh.is_bound())?;
        Some(Skinned { mesh, matrices })
    }

    /// Moves everything that moves to where it is at a time in seconds: actors, and lights and
    /// cameras of the scene that hang on moving nodes. Ask for [`Stage::lights`] again after it. After
    /// an error what moves is between two times, until a later call succeeds.
    pub fn set_time(&mut self, time_s: f64) -> Result<(), StageError> {
        if time_s == self.time_s {
            return Ok(());
        }
        self.time_s = f64::NAN;
        let posed = self.scene.posed(time_s);
        let parts = self.actors.iter().map(|actor| {
            let triangles = actor.triangles.start as usize..actor.triangles.end as usize;
            (actor.instance, triangles)
        });
        self.soup.repose(&self.scene, &posed, parts);
        // An actor may have been taken out of the world.
        let there = |actor: &&Actor| self.world.object(actor.object).is_ok();
        let there: Vec<Actor> = self.actors.iter().filter(there).cloned().collect();
        for actor in &there {
            let places = actor.vertices.clone().map(|v| self.soup.place(v));
            let places: Vec<glam::DVec3> = places.collect();
            let deformed = self.world.deform(actor.object, &places);
            deformed.map_err(|error| StageError::actor(&self.scene, actor.instance, error))?;
            self.mesh.put(actor.vertices.start as usize, places);
        }
        self.scene.follow(&posed);
        self.posed = posed;
        self.time_s = time_s;
        Ok(())
    }

    /// [`Stage::mesh`] as it is at a time.
    pub(crate) fn mesh_at(&self, time_s: f64) -> Mesh {
        let posed = self.scene.posed(time_s);
        let (mut mesh, mut placed) = (self.mesh.clone(), Vec::new());
        for actor in &self.actors {
            let instance = &self.scene.instances[actor.instance as usize];
            let of = &self.scene.meshes[instance.mesh as usize];
            posed.positions(instance, of, self.soup.origin, &mut placed);
            mesh.put(actor.vertices.start as usize, placed.iter().copied());
        }
        mesh
    }

    /// For each triangle of the world its triangle in `soup`; none for padding, and for objects
    /// that are no actors.
    pub fn surfaces(&self) -> Vec<Option<u32>> {
        let world = &self.world;
        let fixed = world.fixed.triangles.end as usize;
        let mut surfaces = vec![None; world.triangles.len()];
        for (surface, &source) in surfaces[..fixed].iter_mut().zip(world.source.iter()) {
            *surface = Some(source);
        }
        for (actor, range) in self.actors.iter().filter_map(|a| Some((a, self.share(a)?))) {
            let source = &world.source[range.clone()];
            for (surface, &source) in surfaces[range].iter_mut().zip(source) {
                *surface = Some(actor.triangles.start + source);
            }
        }
        surfaces
    }

    /// The triangles of the world that are an actor's; none once its object was removed.
    pub(crate) fn share(&self, actor: &Actor) -> Option<Range<usize>> {
        let range = &self.world.object(actor.object).ok()?.extent.triangles;
        Some(range.start as usize..range.end as usize)
    }
}

/// What of the flattened scene never moves: its vertices and triangles, which come first.
pub fn fixed_part(scene: &Scene, soup: &umbrage_scene::Soup) -> [usize; 2] {
    let moving = scene.moving();
    let moves = |instance: &u32| moving[*instance as usize];
    let vertices = (0..).zip(&soup.vertices).filter(|(i, _)| !moves(i));
    [
        vertices.map(|(_, range)| range.end).max().unwrap_or(0) as usize,
        soup.instance.partition_point(|i| !moves(i)),
    ]
}

/// Inserts an object for each moving instance; `fixed` of the mesh's triangles do not move.
pub(crate) fn insert(
    scene: &Scene,
    soup: &umbrage_scene::Soup,
    mesh: &Mesh,
    fixed: usize,
    world: &mut World,
) -> Result<Vec<Actor>, StageError> {
    let mut actors = Vec::new();
    let mut end = fixed;
    for run in soup.instance[fixed..].chunk_by(|a, b| a == b) {
        let (instance, triangles) = (run[0], end..end + run.len());
        end = triangles.end;
        let vertices = soup.vertices[instance as usize].clone();
        let positions = vertices.start as usize..vertices.end as usize;
        let part = Mesh {
            positions: mesh.positions[positions.clone()].to_vec(),
            residuals: mesh.residuals.get(positions).unwrap_or_default().to_vec(),
            triangles: (mesh.triangles[triangles.clone()].iter())
                .map(|t| t.map(|v| v - vertices.start))
                .collect(),
            casting: mesh.casting[triangles.clone()].to_vec(),
        };
        let of = &scene.meshes[scene.instances[instance as usize].mesh as usize];
        let pose = Pose::at(glam::DVec3::ZERO);
        let inserted = world.insert_deforming(&part, &keys(of), &pose);
        actors.push(Actor {
            instance,
            object: inserted.map_err(|error| StageError::actor(scene, instance, error))?,
            vertices,
            triangles: triangles.start as u32..triangles.end as u32,
        });
    }
    Ok(actors)
}

/// One key for vertices that always move alike: those bound at one place to the same joints by the
/// same weights.
fn keys(mesh: &umbrage_scene::Mesh) -> Vec<u32> {
    let mut seen = HashMap::new();
    let key = |(v, p): (usize, &Vec3)| {
        // Adding zero turns -0 into 0, as welding does.
        let place = (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        let joints = mesh.joints.get(v).copied().unwrap_or_default();
        let weights = mesh.weights.get(v).copied().unwrap_or_default();
        let next = seen.len() as u32;
        *seen
            .entry((place, joints, weights.map(f32::to_bits)))
            .or_insert(next)
    };
    mesh.positions.iter().enumerate().map(key).collect()
}
