//! Statements of an OBJ file in the one form that `tobj` reads without surprise.
//!
//! Takes text; gives statements, one a line, through [`BufRead`]. Numbers are finite and as many as
//! `tobj` wants. Corners count from 1, are in range of what stands before them, and name all three
//! attributes: those that a file leaves out are `nan`, put in front of its own. Concave polygons
//! are cut, since `tobj` makes fans. An `o` with a number of ours begins a [`Part`] at each object
//! and each material; what the number stands for is in [`Layout`].

use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt::Write;
use std::io::{BufRead, Read};

use glam::Vec3;

use super::{NAMELESS, numbers, polygon, rest, text};
use crate::{LoadReport, Progress};

/// What the numbers after `o` stand for.
#[derive(Default)]
pub(super) struct Layout {
    pub(super) parts: Vec<Part>,
    /// Names after `o` or `g`; first that of faces before any.
    pub(super) objects: Vec<String>,
    /// Names after `usemtl`.
    pub(super) materials: Vec<String>,
}

/// Faces of one object and one material; indices into [`Layout`].
#[derive(Clone, Copy, Default)]
pub(super) struct Part {
    pub(super) object: usize,
    pub(super) material: Option<usize>,
}

/// The statements, read to the end or to the first that cannot be understood.
pub(super) struct Statements<'a> {
    lines: Box<dyn Iterator<Item = (u64, Cow<'a, str>)> + 'a>,
    report: &'a RefCell<LoadReport>,
    progress: &'a dyn Progress,
    done: u64,
    /// Positions, and how many texture coordinates and normals there are so far.
    positions: Vec<Vec3>,
    counts: [usize; 2],
    face: Vec<[usize; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The statement at hand, of which `taken` bytes were read.
    plain: String,
    taken: usize,
    /// Line of the statement at hand, from 1.
    pub(super) line: u64,
    /// What is wrong with it.
    pub(super) error: Option<String>,
    pub(super) layout: Layout,
}

impl<'a> Statements<'a> {
    pub(super) fn new(
        text: &'a str,
        report: &'a RefCell<LoadReport>,
        progress: &'a dyn Progress,
    ) -> Self {
        Self {
            lines: Box::new(text::statements(text)),
            report,
            progress,
            done: 0,
            positions: Vec::new(),
            counts: [0; 2],
            face: Vec::new(),
            triangles: Vec::new(),
            plain: "vt nan nan\nvn nan nan nan\no 0\n".to_owned(),
            taken: 0,
            line: 0,
            error: None,
            layout: Layout {
                parts: vec![Part::default()],
                objects: vec![String::new()],
                materials: Vec::new(),
            },
        }
    }

    /// Appends the plain form of one statement; the error says what is wrong with it.
    fn statement(&mut self, statement: &str) -> Result<(), String> {
        let mut words = statement.split_ascii_whitespace();
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match keyword {
            "v" => {
                let [x, y, z] = numbers(words, 3)?;
                self.positions.push(Vec3::new(x, y, z));
                self.write(format_args!("v {x} {y} {z}"));
            }
            "vt" => {
                let [u, v] = numbers(words, 1)?;
                self.counts[0] += 1;
                self.write(format_args!("vt {u} {v}"));
            }
            "vn" => {
                let [x, y, z] = numbers(words, 3)?;
                self.counts[1] += 1;
                self.write(format_args!("vn {x} {y} {z}"));
            }
            "f" | "fo" => self.face(words)?,
            "o" | "g" => {
                self.layout.objects.push(rest(statement).to_owned());
                self.part();
            }
            "usemtl" => {
                let name = rest(statement);
                self.layout.materials.push(name.to_owned());
                self.part();
                let name = if name.is_empty() { NAMELESS } else { name };
                self.write(format_args!("usemtl {name}"));
            }
            "mtllib" => self.write(format_args!("mtllib {}", rest(statement))),
            "p" | "l" => self.report.borrow_mut().skipped_primitives += 1,
            "s" => {}
            _ if keyword.starts_with('#') => {}
            _ => {
                let mut report = self.report.borrow_mut();
                report.skipped_statements += 1;
                let word = clip(keyword);
                report.note(|| format!("statement {word:?} skipped"));
            }
        }
        Ok(())
    }

    fn write(&mut self, line: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.plain, "{line}"); // a string takes all
    }

    /// Begins a part of the object and material that were named last.
    fn part(&mut self) {
        self.write(format_args!("o {}", self.layout.parts.len()));
        self.layout.parts.push(Part {
            object: self.layout.objects.len() - 1,
            material: self.layout.materials.len().checked_sub(1),
        });
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), String> {
        self.face.clear();
        for word in words.take_while(|w| !w.starts_with('#')) {
            let corner = self.corner(word)?;
            self.face.push(corner);
        }
        if self.face.len() < 3 {
            let mut report = self.report.borrow_mut();
            report.skipped_faces += 1;
            report.note(|| "face with fewer than three corners skipped".to_owned());
            return Ok(());
        }
        let mut corners = |list: &mut dyn Iterator<Item = usize>| {
            self.plain.push('f');
            for [v, vt, vn] in list.map(|i| self.face[i]) {
                let _ = write!(self.plain, " {v}/{vt}/{vn}");
            }
            self.plain.push('\n');
        };
        self.triangles.clear();
        let place = |i: usize| self.positions[self.face[i][0] - 1];
        if polygon::cut(self.face.len(), place, &mut self.triangles) {
            for t in &self.triangles {
                corners(&mut t.iter().map(|&i| i as usize));
            }
        } else {
            corners(&mut (0..self.face.len()));
        }
        Ok(())
    }

    /// Position, texture coordinate and normal of a corner, as `tobj` counts them. Geometry does
    /// not need the second and third: out of range they are left out and counted.
    fn corner(&self, word: &str) -> Result<[usize; 3], String> {
        let [uvs, normals] = self.counts;
        let counts = [self.positions.len(), uvs, normals];
        let kinds = ["vertices", "texture coordinates", "normals"];
        let mut corner = [0, 1, 1];
        for (slot, text) in word.split('/').enumerate() {
            if slot >= 3 {
                return Err(format!("corner {:?} has more than three parts", clip(word)));
            }
            if text.is_empty() && slot > 0 {
                continue;
            }
            match resolve(text, counts[slot], kinds[slot]) {
                Ok(index) => corner[slot] += index,
                Err(what) if slot == 0 => return Err(what),
                Err(what) => {
                    let mut report = self.report.borrow_mut();
                    report.dropped_attributes += 1;
                    report.note(|| what);
                }
            }
        }
        Ok(corner)
    }
}

