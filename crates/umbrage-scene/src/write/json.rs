//! Nodes, lights, cameras and materials of a written file, as JSON.
//!
//! Takes the parts of a [`Scene`] whose indices are in range; gives what the file says about them.

use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use crate::{AlphaMode, Camera, Light, LightKind, Material, Scene};

/// Near plane, in metres, of a camera that has none: glTF demands one.
const NEAR: f64 = 0.05;

/// Nodes of instances, lights and cameras, in this order; and which of them hang on no other.
pub(super) fn nodes(scene: &Scene, numbers: &[Option<usize>]) -> (Vec<Value>, Vec<usize>) {
    let mut nodes = Nodes::default();
    for instance in &scene.instances {
        let Some(mesh) = numbers[instance.mesh as usize] else {
            continue;
        };
        let mut node = json!({"name": instance.name, "mesh": mesh});
        let t = nodes.rest(&instance.name, instance.transform.translation);
        if instance.transform != glam::DAffine3::IDENTITY {
            let m = instance.transform.matrix3.to_cols_array();
            let rows = [
                m[0], m[1], m[2], 0.0, m[3], m[4], m[5], 0.0, m[6], m[7], m[8], 0.0, t.x, t.y, t.z,
                1.0,
            ];
            node["matrix"] = json!(rows.to_vec());
        }
        nodes.push(node);
    }
    let place = |nodes: &mut Nodes, name: &str, position: DVec3, rotation: DQuat| {
        let translation = nodes.rest(name, position).to_array();
        let rotation = rotation.normalize().to_array();
        json!({"name": name, "translation": translation, "rotation": rotation})
    };
    for (index, light) in scene.lights.iter().enumerate() {
        let direction = light.direction.try_normalize().unwrap_or(DVec3::NEG_Z);
        let rotation = DQuat::from_rotation_arc(DVec3::NEG_Z, direction);
        let mut node = place(&mut nodes, &light.name, light.position, rotation);
        node["extensions"] = json!({"KHR_lights_punctual": {"light": index}});
        nodes.push(node);
    }
    for (index, camera) in scene.cameras.iter().enumerate() {
        let right = camera.forward.cross(camera.up);
        let basis = DMat3::from_cols(right, camera.up, -camera.forward);
        let mut node = place(
            &mut nodes,
            &camera.name,
            camera.position,
            DQuat::from_mat3(&basis),
        );
        node["camera"] = json!(index);
        nodes.push(node);
    }
    (nodes.all, nodes.roots)
}

/// Nodes as they are written.
#[derive(Default)]
struct Nodes {
    all: Vec<Value>,
    roots: Vec<usize>,
    /// Whether the next one hangs on the last.
    hangs: bool,
}

impl Nodes {
    /// Where the next node stands. What of `position` one f32 does not hold is left to it, and a node
    /// above it stands where the f32 is.
    fn rest(&mut self, name: &str, position: DVec3) -> DVec3 {
        let above = position.as_vec3().as_dvec3();
        if above == position || !above.is_finite() {
            return position;
        }
        let child = self.all.len() + 1;
        self.push(json!({"name": name, "translation": above.to_array(), "children": [child]}));
        self.hangs = true;
        position - above
    }

    fn push(&mut self, node: Value) {
        if !std::mem::take(&mut self.hangs) {
            self.roots.push(self.all.len());
        }
        self.all.push(node);
    }
}

/// A light of `KHR_lights_punctual`; its node places it.
pub(super) fn light(light: &Light) -> Value {
    let kind = match light.kind {
        LightKind::Point => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional => "directional",
    };
    let mut value = json!({
        "name": light.name, "type": kind,
        "color": light.color.to_array(), "intensity": light.intensity,
    });
    if let Some(range) = light.range {
        value["range"] = json!(range);
    }
    if let LightKind::Spot {
        inner_rad,
        outer_rad,
    } = light.kind
    {
        value["spot"] = json!({"innerConeAngle": inner_rad, "outerConeAngle": outer_rad});
    }
    value
}

/// A perspective camera; its node places it.
pub(super) fn camera(camera: &Camera) -> Value {
    let near = camera.near.unwrap_or(NEAR);
    json!({
        "name": camera.name, "type": "perspective",
        "perspective": {"yfov": camera.fovy_rad, "znear": near},
    })
}

/// A material; what exceeds 1 in its emission becomes a strength.
pub(super) fn material(material: &Material) -> Value {
    let mut value = json!({
        "name": material.name,
        "doubleSided": material.double_sided,
        "pbrMetallicRoughness": {
            "baseColorFactor": material.base_color.to_array(),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
    });
    if let Some(image) = material.base_color_image {
        value["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": image });
    }
    let strength = material.emissive.max_element();
    if strength > 1.0 {
        // A power of two divides without rounding.
        let strength = strength.log2().ceil().exp2();
        value["emissiveFactor"] = json!((material.emissive / strength).to_array());
        value["extensions"] =
            json!({"KHR_materials_emissive_strength": {"emissiveStrength": strength}});
    } else if strength > 0.0 {
        value["emissiveFactor"] = json!(material.emissive.to_array());
    }
    match material.alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Mask { cutoff } => {
            value["alphaMode"] = json!("MASK");
            value["alphaCutoff"] = json!(cutoff);
        }
        AlphaMode::Blend => value["alphaMode"] = json!("BLEND"),
    }
    value
}
