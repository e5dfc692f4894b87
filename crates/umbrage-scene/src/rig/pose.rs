//! A scene at a time.
//!
//! Takes a scene and seconds; gives where every node stands and what every joint does to the
//! vertices bound to it, composed in f64. Positions are blended in f64; whoever keeps them rounds them
//! once, and what is kept is the geometry for whoever draws, casts or judges.
//! Source: glTF 2.0 specification, section 3.7.3.3: a joint matrix is the joint's world transform
//! times its inverse bind matrix, and the transform of the skinned mesh's own node is ignored.

use glam::{DAffine3, DMat3, DVec3, DVec4};

use super::{Local, Part, Rig};
use crate::{Camera, Instance, Light, Mesh, Scene};

/// Nodes that are posed to find out what mirrors, at most: a second's work.
const MOST_POSED: usize = 1 << 22;

/// Where everything stands at a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Posed {
    /// World transform of each node of the rig.
    pub nodes: Vec<DAffine3>,
    /// For each skin, one joint matrix a joint: mesh space, as bound, to world space.
    pub skins: Vec<Vec<DAffine3>>,
}

/// What takes the vertices of one instance from mesh space to world space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Placing<'a> {
    /// One transform for all.
    Rigid(DAffine3),
    /// Joint matrices, with the mesh's weights.
    Skinned(&'a [DAffine3]),
}

impl Posed {
    /// World transform of an instance; without meaning for a skinned one.
    pub fn transform(&self, instance: &Instance) -> DAffine3 {
        let node = instance.node.and_then(|n| self.nodes.get(n as usize));
        *node.unwrap_or(&instance.transform)
    }

    /// Joint matrices of an instance, if it is skinned.
    pub fn joints(&self, instance: &Instance) -> Option<&[DAffine3]> {
        let skin = self.skins.get(instance.skin? as usize);
        skin.map(Vec::as_slice)
    }

    pub(crate) fn placing(&self, instance: &Instance, mesh: &Mesh) -> Placing<'_> {
        match self.joints(instance) {
            Some(joints) if mesh.is_bound() => Placing::Skinned(joints),
            _ => Placing::Rigid(self.transform(instance)),
        }
    }

    /// Replaces `positions` with the vertices of an instance of `mesh`, one each, relative to
    /// `origin`.
    pub fn positions(
        &self,
        instance: &Instance,
        mesh: &Mesh,
        origin: DVec3,
        positions: &mut Vec<DVec3>,
    ) {
        positions.clear();
        let placing = self.placing(instance, mesh);
        placing.place(mesh, origin, |p| positions.push(p));
    }
}

impl Placing<'_> {
    /// The transform of one vertex.
    pub(crate) fn of_vertex(&self, mesh: &Mesh, vertex: usize) -> DAffine3 {
        match *self {
            Self::Rigid(transform) => transform,
            Self::Skinned(joints) => {
                let (joint, weight) = (mesh.joints[vertex], mesh.weights[vertex].map(f64::from));
                // Weights sum to one in f32; in f64 the rest would move what is far from zero.
                let sum: f64 = weight.iter().sum();
                let mut blend = DAffine3 {
                    matrix3: DMat3::ZERO,
                    translation: DVec3::ZERO,
                };
                for (&joint, weight) in joint.iter().zip(weight) {
                    if let Some(of) = joints.get(joint as usize).filter(|_| weight != 0.0) {
                        blend.matrix3 += of.matrix3 * (weight / sum);
                        blend.translation += of.translation * (weight / sum);
                    }
                }
                blend
            }
        }
    }

    /// Whether most of it is turned inside out; none if it has no volume to turn.
    pub(crate) fn mirrors(&self) -> Option<bool> {
        let transforms = match self {
            Self::Rigid(transform) => std::slice::from_ref(transform),
            Self::Skinned(joints) => joints,
        };
        let signs = transforms.iter().map(|t| t.matrix3.determinant());
        let [mut inside_out, mut upright] = [0, 0];
        for sign in signs {
            inside_out += u32::from(sign < 0.0);
            upright += u32::from(sign > 0.0);
        }
        (inside_out + upright > 0).then_some(inside_out > upright)
    }

    /// Hands over the places of a mesh's vertices, in order, relative to `origin`.
    pub(crate) fn place(&self, mesh: &Mesh, origin: DVec3, mut to: impl FnMut(DVec3)) {
        let from = mesh.positions.iter().map(|p| p.as_dvec3());
        match self {
            Self::Rigid(t) if *t == DAffine3::IDENTITY && origin == DVec3::ZERO => {
                from.for_each(to); // keeps the sign of zero too
            }
            Self::Rigid(transform) => {
                from.for_each(|p| to(transform.transform_point3(p) - origin));
            }
            Self::Skinned(_) => {
                for (v, p) in from.enumerate() {
                    to(self.of_vertex(mesh, v).transform_point3(p) - origin);
                }
            }
        }
    }
}

