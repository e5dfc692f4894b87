//! What a fuzzer, and a test on stable, does with bytes: loads them, and then *uses* what came.
//!
//! Takes the bytes of a file; gives whether they were used or refused. Whatever they are, nothing
//! panics, hangs or takes memory without bound, and what is used keeps the invariants that its
//! types state: these are asserted here, since nothing downstream would notice.
#![allow(dead_code, reason = "each target uses its own body")]

mod cast;
mod light;
mod saved;
mod scene;

pub(crate) use light::lights;
pub(crate) use saved::world;
pub(crate) use scene::{gltf, obj};

/// What became of some bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// They were loaded, and everything after that worked.
    Used,
    /// They were refused with this message, which names what was read.
    Refused(String),
}

/// A body: from bytes to what became of them.
pub(crate) type Body = fn(&[u8]) -> Outcome;

/// Every body under the name of its target and of its folder in the corpus.
pub(crate) const BODIES: [(&str, Body); 4] = [
    ("gltf", gltf),
    ("obj", obj),
    ("world", world),
    ("lights", lights),
];
