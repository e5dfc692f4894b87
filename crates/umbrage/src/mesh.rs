//! Triangles as a host has them.

use glam::{DVec3, Vec3};
use umbrage_core::Casting;

use crate::Error;

/// Borrowed triangles. Any soup will do: open, intersecting, with several triangles on an edge.
///
/// ```
/// use umbrage::{Casting, Mesh};
///
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let leaf = Mesh::new(&positions, &[0, 1, 2]).casting(&[Casting::Both]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    positions: &'a [[f32; 3]],
    indices: &'a [u32],
    casting: &'a [Casting],
    origin: [f64; 3],
}

impl<'a> Mesh<'a> {
    /// Positions in metres, and three indices a triangle, counter-clockwise seen from its front.
    /// Triangles cast where their front faces the light.
    pub fn new(positions: &'a [[f32; 3]], indices: &'a [u32]) -> Self {
        Self {
            positions,
            indices,
            casting: &[Casting::Front],
            origin: [0.0; 3],
        }
    }

    /// With this rule for all triangles, or these, one a triangle.
    #[must_use]
    pub fn casting(mut self, casting: &'a [Casting]) -> Self {
        self.casting = casting;
        self
    }

    /// With positions relative to this point of the world: 48 bits are kept of their sum.
    #[must_use]
    pub fn origin(mut self, origin: impl Into<[f64; 3]>) -> Self {
        self.origin = origin.into();
        self
    }
}

/// All triangles of meshes, one mesh after the other.
pub(crate) fn joined(meshes: &[Mesh<'_>]) -> Result<umbrage_core::Mesh, Error> {
    let mut all = umbrage_core::Mesh::default();
    for (number, mesh) in meshes.iter().enumerate() {
        let (triangles, rest) = mesh.indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(Error::Indices {
                mesh: number,
                indices: mesh.indices.len(),
            });
        }
        match mesh.casting {
            &[rule] => all.casting.extend(triangles.iter().map(|_| rule)),
            rules if rules.len() == triangles.len() => all.casting.extend(rules),
            rules => {
                return Err(Error::Casting {
                    mesh: number,
                    casting: rules.len(),
                    triangles: triangles.len(),
                });
            }
        }
        check_indices(mesh, all.triangles.len())?;
        let first = all.positions.len() as u32;
        let moved = triangles.iter().map(|t| t.map(|v| v.wrapping_add(first)));
        all.triangles.extend(moved);
        all.positions
            .extend(mesh.positions.iter().copied().map(Vec3::from));
    }
    if meshes.iter().any(|mesh| mesh.origin != [0.0; 3]) {
        let placed = meshes.iter().flat_map(|mesh| {
            let origin = DVec3::from(mesh.origin);
            let places = mesh.positions.iter();
            places.map(move |&p| origin + Vec3::from(p).as_dvec3())
        });
        all.stand(placed);
    }
    Ok(all)
}

/// Whether indices are of this mesh's vertices: joined with others, they could be of theirs.
fn check_indices(mesh: &Mesh<'_>, triangles_before: usize) -> Result<(), Error> {
    let vertices = mesh.positions.len();
    let outside = mesh.indices.iter().position(|&v| v as usize >= vertices);
    match outside {
        Some(at) => Err(umbrage_core::world::WorldError::IndexOutOfRange {
            triangle: triangles_before + at / 3,
            vertex: mesh.indices[at],
            vertices,
        }
        .into()),
        None => Ok(()),
    }
}
