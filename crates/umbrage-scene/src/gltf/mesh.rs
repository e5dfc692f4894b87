//! Meshes: the primitives of each glTF mesh joined into one triangle list.
//!
//! Takes the root and the accessors; gives `scene.meshes`, one for each glTF mesh and under the
//! same index. Invariant: indices are in range and positions finite. Primitives that name the same
//! attributes share their vertices. Source: glTF 2.0 specification, section 3.7.2.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use gltf::Semantic;
use gltf::json::Index;
use gltf::json::mesh::{Mode, Primitive};
use gltf::json::validation::Checked;

use super::{Context, name_or, weights};
use crate::{Material, Mesh, Progress, Scene, SceneError};

/// Loads every mesh.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    progress: &dyn Progress,
) -> Result<(), SceneError> {
    let root = context.root;
    progress.stage("meshes", root.meshes.len() as u64);
    for (index, mesh) in root.meshes.iter().enumerate() {
        let mut joined = Mesh {
            name: name_or(&mesh.name, "mesh", index),
            ..Mesh::default()
        };
        let mut shared = HashMap::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let at = At {
                mesh: index,
                primitive: number,
            };
            append(context, scene, &mut joined, &mut shared, at, primitive)?;
        }
        pad(&mut joined);
        scene.meshes.push(joined);
        progress.advance(index as u64 + 1);
    }
    Ok(())
}

/// Which primitive is at hand.
#[derive(Clone, Copy)]
struct At {
    mesh: usize,
    primitive: usize,
}

impl Context<'_> {
    fn primitive_item(&self, at: At) -> String {
        let name = name_or(&self.root.meshes[at.mesh].name, "mesh", at.mesh);
        format!("mesh {} ({name}), primitive {}", at.mesh, at.primitive)
    }

    fn broken_primitive(&self, at: At, what: String) -> SceneError {
        let name = name_or(&self.root.meshes[at.mesh].name, "mesh", at.mesh);
        let (path, mesh, primitive) = (self.path.clone(), at.mesh, at.primitive);
        SceneError::Primitive {
            path,
            mesh,
            name,
            primitive,
            what,
        }
    }
}

/// The accessors that tell the vertices of a primitive.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Attributes {
    position: usize,
    normal: Option<usize>,
    uv: Option<usize>,
    /// Joints and their weights, four a set.
    influences: Vec<[usize; 2]>,
}

/// First vertex and number of vertices of attributes that are already in the mesh.
type Shared = HashMap<Attributes, (u32, u32)>;

/// Appends one primitive to its mesh.
fn append(
    context: &mut Context<'_>,
    scene: &mut Scene,
    mesh: &mut Mesh,
    shared: &mut Shared,
    at: At,
    primitive: &Primitive,
) -> Result<(), SceneError> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err(context.broken_primitive(at, "unknown mode".to_owned()));
    };
    let solid = matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    );
    let accessor = |semantic| {
        let accessor = primitive.attributes.get(&Checked::Valid(semantic));
        accessor.map(Index::value)
    };
    let Some(position) = accessor(Semantic::Positions).filter(|_| solid) else {
        scene.report.skipped_primitives += 1;
        let item = context.primitive_item(at);
        scene
            .report
            .note(|| format!("{item}: points, lines or no positions, skipped"));
        return Ok(());
    };
    if primitive.targets.is_some() {
        scene.report.ignored_morphs += 1;
    }
    let influences = |set| {
        Some([
            accessor(Semantic::Joints(set))?,
            accessor(Semantic::Weights(set))?,
        ])
    };
    let attributes = Attributes {
        position,
        normal: accessor(Semantic::Normals),
        uv: accessor(Semantic::TexCoords(0)),
        influences: (0..).map_while(influences).collect(),
    };
    let (base, count) = match shared.get(&attributes) {
        Some(&range) => range,
        None => {
            let range = vertices(context, scene, mesh, at, &attributes)?;
            shared.insert(attributes, range);
            range
        }
    };
    let indices = match primitive.indices {
        Some(accessor) => {
            let item = context.primitive_item(at);
            Some(context.indices(accessor.value(), || item)?)
        }
        None => None,
    };
    if let Some(bad) = indices.iter().flatten().position(|&v| v >= count) {
        let value = indices.as_ref().map_or(0, |i| i[bad]);
        let what = format!("index {bad} names vertex {value}, but there are {count}");
        return Err(context.broken_primitive(at, what));
    }
    let length = indices.as_ref().map_or(count as usize, Vec::len);
    let (triangles, left) = match mode {
        Mode::Triangles => (length / 3, length % 3),
        _ if length < 3 => (0, length),
        _ => (length - 2, 0),
    };
    scene.report.leftover_vertices += left as u64;

    let path = context.path.clone();
    let item = || {
        format!(
            "mesh {} ({}), primitive {}",
            at.mesh, mesh.name, at.primitive
        )
    };
    context.budget.take(triangles as u64, 16, &path, item)?;
    let material = material(context, scene, at, primitive)?;
    let vertex = |i: usize| base + indices.as_ref().map_or(i as u32, |list| list[i]);
    mesh.triangles
        .extend((0..triangles).map(|t| corners(mode, t).map(vertex)));
    mesh.materials.resize(mesh.triangles.len(), material);
    Ok(())
}

