//! Volumes to a frame plan: plain data that says how each light is drawn for one view.

pub mod bounds;
pub mod extrusion;
pub mod eye_count;
mod eye_counts;
mod parts;
pub mod plan;
pub mod view;

pub use bounds::Rect;
pub use extrusion::{Distance, Extrusion};
pub use eye_count::{EyeCount, eye_count};
pub use parts::PartPlan;
pub use plan::{FramePlan, LightPath, LightPlan, PathRule, PlanOptions, SkipReason, ZFailReason};
