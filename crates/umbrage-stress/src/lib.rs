//! Seeded campaigns that try to break Umbrage: hostile geometry and placements, checked by exact
//! crossing counts on the CPU and by masks on the GPU, both against the oracle.
//!
//! [`families`] make [`Case`]s from seeds; [`points`] asks a case's volumes at points, [`masks`]
//! draws it; [`campaign`] does so thousands of times and counts; [`mod@shrink`] and [`mod@file`] make a
//! failure small and keep it.
//!
//! ```
//! use umbrage_stress::campaign::{CampaignOptions, run};
//!
//! let mut options = CampaignOptions::default();
//! options.cases = 40;
//! let found = run(&options, None, &|_| ())?.total();
//! assert_eq!((found.cases, found.wrong, found.open), (40, 0, 0));
//! # Ok::<(), umbrage_stress::masks::DrawError>(())
//! ```
#![forbid(unsafe_code)]

pub mod campaign;
pub mod case;
pub mod exact;
pub mod families;
pub mod file;
pub mod keep;
pub mod limits;
pub mod masks;
pub mod points;
pub mod rng;
mod samples;
pub mod shrink;
pub mod surface;

pub use case::{Case, CaseId};
pub use shrink::shrink;
