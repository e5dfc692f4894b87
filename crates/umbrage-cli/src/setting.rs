//! From options to what a frame needs: a staged scene, its lights and a view.
//!
//! Takes a scene's specification and the common options; every option that names something the
//! scene lacks (a camera, say) is refused here, with a list of what it has.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::path::Path;

use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Light, Mesh, View};
use umbrage_lab::auto_camera::auto_camera;
use umbrage_lab::camera;
use umbrage_lab::seeded_lights::seeded_lights;
use umbrage_lab::stage::{Stage, StageLight};
use umbrage_scene::{Camera, Disk, Progress, light_file};

use crate::actor;
use crate::args::{Common, RunArgs, WorldArgs};
use crate::error::CliError;
use crate::progress::Bar;
use crate::values::{CameraChoice, LightChoice, RangeChoice};

/// Seeded lights for a scene that brings none.
const DEFAULT_SEEDED: usize = 64;
/// Vertical angle of view where none is given.
const DEFAULT_FOVY_DEG: f64 = 60.0;

/// A scene under one set of options.
#[derive(Debug)]
pub(crate) struct Setting {
    pub(crate) stage: Stage,
    pub(crate) lights: Vec<StageLight>,
    pub(crate) view: View,
}

impl Setting {
    /// Loads `scene` and settles casters, lights and view.
    pub(crate) fn new(scene: &str, common: &Common) -> Result<Self, CliError> {
        common.method.0.check(common.run.shadows.into())?;
        use_threads(&common.run);
        let bar = Bar::new(common.results.quiet);
        let stage = stage(scene, &common.world, &bar)?;
        bar.stage("place lights", 0);
        let lights = lights(&stage, &common.lights, &common.world)?;
        bar.stage("place camera", 0);
        let (camera, size) = (common.view.camera.as_ref(), common.view.size.0);
        let view = view(&stage, &lights, camera, size, common.view.near)?;
        Ok(Self {
            stage,
            lights,
            view,
        })
    }
}

/// Loads a scene with its actors, builds its world, and poses everything.
pub(crate) fn stage(scene: &str, args: &WorldArgs, bar: &Bar) -> Result<Stage, CliError> {
    let scene = actor::open(scene, &args.actors, bar)?;
    let world_file = args.file.as_deref();
    bar.stage(world_step(world_file), 0);
    let origin = args.origin.map(|point| point.0);
    let casters = args.casters.into();
    let mut stage = Stage::with_world_file(scene, casters, origin, args.weld, world_file)?;
    stage.set_time(args.time)?;
    Ok(stage)
}

/// What `--world` makes of the step to a world, for those who wait.
pub(crate) fn world_step(world_file: Option<&Path>) -> &'static str {
    match world_file {
        None => "build world",
        Some(file) if file.exists() => "open saved world",
        Some(_) => "build and save world",
    }
}

/// Makes `--threads` the size of the pool that everything here runs on.
pub(crate) fn use_threads(run: &RunArgs) {
    limit_threads(run.threads);
}

/// The same for verbs that draw nothing.
pub(crate) fn limit_threads(threads: Option<NonZeroUsize>) {
    if let Some(threads) = threads {
        // Fails only if the pool is in use already, and this is the first thing a verb does.
        let _ = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build_global();
    }
}

/// The scenery (where all moves: as it is at time zero) with the casting rules of its materials: what
/// is inside and outside depends neither on `--casters` nor on `--time`, so seeded lights do not
/// either, nor, given lights that stand, the automatic camera.
fn as_materials_say(stage: &Stage) -> Cow<'_, Mesh> {
    let rule = |&m: &u32| match stage.scene.materials[m as usize].double_sided {
        true => Casting::Both,
        false => Casting::Front,
    };
    let mesh = stage.scenery();
    let materials = stage.soup.material.iter().take(mesh.triangles.len());
    let casting: Vec<Casting> = materials.map(rule).collect();
    if casting == mesh.casting {
        return mesh;
    }
    Cow::Owned(Mesh {
        casting,
        ..mesh.into_owned()
    })
}

/// A mesh in f32, and the place that it is then relative to: what searches for places to stand works
/// in f32, which would see a world far from zero in steps.
fn in_f32(mesh: Cow<'_, Mesh>) -> (Cow<'_, Mesh>, DVec3) {
    if mesh.residuals.is_empty() {
        return (mesh, DVec3::ZERO);
    }
    let positions = mesh.positions.iter().map(|p| p.as_dvec3());
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = positions.fold(none, |(low, high), p| (low.min(p), high.max(p)));
    let middle = ((low + high) * 0.5).round();
    let mut near = mesh.into_owned();
    let places: Vec<DVec3> = (0..near.positions.len() as u32)
        .map(|v| near.places().at(v) - middle)
        .collect();
    near.stand(places);
    near.residuals.clear();
    (Cow::Owned(near), middle)
}

/// The lights that were chosen, on the stage.
pub(crate) fn lights(
    stage: &Stage,
    choice: &LightChoice,
    args: &WorldArgs,
) -> Result<Vec<StageLight>, CliError> {
    let range = match args.range {
        RangeChoice::Auto => None,
        RangeChoice::Metres(range) => Some(range),
    };
    let seeded = |count, seed| {
        let (mesh, middle) = in_f32(as_materials_say(stage));
        let origin = stage.soup.origin + middle;
        let placed = seeded_lights(&mesh, count, seed).into_iter().enumerate();
        placed
            .map(|(number, (position, range))| {
                seeded_light(number, position.as_dvec3() + origin, range)
            })
            .collect()
    };
    let chosen: Cow<'_, [umbrage_scene::Light]> = match choice {
        LightChoice::Scene if !stage.scene.lights.is_empty() => Cow::Borrowed(&stage.scene.lights),
        LightChoice::Scene => seeded(DEFAULT_SEEDED, 0),
        LightChoice::Seeded { count, seed } => seeded(*count, *seed),
        LightChoice::File(path) => Cow::Owned(light_file::read(path, &Disk)?),
    };
    Ok(chosen
        .iter()
        .map(|light| stage.light(light, range))
        .collect())
}

