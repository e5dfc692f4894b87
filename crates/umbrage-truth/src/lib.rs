//! The oracle (exact ray cast) and the error counts that Umbrage is judged by.
//!
//! [`Oracle`] answers, for one eye ray and one light, what the geometry itself says: lit,
//! shadowed, or not a question at all. A [`Mask`] is what a shadow method said, and [`judge()`]
//! counts where the two differ, apart from the places where the oracle's own answer hangs on less
//! than the stated tolerance.
//!
//! The crate sees only triangles, lights and the view. It shares no predicate, edge, query or
//! counter code with the system it judges, so that one mistake cannot hide in both.
//!
//! ```
//! use glam::Vec3;
//! use umbrage_core::{Casting, Light, LightShape, Mesh, View};
//! use umbrage_truth::{JudgeOptions, NearClip, Oracle, judge};
//!
//! let mesh = Mesh {
//!     positions: vec![Vec3::new(-9.0, 0.0, 9.0), Vec3::new(9.0, 0.0, 9.0), Vec3::new(0.0, 0.0, -9.0)],
//!     triangles: vec![[0, 1, 2]],
//!     casting: vec![Casting::Front],
//!     ..Mesh::default()
//! };
//! let view = View::look_at(Vec3::new(0.0, 4.0, 4.0), Vec3::ZERO, 1.0, 0.1, [32, 24]);
//! let light = Light { position: glam::DVec3::new(0.0, 3.0, 0.0), range: 8.0, shape: LightShape::Point };
//! let oracle = Oracle::new(&mesh);
//! let mut mask = oracle.shadow_mask(&view, &[light], NearClip::Clamped);
//! let options = JudgeOptions::default();
//! assert_eq!(judge(&oracle, &view, &[light], &mask, &options, &|_, _| ()).wrong, 0);
//! mask.set(16, 12, 0, false);
//! assert_eq!(judge(&oracle, &view, &[light], &mask, &options, &|_, _| ()).wrong, 1);
//! ```
#![forbid(unsafe_code)]

mod bvh;
pub mod judge;
pub mod mask;
pub mod oracle;
mod predicate;
pub mod rays;
mod shadow;
mod tile;

pub use judge::{
    ErrorMap, JudgeOptions, Judgement, LightErrors, Verdicts, Worst, WrongKind, judge,
};
pub use mask::Mask;
pub use oracle::{FirstHit, Oracle, Verdict};
pub use rays::{EyeRays, NearClip};
