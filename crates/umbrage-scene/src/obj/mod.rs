//! Wavefront OBJ files.
//!
//! Takes a path; gives one mesh and one instance for each `o` or `g` that has faces. The format
//! knows no culling, so its materials are double-sided. Numbers are parsed in f64 and rounded once;
//! an error names its line, which is why the text is read here and not by a library.
//!
//! Source: Wavefront Object Files (.obj), Advanced Visualizer manual, appendix B1.

mod faces;
mod mtl;
mod polygon;
mod text;

use std::path::Path;

use glam::{DAffine3, Vec2, Vec3};

use crate::{Instance, LoadReport, Progress, Scene, SceneError, source};
use faces::{Attributes, Faces};
use mtl::Library;

/// What the statements read so far have set up.
struct Reader<'a> {
    path: &'a Path,
    scene: Scene,
    attributes: Attributes,
    faces: Faces,
    library: Library,
    material: u32,
}

/// Loads a `.obj` file and the material libraries and images beside it.
pub(crate) fn load(path: &Path, progress: &dyn Progress) -> Result<Scene, SceneError> {
    let bytes = source::read(path)?;
    let text = text::decode(&bytes, path)?;
    let mut reader = Reader {
        path,
        scene: Scene {
            name: source::stem(path),
            ..Scene::default()
        },
        attributes: Attributes::default(),
        faces: Faces::default(),
        library: Library::default(),
        material: u32::MAX,
    };
    progress.stage("obj", bytes.len() as u64);
    let mut done = 0;
    for (line, statement) in text::statements(&text) {
        reader
            .statement(statement.as_ref())
            .map_err(|what| SceneError::Obj {
                path: path.to_owned(),
                line,
                what,
            })?;
        done += statement.len() as u64 + 1;
        if line % 65536 == 0 {
            progress.advance(done);
        }
    }
    reader.finish_mesh();
    progress.advance(bytes.len() as u64);
    reader.scene.report.nodes = reader.scene.instances.len() as u64;
    Ok(reader.scene)
}

impl Reader<'_> {
    /// One statement; the error says what is wrong with it.
    fn statement(&mut self, statement: &str) -> Result<(), String> {
        let mut words = statement.split_ascii_whitespace();
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match keyword {
            "v" => self
                .attributes
                .positions
                .push(Vec3::from(numbers::<3>(words, 3)?)),
            "vn" => self
                .attributes
                .normals
                .push(Vec3::from(numbers::<3>(words, 3)?)),
            "vt" => {
                let [u, v] = numbers::<2>(words, 1)?;
                self.attributes.uvs.push(Vec2::new(u, 1.0 - v));
            }
            "f" | "fo" => {
                if self.material == u32::MAX {
                    self.material = self.library.fallback(&mut self.scene);
                }
                let report = &mut self.scene.report;
                self.faces
                    .add(words, &self.attributes, self.material, report)?;
            }
            "o" | "g" => {
                self.finish_mesh();
                self.faces.name = rest(statement);
            }
            "usemtl" => self.material = self.library.find(&rest(statement), &mut self.scene),
            "mtllib" => self
                .library
                .read(&rest(statement), self.path, &mut self.scene),
            "p" | "l" => self.scene.report.skipped_primitives += 1,
            "s" => {}
            _ if keyword.starts_with('#') => {}
            _ => skip(keyword, &mut self.scene.report),
        }
        Ok(())
    }

    /// Ends the mesh at hand, if it has faces.
    fn finish_mesh(&mut self) {
        let index = self.scene.meshes.len();
        if let Some(mesh) = self.faces.take(index) {
            let (name, transform) = (mesh.name.clone(), DAffine3::IDENTITY);
            self.scene.meshes.push(mesh);
            self.scene.instances.push(Instance {
                name,
                mesh: index as u32,
                transform,
            });
        }
    }
}

/// Counts a statement that has no meaning here.
fn skip(keyword: &str, report: &mut LoadReport) {
    report.skipped_statements += 1;
    let word: String = keyword.chars().take(20).collect();
    report.note(|| format!("statement {word:?} skipped"));
}

/// What follows the keyword: names may contain spaces.
fn rest(statement: &str) -> String {
    let statement = statement.trim();
    statement
        .split_once(|c: char| c.is_ascii_whitespace())
        .map_or("", |(_, r)| r.trim())
        .to_owned()
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

/// A finite number, rounded to f32.
fn number(word: &str) -> Result<f32, String> {
    let value = word.parse::<f64>().map_or(f32::NAN, |v| v as f32);
    if value.is_finite() {
        return Ok(value);
    }
    let word: String = word.chars().take(30).collect();
    Err(format!("{word:?} is not a finite number"))
}