/// A seeded light: pale colours all around the wheel, one lux at half its range.
fn seeded_light(number: usize, position: DVec3, range: f32) -> umbrage_scene::Light {
    // Steps of the golden ratio: neighbours in number differ in hue, and no hue comes twice.
    let hue = (number as f64 * 0.618_033_988_749_895).fract() as f32;
    let part = |shift: f32| 0.7 + 0.3 * (std::f32::consts::TAU * (hue + shift)).cos();
    umbrage_scene::Light {
        name: format!("seeded_{number}"),
        position,
        color: Vec3::new(part(0.0), part(1.0 / 3.0), part(2.0 / 3.0)),
        intensity: (0.5 * range).powi(2),
        range: Some(range),
        ..umbrage_scene::Light::default()
    }
}

/// The chosen camera's view; without a choice that of the scene's first camera, or automatic.
pub(crate) fn view(
    stage: &Stage,
    lights: &[StageLight],
    camera: Option<&CameraChoice>,
    size: [u32; 2],
    near: Option<f32>,
) -> Result<View, CliError> {
    let default_fovy = DEFAULT_FOVY_DEG.to_radians();
    let cameras = &stage.scene.cameras;
    let auto = || {
        let aspect = size[0] as f32 / size[1] as f32;
        let (plain, middle) = in_f32(as_materials_say(stage));
        let near = |light: &StageLight| Light {
            position: light.light.position - middle,
            ..light.light
        };
        let shadow_lights: Vec<Light> = lights.iter().map(near).collect();
        let found = auto_camera(&plain, &shadow_lights, default_fovy as f32, aspect);
        let origin = stage.soup.origin + middle;
        let [eye, target] = [found.eye, found.target].map(|p| p.as_dvec3() + origin);
        Camera::look_at("auto", eye, target, default_fovy)
    };
    let camera: Camera = match camera {
        None => cameras.first().cloned().unwrap_or_else(auto),
        Some(CameraChoice::Auto) => auto(),
        Some(CameraChoice::Free {
            eye,
            target,
            fovy_deg,
        }) => {
            let fovy_deg = fovy_deg.unwrap_or(DEFAULT_FOVY_DEG);
            Camera::look_at("free", *eye, *target, fovy_deg.to_radians())
        }
        Some(CameraChoice::Index(number)) => cameras
            .get(*number)
            .cloned()
            .ok_or_else(|| no_camera(&number.to_string(), cameras))?,
        Some(CameraChoice::Name(name)) => {
            let named = cameras.iter().find(|camera| camera.name == *name);
            named.cloned().ok_or_else(|| no_camera(name, cameras))?
        }
    };
    let near = near
        .or(camera.near.map(|near| near as f32))
        .filter(|near| *near > 0.0);
    let near =
        near.unwrap_or_else(|| (1e-4 * diagonal(&stage.scenery())).clamp(f32::MIN_POSITIVE, 0.1));
    Ok(camera::view(
        &camera,
        stage.local(camera.position),
        near,
        size,
    ))
}

fn no_camera(wanted: &str, cameras: &[Camera]) -> CliError {
    let names: Vec<String> = cameras
        .iter()
        .enumerate()
        .map(|(n, camera)| format!("{n} ({})", camera.name))
        .collect();
    let has = if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    };
    CliError::BadInput(format!(
        "--camera {wanted}: the scene has no such camera; it has {has}, and auto always works"
    ))
}

fn diagonal(mesh: &Mesh) -> f32 {
    let low = mesh
        .positions
        .iter()
        .fold(Vec3::INFINITY, |low, p| low.min(*p));
    let high = mesh
        .positions
        .iter()
        .fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
    (high - low).max(Vec3::ZERO).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Verb};
    use clap::Parser;

    #[test]
    fn a_missing_camera_is_bad_input_that_lists_the_others() {
        let error = no_camera(
            "7",
            &[Camera {
                name: "porch".to_owned(),
                ..Camera::default()
            }],
        );
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("0 (porch)"), "{error}");
    }

    /// Where everything moves, the mesh at time zero stands for the scenery.
    #[test]
    fn seeded_lights_and_the_automatic_camera_stay_as_time_goes_on() {
        let man = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../data/actors/cesium_man.glb"
        );
        let [begin, later] = ["0", "0.7"].map(|time| {
            let line = [
                "umbrage", "render", man, "--lights", "5", "--camera", "auto",
            ];
            let line = line.into_iter().chain(["--time", time, "--quiet"]);
            let Ok(Verb::Render(args)) = Cli::try_parse_from(line).map(|cli| cli.verb) else {
                panic!("not render")
            };
            Setting::new(&args.scene, &args.common).unwrap()
        });
        assert_ne!(begin.stage.mesh.positions, later.stage.mesh.positions);
        assert_eq!(begin.lights, later.lights);
        let of = |view: &View| (view.eye, view.forward, view.near);
        assert_eq!(of(&begin.view), of(&later.view));
    }

    #[test]
    fn seeded_lights_are_valid_in_the_scenes_terms() {
        for number in 0..100 {
            let light = seeded_light(number, DVec3::ZERO, 4.0);
            assert!(light.color.min_element() >= 0.0 && light.color.max_element() <= 1.0);
            assert_eq!(light.intensity, 4.0);
        }
    }
}
