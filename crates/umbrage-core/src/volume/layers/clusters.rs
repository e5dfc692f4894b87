//! What a light sees of the clusters of its chain: a box and a bound on the layers of each.
//!
//! Takes a chain; gives a [`Seen`] a cluster, some 2 ns a triangle.
//!
//! **The bound.** Let no triangle of the cluster meet some ray from the light, and `m` of them meet
//! another. A great circle through both rays is crossed once at most by what the light sees of an
//! edge. On the way from the one to the other and back the count changes at edges of the boundary
//! alone, by one a quad: up by `m` on one half of the circle, and down by `m` on the other. So the
//! boundary has at least `2 m` quads. For a directional light a line across takes the place of the
//! circle. A ray that meets none exists unless the box has the light in it; then the number of
//! triangles stands.

use glam::Vec3;

use crate::lanes64::{Lanes64, with_lanes};
use crate::light::Light;
use crate::volume::Chain;
use crate::world::{BoxCluster, Cluster, LANES, World};

/// A cluster's triangles in the chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    /// No ray from the light meets more of them.
    pub(super) layers: u32,
}

/// Replaces `seen` with an entry for each cluster of the chain.
pub(super) fn see(world: &World, light: &Light, chain: &[Chain], seen: &mut Vec<Seen>) {
    seen.clear();
    with_lanes!(see_with(world, light, chain, seen));
}

#[inline(always)]
fn see_with<L: Lanes64>(l: L, world: &World, light: &Light, chain: &[Chain], seen: &mut Vec<Seen>) {
    let anywhere = light.is_directional();
    for part in chain {
        let cluster = part.cluster as usize;
        let (low, high) = box_of(&world.boxes[cluster], part.wound | part.reversed);
        let around = low.as_dvec3().cmple(light.position) & high.as_dvec3().cmpge(light.position);
        let triangles = part.len() as u32;
        let layers = match around.all() && !anywhere {
            true => triangles,
            false => triangles.min(boundary(l, &world.clusters[cluster], part) / 2),
        };
        seen.push(Seen { low, high, layers });
    }
}

/// Quads of the boundary of a cluster's triangles, or more.
#[inline(always)]
fn boundary<L: Lanes64>(l: L, cluster: &Cluster, part: &Chain) -> u32 {
    let mut quads = 0;
    for side in &cluster.sides {
        for mask in [part.wound, part.reversed] {
            if mask != 0 {
                let cancelled = side.paired & l.permute(mask, &side.partner);
                quads += (mask & !cancelled).count_ones();
            }
        }
    }
    quads
}

/// Lanes worked on at a time.
const CHUNK: usize = 16;

/// The box of some of a cluster's triangles.
#[inline(always)]
fn box_of(boxes: &BoxCluster, mask: u64) -> (Vec3, Vec3) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for axis in 0..3 {
        let mut least = [f32::INFINITY; CHUNK];
        let mut most = [f32::NEG_INFINITY; CHUNK];
        for first in (0..LANES).step_by(CHUNK) {
            let bits = (mask >> first) as u16;
            for i in 0..CHUNK {
                let (min, max) = (boxes.min[axis][first + i], boxes.max[axis][first + i]);
                let is_in = bits & 1 << i != 0;
                least[i] = if is_in & (min < least[i]) {
                    min
                } else {
                    least[i]
                };
                most[i] = if is_in & (max > most[i]) {
                    max
                } else {
                    most[i]
                };
            }
        }
        for i in 0..CHUNK {
            low[axis] = low[axis].min(least[i]);
            high[axis] = high[axis].max(most[i]);
        }
    }
    (low.into(), high.into())
}
