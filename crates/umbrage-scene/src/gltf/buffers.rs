//! Buffers: the bytes that accessors and images are views of.
//!
//! Takes the root and the binary chunk; gives the bytes of every buffer, each file read once
//! however many buffers name it. Invariant: a loaded buffer has at least the length it declares.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use gltf::json::{Buffer, Root};

use crate::uri::{self, Place};
use crate::{Files, SceneError};

/// The bytes of every buffer, cut to the declared length.
pub(super) struct Buffers {
    bytes: Vec<(Rc<[u8]>, usize)>,
    read: u64,
}

impl Buffers {
    /// The bytes of buffer `index`.
    pub(super) fn get(&self, index: usize) -> Option<&[u8]> {
        self.bytes
            .get(index)
            .map(|(bytes, length)| &bytes[..*length])
    }

    /// Bytes of the files that were read for them, each counted once.
    pub(super) fn bytes_read(&self) -> u64 {
        self.read
    }
}

/// Reads every buffer.
pub(super) fn load(
    root: &Root,
    binary: Option<&[u8]>,
    path: &Path,
    files: &dyn Files,
) -> Result<Buffers, SceneError> {
    let mut known: HashMap<PathBuf, Rc<[u8]>> = HashMap::new();
    let mut buffers = Buffers {
        bytes: Vec::with_capacity(root.buffers.len()),
        read: 0,
    };
    let binary: Option<Rc<[u8]>> = binary.map(Rc::from);
    for (index, buffer) in root.buffers.iter().enumerate() {
        let fail = |what| SceneError::Buffer {
            path: path.to_owned(),
            buffer: index,
            what,
        };
        let place = buffer.uri.as_deref().map(|uri| uri::place(uri, path));
        let bytes = match place.transpose().map_err(fail)? {
            Some(Place::Data(bytes)) => bytes.into(),
            Some(Place::File(file)) => match known.get(&file) {
                Some(bytes) => bytes.clone(),
                None => {
                    let bytes = files.read(&file).map_err(|error| fail(error.to_string()))?;
                    let bytes: Rc<[u8]> = bytes.into();
                    buffers.read += bytes.len() as u64;
                    known.insert(file, bytes.clone());
                    bytes
                }
            },
            None => embedded(index, buffer, binary.as_ref()).map_err(fail)?,
        };
        let length = usize::try_from(buffer.byte_length.0)
            .ok()
            .filter(|&l| l <= bytes.len());
        let length = length.ok_or_else(|| {
            fail(format!(
                "{} bytes are declared, but there are {}",
                buffer.byte_length.0,
                bytes.len()
            ))
        })?;
        buffers.bytes.push((bytes, length));
    }
    Ok(buffers)
}

/// The binary chunk, which only buffer 0 may be. A buffer of no bytes needs none.
fn embedded(index: usize, buffer: &Buffer, binary: Option<&Rc<[u8]>>) -> Result<Rc<[u8]>, String> {
    match binary {
        Some(binary) if index == 0 => Ok(binary.clone()),
        _ if buffer.byte_length.0 == 0 => Ok(Rc::from([])),
        _ => Err("it has neither a URI nor a binary chunk".to_owned()),
    }
}