impl Mesh {
    /// Whether its vertices know which joints they follow.
    pub fn is_bound(&self) -> bool {
        let count = self.positions.len();
        count > 0 && self.joints.len() == count && self.weights.len() == count
    }
}

impl Scene {
    /// Where everything stands as the file puts it, with nothing playing.
    pub fn rest(&self) -> Posed {
        self.rig.as_ref().map_or_else(Posed::default, |rig| {
            let locals = rig.nodes.iter().map(|node| node.local);
            rig.composed(&locals.map(|l| l.affine()).collect::<Vec<_>>())
        })
    }

    /// Where everything stands at a time: every clip of [`Rig::playing`] loops over its own
    /// duration. A time that is not finite counts as zero.
    pub fn posed(&self, time_s: f64) -> Posed {
        let time_s = if time_s.is_finite() { time_s } else { 0.0 };
        self.rig
            .as_ref()
            .map_or_else(Posed::default, |rig| rig.posed(time_s))
    }

    /// For each instance, whether it is mirrored: as it stands at rest, or where it has no volume
    /// then, at the first key of what plays, or the first middle between two, at which it has one;
    /// of very many keys the first.
    pub(crate) fn mirrored(&self) -> Vec<bool> {
        let of = |posed: &Posed, instance: &Instance| {
            let mesh = self.meshes.get(instance.mesh as usize)?;
            posed.placing(instance, mesh).mirrors()
        };
        let rest = self.rest();
        let mut found: Vec<Option<bool>> = self.instances.iter().map(|i| of(&rest, i)).collect();
        let moving = self.moving();
        let open = |found: &[Option<bool>]| -> Vec<usize> {
            let open = |&i: &usize| found[i].is_none() && moving[i];
            (0..found.len()).filter(open).collect()
        };
        let keys = match (&self.rig, open(&found).is_empty()) {
            (Some(rig), false) => rig.key_times(),
            _ => Vec::new(),
        };
        let most = MOST_POSED / (1 + rest.nodes.len());
        for time_s in keys.into_iter().take(most.max(2)) {
            let left = open(&found);
            if left.is_empty() {
                break;
            }
            let posed = self.posed(time_s);
            for i in left {
                found[i] = of(&posed, &self.instances[i]);
            }
        }
        found.into_iter().map(|m| m.unwrap_or(false)).collect()
    }

    /// For each instance, whether it ever moves: it is skinned, or hangs on a node that moves.
    pub fn moving(&self) -> Vec<bool> {
        let nodes = self.rig.as_ref().map_or_else(Vec::new, Rig::moving);
        let moves = |i: &Instance| {
            let node = i.node.and_then(|n| nodes.get(n as usize));
            self.rig.is_some() && (i.skin.is_some() || node.copied().unwrap_or(false))
        };
        self.instances.iter().map(moves).collect()
    }

