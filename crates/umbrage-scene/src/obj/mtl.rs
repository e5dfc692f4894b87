//! Material libraries of OBJ files.
//!
//! Takes the name of a library; gives what `tobj` reads of it, once its statements are known to be
//! whole; then makes materials and their colour images of that. A library, material or image that
//! is not there is counted and stood in for. Colours are taken as linear. Sources: MTL material
//! format, Alias/Wavefront 1995; the PBR keys `Pr`, `Pm` and `Ke` of later exporters.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::{Vec3, Vec4};

use super::{NAMELESS, number, numbers, rest, text};
use crate::image::{Decoder, ImageError};
use crate::{AlphaMode, Files, LoadReport, Material, Scene, image, source, uri};

/// Reads the libraries of one file, each once.
pub(super) struct Libraries<'a> {
    obj: &'a Path,
    files: &'a dyn Files,
    report: &'a RefCell<LoadReport>,
    /// By path, so that one library is one however it is spelled.
    read: RefCell<HashSet<PathBuf>>,
}

impl<'a> Libraries<'a> {
    pub(super) fn new(
        obj: &'a Path,
        files: &'a dyn Files,
        report: &'a RefCell<LoadReport>,
    ) -> Self {
        let read = RefCell::default();
        Self {
            obj,
            files,
            report,
            read,
        }
    }

    /// Reads the libraries that an `mtllib` statement names: one name that may contain spaces, or
    /// several names.
    pub(super) fn load(&self, names: &Path) -> tobj::MTLLoadResult {
        let names = names.to_string_lossy();
        let mut plain = String::new();
        if self.append(&names, &mut plain).is_err() {
            for name in names.split_ascii_whitespace() {
                if let Err(what) = self.append(name, &mut plain) {
                    let mut report = self.report.borrow_mut();
                    report.missing_libraries += 1;
                    report.note(|| format!("material library {name:?}: {what}"));
                }
            }
        }
        tobj::load_mtl_buf(&mut plain.as_bytes())
    }

    /// Appends the statements of one library that have a meaning here.
    fn append(&self, name: &str, plain: &mut String) -> Result<(), String> {
        let file = uri::beside(name, self.obj)?;
        if self.read.borrow().contains(&file) {
            return Ok(());
        }
        let bytes = self.files.read(&file).map_err(|e| e.to_string())?;
        let text = text::decode(&bytes, Path::new(name)).map_err(|e| e.to_string())?;
        self.read.borrow_mut().insert(file);
        let mut named = false;
        for (_, statement) in text::statements(&text) {
            named |= statement.split_ascii_whitespace().next() == Some("newmtl");
            if !named {
                continue;
            }
            match checked(&statement) {
                Ok(Some(statement)) => {
                    let _ = writeln!(plain, "{statement}"); // a string takes all
                }
                Ok(None) => {}
                Err(_) => self.report.borrow_mut().repaired_materials += 1,
            }
        }
        Ok(())
    }
}

/// A statement as `tobj` takes it, if it has a meaning here.
fn checked(statement: &str) -> Result<Option<String>, String> {
    let mut words = statement.split_ascii_whitespace();
    let key = words.next().unwrap_or_default();
    let mut one = || number(words.next().unwrap_or_default());
    Ok(Some(match key {
        "newmtl" if rest(statement).is_empty() => format!("newmtl {NAMELESS}"),
        "map_Kd" if rest(statement).is_empty() => return Err("no file".to_owned()),
        "newmtl" | "map_Kd" => format!("{key} {}", rest(statement)),
        "Kd" | "Ke" => {
            let [r, g, b] = numbers(words, 1)?;
            format!("{key} {r} {g} {b}")
        }
        "d" | "Ns" | "Pr" | "Pm" => format!("{key} {}", one()?),
        "Tr" => format!("d {}", 1.0 - one()?),
        _ => return Ok(None),
    }))
}

/// Appends every material of the libraries, then a plain one, counted, for each name in `asked`
/// that none of them defines. Gives the index of each name in `asked`.
pub(super) fn define(
    materials: &[tobj::Material],
    asked: &[String],
    (obj, files): (&Path, &dyn Files),
    scene: &mut Scene,
) -> Vec<u32> {
    let mut images = Images::default();
    let mut by_name = HashMap::new();
    for (index, from) in materials.iter().enumerate() {
        let mut material = convert(from);
        if let Some(name) = &from.diffuse_texture {
            material.base_color_image = images.load(name, (obj, files), scene);
        }
        by_name.insert(material.name.clone(), index as u32);
        scene.materials.push(material);
    }
    let mut find = |name: &String| {
        *by_name.entry(name.clone()).or_insert_with(|| {
            scene.report.missing_materials += 1;
            let note = || format!("material {name:?} is in no library, a plain one is used");
            scene.report.note(note);
            scene.materials.push(plain(name));
            scene.materials.len() as u32 - 1
        })
    };
    asked.iter().map(&mut find).collect()
}

/// Appends the material of faces that name none.
pub(super) fn fallback(scene: &mut Scene) -> u32 {
    scene.materials.push(plain("default"));
    scene.materials.len() as u32 - 1
}

/// What faces have if they name nothing known.
fn plain(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        double_sided: true,
        ..Material::default()
    }
}

fn convert(from: &tobj::Material) -> Material {
    let name = if from.name == NAMELESS {
        ""
    } else {
        &from.name
    };
    let other = |key: &str| from.unknown_param.get(key)?.parse::<f32>().ok();
    // Beckmann roughness of a Blinn-Phong exponent.
    let shiny = from.shininess.map(|n| (2.0 / (n.max(0.0) + 2.0)).sqrt());
    let color = Vec3::from(from.diffuse.unwrap_or([1.0; 3])).clamp(Vec3::ZERO, Vec3::ONE);
    let alpha = from.dissolve.unwrap_or(1.0).clamp(0.0, 1.0);
    Material {
        base_color: Vec4::from((color, alpha)),
        emissive: Vec3::from(from.emissive.unwrap_or_default()).max(Vec3::ZERO),
        alpha: if alpha < 1.0 {
            AlphaMode::Blend
        } else {
            AlphaMode::Opaque
        },
        roughness: other("Pr").map_or(shiny.unwrap_or(1.0), |r| r.clamp(0.0, 1.0)),
        metallic: other("Pm").map_or(0.0, |m| m.clamp(0.0, 1.0)),
        ..plain(name)
    }
}

/// Images of one file, each decoded once.
#[derive(Default)]
struct Images {
    known: HashMap<String, Option<u32>>,
    decoder: Decoder,
}

impl Images {
    /// The image of a `map_Kd`; options before its name are skipped.
    fn load(
        &mut self,
        name: &str,
        (obj, files): (&Path, &dyn Files),
        scene: &mut Scene,
    ) -> Option<u32> {
        let name = match name.starts_with('-') {
            true => name.split_ascii_whitespace().next_back()?,
            false => name,
        };
        let name = name.replace('\\', "/");
        if let Some(&known) = self.known.get(&name) {
            return known;
        }
        let bytes = uri::beside(&name, obj);
        let bytes = bytes.and_then(|file| files.read(&file).map_err(|e| e.to_string()));
        let result = bytes.map_err(ImageError::Missing);
        let result = result.and_then(|bytes| self.decoder.decode(&bytes));
        let known = image::keep(scene, source::stem(Path::new(&name)), result);
        self.known.insert(name, known);
        known
    }
}
