//! The rig of a file that has skins or animations, and which instances follow it.
//!
//! Takes the visited tree and what it carries; gives `scene.rig`. Invariant: an instance has a skin
//! only if its mesh has joints, each of them one of the skin's.

use super::nodes::Tree;
use super::{Context, clips, skins};
use crate::rig::{Rig, Skin};
use crate::{Mesh, Progress, Scene, SceneError};

/// Loads skins and clips, and binds instances to them.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    tree: Tree,
    progress: &dyn Progress,
) -> Result<(), SceneError> {
    let root = context.root;
    for instance in &scene.instances {
        if let Some(skin) = instance.skin {
            let item = || format!("node {}", instance.name);
            context.resolve(&root.skins, skin as usize, "skin", item)?;
        }
    }
    progress.stage("rig", root.animations.len() as u64);
    let skins = skins::load(context, scene, &tree)?;
    let clips = clips::load(context, scene, &tree)?;
    bind(context, scene, &skins)?;
    let moves = clips.iter().any(|clip| !clip.channels.is_empty());
    if !moves && scene.instances.iter().all(|i| i.skin.is_none()) {
        let nodes = (scene.instances.iter_mut().map(|i| &mut i.node))
            .chain(scene.lights.iter_mut().map(|l| &mut l.node))
            .chain(scene.cameras.iter_mut().map(|c| &mut c.node));
        nodes.for_each(|node| *node = None);
        return Ok(());
    }
    scene.rig = Some(Rig {
        nodes: tree.nodes,
        // A skin left out keeps its number; no instance has it.
        skins: skins.into_iter().map(Option::unwrap_or_default).collect(),
        playing: (!clips.is_empty()).then_some(0).into_iter().collect(),
        clips,
    });
    Ok(())
}

/// Takes the skin from instances that cannot follow it.
fn bind(
    context: &Context<'_>,
    scene: &mut Scene,
    skins: &[Option<Skin>],
) -> Result<(), SceneError> {
    let last_joint: Vec<Option<u16>> = scene.meshes.iter().map(last_joint).collect();
    for instance in &mut scene.instances {
        let Some(number) = instance.skin else {
            continue;
        };
        let skin = skins.get(number as usize).and_then(Option::as_ref);
        let what = match (last_joint[instance.mesh as usize], skin) {
            (_, None) => "it has no joints, or some are not in the scene",
            (None, _) => "the mesh has no joints and weights",
            (Some(last), Some(skin)) if usize::from(last) >= skin.joints.len() => {
                let mesh = instance.mesh as usize;
                return Err(SceneError::Dangling {
                    path: context.path.clone(),
                    from: format!("mesh {mesh} ({})", scene.meshes[mesh].name),
                    kind: "joint",
                    index: last.into(),
                    len: skin.joints.len() as u64,
                });
            }
            _ => continue,
        };
        instance.skin = None;
        scene.report.ignored_skins += 1;
        let note = || format!("node {}: skin {number} left out: {what}", instance.name);
        scene.report.note(note);
    }
    Ok(())
}

/// The highest joint that a vertex of the mesh follows.
fn last_joint(mesh: &Mesh) -> Option<u16> {
    let joints = mesh.joints.iter().flatten();
    joints.max().copied().filter(|_| mesh.is_bound())
}
