//! Clusters: runs of 64 triangles in BVH order, with what the counter needs to know inside them.
//!
//! Takes the edge table; gives for every side of every triangle one of three answers: the edge has
//! this one triangle only; it has exactly one other, wound the other way, in the same cluster (its
//! *partner*, named by lane); or it is *shared* and needs a real counter. Inside a cluster the
//! boundary is then bit arithmetic on 64-bit masks. No edge knows a face; the partner lane is one
//! byte a side.

use bytemuck::{Pod, Zeroable};

use super::Edges;
use crate::mesh::Casting;

/// Triangles a cluster.
pub const LANES: usize = 64;

/// What the counter needs to know about 64 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Cluster {
    /// Triangles that cast where their front faces the light.
    pub casts_front: u64,
    /// Triangles that cast where their back faces the light.
    pub casts_back: u64,
    /// Sides (0,1), (1,2), (2,0).
    pub sides: [ClusterSide; 3],
}

/// One side of 64 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ClusterSide {
    /// Lane of the partner, where there is one.
    pub partner: [u8; LANES],
    /// Triangles that have a partner.
    pub paired: u64,
    /// Triangles whose edge needs a counter.
    pub shared: u64,
}

const NO_SIDE: ClusterSide = ClusterSide {
    partner: [0; LANES],
    paired: 0,
    shared: 0,
};

/// Clusters of all triangles; the last may be partly empty.
pub(super) fn clusters(casting: &[Casting], edges: &Edges) -> Vec<Cluster> {
    let mut clusters: Vec<Cluster> = casting
        .chunks(LANES)
        .map(|chunk| Cluster {
            casts_front: mask(chunk, |c| matches!(c, Casting::Front | Casting::Both)),
            casts_back: mask(chunk, |c| matches!(c, Casting::Back | Casting::Both)),
            sides: [NO_SIDE; 3],
        })
        .collect();

    // On each edge: sides that run along it, and against it, and one side of each kind.
    let mut users = vec![EdgeUsers::default(); edges.vertices.len()];
    for t in 0..casting.len() as u32 {
        for (k, u) in edges.of_triangle(t).into_iter().enumerate() {
            let kind = usize::from(u.sign() < 0);
            let user = &mut users[u.edge() as usize];
            user.count[kind] = user.count[kind].saturating_add(1);
            user.side[kind] = 3 * t + k as u32;
        }
    }
    for t in 0..casting.len() {
        for (k, u) in edges.of_triangle(t as u32).into_iter().enumerate() {
            let kind = usize::from(u.sign() < 0);
            let user = &users[u.edge() as usize];
            let side = &mut clusters[t / LANES].sides[k];
            let (lane, bit) = (t % LANES, 1u64 << (t % LANES));
            match (user.count[kind], user.count[1 - kind]) {
                (1, 0) => {}
                (1, 1) if user.side[1 - kind] as usize / (3 * LANES) == t / LANES => {
                    side.partner[lane] = (user.side[1 - kind] as usize / 3 % LANES) as u8;
                    side.paired |= bit;
                }
                _ => side.shared |= bit,
            }
        }
    }
    clusters
}

#[derive(Clone, Copy, Default)]
struct EdgeUsers {
    count: [u8; 2],
    side: [u32; 2],
}

fn mask(chunk: &[Casting], is: impl Fn(Casting) -> bool) -> u64 {
    chunk
        .iter()
        .enumerate()
        .map(|(lane, &c)| u64::from(is(c)) << lane)
        .sum()
}
