//! Text of OBJ and MTL files as statements with line numbers.
//!
//! Takes bytes; gives lines, with those that a backslash continues joined. Names in old encodings
//! are accepted, UTF-16 and binary files are not.

use std::borrow::Cow;
use std::path::Path;

use crate::SceneError;

/// The text of a file; bytes that are not UTF-8 become replacement characters.
pub(super) fn decode<'a>(bytes: &'a [u8], path: &Path) -> Result<Cow<'a, str>, SceneError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let utf16 = bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF");
    if utf16 || bytes.contains(&0) {
        return Err(SceneError::NotText {
            path: path.to_owned(),
        });
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// Each statement with the number of its first line, from 1.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (u64, Cow<'_, str>)> {
    // Old Macintosh files end lines with a carriage return alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = text.split(end).zip(1u64..);
    std::iter::from_fn(move || {
        let (line, number) = lines.next()?;
        let Some(start) = continued(line) else {
            return Some((number, Cow::Borrowed(line)));
        };
        let mut joined = start.to_owned();
        for (line, _) in lines.by_ref() {
            joined.push(' ');
            match continued(line) {
                Some(more) => joined.push_str(more),
                None => {
                    joined.push_str(line);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    })
}

/// A line without the backslash that continues it; a comment is never continued.
fn continued(line: &str) -> Option<&str> {
    let line = line.trim_end().strip_suffix('\\')?;
    (!line.trim_start().starts_with('#')).then_some(line)
}
