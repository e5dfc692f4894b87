//! Face normals of skinned characters, as the article has them ("Using Shadow Volumes with Character
//! Animation").
//!
//! Takes the stage's actors; gives for each corner of an object's triangle the normal at rest, and
//! the joints and weights that turn it: those of the corner itself, or the same for all three corners,
//! averaged over them. Positions come posed from the world's own buffer, the same bits for the visible
//! surface and for its volume; only whether a triangle faces the light hangs on these normals.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use glam::DMat3;
use umbrage_core::world::World;

use crate::actors::Skinned;
use crate::method::Normals;
use crate::stage::Stage;

/// What turns the normal of one corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SkinnedCorner {
    /// Of the triangle as bound; all zero where the corner has no skin.
    normal: [f32; 3],
    unused: f32,
    /// Numbers of joints, counted over all actors.
    joints: [u32; 4],
    weights: [f32; 4],
}

/// One entry for each corner after the fixed triangles; at least one, and no more if normals are
/// found anew.
pub(super) fn corners(stage: &Stage, normals: Normals) -> Vec<SkinnedCorner> {
    let world = &stage.world;
    let fixed = world.fixed.triangles.end as usize;
    if normals == Normals::Neighbours {
        return vec![SkinnedCorner::default()];
    }
    let count = 3 * (world.triangles.len() - fixed);
    let mut all = vec![SkinnedCorner::default(); count.max(1)];
    let mut first_joint = 0;
    for actor in &stage.actors {
        let Some(skin) = stage.skinned(actor) else {
            continue;
        };
        let joints = first_joint;
        first_joint += skin.matrices.len() as u32;
        // Gone actors have joints, but no triangles.
        let Ok(object) = world.object(actor.object) else {
            continue;
        };
        let Ok(became) = world.vertices_of(actor.object) else {
            continue;
        };
        let bound: HashMap<u32, usize> = (became.iter().enumerate())
            .filter_map(|(ours, theirs)| theirs.map(|theirs| (theirs, ours)))
            .collect();
        for t in object.extent.triangles.clone() {
            let vertices = world.triangles[t as usize].map(|v| bound.get(&v).copied());
            let [Some(a), Some(b), Some(c)] = vertices else {
                continue;
            };
            let place = 3 * (t as usize - fixed);
            all[place..place + 3].copy_from_slice(&of_triangle(&skin, [a, b, c], joints, normals));
        }
    }
    all
}

fn of_triangle(
    skin: &Skinned<'_>,
    vertices: [usize; 3],
    first_joint: u32,
    normals: Normals,
) -> [SkinnedCorner; 3] {
    let [a, b, c] = vertices.map(|v| skin.mesh.positions[v]);
    let normal = (b - a).cross(c - a).normalize_or_zero().to_array();
    let corner = |bones: [(u16, f32); 4]| SkinnedCorner {
        normal,
        unused: 0.0,
        joints: bones.map(|(joint, _)| first_joint + u32::from(joint)),
        weights: bones.map(|(_, weight)| weight),
    };
    let of_vertex = |v: usize| {
        let (joints, weights) = (skin.mesh.joints[v], skin.mesh.weights[v]);
        [0, 1, 2, 3].map(|i| (joints[i], weights[i]))
    };
    match normals {
        Normals::FaceWeights => [corner(averaged(vertices.map(of_vertex))); 3],
        _ => vertices.map(|v| corner(of_vertex(v))),
    }
}

/// The four heaviest joints of three vertices together, with weights that sum to 1.
fn averaged(vertices: [[(u16, f32); 4]; 3]) -> [(u16, f32); 4] {
    let mut sums: Vec<(u16, f32)> = Vec::with_capacity(12);
    for (joint, weight) in vertices.into_iter().flatten() {
        match sums.iter_mut().find(|(known, _)| *known == joint) {
            Some((_, sum)) => *sum += weight,
            None => sums.push((joint, weight)),
        }
    }
    sums.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sums.resize(4, (0, 0.0));
    let total: f32 = sums.iter().map(|(_, weight)| weight).sum();
    [0, 1, 2, 3].map(|i| (sums[i].0, sums[i].1 / total.max(f32::MIN_POSITIVE)))
}

/// What a joint does to normals: three columns a joint of all actors, padded to four numbers; at
/// least one joint. The cofactors of its matrix: they keep fronts in front under mirrors too.
pub(super) fn matrices(stage: &Stage) -> Vec<[[f32; 4]; 3]> {
    let column = |c: glam::DVec3| c.extend(0.0).as_vec4().to_array();
    let of_joint = |m: &glam::DAffine3| {
        let m: DMat3 = m.matrix3;
        [
            column(m.y_axis.cross(m.z_axis)),
            column(m.z_axis.cross(m.x_axis)),
            column(m.x_axis.cross(m.y_axis)),
        ]
    };
    let skins = stage.actors.iter().filter_map(|actor| stage.skinned(actor));
    let mut all: Vec<_> = skins
        .flat_map(|skin| skin.matrices.iter().map(of_joint).collect::<Vec<_>>())
        .collect();
    all.resize(all.len().max(1), [[0.0; 4]; 3]);
    all
}

/// First corner that has an entry.
pub(super) fn first_corner(world: &World) -> u32 {
    3 * world.fixed.triangles.end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn face_weights_are_averages_of_the_heaviest() {
        let one = |joint| [(joint, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let two = [(7, 0.75), (2, 0.25), (0, 0.0), (0, 0.0)];
        let found = averaged([one(7), two, one(2)]);
        assert_eq!(found[0].0, 7);
        assert!((found[0].1 - 1.75 / 3.0).abs() < 1e-6);
        assert!((found[1].1 - 1.25 / 3.0).abs() < 1e-6);
        let many = [[(1, 0.4), (2, 0.3), (3, 0.2), (4, 0.1)], one(5), one(6)];
        let kept = averaged(many).map(|(joint, _)| joint);
        assert_eq!(kept, [5, 6, 1, 2]);
        let sum: f32 = averaged(many).iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-6 && averaged([one(0); 3])[0] == (0, 1.0));
    }
}
