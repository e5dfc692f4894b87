//! Materials and the base colour images that they reach.
//!
//! Takes the root; gives `scene.materials`, one for each glTF material and under the same index,
//! and `scene.images`, only those that a base colour uses. An image that cannot be had is counted
//! and left out, never an error. Source: glTF 2.0 specification, section 3.9.

use std::collections::HashMap;

use glam::{Vec3, Vec4};

use gltf::json::extensions::material::PbrSpecularGlossiness;
use gltf::json::image::Image as Declared;
use gltf::json::material::{AlphaMode as SourceAlpha, Material as Source, PbrBaseColorFactor};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;

use super::{Context, name_or};
use crate::image::{self, Decoder, ImageError};
use crate::uri::{self, Place};
use crate::{AlphaMode, LoadReport, Material, Progress, Scene, SceneError};

/// Loads every material.
pub(super) fn load(
    context: &mut Context<'_>,
    scene: &mut Scene,
    progress: &dyn Progress,
) -> Result<(), SceneError> {
    let root = context.root;
    progress.stage("materials", root.materials.len() as u64);
    let mut images = Images {
        decoder: Decoder::default(),
        known: HashMap::new(),
    };
    for (index, source) in root.materials.iter().enumerate() {
        let mut material = plain(source, index, &mut scene.report);
        let texture = source
            .pbr_metallic_roughness
            .base_color_texture
            .as_ref()
            .or_else(|| specular(source)?.diffuse_texture.as_ref());
        if let Some(texture) = texture {
            material.base_color_image = images.of(context, scene, texture);
        }
        scene.materials.push(material);
        progress.advance(index as u64 + 1);
    }
    Ok(())
}

/// What `KHR_materials_pbrSpecularGlossiness` says, which a base colour overrides.
fn specular(source: &Source) -> Option<&PbrSpecularGlossiness> {
    source.extensions.as_ref()?.pbr_specular_glossiness.as_ref()
}

/// The values of a material, clamped to their bounds.
fn plain(source: &Source, index: usize, report: &mut LoadReport) -> Material {
    let pbr = &source.pbr_metallic_roughness;
    let specular = specular(source);
    let white = PbrBaseColorFactor::default().0;
    let base = match specular {
        Some(specular) if pbr.base_color_factor.0 == white => specular.diffuse_factor.0,
        _ => pbr.base_color_factor.0,
    };
    let emissive = source.extensions.as_ref();
    let strength = emissive.and_then(|e| Some(e.emissive_strength.as_ref()?.emissive_strength.0));
    let mut clamp = |value: f32, most: f32| {
        let kept = if value.is_nan() {
            0.0
        } else {
            value.clamp(0.0, most)
        };
        report.repaired_materials += u64::from(kept != value);
        kept
    };
    let base_color = Vec4::from(base.map(|c| clamp(c, 1.0)));
    let strength = clamp(strength.unwrap_or(1.0), 1e9);
    let emissive = source.emissive_factor.0;
    let emissive = Vec3::from(emissive.map(|c| clamp(c, 1.0))) * strength;
    let roughness = clamp(pbr.roughness_factor.0, 1.0);
    let metallic = if specular.is_some() {
        0.0
    } else {
        pbr.metallic_factor.0
    };
    let metallic = clamp(metallic, 1.0);
    let cutoff = clamp(source.alpha_cutoff.unwrap_or_default().0, f32::MAX);
    let alpha = match source.alpha_mode {
        Checked::Valid(SourceAlpha::Opaque) => AlphaMode::Opaque,
        Checked::Valid(SourceAlpha::Mask) => AlphaMode::Mask { cutoff },
        Checked::Valid(SourceAlpha::Blend) => AlphaMode::Blend,
        Checked::Invalid => {
            report.repaired_materials += 1;
            AlphaMode::Opaque
        }
    };
    Material {
        name: name_or(&source.name, "material", index),
        base_color,
        base_color_image: None,
        emissive,
        alpha,
        double_sided: source.double_sided,
        roughness,
        metallic,
    }
}

/// Images decoded so far, by their index in the file.
struct Images {
    decoder: Decoder,
    known: HashMap<usize, Option<u32>>,
}

impl Images {
    /// The index in `scene.images` of a texture's image, if it can be had.
    fn of(&mut self, context: &Context<'_>, scene: &mut Scene, texture: &Info) -> Option<u32> {
        let source = context.root.textures.get(texture.index.value());
        let source = source.map(|t| t.source.value());
        let declared = source.and_then(|i| Some((i, context.root.images.get(i)?)));
        let Some((index, declared)) = declared else {
            scene.report.missing_images += 1;
            scene
                .report
                .note(|| format!("texture {} has no image", texture.index));
            return None;
        };
        if let Some(&known) = self.known.get(&index) {
            return known;
        }
        let name = declared
            .name
            .clone()
            .or_else(|| uri::file_name(declared.uri.as_deref()?));
        let name = name_or(&name, "image", index);
        let result = bytes(context, declared)
            .map_err(ImageError::Missing)
            .and_then(|bytes| self.decoder.decode(&bytes));
        let known = image::keep(scene, name, result);
        self.known.insert(index, known);
        known
    }
}

/// The encoded bytes of an image.
fn bytes(context: &Context<'_>, declared: &Declared) -> Result<Vec<u8>, String> {
    match (declared.buffer_view, &declared.uri) {
        (Some(view), _) => Ok(context.view(view.value())?.to_vec()),
        (None, Some(uri)) => match uri::place(uri, &context.path)? {
            Place::Data(bytes) => Ok(bytes),
            Place::File(file) => context.files.read(&file).map_err(|e| e.to_string()),
        },
        (None, None) => Err("it has neither a buffer view nor a URI".to_owned()),
    }
}
