//! The GLB container: twelve bytes of header, a JSON chunk, perhaps a binary chunk.
//!
//! Takes the bytes of a file; gives its JSON and its binary part. Bytes that do not begin with
//! `glTF` are taken as JSON. Source: glTF 2.0 specification, section 4.4.

use std::path::Path;

use crate::{LoadReport, SceneError};

/// The two parts of a file; slices of it.
pub(super) struct Parts<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// Splits a file; a text file has no binary part.
pub(super) fn split<'a>(
    bytes: &'a [u8],
    path: &Path,
    report: &mut LoadReport,
) -> Result<Parts<'a>, SceneError> {
    let is_glb = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("glb"));
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let text = json.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{');
        if is_glb && !text {
            let what = "it does not begin with \"glTF\"".to_owned();
            return Err(SceneError::Container {
                path: path.to_owned(),
                what,
            });
        }
        return Ok(Parts { json, binary: None });
    }
    chunks(bytes, report).map_err(|what| SceneError::Container {
        path: path.to_owned(),
        what,
    })
}

fn chunks<'a>(bytes: &'a [u8], report: &mut LoadReport) -> Result<Parts<'a>, String> {
    let version = word(bytes, 4)?;
    if version != 2 {
        return Err(format!("container version {version}, only 2 is supported"));
    }
    let length = word(bytes, 8)? as usize;
    if length > bytes.len() {
        return Err(format!(
            "its header says {length} bytes, but there are {}",
            bytes.len()
        ));
    }
    if length < bytes.len() {
        report.ignored_chunks += 1;
        report.note(|| {
            format!(
                "{} bytes after the end of the container",
                bytes.len() - length
            )
        });
    }
    let mut rest = bytes.get(12..length).ok_or("it ends inside its header")?;
    let mut json = None;
    let mut binary = None;
    while !rest.is_empty() {
        let size = word(rest, 0)? as usize;
        let kind = word(rest, 4)?;
        let end = size.checked_add(8).filter(|&end| end <= rest.len());
        let end = end.ok_or_else(|| format!("a chunk of {size} bytes is cut short"))?;
        let body = &rest[8..end];
        match kind {
            JSON if json.is_none() => json = Some(body),
            _ if json.is_none() => return Err("its first chunk is not JSON".to_owned()),
            BIN if binary.is_none() => binary = Some(body),
            _ => {
                report.ignored_chunks += 1;
                report.note(|| format!("chunk of type {kind:#010x} ignored"));
            }
        }
        rest = &rest[end..];
    }
    let json = json.ok_or("it has no JSON chunk")?;
    Ok(Parts { json, binary })
}

/// The little-endian word at `at`.
fn word(bytes: &[u8], at: usize) -> Result<u32, String> {
    let four = bytes
        .get(at..at + 4)
        .and_then(|b| <[u8; 4]>::try_from(b).ok());
    four.map(u32::from_le_bytes)
        .ok_or_else(|| "it ends inside a header".to_owned())
}
