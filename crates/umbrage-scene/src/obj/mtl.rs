//! Material libraries of OBJ files.
//!
//! Takes the name of a library; appends its materials and their colour images to the scene. A
//! library, material or image that is not there is counted and stood in for. Colours are taken as
//! linear. Sources: MTL material format, Alias/Wavefront 1995; the PBR keys `Pr`, `Pm` and `Ke` of
//! later exporters.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{Vec3, Vec4};

use super::{number, numbers, rest, text};
use crate::image::{Decoder, ImageError};
use crate::{AlphaMode, Material, Scene, image, source, uri};

/// Materials by name, over all libraries of one file.
#[derive(Default)]
pub(super) struct Library {
    by_name: HashMap<String, u32>,
    read: HashSet<String>,
    images: HashMap<String, Option<u32>>,
    decoder: Decoder,
}

/// What faces have before the first `usemtl`, or if that names nothing known.
fn plain(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        double_sided: true,
        ..Material::default()
    }
}

impl Library {
    /// The material of this name; a plain one, counted, if no library defines it.
    pub(super) fn find(&mut self, name: &str, scene: &mut Scene) -> u32 {
        if let Some(&known) = self.by_name.get(name) {
            return known;
        }
        scene.report.missing_materials += 1;
        scene
            .report
            .note(|| format!("material {name:?} is in no library, a plain one is used"));
        self.define(plain(name), scene)
    }

    /// The material of faces that name none.
    pub(super) fn fallback(&mut self, scene: &mut Scene) -> u32 {
        match self.by_name.get("") {
            Some(&known) => known,
            None => {
                let index = self.define(plain("default"), scene);
                self.by_name.insert(String::new(), index);
                index
            }
        }
    }

    fn define(&mut self, material: Material, scene: &mut Scene) -> u32 {
        let index = scene.materials.len() as u32;
        self.by_name.insert(material.name.clone(), index);
        scene.materials.push(material);
        index
    }

    /// Reads the libraries that an `mtllib` statement names: one name that may contain spaces, or
    /// several names.
    pub(super) fn read(&mut self, names: &str, obj: &Path, scene: &mut Scene) {
        if self.read_one(names, obj, scene).is_ok() {
            return;
        }
        for name in names.split_ascii_whitespace() {
            if let Err(what) = self.read_one(name, obj, scene) {
                scene.report.missing_libraries += 1;
                scene
                    .report
                    .note(|| format!("material library {name:?}: {what}"));
            }
        }
    }

    fn read_one(&mut self, name: &str, obj: &Path, scene: &mut Scene) -> Result<(), String> {
        if self.read.contains(name) {
            return Ok(());
        }
        let bytes = uri::fetch_file(name, obj)?;
        let text = text::decode(&bytes, Path::new(name)).map_err(|e| e.to_string())?;
        self.read.insert(name.to_owned());
        let mut current: Option<Material> = None;
        for (_, statement) in text::statements(&text) {
            let statement = statement.trim();
            if statement.split_ascii_whitespace().next() == Some("newmtl") {
                let next = plain(&rest(statement));
                if let Some(done) = current.replace(next) {
                    self.define(done, scene);
                }
            } else if let Some(material) = &mut current
                && self.set(material, statement, obj, scene).is_err()
            {
                scene.report.repaired_materials += 1;
            }
        }
        if let Some(done) = current {
            self.define(done, scene);
        }
        Ok(())
    }

    /// One statement of a material.
    fn set(
        &mut self,
        material: &mut Material,
        statement: &str,
        obj: &Path,
        scene: &mut Scene,
    ) -> Result<(), String> {
        let mut words = statement.split_ascii_whitespace();
        let key = words.next().unwrap_or_default();
        let mut one = || number(words.next().unwrap_or_default());
        match key {
            "Kd" => {
                let color = Vec3::from(numbers::<3>(words, 1)?).clamp(Vec3::ZERO, Vec3::ONE);
                material.base_color = color.extend(material.base_color.w);
            }
            "Ke" => material.emissive = Vec3::from(numbers::<3>(words, 1)?).max(Vec3::ZERO),
            "d" => set_alpha(material, one()?),
            "Tr" => set_alpha(material, 1.0 - one()?),
            "Pr" => material.roughness = one()?.clamp(0.0, 1.0),
            "Pm" => material.metallic = one()?.clamp(0.0, 1.0),
            // Beckmann roughness of a Blinn-Phong exponent.
            "Ns" => material.roughness = (2.0 / (one()?.max(0.0) + 2.0)).sqrt(),
            "map_Kd" => material.base_color_image = self.image(&rest(statement), obj, scene),
            _ => {}
        }
        Ok(())
    }

    /// The image of a `map_Kd`; options before its name are skipped.
    fn image(&mut self, name: &str, obj: &Path, scene: &mut Scene) -> Option<u32> {
        let name = match name.starts_with('-') {
            true => name
                .split_ascii_whitespace()
                .next_back()
                .unwrap_or_default(),
            false => name,
        };
        let name = name.replace('\\', "/");
        if let Some(&known) = self.images.get(&name) {
            return known;
        }
        let result = uri::fetch_file(&name, obj).map_err(ImageError::Missing);
        let result = result.and_then(|bytes| self.decoder.decode(&bytes));
        let known = image::keep(scene, source::stem(Path::new(&name)), result);
        self.images.insert(name, known);
        known
    }
}

fn set_alpha(material: &mut Material, alpha: f32) {
    let alpha = alpha.clamp(0.0, 1.0);
    material.base_color = Vec4::from((material.base_color.truncate(), alpha));
    material.alpha = if alpha < 1.0 {
        AlphaMode::Blend
    } else {
        AlphaMode::Opaque
    };
}
