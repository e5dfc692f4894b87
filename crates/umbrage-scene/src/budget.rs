//! How much memory the geometry of one file may take.
//!
//! A small file can name one accessor a million times, or an accessor of zeros that has no data at
//! all, so what is expanded is counted before it is allocated. Invariant: the vectors of all meshes
//! together never take more than the limit.

use std::path::Path;

use crate::SceneError;

/// Any file may expand to this, in bytes.
const FLOOR: u64 = 1 << 30;
/// Beyond it, to this many times its real size, buffers included.
const FACTOR: u64 = 64;

/// Bytes granted so far, and the most that will be.
pub(crate) struct Budget {
    used: u64,
    limit: u64,
}

impl Budget {
    /// For a file that holds `bytes` in all.
    pub(crate) fn new(bytes: u64) -> Self {
        Self {
            used: 0,
            limit: FLOOR.max(bytes.saturating_mul(FACTOR)),
        }
    }

    /// Grants `count` items of `size` bytes for `item`, or refuses.
    pub(crate) fn take(
        &mut self,
        count: u64,
        size: usize,
        path: &Path,
        item: impl FnOnce() -> String,
    ) -> Result<(), SceneError> {
        let bytes = self.used.saturating_add(count.saturating_mul(size as u64));
        if bytes > self.limit {
            let (path, item, limit) = (path.to_owned(), item(), self.limit);
            return Err(SceneError::TooLarge {
                path,
                item,
                bytes,
                limit,
            });
        }
        self.used = bytes;
        Ok(())
    }
}
