//! Flattening: every instance of every mesh as one triangle soup in world space.
//!
//! Takes a [`Scene`]; gives a [`Soup`]. Transforms are applied in f64 and rounded to f32 once,
//! after the origin is subtracted, so an identity transform keeps the bits of the file and a world
//! far from zero keeps its detail. A transform that mirrors reverses the winding, so that the front
//! of a triangle stays its front.

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};

use crate::{Instance, Mesh, Scene, SceneError};

/// Most triangles that [`Scene::soup`] gives.
pub const MAX_TRIANGLES: u64 = 200_000_000;

/// One world-space triangle soup.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// World position that the positions are relative to: zero if the world contains it or lies
    /// near it, else the centre of the world in whole metres.
    pub origin: DVec3,
    /// World position minus origin; vertices are shared inside an instance, not between them.
    pub positions: Vec<Vec3>,
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
}

impl Scene {
    /// Flattens every instance into one soup, in the order of the instances.
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
        let used = self.check_used()?;
        let triangles = self.flattened_triangles() as usize;
        let vertices: usize = used.iter().map(|(_, m)| m.positions.len()).sum();
        let shaded = used.iter().any(|(_, m)| !m.normals.is_empty());
        let textured = used.iter().any(|(_, m)| !m.uvs.is_empty());

        let mut soup = Soup {
            origin: at.unwrap_or_else(|| origin(&used)),
            ..Soup::default()
        };
        self.reserve(&mut soup.positions, vertices)?;
        self.reserve(&mut soup.triangles, triangles)?;
        self.reserve(&mut soup.material, triangles)?;
        self.reserve(&mut soup.instance, triangles)?;
        self.reserve(&mut soup.normals, if shaded { triangles } else { 0 })?;
        self.reserve(&mut soup.uvs, if textured { triangles } else { 0 })?;

        for (index, &(instance, mesh)) in used.iter().enumerate() {
            let base = soup.positions.len();
            place(
                &instance.transform,
                soup.origin,
                &mesh.positions,
                &mut soup.positions,
            );
            if let Some(v) = soup.positions[base..].iter().position(|p| !p.is_finite()) {
                let what = format!("vertex {v} is not finite in world space");
                return Err(self.invalid(self.instance_item(index), what));
            }
            append(
                &mut soup,
                (index as u32, instance),
                mesh,
                base as u32,
                [shaded, textured],
            );
        }
        Ok(soup)
    }

    /// The mesh of each instance, once every index is known to be in range.
    fn check_used(&self) -> Result<Vec<(&Instance, &Mesh)>, SceneError> {
        let triangles = self.flattened_triangles();
        if triangles > MAX_TRIANGLES {
            let (scene, limit) = (self.name.clone(), MAX_TRIANGLES);
            return Err(SceneError::TooManyTriangles {
                scene,
                triangles,
                limit,
            });
        }
        self.check_meshes()?;
        let mut vertices = 0u64;
        let mut used = Vec::with_capacity(self.instances.len());
        for (i, instance) in self.instances.iter().enumerate() {
            let Some(mesh) = self.meshes.get(instance.mesh as usize) else {
                let what = format!("mesh {} of {}", instance.mesh, self.meshes.len());
                return Err(self.invalid(self.instance_item(i), what));
            };
            vertices += mesh.positions.len() as u64;
            used.push((instance, mesh));
        }
        if vertices > u64::from(u32::MAX) {
            let what = format!("{vertices} vertices do not fit 32-bit indices");
            return Err(self.invalid("flattened scene".to_owned(), what));
        }
        Ok(used)
    }

    /// That every mesh keeps the invariant of [`Scene`].
    pub(crate) fn check_meshes(&self) -> Result<(), SceneError> {
        for (m, mesh) in self.meshes.iter().enumerate() {
            self.check_mesh(mesh)
                .map_err(|what| self.invalid(format!("mesh {m} ({})", mesh.name), what))?;
        }
        Ok(())
    }

    /// What is wrong with a mesh, if anything.
    fn check_mesh(&self, mesh: &Mesh) -> Result<(), String> {
        let vertices = mesh.positions.len();
        for (what, len) in [("normals", mesh.normals.len()), ("uvs", mesh.uvs.len())] {
            if len != 0 && len != vertices {
                return Err(format!("{len} {what} for {vertices} vertices"));
            }
        }
        if mesh.materials.len() != mesh.triangles.len() {
            let (m, t) = (mesh.materials.len(), mesh.triangles.len());
            return Err(format!("{m} materials for {t} triangles"));
        }
        let beyond = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
        if let Some(t) = mesh.triangles.iter().position(beyond) {
            return Err(format!("triangle {t} names a vertex beyond {vertices}"));
        }
        let count = self.materials.len();
        if let Some(t) = mesh.materials.iter().position(|&m| m as usize >= count) {
            return Err(format!("triangle {t} names a material beyond {count}"));
        }
        Ok(())
    }

    fn instance_item(&self, index: usize) -> String {
        format!("instance {index} ({})", self.instances[index].name)
    }

    pub(crate) fn invalid(&self, item: String, what: String) -> SceneError {
        SceneError::Invalid {
            scene: self.name.clone(),
            item,
            what,
        }
    }

    fn reserve<T>(&self, into: &mut Vec<T>, count: usize) -> Result<(), SceneError> {
        into.try_reserve_exact(count)
            .map_err(|_| SceneError::OutOfMemory {
                scene: self.name.clone(),
                bytes: count as u64 * size_of::<T>() as u64,
            })
    }
}

