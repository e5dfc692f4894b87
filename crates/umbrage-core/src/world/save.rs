//! A [`World`] to a file, and the file mapped back as a `World`.
//!
//! The file holds the arrays as they are in memory, so that opening copies nothing: it checks a
//! checksum an array and, in one pass, that no number points outside. A file from another version,
//! another mesh or another kind of machine is refused, never repaired: building is the repair.

mod bounds;
mod error;
mod layout;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use bytemuck::{CheckedBitPattern, NoUninit};
use glam::Vec3;
use rayon::prelude::*;

pub use self::error::SavedWorldError;
use self::layout::{
    ALIGNMENT, BYTE_ORDER, Contents, Head, MAGIC, Placed, Preamble, Section, VERSION,
};
use super::array::{Array, MappedFile};
use super::{Bvh, Edges, Extent, LANES, Planes, World};
use crate::fingerprint::{Fingerprint, checksum};

impl World {
    /// What of an array is not an object's.
    fn fixed_part<'a, T>(&self, array: &'a [T], fixed: &Range<u32>) -> &'a [T] {
        match self.objects.is_empty() {
            true => array,
            false => &array[..fixed.end as usize],
        }
    }

    /// Writes the world without its objects to `path`, whole or not at all; [`World::open`] asks for the same
    /// `fingerprint`, which is that of the mesh it was built from.
    ///
    /// # Errors
    /// [`SavedWorldError::Io`].
    pub fn save(&self, path: &Path, fingerprint: Fingerprint) -> Result<(), SavedWorldError> {
        let Extent {
            vertices,
            triangles,
            edges,
            nodes,
        } = &self.fixed;
        let clusters = 0..triangles.end.div_ceil(LANES as u32);
        let residuals = match self.keeps_residuals {
            true => bytes(self.fixed_part(&self.residuals, vertices)),
            false => bytes(&self.residuals),
        };
        let arrays: [(&[u8], usize); Section::ALL.len()] = [
            bytes(self.fixed_part(&self.positions, vertices)),
            residuals,
            bytes(self.fixed_part(&self.triangles, triangles)),
            bytes(self.fixed_part(&self.source, triangles)),
            bytes(self.fixed_part(&self.casting, triangles)),
            bytes(self.fixed_part(&self.edges.vertices, edges)),
            bytes(self.fixed_part(&self.edges.sides, &clusters)),
            bytes(self.fixed_part(&self.clusters, &clusters)),
            bytes(self.fixed_part(&self.planes.clusters, &clusters)),
            bytes(self.fixed_part(&self.boxes, &clusters)),
            bytes(self.fixed_part(&self.bvh.nodes, nodes)),
        ];
        let mut end = size_of::<Head>();
        let sections = arrays.map(|(bytes, element)| {
            let offset = end.next_multiple_of(ALIGNMENT);
            end = offset + bytes.len();
            Placed {
                offset: offset as u64,
                bytes: bytes.len() as u64,
                element_bytes: element as u64,
                checksum: checksum(bytes),
            }
        });
        let head = Head::new(Contents {
            file_bytes: end as u64,
            fingerprint,
            sections,
            report: (&self.report).into(),
        });
        write_whole(path, |file| {
            file.write_all(bytemuck::bytes_of(&head))?;
            let mut at = size_of::<Head>();
            for (bytes, _) in arrays {
                let gap = at.next_multiple_of(ALIGNMENT) - at;
                file.write_all(&[0; ALIGNMENT][..gap])?;
                file.write_all(bytes)?;
                at += gap + bytes.len();
            }
            Ok(())
        })?;
        Ok(())
    }

    /// Maps a world that was saved with the same `fingerprint`, in milliseconds for a million
    /// triangles. The file must not be changed in place while the world or a clone of it lives;
    /// saving over it is safe, since that replaces the file.
    ///
    /// # Errors
    /// Anything but an undamaged world of this format and this mesh is refused.
    pub fn open(path: &Path, fingerprint: Fingerprint) -> Result<Self, SavedWorldError> {
        // Asked before opening: that would wait for whoever writes to a pipe.
        let found = fs::metadata(path)?;
        if !found.is_file() || found.len() < size_of::<Preamble>() as u64 {
            return Err(SavedWorldError::NotASavedWorld);
        }
        Self::from_file(MappedFile::new(&File::open(path)?)?, fingerprint)
    }

    /// [`World::open`] of a file that is in memory, for hosts that keep theirs in an archive. The
    /// bytes are copied.
    ///
    /// # Errors
    /// As [`World::open`].
    pub fn from_saved(bytes: &[u8], fingerprint: Fingerprint) -> Result<Self, SavedWorldError> {
        if bytes.len() < size_of::<Preamble>() {
            return Err(SavedWorldError::NotASavedWorld);
        }
        Self::from_file(MappedFile::copied(bytes)?, fingerprint)
    }

    fn from_file(file: MappedFile, fingerprint: Fingerprint) -> Result<Self, SavedWorldError> {
        let contents = contents(file.bytes())?;
        if contents.fingerprint != fingerprint {
            return Err(SavedWorldError::Stale);
        }
        let sections = Section::ALL.into_par_iter();
        sections.try_for_each(|section| verify(&file, &contents, section))?;
        let residuals: Array<Vec3> = array(&file, &contents, Section::Residuals)?;
        let world = Self {
            positions: array(&file, &contents, Section::Positions)?,
            keeps_residuals: !residuals.is_empty(),
            residuals,
            triangles: array(&file, &contents, Section::Triangles)?,
            source: array(&file, &contents, Section::Source)?,
            casting: array(&file, &contents, Section::Casting)?,
            edges: Edges {
                vertices: array(&file, &contents, Section::Edges)?,
                sides: array(&file, &contents, Section::Sides)?,
            },
            clusters: array(&file, &contents, Section::Clusters)?,
            planes: Planes {
                clusters: array(&file, &contents, Section::Planes)?,
            },
            boxes: array(&file, &contents, Section::Boxes)?,
            bvh: Bvh {
                nodes: array(&file, &contents, Section::Nodes)?,
            },
            report: (&contents.report).into(),
            ..Self::default()
        };
        bounds::check(&world, fingerprint.triangles())?;
        Ok(world.without_objects())
    }
}

