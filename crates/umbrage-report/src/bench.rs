//! Run time against error: the report of `umbrage bench`.
//!
//! Takes rows, one a method and view, as the runner measured them; gives files, tables and a
//! verdict against an earlier run. Invariant: a figure that was not measured is null, never zero.

mod baseline;
mod compare;
mod csv;
mod difference;
mod html;
mod machine;
mod over_all;
mod rows;
mod scaling;
mod terminal;
mod when;
mod write;

pub use baseline::{BaselineError, read};
pub use compare::{Change, Comparison, Measure, OtherSettings, Regression, compare};
pub use csv::csv;
pub use difference::{Difference, DifferenceError, Picture};
pub use html::html;
pub use machine::Machine;
pub use over_all::{OverAll, over_all};
pub use rows::{BenchReport, BenchRow, View};
pub use terminal::terminal;
pub use when::rfc3339;
pub use write::{FILES, write};
