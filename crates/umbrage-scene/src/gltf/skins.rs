//! Skins: joints and the matrices they were bound with.
//!
//! Takes the root and the visited tree; gives one skin for each of the file's, under the same
//! index; none for a skin of which a joint is not in the scene. Source: glTF 2.0 specification,
//! section 3.7.3.

use glam::{DAffine3, DMat3, DVec3};

use super::nodes::Tree;
use super::{Context, name_or};
use crate::rig::Skin;
use crate::{Scene, SceneError};

/// Loads every skin.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    tree: &Tree,
) -> Result<Vec<Option<Skin>>, SceneError> {
    let root = context.root;
    let mut skins = Vec::with_capacity(root.skins.len());
    for (index, source) in root.skins.iter().enumerate() {
        let name = name_or(&source.name, "skin", index);
        let item = || format!("skin {index} ({name})");
        let broken = |path: &std::path::Path, what: String| SceneError::Skin {
            path: path.to_owned(),
            skin: index,
            name: name.clone(),
            what,
        };
        let count = source.joints.len();
        if count > usize::from(u16::MAX) + 1 {
            let what = format!("{count} joints, more than 16-bit numbers reach");
            return Err(broken(&context.path, what));
        }
        let mut joints = Vec::with_capacity(count);
        for joint in &source.joints {
            context.resolve(&root.nodes, joint.value(), "node", item)?;
            joints.extend(tree.place[joint.value()]);
        }
        let inverse_bind = match source.inverse_bind_matrices {
            None => vec![DAffine3::IDENTITY; count],
            Some(accessor) => {
                let mut matrices = context.vectors::<16>(accessor.value(), item)?;
                if matrices.len() < count {
                    let what = format!("{} matrices for {count} joints", matrices.len());
                    return Err(broken(&context.path, what));
                }
                matrices.truncate(count);
                if let Some(joint) = matrices
                    .iter()
                    .position(|m| !m.iter().all(|x| x.is_finite()))
                {
                    let what = format!("the matrix of joint {joint} is not finite");
                    return Err(broken(&context.path, what));
                }
                let odd = matrices
                    .iter()
                    .filter(|m| [m[3], m[7], m[11]] != [0.0; 3] || m[15] != 1.0);
                scene.report.repaired_transforms += odd.count() as u64;
                matrices.iter().map(affine).collect()
            }
        };
        skins.push((joints.len() == count && count > 0).then_some(Skin {
            name,
            joints,
            inverse_bind,
        }));
    }
    Ok(skins)
}

/// Column-major, the last row taken as 0 0 0 1.
fn affine(m: &[f32; 16]) -> DAffine3 {
    let column = |i: usize| DVec3::new(m[i].into(), m[i + 1].into(), m[i + 2].into());
    DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(4), column(8)),
        translation: column(12),
    }
}
