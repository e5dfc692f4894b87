//! Spans of a frame for the Tracy profiler, which shows them as they happen: with the feature `tracy`,
//! else nothing at all.

/// A stretch of time, from its making to its end.
pub(crate) struct Span(#[cfg(feature = "tracy")] Option<tracy_client::Span>);

impl Span {
    /// Ends it before it goes out of scope.
    pub(crate) fn end(self) {
        #[cfg(feature = "tracy")]
        drop(self.0);
    }
}

/// Begins one.
#[cfg(feature = "tracy")]
pub(crate) fn span(name: &'static str) -> Span {
    let client = tracy_client::Client::running();
    Span(client.map(|client| client.span_alloc(Some(name), "frame", file!(), line!(), 0)))
}

/// Begins one.
#[cfg(not(feature = "tracy"))]
#[inline(always)]
pub(crate) fn span(_name: &'static str) -> Span {
    Span()
}

/// A frame is done.
pub(crate) fn frame_mark() {
    #[cfg(feature = "tracy")]
    if let Some(client) = tracy_client::Client::running() {
        client.frame_mark();
    }
}

/// Listens for a Tracy that connects, until the program ends. Does nothing without the feature.
pub fn start() {
    #[cfg(feature = "tracy")]
    tracy_client::Client::start();
}
