//! Why a file is refused.

use std::io;

use thiserror::Error;

/// Why a file cannot be opened as a world, or a world not be saved.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SavedWorldError {
    /// It does not begin as saved worlds do.
    #[error("not a saved world: choose another file")]
    NotASavedWorld,
    /// Written on a machine that stores numbers the other way round.
    #[error("saved on a machine with another byte order: build the world here and save it again")]
    OtherByteOrder,
    /// Another version of the format.
    #[error(
        "saved in format {found}, this is format {expected}: build the world and save it again"
    )]
    OtherVersion {
        /// In the file.
        found: u32,
        /// The only one that is read.
        expected: u32,
    },
    /// Shorter or longer than it says.
    #[error("{found} bytes of {expected}: incomplete; build the world and save it again")]
    Truncated {
        /// Bytes in the file.
        found: u64,
        /// Bytes it should have.
        expected: u64,
    },
    /// A checksum does not match.
    #[error("damaged in its {section}: build the world and save it again")]
    Damaged {
        /// Array, or "head".
        section: &'static str,
    },
    /// Made from another mesh.
    #[error(
        "stale: made from other triangles, casting rules, origin or welding; \
         build the world and save it again"
    )]
    Stale,
    /// Whole, but not a world: something points outside.
    #[error("{section}[{item}] is not valid in a world: build the world and save it again")]
    Invalid {
        /// Array.
        section: &'static str,
        /// Index into it.
        item: usize,
    },
    /// What the system says.
    #[error(transparent)]
    Io(#[from] io::Error),
}
