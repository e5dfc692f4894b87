//! The bytes of a file as JSON and binary chunk.
//!
//! Takes the bytes of a file; gives slices of it, cut by the `gltf` package. Bytes that do not
//! begin with `glTF` are taken as JSON. The package trusts the length in the header and knows two
//! chunks only, so the length is checked before it and other chunks are skipped after it.
//! Source: glTF 2.0 specification, section 4.4.

use std::borrow::Cow;
use std::path::Path;

use gltf::binary::Error as Broken;
use gltf::{Error, Glb};

use crate::{LoadReport, SceneError};

/// The two parts of a file.
pub(super) struct Parts<'a> {
    pub(super) json: Cow<'a, [u8]>,
    pub(super) binary: Option<Cow<'a, [u8]>>,
}

/// Splits a file; a text file has no binary part.
pub(super) fn split<'a>(
    bytes: &'a [u8],
    path: &Path,
    report: &mut LoadReport,
) -> Result<Parts<'a>, SceneError> {
    let broken = |what| SceneError::Container {
        path: path.to_owned(),
        what,
    };
    if bytes.starts_with(b"glTF") {
        return chunks(bytes, report).map_err(broken);
    }
    let is_glb = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("glb"));
    let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = json.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{');
    if is_glb && !text {
        return Err(broken("it does not begin with \"glTF\"".to_owned()));
    }
    Ok(Parts {
        json: json.into(),
        binary: None,
    })
}

fn chunks<'a>(bytes: &'a [u8], report: &mut LoadReport) -> Result<Parts<'a>, String> {
    let length = word(bytes, 8)? as usize;
    if length < 12 || length > bytes.len() {
        let there = bytes.len();
        return Err(format!(
            "its header says {length} bytes, but there are {there}"
        ));
    }
    if length < bytes.len() {
        report.ignored_chunks += 1;
        let more = bytes.len() - length;
        report.note(|| format!("{more} bytes after the end of the container"));
    }
    let whole = &bytes[..length];
    let mut parts = match Glb::from_slice(whole) {
        Ok(Glb { json, bin, .. }) => Parts { json, binary: bin },
        Err(Error::Binary(Broken::Version(version))) => {
            return Err(format!("container version {version}, only 2 is supported"));
        }
        Err(Error::Binary(Broken::Io(_))) => return Err("it ends inside a header".to_owned()),
        Err(Error::Binary(Broken::UnknownChunkType(_) | Broken::ChunkType(_))) => Parts {
            json: first_chunk(whole)?.into(),
            binary: None,
        },
        Err(error) => return Err(error.to_string()),
    };
    let binary = parts.binary.as_ref().map_or(0, |binary| 8 + binary.len());
    let mut rest = &whole[20 + parts.json.len() + binary..];
    while !rest.is_empty() {
        let (size, kind) = (word(rest, 0)? as usize, word(rest, 4)?);
        let body = rest[8..].get(..size);
        let body = body.ok_or_else(|| format!("a chunk of {size} bytes is cut short"))?;
        rest = &rest[8 + size..];
        if kind == u32::from_le_bytes(*b"BIN\0") && parts.binary.is_none() {
            parts.binary = Some(body.into());
            continue;
        }
        report.ignored_chunks += 1;
        report.note(|| format!("chunk of type {kind:#010x} ignored"));
    }
    Ok(parts)
}

/// The JSON chunk of a file whose second chunk the package does not know.
fn first_chunk(whole: &[u8]) -> Result<&[u8], String> {
    let size = word(whole, 12)? as usize;
    match whole.get(16..20) {
        Some(b"JSON") => whole[20..]
            .get(..size)
            .ok_or_else(|| format!("a chunk of {size} bytes is cut short")),
        _ => Err("its first chunk is not JSON".to_owned()),
    }
}

/// The little-endian word at `at`.
fn word(bytes: &[u8], at: usize) -> Result<u32, String> {
    let four = bytes.get(at..).and_then(<[u8]>::first_chunk);
    four.map(|b| u32::from_le_bytes(*b))
        .ok_or_else(|| "it ends inside a header".to_owned())
}
