//! Scene files: bytes to a scene, to a soup at several times, to a world and its volumes.
//!
//! What a file names beside itself is found in the same bytes: a glTF file's buffers and images are
//! the file; an OBJ file's library is what follows a line `#mtl`.

use std::path::Path;

use umbrage_core::{Casting, Mesh};
use umbrage_scene::{Files, Scene, SceneError, Soup};

use super::{Outcome, cast, light};

/// Scenes with more triangles than this are loaded, but not flattened.
const MANY_FLATTENED: u64 = 20_000;
/// Soups with more triangles than this become no world: fuzzing lives of many small cases.
const MANY_BUILT: usize = 1_000;
/// Lights of a scene that cast, at most.
const LIGHTS: usize = 6;

pub(crate) fn gltf(bytes: &[u8]) -> Outcome {
    let name = match bytes.starts_with(b"glTF") {
        true => "fuzzed.glb",
        false => "fuzzed.gltf",
    };
    load(name, bytes, bytes)
}

pub(crate) fn obj(bytes: &[u8]) -> Outcome {
    const MARK: &[u8] = b"#mtl\n";
    let mark = bytes.windows(MARK.len()).position(|window| window == MARK);
    let (scene, library) = bytes.split_at(mark.unwrap_or(bytes.len()));
    load("fuzzed.obj", scene, library)
}

/// A scene's own file, and one for everything that it names.
struct Beside<'a> {
    scene: &'a [u8],
    other: &'a [u8],
}

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, SceneError> {
        let stem = path.file_stem().is_some_and(|stem| stem == "fuzzed");
        Ok(if stem { self.scene } else { self.other }.to_vec())
    }
}

fn load(name: &str, scene: &[u8], other: &[u8]) -> Outcome {
    let files = Beside { scene, other };
    let used = umbrage_scene::load_from(Path::new(name), &files, &()).and_then(use_scene);
    match used {
        Ok(()) => Outcome::Used,
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("fuzzed"), "it names no file: {message}");
            Outcome::Refused(message)
        }
    }
}

fn use_scene(mut scene: Scene) -> Result<(), SceneError> {
    check(&scene);
    if scene.flattened_triangles() > MANY_FLATTENED {
        return Ok(());
    }
    build(&scene, &scene.soup()?);
    for time_s in [0.0, 0.3, 1e9] {
        let posed = scene.posed(time_s);
        scene.follow(&posed);
        check_lights(&scene);
        // What plays may leave what 32 bits hold, which is an error that names it.
        let soup = scene.soup_posed(&posed, None)?;
        if time_s == 0.3 {
            build(&scene, &soup);
        }
    }
    Ok(())
}

fn build(scene: &Scene, soup: &Soup) {
    if soup.triangles.len() > MANY_BUILT {
        return;
    }
    let rule = |&material: &u32| match scene.materials[material as usize].double_sided {
        true => Casting::Both,
        false => Casting::Front,
    };
    let mesh = Mesh {
        positions: soup.positions.clone(),
        residuals: soup.residuals.clone(),
        triangles: soup.triangles.clone(),
        casting: soup.material.iter().map(rule).collect(),
    };
    let lights = scene.lights.iter().take(LIGHTS);
    let lights = lights.map(|l| light::cast_by(l, soup.origin)).collect();
    cast::cast(&mesh, lights);
}

/// The invariant of a loaded scene, as [`Scene`] states it.
fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        let vertices = mesh.positions.len();
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
        let corners = mesh.triangles.iter().flatten();
        assert!(corners.into_iter().all(|&v| (v as usize) < vertices));
        assert_eq!(mesh.materials.len(), mesh.triangles.len());
        let materials = scene.materials.len();
        assert!(mesh.materials.iter().all(|&m| (m as usize) < materials));
    }
    for instance in &scene.instances {
        assert!((instance.mesh as usize) < scene.meshes.len());
        assert!(instance.transform.is_finite());
    }
    for image in &scene.images {
        let [width, height] = image.size.map(|n| n as usize);
        assert_eq!(image.rgba8.len(), 4 * width * height);
    }
    for material in &scene.materials {
        let image = material.base_color_image;
        assert!(image.is_none_or(|i| (i as usize) < scene.images.len()));
        assert!(material.base_color.is_finite() && material.emissive.is_finite());
    }
    check_lights(scene);
}

fn check_lights(scene: &Scene) {
    let mut names: Vec<&str> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(
        names.len(),
        scene.lights.len(),
        "names of lights are unique"
    );
    scene.lights.iter().for_each(light::check);
    for camera in &scene.cameras {
        assert!(camera.position.is_finite(), "{camera:?}");
        assert!((camera.forward.length() - 1.0).abs() < 1e-6, "{camera:?}");
        assert!(camera.forward.dot(camera.up).abs() < 1e-6, "{camera:?}");
    }
}
