//! The node tree: instances, lights and cameras in world space.
//!
//! Takes the root; gives `scene.instances`, `scene.lights` and `scene.cameras` in the order of
//! the tree, and where each node of the file stands in it. Transforms are composed in f64. Invariant: every node is visited at most once, on a
//! stack of our own, so that neither cycles nor deep trees do harm.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use gltf::json::extensions::scene::khr_lights_punctual::Light;
use gltf::json::{Index, Node, Value};

use super::{Context, lights, name_or};
use crate::rig::{self, Local, Parts};
use crate::{Camera, Instance, Progress, Scene, SceneError};

/// The visited part of the tree.
#[derive(Default)]
pub(super) struct Tree {
    /// In the order of the visit: parents before children.
    pub(super) nodes: Vec<rig::Node>,
    /// For each node of the file its place in `nodes`, if it was visited.
    pub(super) place: Vec<Option<u32>>,
}

/// Walks the nodes of the default scene, else of the first, else all nodes without a parent.
pub(super) fn load(
    context: &Context<'_>,
    scene: &mut Scene,
    progress: &dyn Progress,
) -> Result<Tree, SceneError> {
    let nodes = &context.root.nodes;
    progress.stage("nodes", nodes.len() as u64);
    let mut tree = Tree {
        nodes: Vec::new(),
        place: vec![None; nodes.len()],
    };
    let mut stack: Vec<Visit> = Vec::new();
    stack.extend(roots(context)?.into_iter().rev().map(|index| Visit {
        index,
        parent: None,
        above: DAffine3::IDENTITY,
        visible: true,
    }));
    while let Some(visit) = stack.pop() {
        let (index, parent) = (visit.index, visit.parent);
        let node = context.resolve(nodes, index, "node", || match parent {
            Some(parent) => format!("node {parent}"),
            None => "the scene".to_owned(),
        })?;
        let place = tree.nodes.len() as u32;
        if tree.place[index].replace(place).is_some() {
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
        let hides = visit.visible && visibility == Some(&Value::Bool(false));
        scene.report.hidden_nodes += u64::from(hides);
        // What is hidden is not placed, but joints may lie below it.
        let visible = visit.visible && !hides;
        let local = local(node, &mut scene.report.repaired_transforms);
        tree.nodes.push(rig::Node {
            parent: parent.and_then(|p| tree.place[p]),
            local,
            velocity: None,
        });
        let transform = visit.above * local.affine();
        if !transform.is_finite() {
            let (path, name) = (context.path.clone(), name_or(&node.name, "node", index));
            return Err(SceneError::NodeTransform {
                path,
                node: index,
                name,
            });
        }
        if visible {
            hang(context, scene, (index, place), node, transform)?;
        }
        let below = node.children.iter().flatten().rev();
        stack.extend(below.map(|child| Visit {
            index: child.value(),
            parent: Some(index),
            above: transform,
            visible,
        }));
    }
    unique_light_names(scene);
    Ok(tree)
}

/// A node to go to.
struct Visit {
    index: usize,
    parent: Option<usize>,
    above: DAffine3,
    visible: bool,
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
fn local(node: &Node, repaired: &mut u64) -> Local {
    if let Some(m) = node.matrix.map(|m| m.map(f64::from)) {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            *repaired += 1;
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        let linear = DMat3::from_cols(column(0), column(4), column(8));
        return Local::Matrix(DAffine3 {
            matrix3: linear,
            translation: column(12),
        });
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
    Local::Parts(Parts {
        translation,
        rotation,
        scale,
    })
}

/// Appends what hangs on a node.
fn hang(
    context: &Context<'_>,
    scene: &mut Scene,
    (index, place): (usize, u32),
    node: &Node,
    transform: DAffine3,
) -> Result<(), SceneError> {
    let root = context.root;
    let item = || format!("node {index} ({})", name_or(&node.name, "node", index));
    if let Some(mesh) = node.mesh.map(|m| m.value()) {
        context.resolve(&root.meshes, mesh, "mesh", item)?;
        scene.report.ignored_instancing +=
            u64::from(extension(node, "EXT_mesh_gpu_instancing").is_some());
        let name = name_or(&node.name, "node", index);
        scene.instances.push(Instance {
            name,
            mesh: mesh as u32,
            transform,
            node: Some(place),
            skin: node.skin.map(|skin| skin.value() as u32),
        });
    }
    if let Some(camera) = node.camera {
        let source = context.resolve(&root.cameras, camera.value(), "camera", item)?;
        let name = node.name.clone().or_else(|| source.name.clone());
        let name = name_or(&name, "camera", scene.cameras.len());
        let camera = lights::camera(source, name, &transform, &mut scene.report);
        scene.cameras.extend(camera.map(|camera| Camera {
            node: Some(place),
            ..camera
        }));
    }
    let light = node.extensions.as_ref();
    if let Some(light) = light.and_then(|e| e.khr_lights_punctual.as_ref()) {
        let source: &Light = context.resolve(root.as_ref(), light.light.value(), "light", item)?;
        let name = node.name.clone().or_else(|| source.name.clone());
        let name = name_or(&name, "light", scene.lights.len());
        let light = lights::light(source, name, &transform, &mut scene.report);
        scene.lights.extend(light.map(|light| crate::Light {
            node: Some(place),
            ..light
        }));
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
