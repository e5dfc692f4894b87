//! Numbers for changes, so that whoever copied something knows whether the copy is still right.

use std::sync::atomic::{AtomicU64, Ordering};

static LAST: AtomicU64 = AtomicU64::new(0);

/// A number higher than any given out before in this process. What carries the same stamp has not
/// changed since, even if it was cloned or moved meanwhile; 0 is never given out.
pub(crate) fn next() -> u64 {
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}
