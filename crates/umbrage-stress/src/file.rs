//! Cases as files that `umbrage check` reads.
//!
//! Takes a case; gives a scene, a `.glb` file of it, and the command line that checks it. Positions
//! of vertices and lights, and the eye, come back to the last bit, but for this: where no vertex is
//! more than 2^-13 m from what f32 rounds it to, which is so within 1 km of zero, vertices come back
//! rounded. Directions of spots and cameras go through a quaternion and come back within some 2^-22. Materials say whether a triangle casts
//! from its front or from both sides; one that casts from its back is turned over; that a triangle
//! casts from neither side, a file cannot say.

use std::path::Path;

use glam::{DAffine3, DVec3};
use umbrage_core::{Casting, LightShape, View};
use umbrage_lab::camera;
use umbrage_lab::lab::Method;
use umbrage_lab::stage::{Casters, Stage, StageError};
use umbrage_scene::{Camera, Instance, Light, LightKind, Material, Mesh, Scene, SceneError};

use crate::case::{Case, SIZE};

/// The scene of a case, with a camera for each view.
pub fn scene(case: &Case) -> Scene {
    let material = |double_sided| Material {
        double_sided,
        ..Material::default()
    };
    let turned = |(&[a, b, c], rule): (&[u32; 3], &Casting)| match rule {
        Casting::Back => [a, c, b],
        _ => [a, b, c],
    };
    let rules = || case.mesh.casting.iter();
    let mesh = Mesh {
        name: "case".to_owned(),
        positions: (0..case.mesh.positions.len() as u32)
            .map(|v| (case.mesh.places().at(v) - case.origin).as_vec3())
            .collect(),
        triangles: case
            .mesh
            .triangles
            .iter()
            .zip(rules())
            .map(turned)
            .collect(),
        materials: rules()
            .map(|rule| u32::from(*rule == Casting::Both))
            .collect(),
        ..Mesh::default()
    };
    let lights = case.lights.iter().enumerate();
    Scene {
        name: "case".to_owned(),
        meshes: vec![mesh],
        instances: vec![Instance {
            name: "case".to_owned(),
            transform: DAffine3::from_translation(case.origin),
            ..Instance::default()
        }],
        materials: vec![material(false), material(true)],
        lights: lights
            .map(|(number, light)| scene_light(number, light))
            .collect(),
        cameras: case.views.iter().map(scene_camera).collect(),
        ..Scene::default()
    }
}

fn scene_light(number: usize, light: &umbrage_core::Light) -> Light {
    let (kind, direction) = match light.shape {
        LightShape::Point => (LightKind::Point, DVec3::NEG_Z),
        LightShape::Directional { direction } => (LightKind::Directional, direction.as_dvec3()),
        LightShape::Spot {
            direction,
            cos_outer,
        } => {
            let outer_rad = cos_outer.clamp(-1.0, 1.0).acos();
            let kind = LightKind::Spot {
                inner_rad: 0.5 * outer_rad,
                outer_rad,
            };
            (kind, direction.as_dvec3())
        }
    };
    Light {
        name: format!("light_{number}"),
        position: light.position,
        direction: direction.normalize_or(DVec3::NEG_Z),
        range: Some(light.range).filter(|range| range.is_finite()),
        kind,
        ..Light::default()
    }
}

fn scene_camera(view: &View) -> Camera {
    Camera {
        name: "camera".to_owned(),
        position: view.eye,
        forward: view.forward.as_dvec3().normalize(),
        up: view.up.as_dvec3().normalize(),
        fovy_rad: 2.0 * (1.0 / f64::from(view.scale_y)).atan(),
        near: Some(f64::from(view.near)),
        ..Camera::default()
    }
}

/// Writes a case.
///
/// # Errors
/// What the system says, or a value that no file can hold.
pub fn write(case: &Case, path: &Path) -> Result<(), SceneError> {
    umbrage_scene::write::glb(&scene(case), path)
}

/// Why a file is no case.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// As a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// As a world.
    #[error(transparent)]
    Stage(#[from] StageError),
}

/// Reads a case as `umbrage check` does, with the command line of [`command`].
///
/// # Errors
/// As for any scene.
pub fn read(path: &Path) -> Result<Case, ReadError> {
    let scene = umbrage_scene::load(path, &())?;
    let stage = Stage::new(scene, Casters::Material, Some(DVec3::ZERO))?;
    let lights = stage.lights(None);
    let node = stage.scene.instances.first();
    let cameras = stage.scene.cameras.iter();
    let view = |seen: &Camera| {
        let near = seen.near.unwrap_or_default() as f32;
        camera::view(seen, stage.local(seen.position), near, SIZE)
    };
    Ok(Case {
        lights: lights.iter().map(|light| light.light).collect(),
        views: cameras.map(view).collect(),
        origin: node.map_or(DVec3::ZERO, |node| node.transform.translation),
        mesh: stage.mesh,
        ..Case::default()
    })
}

/// The command line that checks the file.
pub fn command(path: &Path, method: Method) -> String {
    let [width, height] = SIZE;
    format!(
        "umbrage check {} --camera 0 --size {width}x{height} --origin 0,0,0 --method {}",
        path.display(),
        method.name()
    )
}
