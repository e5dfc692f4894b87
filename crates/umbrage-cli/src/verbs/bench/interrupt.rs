//! Ctrl-C: asks the run to end where what it has is whole.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Whether someone pressed Ctrl-C.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt(Arc<State>);

#[derive(Debug, Default)]
struct State {
    presses: AtomicU32,
    writing: Mutex<()>,
}

impl Interrupt {
    /// From now on the first Ctrl-C only sets the flag; the second ends the program at once, or as
    /// soon as the files being written are whole.
    pub(super) fn listen() -> Self {
        let flag = Self::default();
        let seen = flag.clone();
        // Fails only where another handler is set, and none is.
        let _ = ctrlc::set_handler(move || {
            if seen.0.presses.fetch_add(1, Ordering::Relaxed) > 0 {
                let _whole = seen.writing();
                std::process::exit(1);
            }
            eprintln!("umbrage: ending after this frame; Ctrl-C again to end at once");
        });
        flag
    }

    pub(super) fn came(&self) -> bool {
        self.0.presses.load(Ordering::Relaxed) > 0
    }

    /// Held while files are written: the program does not end meanwhile.
    pub(super) fn writing(&self) -> MutexGuard<'_, ()> {
        self.0
            .writing
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}
