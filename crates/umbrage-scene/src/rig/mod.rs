//! What moves in a scene: the node tree, skins, and clips, as plain data.
//!
//! A loader fills a [`Rig`] only if a file has skins or animations; [`Scene::posed`] gives the tree
//! at a time. Invariant of a loaded rig: parents stand before their children, every index is in
//! range, every number is finite, and the times of a curve ascend.
//!
//! Source: glTF 2.0 specification, sections 3.7.3 (skins), 3.11 (animations) and appendix C.
//!
//! [`Scene::posed`]: crate::Scene::posed

mod actor;
mod curve;
mod pose;

use glam::{DAffine3, DQuat, DVec3, Vec4};

pub use actor::Placement;
pub(crate) use pose::Placing;
pub use pose::Posed;

/// Nodes, skins and clips of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// Parents before their children.
    pub nodes: Vec<Node>,
    /// Sets of joints that meshes hang on.
    pub skins: Vec<Skin>,
    /// Every clip of the file, in its order.
    pub clips: Vec<Clip>,
    /// Clips that play, each looping over its own duration. Of a file with several, the first:
    /// glTF does not say which belong together.
    pub playing: Vec<u32>,
}

/// One node of the tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// The node that its transform is relative to, with a lower index; none for a root.
    pub parent: Option<u32>,
    /// Where it stands when nothing plays.
    pub local: Local,
    /// Metres a second in its parent's space, added to where it stands. `Some` marks a node that
    /// moves even while the velocity is zero.
    pub velocity: Option<DVec3>,
}

/// A node's transform relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// Parts, each of which a clip may replace.
    Parts(Parts),
    /// A matrix, which no clip replaces.
    Matrix(DAffine3),
}

/// Scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Metres.
    pub translation: DVec3,
    /// Of unit length.
    pub rotation: DQuat,
    /// May mirror, may be zero.
    pub scale: DVec3,
}

impl Default for Local {
    fn default() -> Self {
        Self::Parts(Parts::default())
    }
}

impl Default for Parts {
    /// Changes nothing.
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
        }
    }
}

impl Local {
    /// As a matrix.
    pub fn affine(&self) -> DAffine3 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts(p) => {
                DAffine3::from_scale_rotation_translation(p.scale, p.rotation, p.translation)
            }
        }
    }
}

/// Joints that the vertices of a mesh follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Name in the file, or `skin_N`.
    pub name: String,
    /// Indices into [`Rig::nodes`]; `Mesh::joints` are indices into this list.
    pub joints: Vec<u32>,
    /// One a joint: mesh space to the joint's space, as they were bound.
    pub inverse_bind: Vec<DAffine3>,
}

/// Curves that play together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    /// Name in the file, or `animation_N`.
    pub name: String,
    /// Time of its last key in seconds: it begins anew then. Before its first key a curve keeps
    /// that key's value.
    pub duration_s: f64,
    /// What it moves.
    pub channels: Vec<Channel>,
}

/// One part of one node over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Index into [`Rig::nodes`]; its transform is [`Local::Parts`].
    pub node: u32,
    /// Which part.
    pub part: Part,
    /// Its values.
    pub curve: Curve,
}

/// What a channel replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// [`Parts::translation`].
    Translation,
    /// [`Parts::rotation`].
    Rotation,
    /// [`Parts::scale`].
    Scale,
}

/// How values between keys are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight between two keys; along the shorter great arc for rotations.
    #[default]
    Linear,
    /// The value of the key before.
    Step,
    /// A cubic Hermite spline.
    CubicSpline,
}

/// Values at keys.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// How values between keys are found.
    pub interpolation: Interpolation,
    /// One a key, in seconds, ascending; not empty.
    pub times_s: Vec<f32>,
    /// One a key; for a cubic spline three: tangent in, value, tangent out. A rotation is x, y, z,
    /// w; anything else leaves w zero.
    pub values: Vec<Vec4>,
}

impl Rig {
    /// For each node, whether it or a node above it ever moves.
    pub fn moving(&self) -> Vec<bool> {
        let mut moving: Vec<bool> = self.nodes.iter().map(|n| n.velocity.is_some()).collect();
        let playing = self
            .playing
            .iter()
            .filter_map(|&c| self.clips.get(c as usize));
        for channel in playing.flat_map(|clip| &clip.channels) {
            if let Some(flag) = moving.get_mut(channel.node as usize) {
                *flag = true;
            }
        }
        for (i, node) in self.nodes.iter().enumerate() {
            let above = node.parent.and_then(|p| moving.get(p as usize));
            moving[i] |= above.copied().unwrap_or(false);
        }
        moving
    }

    /// What breaks the invariant, if anything.
    pub(crate) fn check(&self) -> Result<(), String> {
        let count = self.nodes.len();
        for (n, node) in self.nodes.iter().enumerate() {
            if node.parent.is_some_and(|p| p as usize >= n) {
                return Err(format!("node {n} does not stand after its parent"));
            }
        }
        for (s, skin) in self.skins.iter().enumerate() {
            if skin.joints.len() != skin.inverse_bind.len() {
                return Err(format!("skin {s} has not one inverse bind matrix a joint"));
            }
            if skin.joints.iter().any(|&j| j as usize >= count) {
                return Err(format!("skin {s} names a node beyond {count}"));
            }
        }
        for (c, clip) in self.clips.iter().enumerate() {
            for (i, channel) in clip.channels.iter().enumerate() {
                if channel.node as usize >= count || !channel.curve.is_whole() {
                    return Err(format!(
                        "clip {c}, channel {i}: no such node, or no whole curve"
                    ));
                }
            }
        }
        match self
            .playing
            .iter()
            .find(|&&c| c as usize >= self.clips.len())
        {
            Some(clip) => Err(format!("clip {clip} plays, but there is none")),
            None => Ok(()),
        }
    }
}
