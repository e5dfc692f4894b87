//! Subset to volume: facing, signed edge counters, silhouette quads, caps.
//!
//! Give every triangle of a light's subset a coefficient in {-1, 0, +1}; the counter of an edge is
//! the signed sum over its triangles. That is the boundary of the chain of coefficients, so the
//! volume closes by construction: whatever the subset, the soup, or the outcome of any one facing
//! test (Aldridge and Woods 2004, section 2.4).
//!
//! **Caps.** The light cap is the chain; the dark cap is the same triangles, reversed and extruded,
//! as in the 2004 paper. Which half of a mesh that is, is the casting rule's matter:
//! [`Casting::Front`](crate::Casting::Front) takes the triangles that face the light,
//! [`Casting::Back`](crate::Casting::Back) those that face away, reversed. Depth-fail tutorials mix
//! the two: their near cap is the triangles that face the light, their far cap those that face away,
//! extruded as they are. On a closed mesh all three close, since the halves bound each other: the
//! boundary of those facing is that of those facing away, reversed. So the sides are the same too,
//! and so are the shadows outside of the mesh; inside, only what faces the light is before a point.
//! On an open mesh, or where a light's range takes in a part of a mesh, the mixed volume does not
//! close; the other two do.
//!
//! **Baselines.** [`Construction`] names other ways from a chain to quads.

mod brute;
mod build;
mod cache;
mod chain;
mod clock;
mod construction;
mod counter;
mod crow;
mod cube;
mod facing;
mod hidden;
mod layers;
mod plain;
mod range;
mod store;
mod validate;
mod volumes;

pub use brute::brute;
pub use build::VolumeBuilder;
pub use chain::{Chain, ChainTriangle, Quad};
pub use clock::BuildTimes;
pub use construction::Construction;
pub use counter::counter;
pub use crow::Crow;
pub use facing::facing;
pub use hidden::{HiddenScratch, drop_hidden};
pub use layers::LayerLimit;
pub use plain::plain_counter;
pub(crate) use range::SLACK;
pub use range::{QuadRange, QuadReach, RangePrefix, range_first};
pub use store::Version;
pub use validate::{ClosureFault, check_closed};
pub use volumes::{LightVolume, Part, Volumes};