impl BufRead for Statements<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        while self.taken == self.plain.len() {
            let Some((line, statement)) = self.lines.next() else {
                break;
            };
            self.line = line;
            self.plain.clear();
            self.taken = 0;
            self.statement(&statement).map_err(|what| {
                self.error = Some(what);
                std::io::ErrorKind::InvalidData
            })?;
            self.done += statement.len() as u64 + 1;
            if line % 65536 == 0 {
                self.progress.advance(self.done);
            }
        }
        Ok(&self.plain.as_bytes()[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

impl Read for Statements<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let amount = self.fill_buf()?.read(into)?;
        self.consume(amount);
        Ok(amount)
    }
}

/// An index from 1, or backwards from -1, as an index from 1.
fn resolve(text: &str, count: usize, kind: &str) -> Result<usize, String> {
    let bad = || format!("index {:?} where there are {count} {kind}", clip(text));
    let index: i64 = text.parse().map_err(|_| bad())?;
    let index = if index < 0 {
        index.saturating_add(count as i64 + 1)
    } else {
        index
    };
    let index = usize::try_from(index).map_err(|_| bad())?;
    (1..=count)
        .contains(&index)
        .then_some(index)
        .ok_or_else(bad)
}

fn clip(text: &str) -> String {
    text.chars().take(30).collect()
}