    /// Moves lights and cameras with their nodes. Those on nodes that never move stay as they are.
    pub fn follow(&mut self, posed: &Posed) {
        let moving = self.rig.as_ref().map_or_else(Vec::new, Rig::moving);
        let place = |node: Option<u32>| {
            let node = node? as usize;
            let moves = *moving.get(node)?;
            posed.nodes.get(node).filter(|_| moves)
        };
        let turned = |to: &DAffine3, axis: DVec3, before: DVec3| {
            (to.matrix3 * axis).try_normalize().unwrap_or(before)
        };
        for light in &mut self.lights {
            if let Some(to) = place(light.node) {
                let Light { direction, .. } = *light;
                light.position = to.translation;
                light.direction = turned(to, DVec3::NEG_Z, direction);
            }
        }
        for camera in &mut self.cameras {
            if let Some(to) = place(camera.node) {
                let Camera { forward, up, .. } = *camera;
                camera.position = to.translation;
                camera.forward = turned(to, DVec3::NEG_Z, forward);
                let upward = turned(to, DVec3::Y, up);
                let level = upward - camera.forward * upward.dot(camera.forward);
                camera.up = level.try_normalize().unwrap_or(up);
            }
        }
    }
}

impl Rig {
    /// Times at which what plays has keys, ascending, and the middles between them: at its last key
    /// a clip begins anew.
    fn key_times(&self) -> Vec<f64> {
        let playing = self.playing.iter();
        let clips = playing.filter_map(|&c| self.clips.get(c as usize));
        let curves = clips.flat_map(|clip| &clip.channels).map(|c| &c.curve);
        let mut keys: Vec<f64> = curves
            .flat_map(|curve| curve.times_s.iter().map(|&t| f64::from(t)))
            .collect();
        keys.sort_by(f64::total_cmp);
        keys.dedup();
        let between = keys.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let mut times: Vec<f64> = between.chain(keys.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        times
    }

    fn posed(&self, time_s: f64) -> Posed {
        let mut locals: Vec<Local> = self.nodes.iter().map(|node| node.local).collect();
        let playing = self
            .playing
            .iter()
            .filter_map(|&c| self.clips.get(c as usize));
        for clip in playing {
            let time_s = match clip.duration_s {
                length if length > 0.0 => time_s.rem_euclid(length),
                _ => 0.0,
            };
            for channel in clip.channels.iter().filter(|c| c.curve.is_whole()) {
                if let Some(Local::Parts(parts)) = locals.get_mut(channel.node as usize) {
                    let is_rotation = channel.part == Part::Rotation;
                    let value: DVec4 = channel.curve.at(time_s, is_rotation);
                    match channel.part {
                        Part::Translation => parts.translation = value.truncate(),
                        Part::Rotation => parts.rotation = glam::DQuat::from_vec4(value),
                        Part::Scale => parts.scale = value.truncate(),
                    }
                }
            }
        }
        let local = |(local, node): (&Local, &super::Node)| {
            let mut local = local.affine();
            local.translation += node.velocity.unwrap_or_default() * time_s;
            local
        };
        let locals: Vec<DAffine3> = locals.iter().zip(&self.nodes).map(local).collect();
        self.composed(&locals)
    }

    /// From transforms relative to parents to those in world space.
    fn composed(&self, locals: &[DAffine3]) -> Posed {
        let mut nodes: Vec<DAffine3> = Vec::with_capacity(locals.len());
        for (node, local) in self.nodes.iter().zip(locals) {
            let above = node.parent.and_then(|p| nodes.get(p as usize).copied());
            nodes.push(above.unwrap_or(DAffine3::IDENTITY) * *local);
        }
        let of = |&joint: &u32| nodes.get(joint as usize).copied().unwrap_or_default();
        let skins = self.skins.iter().map(|skin| {
            let joints = skin.joints.iter().map(of).zip(&skin.inverse_bind);
            joints.map(|(joint, bind)| joint * *bind).collect()
        });
        Posed {
            skins: skins.collect(),
            nodes,
        }
    }
}
