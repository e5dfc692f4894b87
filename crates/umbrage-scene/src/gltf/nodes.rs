//! The node tree: instances, lights and cameras in world space.
//!
//! Takes the root; gives `scene.instances`, `scene.lights` and `scene.cameras` in the order of
//! the tree. Transforms are composed in f64. Invariant: every node is visited at most once, on a
//! stack of our own, so that neither cycles nor deep trees do harm.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use gltf::json::extensions::scene::khr_lights_punctual::Light;
use gltf::json::{Index, Node, Value};

use super::{Context, lights, name_or};
use crate::{Instance, Progress, Scene, SceneError};

/// Walks the nodes of the default scene, else of the first, else all nodes without a parent.
pub(super) fn load(
    context: &Context<'_>,
    scene: &mut Scene,
    progress: &dyn Progress,
) -> Result<(), SceneError> {
    let nodes = &context.root.nodes;
    progress.stage("nodes", nodes.len() as u64);
    let mut visited = vec![false; nodes.len()];
    let mut stack: Vec<(usize, Option<usize>, DAffine3)> = Vec::new();
    stack.extend(
        roots(context)?
            .into_iter()
            .rev()
            .map(|n| (n, None, DAffine3::IDENTITY)),
    );
    while let Some((index, parent, above)) = stack.pop() {
        let node = context.resolve(nodes, index, "node", || match parent {
            Some(parent) => format!("node {parent}"),
            None => "the scene".to_owned(),
        })?;
        if std::mem::replace(&mut visited[index], true) {
            let (path, name) = (context.path.clone(), name_or(&node.name, "node", index));
            return Err(SceneError::NodeTwice {
                path,
                node: index,
                name,
            });
        }
        scene.report.nodes += 1;
        progress.advance(scene.report.nodes);
        let visibility = extension(node, "KHR_node_visibility").and_then(|v| v.get("visible"));
        if visibility == Some(&Value::Bool(false)) {
            scene.report.hidden_nodes += 1;
            continue;
        }
        let transform = above * local(node, &mut scene.report.repaired_transforms);
        if !transform.is_finite() {
            let (path, name) = (context.path.clone(), name_or(&node.name, "node", index));
            return Err(SceneError::NodeTransform {
                path,
                node: index,
                name,
            });
        }
        place(context, scene, index, node, transform)?;
        let below = node.children.iter().flatten().rev();
        stack.extend(below.map(|child| (child.value(), Some(index), transform)));
    }
    unique_light_names(scene);
    Ok(())
}

/// What a node says about an extension that the package has no type for.
fn extension<'a>(node: &'a Node, name: &str) -> Option<&'a Value> {
    node.extensions.as_ref()?.others.get(name)
}

/// The nodes to start from.
fn roots(context: &Context<'_>) -> Result<Vec<usize>, SceneError> {
    let root = context.root;
    if let Some(first) = root.scenes.first() {
        let scene = match root.scene {
            Some(index) => {
                let file = || "the file".to_owned();
                context.resolve(&root.scenes, index.value(), "scene", file)?
            }
            None => first,
        };
        return Ok(scene.nodes.iter().map(Index::value).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|n| &n.children).flatten() {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|&n| !is_child[n]).collect())
}

/// The node's own transform; unit quaternions are made so, and counted if they were far from it.
fn local(node: &Node, repaired: &mut u64) -> DAffine3 {
    if let Some(m) = node.matrix.map(|m| m.map(f64::from)) {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            *repaired += 1;
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        let linear = DMat3::from_cols(column(0), column(4), column(8));
        return DAffine3 {
            matrix3: linear,
            translation: column(12),
        };
    }
    let translation = Vec3::from(node.translation.unwrap_or([0.0; 3])).as_dvec3();
    let scale = Vec3::from(node.scale.unwrap_or([1.0; 3])).as_dvec3();
    let rotation = DQuat::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
    let length = rotation.length();
    if (length - 1.0).abs() > 1e-3 || length.is_nan() {
        *repaired += 1;
    }
    let rotation = match length {
        1.0 => rotation,
        l if l > 0.0 && l.is_finite() => rotation / l,
        _ => DQuat::IDENTITY,
    };
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}

/// Appends what hangs on a node.
fn place(
    context: &Context<'_>,
    scene: &mut Scene,
    index: usize,
    node: &Node,
    transform: DAffine3,
) -> Result<(), SceneError> {
    let root = context.root;
    let item = || format!("node {index} ({})", name_or(&node.name, "node", index));
    if let Some(mesh) = node.mesh.map(|m| m.value()) {
        context.resolve(&root.meshes, mesh, "mesh", item)?;
        scene.report.ignored_skins += u64::from(node.skin.is_some());
        scene.report.ignored_instancing +=
            u64::from(extension(node, "EXT_mesh_gpu_instancing").is_some());
        let name = name_or(&node.name, "node", index);
        scene.instances.push(Instance {
            name,
            mesh: mesh as u32,
            transform,
        });
    }
    if let Some(camera) = node.camera {
        let source = context.resolve(&root.cameras, camera.value(), "camera", item)?;
        let name = node.name.clone().or_else(|| source.name.clone());
        let name = name_or(&name, "camera", scene.cameras.len());
        let camera = lights::camera(source, name, &transform, &mut scene.report);
        scene.cameras.extend(camera);
    }
    let light = node.extensions.as_ref();
    if let Some(light) = light.and_then(|e| e.khr_lights_punctual.as_ref()) {
        let source: &Light = context.resolve(root.as_ref(), light.light.value(), "light", item)?;
        let name = node.name.clone().or_else(|| source.name.clone());
        let name = name_or(&name, "light", scene.lights.len());
        scene
            .lights
            .extend(lights::light(source, name, &transform, &mut scene.report));
    }
    Ok(())
}

/// Appends `_2`, `_3` and so on to light names that were used before.
fn unique_light_names(scene: &mut Scene) {
    let mut used: HashSet<String> = scene.lights.iter().map(|l| l.name.clone()).collect();
    let mut first = HashSet::new();
    let mut next = std::collections::HashMap::<String, u64>::new();
    for light in &mut scene.lights {
        if first.insert(light.name.clone()) {
            continue;
        }
        let number = next.entry(light.name.clone()).or_insert(2);
        let free = loop {
            let name = format!("{}_{number}", light.name);
            *number += 1;
            if used.insert(name.clone()) {
                break name;
            }
        };
        light.name = free;
        scene.report.renamed_lights += 1;
    }
}
