//! What advice changes in a scene, in memory.

use glam::DVec3;
use umbrage_core::{Casting, LightShape};
use umbrage_lab::stage::{Stage, StageLight};

/// One change of one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LightChange {
    /// Another range, in metres.
    Range(f32),
    /// It shines no more.
    Off,
    /// It has no shadows.
    Unshadowed,
    /// It is made one with another, which it outshines: that one's number.
    Takes(usize),
    /// It stands elsewhere, by so many metres.
    Moved(DVec3),
}

/// A group of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Group {
    /// All instances of a mesh of the scene.
    Mesh(u32),
    /// A material of the scene.
    Material(u32),
}

/// What advice changes.
#[derive(Clone, Debug)]
pub(super) enum Change {
    /// Lights, each in its own way.
    Lights(Vec<(usize, LightChange)>),
    /// How a group of triangles casts.
    Casting(Group, Casting),
}

impl Group {
    /// Which triangles of the stage's mesh are in it.
    pub(super) fn members<'a>(self, stage: &'a Stage) -> impl Iterator<Item = bool> + 'a {
        let soup = &stage.soup;
        let is_in = move |(&material, &instance): (&u32, &u32)| match self {
            Group::Mesh(mesh) => stage.scene.instances[instance as usize].mesh == mesh,
            Group::Material(wanted) => material == wanted,
        };
        soup.material.iter().zip(&soup.instance).map(is_in)
    }

    /// Its name, as the scene has it.
    pub(super) fn name(self, stage: &Stage) -> &str {
        match self {
            Group::Mesh(mesh) => &stage.scene.meshes[mesh as usize].name,
            Group::Material(material) => &stage.scene.materials[material as usize].name,
        }
    }

    /// The word for what it is.
    pub(super) fn word(self) -> &'static str {
        match self {
            Group::Mesh(_) => "mesh",
            Group::Material(_) => "material",
        }
    }
}

/// The lights after changes, and which of them have no shadows.
pub(super) fn changed(
    lights: &[StageLight],
    changes: &[(usize, LightChange)],
) -> (Vec<StageLight>, Vec<usize>) {
    let mut changed = lights.to_vec();
    let mut unshadowed = Vec::new();
    for &(number, change) in changes {
        match change {
            LightChange::Range(range) => changed[number].light.range = range,
            LightChange::Off => switch_off(&mut changed[number]),
            LightChange::Unshadowed => unshadowed.push(number),
            LightChange::Moved(by) => changed[number].light.position += by,
            LightChange::Takes(other) => {
                changed[number].power += lights[other].power;
                switch_off(&mut changed[other]);
            }
        }
    }
    (changed, unshadowed)
}

/// No light at all: plans skip it, and nothing is built of it.
fn switch_off(light: &mut StageLight) {
    light.light.shape = LightShape::Point;
    light.light.range = 0.0;
}
