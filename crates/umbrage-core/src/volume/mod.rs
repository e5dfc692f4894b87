//! Subset to volume: facing, signed edge counters, silhouette quads, caps.
//!
//! Give every triangle of a light's subset a coefficient in {-1, 0, +1}; the counter of an edge is
//! the signed sum over its triangles. That is the boundary of the chain of coefficients, so the
//! volume closes by construction: whatever the subset, the soup, or the outcome of any one facing
//! test (Aldridge and Woods 2004, section 2.4).

mod brute;
mod build;
mod cache;
mod chain;
mod counter;
mod crow;
mod facing;
mod hidden;
mod plain;
mod range;
mod store;
mod validate;
mod volumes;

pub use brute::brute;
pub use build::VolumeBuilder;
pub use chain::{Chain, ChainTriangle, Quad};
pub use counter::counter;
pub use crow::Crow;
pub use facing::facing;
pub use hidden::{HiddenScratch, drop_hidden};
pub use plain::plain_counter;
pub use range::{QuadRange, QuadReach, RangePrefix, range_first};
pub use store::Version;
pub use validate::{ClosureFault, check_closed};
pub use volumes::{LightVolume, Volumes};
