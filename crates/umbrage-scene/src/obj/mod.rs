//! Wavefront OBJ files.
//!
//! Takes a path; gives one mesh and one instance for each `o` or `g` that has faces. The format
//! knows no culling, so its materials are double-sided. The `tobj` package reads statements that
//! [`checked`] has put into plain form first, so that it meets nothing it would refuse or misread,
//! and every error names its line. Vertices are shared inside a material, not across.
//!
//! Source: Wavefront Object Files (.obj), Advanced Visualizer manual, appendix B1.

mod checked;
mod mtl;
mod polygon;
mod text;

use std::cell::RefCell;
use std::path::Path;

use glam::{DAffine3, Vec2, Vec3};

use crate::{Files, Instance, LoadReport, Mesh, Progress, Scene, SceneError, source};
use checked::Statements;

/// A name where a file gives none; no name in a text file can be equal to it.
const NAMELESS: &str = "\0";

/// Loads a `.obj` file and the material libraries and images beside it.
pub(crate) fn load(
    path: &Path,
    files: &dyn Files,
    progress: &dyn Progress,
) -> Result<Scene, SceneError> {
    let bytes = files.read(path)?;
    let text = text::decode(&bytes, path)?;
    progress.stage("obj", bytes.len() as u64);
    let report = RefCell::new(LoadReport::default());
    let libraries = mtl::Libraries::new(path, files, &report);
    let mut statements = Statements::new(&text, &report, progress);
    // Every corner names a texture coordinate and a normal, so one index serves all three.
    let read = tobj::load_obj_buf(&mut statements, &tobj::GPU_LOAD_OPTIONS, |names| {
        libraries.load(names)
    });
    let (models, materials) = read.map_err(|error| SceneError::Obj {
        path: path.to_owned(),
        line: statements.line,
        what: statements.error.take().unwrap_or_else(|| error.to_string()),
    })?;
    progress.advance(bytes.len() as u64);

    let layout = statements.layout;
    let mut scene = Scene {
        name: source::stem(path),
        report: report.take(),
        ..Scene::default()
    };
    let asked = mtl::define(
        &materials.unwrap_or_default(),
        &layout.materials,
        (path, files),
        &mut scene,
    );
    let mut fallback = None;
    let mut object = None;
    for model in models {
        if model.mesh.indices.is_empty() {
            continue;
        }
        let part = model
            .name
            .parse()
            .ok()
            .and_then(|n: usize| layout.parts.get(n));
        let part = part.copied().unwrap_or_default();
        if object.replace(part.object) != Some(part.object) {
            begin(&mut scene, &layout.objects[part.object]);
        }
        let material = model.mesh.material_id.map(|m| m as u32);
        let material = material.or_else(|| Some(asked[part.material?]));
        let material =
            material.unwrap_or_else(|| *fallback.get_or_insert_with(|| mtl::fallback(&mut scene)));
        append(&mut scene, &model.mesh, material);
    }
    scene.report.nodes = scene.instances.len() as u64;
    Ok(scene)
}

/// Begins a mesh, and its instance.
fn begin(scene: &mut Scene, name: &str) {
    let index = scene.meshes.len();
    let name = match name {
        "" => format!("mesh_{index}"),
        name => name.to_owned(),
    };
    scene.instances.push(Instance {
        name: name.clone(),
        mesh: index as u32,
        transform: DAffine3::IDENTITY,
        ..Instance::default()
    });
    scene.meshes.push(Mesh {
        name,
        ..Mesh::default()
    });
}

/// Appends the faces of one material to the last mesh. Normals and texture coordinates that no
/// corner names are not numbers, see [`checked`].
fn append(scene: &mut Scene, from: &tobj::Mesh, material: u32) {
    let Some(mesh) = scene.meshes.last_mut() else {
        return;
    };
    let base = mesh.positions.len();
    let (positions, _) = from.positions.as_chunks::<3>();
    mesh.positions
        .extend(positions.iter().map(|&p| Vec3::from(p)));
    let count = mesh.positions.len();

    let (normals, _) = from.normals.as_chunks::<3>();
    if !mesh.normals.is_empty() || normals.iter().any(|n| !n[0].is_nan()) {
        mesh.normals.resize(base, Vec3::ZERO);
        mesh.normals.extend(normals.iter().map(|&n| {
            let unit = Vec3::from(n).try_normalize();
            scene.report.repaired_normals += u64::from(unit.is_none() && !n[0].is_nan());
            unit.unwrap_or(Vec3::ZERO)
        }));
        mesh.normals.resize(count, Vec3::ZERO);
    }
    let (uvs, _) = from.texcoords.as_chunks::<2>();
    if !mesh.uvs.is_empty() || uvs.iter().any(|uv| !uv[0].is_nan()) {
        let flipped = |&[u, v]: &[f32; 2]| match u.is_nan() {
            true => Vec2::ZERO,
            false => Vec2::new(u, 1.0 - v),
        };
        mesh.uvs.resize(base, Vec2::ZERO);
        mesh.uvs.extend(uvs.iter().map(flipped));
        mesh.uvs.resize(count, Vec2::ZERO);
    }
    let (triangles, _) = from.indices.as_chunks::<3>();
    let placed = triangles.iter().map(|t| t.map(|v| v + base as u32));
    mesh.triangles.extend(placed);
    mesh.materials.resize(mesh.triangles.len(), material);
}

/// What follows the keyword: names may contain spaces.
fn rest(statement: &str) -> &str {
    let statement = statement.trim();
    statement
        .split_once(|c: char| c.is_ascii_whitespace())
        .map_or("", |(_, r)| r.trim())
}

/// Up to `N` numbers, of which `needed` must be there; the others default to zero.
fn numbers<'a, const N: usize>(
    mut words: impl Iterator<Item = &'a str>,
    needed: usize,
) -> Result<[f32; N], String> {
    let mut values = [0.0; N];
    for (index, value) in values.iter_mut().enumerate() {
        match words.next() {
            Some(word) => *value = number(word)?,
            None if index < needed => return Err(format!("{needed} numbers are needed")),
            None => break,
        }
    }
    Ok(values)
}

/// A finite number.
fn number(word: &str) -> Result<f32, String> {
    let value: f32 = word.parse().unwrap_or(f32::NAN);
    if value.is_finite() {
        return Ok(value);
    }
    let word: String = word.chars().take(30).collect();
    Err(format!("{word:?} is not a finite number"))
}
