//! What each light costs: the report of `umbrage profile`.
//!
//! Takes rows, one a light, and advice, as the profiler measured them; gives files
//! ([`write()`]) and a trace ([`trace`]). Invariant: a figure that was not measured is null.

mod html;
mod rows;
mod trace;
mod write;

pub use html::html;
pub use rows::{
    Advice, AdviceKind, CpuCost, Frame, GpuCost, LightRow, Pictures, Plan, ProfileReport, Saving,
    Share, Thumbnail,
};
pub use trace::trace;
pub use write::{FILES, write};