/// Makes the length and the checksums of a saved world right, and gives the fingerprint that it
/// claims: for tests of what stands behind them.
#[doc(hidden)]
pub fn reseal(file: &mut [u8]) -> Option<Fingerprint> {
    let mut head: Head = read(file)?;
    let contents = &mut head.contents;
    contents.file_bytes = file.len() as u64;
    for section in Section::ALL {
        let bytes = range(contents, section).and_then(|range| file.get(range));
        contents.sections[section as usize].checksum = checksum(bytes.unwrap_or_default());
    }
    head.checksum = checksum(bytemuck::bytes_of(contents));
    file[..size_of::<Head>()].copy_from_slice(bytemuck::bytes_of(&head));
    Some(head.contents.fingerprint)
}

/// The bytes of an array, and of one element.
fn bytes<T: NoUninit>(array: &[T]) -> (&[u8], usize) {
    (bytemuck::cast_slice(array), size_of::<T>())
}

/// The head of a file, if the file is what it says.
fn contents(file: &[u8]) -> Result<Contents, SavedWorldError> {
    let preamble: Preamble = read(file).ok_or(SavedWorldError::NotASavedWorld)?;
    if preamble.magic != MAGIC {
        return Err(SavedWorldError::NotASavedWorld);
    }
    if preamble.byte_order != BYTE_ORDER {
        return Err(SavedWorldError::OtherByteOrder);
    }
    if preamble.version != VERSION {
        return Err(SavedWorldError::OtherVersion {
            found: preamble.version,
            expected: VERSION,
        });
    }
    let truncated = |expected| SavedWorldError::Truncated {
        found: file.len() as u64,
        expected,
    };
    let head: Head = read(file).ok_or(truncated(size_of::<Head>() as u64))?;
    if head.checksum != checksum(bytemuck::bytes_of(&head.contents)) {
        return Err(SavedWorldError::Damaged { section: "head" });
    }
    if head.contents.file_bytes != file.len() as u64 {
        return Err(truncated(head.contents.file_bytes));
    }
    Ok(head.contents)
}

fn read<T: bytemuck::AnyBitPattern>(file: &[u8]) -> Option<T> {
    file.get(..size_of::<T>()).map(bytemuck::pod_read_unaligned)
}

/// Where an array stands in the file; `None` if it leaves it.
fn range(contents: &Contents, section: Section) -> Option<std::ops::Range<usize>> {
    let placed = &contents.sections[section as usize];
    let start = usize::try_from(placed.offset).ok()?;
    let length = usize::try_from(placed.bytes).ok()?;
    Some(start..start.checked_add(length)?)
}

fn verify(file: &MappedFile, contents: &Contents, section: Section) -> Result<(), SavedWorldError> {
    let bytes = range(contents, section).and_then(|range| file.bytes().get(range));
    let expected = contents.sections[section as usize].checksum;
    if bytes.is_some_and(|bytes| checksum(bytes) == expected) {
        return Ok(());
    }
    Err(SavedWorldError::Damaged {
        section: section.name(),
    })
}

fn array<T: CheckedBitPattern>(
    file: &MappedFile,
    contents: &Contents,
    section: Section,
) -> Result<Array<T>, SavedWorldError> {
    let fits = contents.sections[section as usize].element_bytes == size_of::<T>() as u64;
    range(contents, section)
        .filter(|_| fits)
        .and_then(|range| file.array(range))
        .ok_or(SavedWorldError::Invalid {
            section: section.name(),
            item: 0,
        })
}

/// Lets `fill` write a file under another name beside `path`, then renames it.
fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut part = path.as_os_str().to_owned();
    part.push(format!(".{}.part", std::process::id()));
    let part = PathBuf::from(part);
    let write = || {
        let mut file = BufWriter::new(File::create(&part)?);
        fill(&mut file)?;
        file.into_inner()?.sync_all()?;
        fs::rename(&part, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(&part); // it may not exist; the first error matters
    })
}
