//! A scene placed in another, and walking there.
//!
//! Takes a scene and where it is to stand; appends its meshes, instances, materials, images and rig
//! under a node of its own, and adds its load report. Its lights and cameras stay behind.

use glam::{DAffine3, DQuat, DVec3};

use super::{Channel, Clip, Local, Node, Parts, Rig, Skin};
use crate::Scene;

/// Where a scene stands in another, and how it walks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World position of its origin at time zero, in metres.
    pub at: DVec3,
    /// Turn about +Y, counter-clockwise seen from above, in radians. Its heading is +Z, the front
    /// of a glTF file, turned with it.
    pub turn_rad: f64,
    /// Size in the world by size in its file, above zero.
    pub scale: f64,
    /// Along its heading, in metres a second of the world.
    pub speed: f64,
}

impl Default for Placement {
    /// As it stands in its file.
    fn default() -> Self {
        Self {
            at: DVec3::ZERO,
            turn_rad: 0.0,
            scale: 1.0,
            speed: 0.0,
        }
    }
}

impl Placement {
    fn node(&self) -> Node {
        let rotation = DQuat::from_rotation_y(self.turn_rad);
        Node {
            parent: None,
            local: Local::Parts(Parts {
                translation: self.at,
                rotation,
                scale: DVec3::splat(self.scale),
            }),
            velocity: Some(rotation * DVec3::Z * self.speed),
        }
    }
}

impl Scene {
    /// Places `actor` in this scene. All that was its root now hangs on one node that stands and
    /// walks as `placement` says, and its playing clips play beside those already here.
    pub fn place(&mut self, actor: Scene, placement: &Placement) {
        let [meshes, materials, images] =
            [self.meshes.len(), self.materials.len(), self.images.len()].map(|n| n as u32);
        self.images.extend(actor.images);
        self.materials
            .extend(actor.materials.into_iter().map(|mut m| {
                m.base_color_image = m.base_color_image.map(|i| i + images);
                m
            }));
        self.meshes.extend(actor.meshes.into_iter().map(|mut mesh| {
            mesh.materials.iter_mut().for_each(|m| *m += materials);
            mesh
        }));
        self.report.add(&actor.name, actor.report);
        let rig = self.rig.get_or_insert_default();
        let root = rig.nodes.len() as u32;
        let root_node = placement.node();
        let root_transform = root_node.local.affine();
        rig.nodes.push(root_node);
        let skins = rig.skins.len() as u32;
        rig.append(actor.rig.unwrap_or_default(), root);
        for mut instance in actor.instances {
            instance.mesh += meshes;
            instance.skin = instance.skin.map(|s| s + skins);
            let below = instance.transform;
            instance.transform = root_transform * below;
            instance.node = Some(match instance.node {
                Some(node) => root + 1 + node,
                None => rig.hang(root, below),
            });
            self.instances.push(instance);
        }
    }
}

impl Rig {
    /// A new node below `parent`.
    fn hang(&mut self, parent: u32, local: DAffine3) -> u32 {
        self.nodes.push(Node {
            parent: Some(parent),
            local: Local::Matrix(local),
            velocity: None,
        });
        self.nodes.len() as u32 - 1
    }

    /// Appends another rig, its roots below `root`, which is the last node so far.
    fn append(&mut self, other: Rig, root: u32) {
        let (first, clips) = (root + 1, self.clips.len() as u32);
        self.nodes.extend(other.nodes.into_iter().map(|node| Node {
            parent: Some(node.parent.map_or(root, |p| p + first)),
            ..node
        }));
        self.skins.extend(other.skins.into_iter().map(|skin| Skin {
            joints: skin.joints.iter().map(|j| j + first).collect(),
            ..skin
        }));
        let moved = |c: Channel| Channel {
            node: c.node + first,
            ..c
        };
        self.clips.extend(other.clips.into_iter().map(|clip| Clip {
            channels: clip.channels.into_iter().map(moved).collect(),
            ..clip
        }));
        self.playing.extend(other.playing.iter().map(|c| c + clips));
    }
}
