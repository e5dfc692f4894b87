//! Flattening: every instance of every mesh as one triangle soup in world space.
//!
//! Takes a [`Scene`]; gives a [`Soup`]. Transforms are applied in f64 and rounded to f32 once,
//! after the origin is subtracted, so an identity transform keeps the bits of the file and a world
//! far from zero keeps its detail. Where that rounding would move a vertex by more than
//! [`MAX_ROUNDING_M`], what it leaves is kept as well. A transform that mirrors reverses the winding, so that the front
//! of a triangle stays its front; what mirrors does so by how it stands at rest (or, without volume
//! then, as soon as it has one), so that triangles are the same at all times.

use std::ops::Range;

use glam::{DMat3, DVec3, Vec2, Vec3};

use crate::rig::{Placing, Posed};
use crate::{Instance, Mesh, Scene, SceneError};

/// Most triangles that [`Scene::soup`] gives.
pub const MAX_TRIANGLES: u64 = 200_000_000;

/// How far rounding to f32 may move a vertex along an axis, in metres: an eighth of a millimetre, as
/// happens from 2 km on.
pub const MAX_ROUNDING_M: f32 = 1.0 / 8192.0;

/// One world-space triangle soup.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// World position that the positions are relative to: zero if the world contains it or lies
    /// near it, else the centre of the world in whole metres. What never moves decides, if
    /// anything does not.
    pub origin: DVec3,
    /// World position minus origin; vertices are shared inside an instance, not between them.
    pub positions: Vec<Vec3>,
    /// What f32 leaves of each position; empty where that is nowhere more than [`MAX_ROUNDING_M`].
    pub residuals: Vec<Vec3>,
    /// Three indices into `positions` a triangle; counter-clockwise seen from its front.
    pub triangles: Vec<[u32; 3]>,
    /// One index into [`Scene::materials`] a triangle.
    pub material: Vec<u32>,
    /// One index into [`Scene::instances`] a triangle.
    pub instance: Vec<u32>,
    /// One unit normal a corner, the face's where the mesh has none; empty if no mesh has any.
    pub normals: Vec<[Vec3; 3]>,
    /// One texture coordinate a corner, zero where the mesh has none; empty if no mesh has any.
    pub uvs: Vec<[Vec2; 3]>,
    /// The vertices of each of [`Scene::instances`], in the order of its mesh.
    pub vertices: Vec<Range<u32>>,
    /// Whether the winding of each of [`Scene::instances`] is reversed.
    pub mirrored: Vec<bool>,
}

impl Scene {
    /// Flattens every instance into one soup as the file puts it, with nothing playing: first the
    /// instances that never move, then those that may ([`Scene::moving`]).
    ///
    /// # Errors
    /// More than [`MAX_TRIANGLES`] triangles or 2^32 vertices, no memory for them, an index out of
    /// range, or a vertex that is not finite in f32 relative to the origin.
    pub fn soup(&self) -> Result<Soup, SceneError> {
        self.soup_at(None)
    }

    /// [`Scene::soup`] relative to a given origin.
    ///
    /// # Errors
    /// As [`Scene::soup`].
    pub fn soup_at(&self, at: Option<DVec3>) -> Result<Soup, SceneError> {
        self.soup_posed(&self.rest(), at)
    }

