//! Faces of an OBJ file as an indexed mesh.
//!
//! Takes corners `v`, `v/vt`, `v//vn`, `v/vt/vn`, counted from 1 or backwards from -1; gives a
//! mesh with one vertex for each combination that its faces use. Invariant: every index is in
//! range of the attributes read before the face.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::polygon;
use crate::{LoadReport, Mesh};

/// Everything that `v`, `vt` and `vn` have said so far.
#[derive(Default)]
pub(super) struct Attributes {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
}

/// Position, texture coordinate and normal of a corner; `NONE` where it names none.
type Corner = [u32; 3];

const NONE: u32 = u32::MAX;

/// The mesh that is being read.
#[derive(Default)]
pub(super) struct Faces {
    pub(super) name: String,
    mesh: Mesh,
    corners: HashMap<Corner, u32>,
    /// Corners of the face at hand, kept to save allocations.
    face: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

impl Faces {
    /// Appends one face, cut into triangles.
    pub(super) fn add<'a>(
        &mut self,
        words: impl Iterator<Item = &'a str>,
        attributes: &Attributes,
        material: u32,
        report: &mut LoadReport,
    ) -> Result<(), String> {
        self.face.clear();
        for word in words.take_while(|w| !w.starts_with('#')) {
            self.face.push(corner(word, attributes, report)?);
        }
        if self.face.len() < 3 {
            report.skipped_faces += 1;
            report.note(|| "face with fewer than three corners skipped".to_owned());
            return Ok(());
        }
        self.triangles.clear();
        let place = |i: usize| attributes.positions[self.face[i][0] as usize];
        polygon::triangulate(self.face.len(), place, &mut self.triangles);
        for t in 0..self.triangles.len() {
            let vertices = self.triangles[t].map(|i| self.vertex(i as usize, attributes, report));
            self.mesh.triangles.push(vertices);
            self.mesh.materials.push(material);
        }
        Ok(())
    }

    /// The vertex of corner `i` of the face at hand.
    fn vertex(&mut self, i: usize, attributes: &Attributes, report: &mut LoadReport) -> u32 {
        let corner = self.face[i];
        let next = self.mesh.positions.len() as u32;
        let vertex = *self.corners.entry(corner).or_insert(next);
        if vertex == next {
            let [position, uv, normal] = corner.map(|i| i as usize);
            let mesh = &mut self.mesh;
            mesh.positions.push(attributes.positions[position]);
            if corner[1] != NONE {
                mesh.uvs.resize(next as usize, Vec2::ZERO);
                mesh.uvs.push(attributes.uvs[uv]);
            }
            if corner[2] != NONE {
                mesh.normals.resize(next as usize, Vec3::ZERO);
                let unit = attributes.normals[normal].try_normalize();
                report.repaired_normals += u64::from(unit.is_none());
                mesh.normals.push(unit.unwrap_or(Vec3::ZERO));
            }
        }
        vertex
    }

    /// Ends the mesh; `None` if it has no triangles.
    pub(super) fn take(&mut self, index: usize) -> Option<Mesh> {
        self.corners.clear();
        let mut mesh = std::mem::take(&mut self.mesh);
        let name = std::mem::take(&mut self.name);
        if mesh.triangles.is_empty() {
            return None;
        }
        let count = mesh.positions.len();
        if !mesh.normals.is_empty() {
            mesh.normals.resize(count, Vec3::ZERO);
        }
        if !mesh.uvs.is_empty() {
            mesh.uvs.resize(count, Vec2::ZERO);
        }
        mesh.name = if name.is_empty() {
            format!("mesh_{index}")
        } else {
            name
        };
        Some(mesh)
    }
}

/// The indices of one corner. Geometry does not need its second and third: out of range they are
/// left out and counted.
fn corner(word: &str, attributes: &Attributes, report: &mut LoadReport) -> Result<Corner, String> {
    let counts = [
        attributes.positions.len(),
        attributes.uvs.len(),
        attributes.normals.len(),
    ];
    let kinds = ["vertices", "texture coordinates", "normals"];
    let mut corner = [NONE; 3];
    for (slot, text) in word.split('/').enumerate() {
        if slot >= 3 {
            return Err(format!("corner {:?} has more than three parts", clip(word)));
        }
        if text.is_empty() && slot > 0 {
            continue;
        }
        match resolve(text, counts[slot], kinds[slot]) {
            Ok(index) => corner[slot] = index,
            Err(what) if slot == 0 => return Err(what),
            Err(what) => {
                report.dropped_attributes += 1;
                report.note(|| what);
            }
        }
    }
    Ok(corner)
}

/// An index from 1, or backwards from -1, as an index from 0.
fn resolve(text: &str, count: usize, kind: &str) -> Result<u32, String> {
    let bad = || format!("index {:?} where there are {count} {kind}", clip(text));
    let index: i64 = text.parse().map_err(|_| bad())?;
    let index = if index < 0 {
        index.checked_add(count as i64)
    } else {
        index.checked_sub(1)
    };
    let index = index
        .filter(|&i| (0..count as i64).contains(&i))
        .ok_or_else(bad)?;
    u32::try_from(index)
        .ok()
        .filter(|&i| i != NONE)
        .ok_or_else(bad)
}

fn clip(text: &str) -> String {
    text.chars().take(30).collect()
}
