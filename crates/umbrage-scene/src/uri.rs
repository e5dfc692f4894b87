//! URIs of buffers and images: base64 or plain data, or a file beside the scene.
//!
//! Takes a URI and the path of the scene; gives bytes, or the path of a file. Absolute paths and
//! schemes other than `data:` are refused: a scene reads only what lies beside it.
//! Sources: RFC 2397 (data), RFC 4648 section 4 (base64), RFC 3986 section 2.1 (percent).

use std::path::{Component, Path, PathBuf};

/// What a URI stands for.
pub(crate) enum Place {
    /// Bytes that it holds itself.
    Data(Vec<u8>),
    /// A file, the same path however it is spelled.
    File(PathBuf),
}

/// What a URI in the file `scene` stands for, or why it cannot be had.
pub(crate) fn place(uri: &str, scene: &Path) -> Result<Place, String> {
    if let Some(data) = uri.get(..5).filter(|s| s.eq_ignore_ascii_case("data:")) {
        return data_uri(&uri[data.len()..]).map(Place::Data);
    }
    if has_scheme(uri) {
        return Err(format!(
            "{}: only data URIs and relative files are read",
            clip(uri)
        ));
    }
    beside(&percent_decoded(uri)?, scene).map(Place::File)
}

/// The path of the file with this relative path, seen from the scene's folder.
pub(crate) fn beside(relative: &str, scene: &Path) -> Result<PathBuf, String> {
    let file = Path::new(relative);
    if file.is_absolute() || file.has_root() {
        return Err(format!("{}: absolute paths are not read", clip(relative)));
    }
    let mut path = PathBuf::new();
    for part in file.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if path.file_name().is_some() => {
                path.pop();
            }
            part => path.push(part),
        }
    }
    Ok(scene.parent().unwrap_or(Path::new("")).join(path))
}

/// A name for messages and images: the file name, or nothing for a data URI.
pub(crate) fn file_name(uri: &str) -> Option<String> {
    let file = !uri
        .get(..5)
        .is_some_and(|s| s.eq_ignore_ascii_case("data:"));
    file.then(|| uri.rsplit(['/', '\\']).next().unwrap_or(uri).to_owned())
}

/// A scheme has two letters or more, so that `C:` is taken as a drive, and refused later.
fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        !scheme.is_empty()
            && scheme
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    })
}

fn data_uri(rest: &str) -> Result<Vec<u8>, String> {
    let (head, body) = rest.split_once(',').ok_or("a data URI without a comma")?;
    if head.to_ascii_lowercase().ends_with(";base64") {
        base64(body.as_bytes())
    } else {
        percent_bytes(body)
    }
}

/// Decodes base64 with or without padding, in the common or the URL alphabet.
fn base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut held) = (0u32, 0u32);
    for (at, &c) in text.iter().enumerate() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            c if c.is_ascii_whitespace() => continue,
            _ => return Err(format!("byte {at} of a data URI is not base64")),
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Ok(bytes)
}

fn percent_decoded(text: &str) -> Result<String, String> {
    let bytes = percent_bytes(text)?;
    String::from_utf8(bytes).map_err(|_| format!("{}: not UTF-8 once decoded", clip(text)))
}

fn percent_bytes(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail.get(..2).and_then(|h| std::str::from_utf8(h).ok());
        let code = hex.and_then(|h| u8::from_str_radix(h, 16).ok());
        match (first, code) {
            (b'%', Some(code)) => {
                bytes.push(code);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    Ok(bytes)
}

/// Enough of a URI for a message.
fn clip(uri: &str) -> String {
    uri.chars().take(80).collect()
}
