//! How a loader tells how far it is.

/// Told how far a load is. Implemented for `()`, which stays silent.
pub trait Progress: Sync {
    /// A stage begins; `total` is its number of steps, 0 if unknown.
    fn stage(&self, name: &str, total: u64);
    /// `done` steps of the current stage are done (absolute, not an increment).
    fn advance(&self, done: u64);
}

impl Progress for () {
    fn stage(&self, _name: &str, _total: u64) {}
    fn advance(&self, _done: u64) {}
}