/// Zero if the world's box lies within its own diagonal of zero, else its centre in whole metres.
fn origin(used: &[(&Instance, &Mesh)]) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (instance, mesh) in used {
        for p in &mesh.positions {
            let p = instance.transform.transform_point3(p.as_dvec3());
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

/// Appends the positions of one instance, rounded once.
fn place(transform: &DAffine3, origin: DVec3, from: &[Vec3], to: &mut Vec<Vec3>) {
    if *transform == DAffine3::IDENTITY && origin == DVec3::ZERO {
        to.extend_from_slice(from); // keeps the sign of zero too
        return;
    }
    to.extend(
        from.iter()
            .map(|p| (transform.transform_point3(p.as_dvec3()) - origin).as_vec3()),
    );
}

/// Appends the triangles of one instance and what belongs to their corners.
fn append(
    soup: &mut Soup,
    (index, instance): (u32, &Instance),
    mesh: &Mesh,
    base: u32,
    [shaded, textured]: [bool; 2],
) {
    let linear = instance.transform.matrix3;
    let mirrored = linear.determinant() < 0.0;
    let cofactors = cofactors(linear) * if mirrored { -1.0 } else { 1.0 };
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        let placed = corners.map(|v| base + v);
        soup.triangles.push(placed);
        soup.material.push(mesh.materials[t]);
        soup.instance.push(index);
        if shaded {
            let [p, q, r] = placed.map(|v| soup.positions[v as usize].as_dvec3());
            let face = (q - p).cross(r - p).try_normalize().unwrap_or(DVec3::Y);
            soup.normals.push(corners.map(|v| {
                let own = mesh.normals.get(v as usize).copied().unwrap_or(Vec3::ZERO);
                let own = (cofactors * own.as_dvec3()).try_normalize();
                own.unwrap_or(face).as_vec3()
            }));
        }
        if textured {
            let uv = |v: u32| mesh.uvs.get(v as usize).copied().unwrap_or(Vec2::ZERO);
            soup.uvs.push(corners.map(uv));
        }
    }
}

/// The matrix of cofactors: the inverse transpose times the determinant, defined for singular
/// matrices too. It takes normals to normals.
fn cofactors(m: DMat3) -> DMat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}
