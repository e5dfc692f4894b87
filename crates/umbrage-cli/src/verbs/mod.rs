//! One file per verb: each takes its arguments, prints a table and writes its JSON.

pub(crate) mod bench;
pub(crate) mod check;
#[path = "gen.rs"] // `gen` is a reserved word
pub(crate) mod generate;
pub(crate) mod inspect;
pub(crate) mod profile;
pub(crate) mod render;
pub(crate) mod stress;
pub(crate) mod view;
pub(crate) mod volumes;