    /// [`Scene::soup_at`] with what moves where `posed` says.
    ///
    /// # Errors
    /// As [`Scene::soup`].
    pub fn soup_posed(&self, posed: &Posed, at: Option<DVec3>) -> Result<Soup, SceneError> {
        let used = self.check_used()?;
        let moving = self.moving();
        let mut order: Vec<usize> = (0..used.len()).collect();
        order.sort_by_key(|&i| moving[i]);
        let triangles = self.flattened_triangles() as usize;
        let vertices: usize = used.iter().map(|(_, m)| m.positions.len()).sum();
        let shaded = used.iter().any(|(_, m)| !m.normals.is_empty());
        let textured = used.iter().any(|(_, m)| !m.uvs.is_empty());

        let mut soup = Soup {
            origin: at.unwrap_or_else(|| origin(&used, &moving, posed)),
            vertices: vec![0..0; used.len()],
            mirrored: self.mirrored(),
            ..Soup::default()
        };
        self.reserve(&mut soup.positions, vertices)?;
        self.reserve(&mut soup.residuals, vertices)?;
        self.reserve(&mut soup.triangles, triangles)?;
        self.reserve(&mut soup.material, triangles)?;
        self.reserve(&mut soup.instance, triangles)?;
        self.reserve(&mut soup.normals, if shaded { triangles } else { 0 })?;
        self.reserve(&mut soup.uvs, if textured { triangles } else { 0 })?;

        for index in order {
            let (instance, mesh) = used[index];
            let base = soup.positions.len();
            let placing = posed.placing(instance, mesh);
            placing.place(mesh, soup.origin, |p| {
                let [position, residual] = split(p);
                soup.positions.push(position);
                soup.residuals.push(residual);
            });
            soup.vertices[index] = base as u32..soup.positions.len() as u32;
            if let Some(v) = soup.positions[base..].iter().position(|p| !p.is_finite()) {
                let what = format!("vertex {v} is not finite in world space");
                return Err(self.invalid(self.instance_item(index), what));
            }
            let part = Part {
                index: index as u32,
                mesh,
                placing,
                mirrored: soup.mirrored[index],
                base: base as u32,
            };
            append(&mut soup, &part, [shaded, textured]);
        }
        let moved = |r: &Vec3| r.abs().max_element() > MAX_ROUNDING_M;
        if !soup.residuals.iter().any(moved) {
            soup.residuals = Vec::new();
        }
        Ok(soup)
    }

    fn reserve<T>(&self, into: &mut Vec<T>, count: usize) -> Result<(), SceneError> {
        into.try_reserve_exact(count)
            .map_err(|_| SceneError::OutOfMemory {
                scene: self.name.clone(),
                bytes: count as u64 * size_of::<T>() as u64,
            })
    }
}

/// A place rounded to f32, and what that leaves.
fn split(p: DVec3) -> [Vec3; 2] {
    let position = p.as_vec3();
    [position, (p - position.as_dvec3()).as_vec3()]
}

/// The place that is kept as position and residual `v`.
fn place([positions, residuals]: [&[Vec3]; 2], v: u32) -> DVec3 {
    let residual = residuals.get(v as usize).copied().unwrap_or_default();
    positions[v as usize].as_dvec3() + residual.as_dvec3()
}

impl Soup {
    /// Bytes of one triangle, with or without normals and texture coordinates.
    pub(crate) fn triangle_bytes(shaded: bool, textured: bool) -> usize {
        let normals = if shaded { size_of::<[Vec3; 3]>() } else { 0 };
        let uvs = if textured { size_of::<[Vec2; 3]>() } else { 0 };
        size_of::<([u32; 3], u32, u32)>() + normals + uvs
    }

    /// Where vertex `v` stands relative to the origin.
    pub fn place(&self, v: u32) -> DVec3 {
        place([&self.positions, &self.residuals], v)
    }

    /// Moves instances of `scene` to where `posed` puts them: their positions and normals. Each comes
    /// with its share of `triangles`.
    pub fn repose(
        &mut self,
        scene: &Scene,
        posed: &Posed,
        instances: impl Iterator<Item = (u32, Range<usize>)>,
    ) {
        for (index, range) in instances {
            let Some(instance) = scene.instances.get(index as usize) else {
                continue;
            };
            let (Some(mesh), Some(vertices), Some(&mirrored)) = (
                scene.meshes.get(instance.mesh as usize),
                self.vertices.get(index as usize),
                self.mirrored.get(index as usize),
            ) else {
                continue;
            };
            let placing = posed.placing(instance, mesh);
            let mut at = vertices.start as usize;
            placing.place(mesh, self.origin, |p| {
                let [position, residual] = split(p);
                self.positions[at] = position;
                if let Some(old) = self.residuals.get_mut(at) {
                    *old = residual;
                }
                at += 1;
            });
            if !self.normals.is_empty() {
                let part = Part {
                    index,
                    mesh,
                    placing,
                    mirrored,
                    base: vertices.start,
                };
                let triangles = self.triangles[range.clone()].iter();
                let triangles = triangles.zip(&mut self.normals[range]);
                shade(&part, [&self.positions, &self.residuals], triangles);
            }
        }
    }
}

