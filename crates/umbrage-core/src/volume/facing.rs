//! Facing: a subset to its chain, 64 triangles at a time.
//!
//! Takes a subset and a light; gives the clusters in which a triangle casts. The f32 test is the
//! one of [`Planes::side`](crate::world::Planes::side), with its bound; triangles that the bound
//! leaves open are decided exactly, one by one.

use super::Chain;
use crate::lanes64::{Lanes64, with_lanes};
use crate::light::Light;
use crate::world::{LANES, LightPoint, Subset, World, exact_side, lanes};

/// Appends the chain of `subset` to `chain`.
pub fn facing(world: &World, light: &Light, subset: &Subset, chain: &mut Vec<Chain>) {
    let point = LightPoint::new(light);
    with_lanes!(facing_with(world, &point, subset, chain));
}

#[inline(always)]
fn facing_with<L: Lanes64>(
    l: L,
    world: &World,
    light: &LightPoint,
    subset: &Subset,
    chain: &mut Vec<Chain>,
) {
    for members in &subset.members {
        let at = members.cluster as usize;
        let planes = &world.planes.clusters[at];
        let (mut front, mut back) = l.sides(planes, &light.from(planes));
        let cluster = &world.clusters[at];
        let casts = members.mask & (cluster.casts_front | cluster.casts_back);
        let open = casts & !(front | back);
        if open != 0 {
            let (exact_front, exact_back) = exact_sides(world, light, members.cluster, open);
            front |= exact_front;
            back |= exact_back;
        }
        let wound = members.mask & front & cluster.casts_front;
        // No triangle both ways, whatever a saved world says of its planes: so volumes close.
        let reversed = members.mask & back & cluster.casts_back & !wound;
        if wound | reversed != 0 {
            chain.push(Chain {
                cluster: members.cluster,
                wound,
                reversed,
            });
        }
    }
}

#[cold]
fn exact_sides(world: &World, light: &LightPoint, cluster: u32, open: u64) -> (u64, u64) {
    let (mut front, mut back) = (0, 0);
    for lane in lanes(open) {
        let corners = world.corners(cluster * LANES as u32 + lane);
        match exact_side(corners, light.exact) {
            1 => front |= 1 << lane,
            -1 => back |= 1 << lane,
            _ => {}
        }
    }
    (front, back)
}