/// Places in the index list of the corners of triangle `t`. Every second triangle of a strip is
/// turned, so that all have the winding of the first.
fn corners(mode: Mode, t: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip if t % 2 == 1 => [t, t + 2, t + 1],
        Mode::TriangleStrip => [t, t + 1, t + 2],
        Mode::TriangleFan => [t + 1, t + 2, 0],
        _ => [3 * t, 3 * t + 1, 3 * t + 2],
    }
}

/// Appends the vertices of a primitive; gives the first and their number.
fn vertices(
    context: &mut Context<'_>,
    scene: &mut Scene,
    mesh: &mut Mesh,
    at: At,
    attributes: &Attributes,
) -> Result<(u32, u32), SceneError> {
    let base = mesh.positions.len();
    let item = context.primitive_item(at);
    let positions = context.vectors::<3>(attributes.position, || item)?;
    if let Some(vertex) = positions.iter().position(|p| !Vec3::from(*p).is_finite()) {
        let (path, name) = (context.path.clone(), mesh.name.clone());
        let (mesh, primitive) = (at.mesh, at.primitive);
        return Err(SceneError::NonFiniteVertex {
            path,
            mesh,
            name,
            primitive,
            vertex,
        });
    }
    let count = positions.len();
    if u32::try_from(base + count).is_err() {
        let what = "its mesh has more vertices than 32-bit indices reach".to_owned();
        return Err(context.broken_primitive(at, what));
    }
    mesh.positions.extend(positions.into_iter().map(Vec3::from));

    if let Some(normals) = optional::<3>(context, scene, at, attributes.normal, count)? {
        mesh.normals.resize(base, Vec3::ZERO);
        mesh.normals.extend(normals.into_iter().map(|n| {
            let unit = Vec3::from(n).try_normalize();
            scene.report.repaired_normals += u64::from(unit.is_none());
            unit.unwrap_or(Vec3::ZERO)
        }));
    }
    if let Some(uvs) = optional::<2>(context, scene, at, attributes.uv, count)? {
        mesh.uvs.resize(base, Vec2::ZERO);
        let finite = |uv: [f32; 2]| Some(Vec2::from(uv)).filter(|uv| uv.is_finite());
        mesh.uvs
            .extend(uvs.into_iter().map(|uv| finite(uv).unwrap_or(Vec2::ZERO)));
    }
    if !attributes.influences.is_empty() {
        let item = context.primitive_item(at);
        let sets = &attributes.influences;
        if let Some((joints, shares)) = weights::load(context, scene, &item, sets, count)? {
            mesh.joints.resize(base, weights::UNBOUND.0);
            mesh.weights.resize(base, weights::UNBOUND.1);
            mesh.joints.extend(joints);
            mesh.weights.extend(shares);
        }
    }
    Ok((base as u32, count as u32))
}

/// An attribute that may be absent, and is left out if it does not fit its positions.
fn optional<const N: usize>(
    context: &mut Context<'_>,
    scene: &mut Scene,
    at: At,
    accessor: Option<usize>,
    count: usize,
) -> Result<Option<Vec<[f32; N]>>, SceneError> {
    let Some(accessor) = accessor else {
        return Ok(None);
    };
    let item = context.primitive_item(at);
    let what = match context.vectors::<N>(accessor, || item.clone()) {
        Ok(values) if values.len() == count => return Ok(Some(values)),
        Ok(values) => format!("{} values for {count} vertices", values.len()),
        Err(error @ SceneError::TooLarge { .. }) => return Err(error),
        Err(error) => error.to_string(),
    };
    scene.report.dropped_attributes += 1;
    scene
        .report
        .note(|| format!("{item}: attribute {accessor} left out: {what}"));
    Ok(None)
}

/// The material of a primitive; the default one is appended when first needed.
fn material(
    context: &Context<'_>,
    scene: &mut Scene,
    at: At,
    primitive: &Primitive,
) -> Result<u32, SceneError> {
    let declared = &context.root.materials;
    match primitive.material.map(|m| m.value()) {
        Some(material) => {
            context.resolve(declared, material, "material", || {
                context.primitive_item(at)
            })?;
            Ok(material as u32)
        }
        None => {
            if scene.materials.len() == declared.len() {
                scene.materials.push(Material::default());
            }
            Ok(declared.len() as u32)
        }
    }
}

/// Gives vertices of primitives without normals, texture coordinates or joints the neutral value, if
/// other primitives of the mesh have them.
fn pad(mesh: &mut Mesh) {
    let count = mesh.positions.len();
    if !mesh.normals.is_empty() {
        mesh.normals.resize(count, Vec3::ZERO);
    }
    if !mesh.uvs.is_empty() {
        mesh.uvs.resize(count, Vec2::ZERO);
    }
    if !mesh.joints.is_empty() {
        mesh.joints.resize(count, weights::UNBOUND.0);
        mesh.weights.resize(count, weights::UNBOUND.1);
    }
}