/// Zero if the box of what never moves (of everything, if all moves) lies within its own diagonal
/// of zero, else its centre in whole metres.
fn origin(used: &[(&Instance, &Mesh)], moving: &[bool], posed: &Posed) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let all = moving.iter().all(|&moves| moves);
    for (&(instance, mesh), _) in used.iter().zip(moving).filter(|(_, moves)| all || !**moves) {
        let placing = posed.placing(instance, mesh);
        for (v, p) in mesh.positions.iter().enumerate() {
            let p = placing.of_vertex(mesh, v).transform_point3(p.as_dvec3());
            low = low.min(p);
            high = high.max(p);
        }
    }
    let nearest = DVec3::ZERO.clamp(low.min(high), high.max(low));
    let far = nearest.length() > (high - low).length();
    if far {
        ((low + high) * 0.5).round()
    } else {
        DVec3::ZERO
    }
}

/// One instance on its way into a soup that has its positions.
struct Part<'a> {
    index: u32,
    mesh: &'a Mesh,
    placing: Placing<'a>,
    mirrored: bool,
    /// Its first vertex.
    base: u32,
}

/// Appends the triangles of one instance and what belongs to their corners.
fn append(soup: &mut Soup, part: &Part<'_>, [shaded, textured]: [bool; 2]) {
    let mesh = part.mesh;
    let first = soup.triangles.len();
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let corners = if part.mirrored { [a, c, b] } else { [a, b, c] };
        soup.triangles.push(corners.map(|v| part.base + v));
        soup.material.push(mesh.materials[t]);
        soup.instance.push(part.index);
        if textured {
            let uv = |v: u32| mesh.uvs.get(v as usize).copied().unwrap_or(Vec2::ZERO);
            soup.uvs.push(corners.map(uv));
        }
    }
    if shaded {
        soup.normals.resize(soup.triangles.len(), [Vec3::ZERO; 3]);
        let Soup {
            positions,
            residuals,
            triangles,
            normals,
            ..
        } = soup;
        let triangles = triangles[first..].iter().zip(&mut normals[first..]);
        shade(part, [positions, residuals], triangles);
    }
}

/// Writes the normals of triangles of one instance: the mesh's own where it has them, the face's
/// where it has none.
fn shade<'t>(
    part: &Part<'_>,
    kept: [&[Vec3]; 2],
    triangles: impl Iterator<Item = (&'t [u32; 3], &'t mut [Vec3; 3])>,
) {
    let turned = |linear: DMat3| cofactors(linear) * if part.mirrored { -1.0 } else { 1.0 };
    let rigid = match part.placing {
        Placing::Rigid(transform) => Some(turned(transform.matrix3)),
        Placing::Skinned(_) => None,
    };
    let mesh = part.mesh;
    for (corners, normals) in triangles {
        let [p, q, r] = corners.map(|v| place(kept, v));
        let face = (q - p).cross(r - p).try_normalize().unwrap_or(DVec3::Y);
        *normals = corners.map(|v| {
            let v = (v - part.base) as usize;
            let own = mesh.normals.get(v).copied().unwrap_or(Vec3::ZERO);
            let to_world = rigid.unwrap_or_else(|| turned(part.placing.of_vertex(mesh, v).matrix3));
            let own = (to_world * own.as_dvec3()).try_normalize();
            own.unwrap_or(face).as_vec3()
        });
    }
}

/// The matrix of cofactors: the inverse transpose times the determinant, defined for singular
/// matrices too. It takes normals to normals.
fn cofactors(m: DMat3) -> DMat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}
