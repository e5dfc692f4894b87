//! Ctrl-C: asks the run to end where what it has is whole.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Whether someone pressed Ctrl-C.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt(Arc<AtomicU32>);

impl Interrupt {
    /// From now on the first Ctrl-C only sets the flag; the second ends the program at once.
    pub(super) fn listen() -> Self {
        let flag = Self::default();
        let seen = flag.clone();
        // Fails only where another handler is set, and none is.
        let _ = ctrlc::set_handler(move || {
            if seen.0.fetch_add(1, Ordering::Relaxed) > 0 {
                std::process::exit(1);
            }
            eprintln!("umbrage: ending after this frame; Ctrl-C again to end at once");
        });
        flag
    }

    pub(super) fn came(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }
}
