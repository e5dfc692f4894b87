//! The classic: edges that point to their two faces (Crow 1977, Bergeron 1986). A baseline.
//!
//! An edge is a silhouette where its faces differ. Edges with more or fewer than two triangles get
//! what engines give them: triangles are paired off in opposite directions, and whoever is left
//! has a dangling edge with one face. Written as well as the idea allows: one linear pass over all
//! edges without a branch, or for a small chain a look at each side's other face.

use super::{Chain, Quad};
use crate::world::{EdgeUse, World};

/// Face adjacency of a world, and scratch.
#[derive(Clone, Debug, Default)]
pub struct Crow {
    /// The face that runs along an edge entry and the one that runs against it; `NONE` if missing.
    faces: Vec<[u32; 2]>,
    /// Edge of each entry: entries outnumber edges where more than two triangles meet.
    edge: Vec<u32>,
    /// Entry of each side.
    entry_of_side: Vec<[u32; 3]>,
    /// Coefficient of each triangle for the light at hand, and a 0 for `NONE`.
    coefficient: Vec<i8>,
}

impl Crow {
    /// Pairs off the triangles on each edge.
    pub fn new(world: &World) -> Self {
        let triangles = world.triangles.len();
        let none = triangles as u32;
        let mut crow = Self {
            coefficient: vec![0; triangles + 1],
            ..Self::default()
        };
        // Entries of an edge that still lack a face, newest first.
        let mut open: Vec<Vec<u32>> = vec![Vec::new(); world.edges.vertices.len()];
        for t in 0..none {
            let entries = world.edges.of_triangle(t).map(|u| {
                let kind = usize::from(u.sign() < 0);
                let waiting = &mut open[u.edge() as usize];
                let fits = waiting
                    .iter()
                    .position(|&e| crow.faces[e as usize][kind] == none);
                let entry = match fits {
                    Some(at) => waiting.swap_remove(at),
                    None => {
                        crow.faces.push([none; 2]);
                        crow.edge.push(u.edge());
                        waiting.push(crow.faces.len() as u32 - 1);
                        crow.faces.len() as u32 - 1
                    }
                };
                crow.faces[entry as usize][kind] = t;
                entry
            });
            crow.entry_of_side.push(entries);
        }
        crow
    }

    /// Bytes of adjacency: what edges with face pointers cost.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.faces[..])
            + size_of_val(&self.edge[..])
            + size_of_val(&self.entry_of_side[..])
    }

    /// Appends the silhouette of `chain` to `quads`.
    pub fn silhouette(&mut self, world: &World, chain: &[Chain], quads: &mut Vec<Quad>) {
        for t in chain.iter().flat_map(Chain::triangles) {
            self.coefficient[t.triangle() as usize] = t.coefficient() as i8;
        }
        if chain.len() * 4 > world.clusters.len() {
            self.all_edges(quads);
        } else {
            self.sides_of(chain, world, quads);
        }
        for t in chain.iter().flat_map(Chain::triangles) {
            self.coefficient[t.triangle() as usize] = 0;
        }
    }

    fn all_edges(&self, quads: &mut Vec<Quad>) {
        let mut len = quads.len();
        // At most two quads an entry, and nearly always at most one.
        quads.resize(len + 2 * self.faces.len(), Quad::default());
        for (&[along, against], &edge) in self.faces.iter().zip(&self.edge) {
            let count = self.coefficient[along as usize] - self.coefficient[against as usize];
            let quad = Quad(EdgeUse::new(edge, count < 0));
            quads[len] = quad;
            len += usize::from(count != 0);
            if count.unsigned_abs() == 2 {
                quads[len] = quad;
                len += 1;
            }
        }
        quads.truncate(len);
    }

    fn sides_of(&self, chain: &[Chain], world: &World, quads: &mut Vec<Quad>) {
        for t in chain.iter().flat_map(Chain::triangles) {
            let flip = u32::from(t.coefficient() < 0);
            let uses = world.edges.of_triangle(t.triangle());
            for (u, entry) in uses
                .into_iter()
                .zip(self.entry_of_side[t.triangle() as usize])
            {
                let other = self.faces[entry as usize][usize::from(u.sign() > 0)];
                if i32::from(self.coefficient[other as usize]) != t.coefficient() {
                    quads.push(Quad(EdgeUse(u.0 ^ flip)));
                }
            }
        }
    }
}
