//! What a run measured, made readable: for scripts, for a terminal, for a browser.
//!
//! Takes plain rows of figures ([`bench::BenchReport`]); gives `report.json`, `report.csv` and one
//! self-contained `index.html` ([`bench::write`]), a table for the terminal ([`bench::terminal`])
//! and the comparison of two runs ([`bench::compare`]). Nothing is measured here, and of the
//! other crates of the workspace only `umbrage-scene` is needed, whose `write::whole` writes the files;
//! so a page can be made again from its JSON, without the pictures, which are in none.
//!
//! ```
//! use umbrage_report::bench::{self, BenchReport, BenchRow};
//!
//! let view = ("data/worlds/stormkeep.glb", "auto", [1280, 720]);
//! let mut floor = BenchRow::new("none", view);
//! floor.set_frame_times(&[3.0, 3.1, 3.4]);
//! let mut counter = BenchRow::new("counter", view).exact();
//! counter.set_frame_times(&[6.2, 6.3, 6.1]);
//! counter.set_errors(0, 31, 2_400_000);
//!
//! let mut report = BenchReport::default();
//! report.push(floor);
//! report.push(counter);
//! assert_eq!(report.rows[1].times_none, Some(2.0));
//! assert!(bench::terminal(&report).contains("2.00 x"));
//! ```
//!
//! The rooms: [`mod@bench`] knows what a benchmark measures, [`mod@profile`] what each light of a frame
//! costs. Below them, of use to any report:
//! [`page`] (the HTML shell, style and script), [`sortable`] (HTML tables), [`plot`] (SVG) and
//! [`Table`] (terminal).
#![forbid(unsafe_code)]

pub mod bench;
mod figure;
pub mod page;
pub mod plot;
pub mod profile;
pub mod sortable;
mod table;

pub use table::{Table, grouped};
