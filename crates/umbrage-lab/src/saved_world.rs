//! A world from its file, where there is one.

use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

use thiserror::Error;
use umbrage_core::Mesh;
use umbrage_core::world::{SavedWorldError, World, WorldError};

/// Why there is no world.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WorldFileError {
    /// The mesh.
    #[error(transparent)]
    Build(#[from] WorldError),
    /// The file.
    #[error(transparent)]
    File(#[from] SavedWorldError),
}

/// A world, built or opened.
#[derive(Debug)]
pub struct WorldFromFile {
    /// Of the mesh.
    pub world: World,
    /// How long opening took, fingerprint included; `None` if it was built.
    pub opened_in: Option<Duration>,
}

/// The world of `mesh`: mapped from `file` where that exists, else built, and saved there.
/// A file that is not this mesh's world is refused, and not replaced.
pub fn open_or_build(mesh: &Mesh, file: Option<&Path>) -> Result<WorldFromFile, WorldFileError> {
    let start = Instant::now();
    let fingerprint = file.map(|_| mesh.fingerprint()).unwrap_or_default();
    if let Some(file) = file {
        match World::open(file, fingerprint) {
            Ok(world) => {
                return Ok(WorldFromFile {
                    world,
                    opened_in: Some(start.elapsed()),
                });
            }
            Err(SavedWorldError::Io(error)) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(error.into()),
        }
    }
    let world = World::build(mesh)?;
    if let Some(file) = file {
        world.save(file, fingerprint)?;
    }
    Ok(WorldFromFile {
        world,
        opened_in: None,
    })
}
