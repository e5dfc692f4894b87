//! The classic: unique edges with two face pointers each (Crow 1977, Bergeron 1986). A baseline.
//!
//! Takes a chain; gives a quad for each edge whose two faces differ, wound as the face that casts.
//! The edge and its test are those of Aldridge and Woods 2004 (section 2.1), the rule for open edges
//! that of the depth-fail tutorials (`if f0 > -1 && f1 > -1`). On a consistently wound two-manifold
//! the quads are the counter's. Elsewhere they are what the idea makes of the geometry, and the
//! volume need not close:
//! - an edge of one triangle casts no quad;
//! - a third and any later triangle on an edge is not seen: whatever it casts there is lost;
//! - of two triangles that run the same way along their edge, the second is taken to run against
//!   it. Both facing, they cast no quad where two are due; the second alone facing, its quad is
//!   wound the wrong way round.
//!
//! A face outside the subset counts as one that does not cast (section 2.2). Written as well as the
//! idea allows: one linear pass over all edges without a branch, or for a small chain a look at
//! each side's edge.

use super::{Chain, Quad};
use crate::world::{EdgeUse, World};

/// Face pointers of a world's edges.
#[derive(Clone, Debug, Default)]
pub struct Crow {
    /// Of each edge, the face that runs along it, then the one that runs against it; the only face
    /// of an open edge twice, so that it differs from no one.
    faces: Vec<[u32; 2]>,
    /// Of the world that they were found in.
    topology: Vec<u64>,
}

impl Crow {
    /// Finds the faces of each edge.
    pub fn new(world: &World) -> Self {
        const NONE: u32 = u32::MAX;
        let mut faces = vec![[NONE; 2]; world.edges.vertices.len()];
        for (t, corners) in (0..).zip(&world.triangles[..]) {
            // What fills up the slots of objects is no triangle.
            if corners[0] == corners[1] {
                continue;
            }
            for u in world.edges.of_triangle(t) {
                let edge = &mut faces[u.edge() as usize];
                match edge.iter().position(|&face| face == NONE) {
                    // The first takes the place of its direction, the second what is left.
                    Some(0) if edge[1] == NONE => edge[usize::from(u.sign() < 0)] = t,
                    Some(left) => edge[left] = t,
                    None => {}
                }
            }
        }
        for [along, against] in &mut faces {
            match (*along, *against) {
                // No triangle uses this edge now: any will do.
                (NONE, NONE) => (*along, *against) = (0, 0),
                (NONE, face) => *along = face,
                (face, NONE) => *against = face,
                _ => {}
            }
        }
        Self {
            faces,
            topology: world.topology(),
        }
    }

    /// Finds the faces anew if triangles came or went since; objects that moved change nothing.
    pub fn update(&mut self, world: &World) {
        if self.topology != world.topology() {
            *self = Self::new(world);
        }
    }

    /// Bytes of adjacency: face pointers, and each triangle's edges.
    pub fn bytes(&self, world: &World) -> usize {
        size_of_val(&self.faces[..]) + size_of_val(&world.edges.sides[..])
    }

    /// Appends the silhouette of `chain` to `quads`. `coefficients` has one entry a triangle, all
    /// zero, and is all zero again afterwards.
    pub fn silhouette(
        &self,
        world: &World,
        chain: &[Chain],
        coefficients: &mut [i8],
        quads: &mut Vec<Quad>,
    ) {
        for t in chain.iter().flat_map(Chain::triangles) {
            coefficients[t.triangle() as usize] = t.coefficient() as i8;
        }
        if chain.len() * 4 > world.clusters.len() {
            self.all_edges(coefficients, quads);
        } else {
            self.sides_of(chain, world, coefficients, quads);
        }
        for t in chain.iter().flat_map(Chain::triangles) {
            coefficients[t.triangle() as usize] = 0;
        }
    }

    fn all_edges(&self, coefficients: &[i8], quads: &mut Vec<Quad>) {
        let mut len = quads.len();
        // At most two quads an edge, and nearly always at most one.
        quads.resize(len + 2 * self.faces.len(), Quad::default());
        for (edge, &[along, against]) in (0..).zip(&self.faces) {
            let count = coefficients[along as usize] - coefficients[against as usize];
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

    fn sides_of(&self, chain: &[Chain], world: &World, coefficients: &[i8], quads: &mut Vec<Quad>) {
        let mut len = quads.len();
        let triangles: usize = chain.iter().map(Chain::len).sum();
        // Written without a branch, kept if one is due.
        quads.resize(len + 3 * triangles, Quad::default());
        for t in chain.iter().flat_map(Chain::triangles) {
            for u in world.edges.of_triangle(t.triangle()) {
                let [along, against] = self.faces[u.edge() as usize];
                let count = coefficients[along as usize] - coefficients[against as usize];
                quads[len] = Quad(EdgeUse::new(u.edge(), count < 0));
                // Two are due where both faces cast, from opposite sides: one from each.
                let is_face = (t.triangle() == along) | (t.triangle() == against);
                len += usize::from(is_face & (count != 0));
            }
        }
        quads.truncate(len);
    }
}
