//! What was measured, as plain data: the keys of `report.json`.
//!
//! Keys are fixed, scripts depend on them; more may be added. Invariants: a figure that was not
//! measured is null; `wrong_ppm` and `times_none` follow from the other keys and are set here.

use serde::{Deserialize, Serialize};

use super::{Machine, Picture};

/// One run of `umbrage bench`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct BenchReport {
    /// The command line that made it.
    pub command: String,
    /// Options that decide what is measured, beside scene, camera, size and method, in one spelling.
    /// Reports with others are not comparable; empty where an older version wrote none.
    pub settings: String,
    /// Whether the oracle was asked.
    pub oracle: bool,
    /// When the run began: RFC 3339, UTC ([`rfc3339`](super::rfc3339)).
    pub when: String,
    /// Where it ran.
    pub machine: Machine,
    /// Whether every row that was asked for is here.
    pub complete: bool,
    /// Frames timed for a row, after one that warms up.
    pub repeat: u32,
    /// One for each method and view, in the order of the run.
    pub rows: Vec<BenchRow>,
    /// One for each scene, camera and size, in order of first use.
    pub views: Vec<View>,
}

/// What all methods of a view have in common.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// As on the command line.
    pub scene: String,
    /// As on the command line.
    pub camera: String,
    /// Width and height.
    pub size: [u32; 2],
    /// Of the scene, as lit.
    pub lights: u64,
    /// Of the scene.
    pub triangles: u64,
}

/// One method in one view.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct BenchRow {
    /// As on the command line.
    pub scene: String,
    /// Name of the method, as `--methods` takes it.
    pub method: String,
    /// Width and height.
    pub size: [u32; 2],
    /// As on the command line.
    pub camera: String,
    /// Whole frame, median over the repeats; null where the method failed.
    pub frame_ms: Option<f64>,
    /// Shadow volumes, on the CPU: made anew, as the first frame does, which is not timed; where
    /// time runs on (`--play`), brought up to date, median over the repeats. Null for a method
    /// without volumes.
    pub build_ms: Option<f64>,
    /// The whole first frame, which warms up: everything that is kept is made in it.
    #[serde(default)]
    pub first_frame_ms: Option<f64>,
    /// Null on an adapter without timestamps.
    pub gpu_ms: Option<f64>,
    /// Pixel-lights where the oracle disagrees; null where it was not asked.
    pub wrong: Option<u64>,
    /// Pixel-lights where the oracle's own answer depends on the tolerance.
    pub ambiguous: Option<u64>,
    /// Pixel-lights in range of the light and facing it.
    pub samples: Option<u64>,
    /// Wrong ones in a million samples.
    pub wrong_ppm: Option<f64>,
    /// Whether the method promises that none is wrong.
    #[serde(default)]
    pub exact: bool,
    /// Fastest of the repeats.
    #[serde(default)]
    pub frame_ms_min: Option<f64>,
    /// Slowest of the repeats.
    #[serde(default)]
    pub frame_ms_max: Option<f64>,
    /// Third quartile less the first.
    #[serde(default)]
    pub frame_ms_iqr: Option<f64>,
    /// `frame_ms` over that of method `none` in the same view; null where that was not run.
    #[serde(default)]
    pub times_none: Option<f64>,
    /// Of the scene, as lit.
    #[serde(default)]
    pub lights: u64,
    /// Of the scene.
    #[serde(default)]
    pub triangles: u64,
    /// Frames timed.
    #[serde(default)]
    pub repeats: u32,
    /// GPU memory that the method takes beside what every method needs.
    #[serde(default)]
    pub gpu_bytes: Option<u64>,
    /// What a reader should know of this row; may be empty.
    #[serde(default)]
    pub note: String,
    /// Why there are no figures, or no errors; null where nothing failed.
    #[serde(default)]
    pub failed: Option<String>,
    /// Where the method was wrong, encoded once: the page is written after every view.
    #[serde(skip)]
    pub difference: Option<Picture>,
}

impl BenchRow {
    /// A row without figures, of (scene, camera, size).
    pub fn new(method: &str, (scene, camera, size): (&str, &str, [u32; 2])) -> Self {
        Self {
            scene: scene.to_owned(),
            method: method.to_owned(),
            size,
            camera: camera.to_owned(),
            ..Self::default()
        }
    }

    /// Of a method that promises no wrong pixel-lights.
    pub fn exact(mut self) -> Self {
        self.exact = true;
        self
    }

    /// Median, extremes and quartiles of the frames' milliseconds; without frames, null.
    pub fn set_frame_times(&mut self, frames_ms: &[f64]) {
        let mut sorted = frames_ms.to_vec();
        sorted.sort_by(f64::total_cmp);
        self.repeats = sorted.len() as u32;
        self.frame_ms = quantile(&sorted, 0.5);
        self.frame_ms_min = sorted.first().copied();
        self.frame_ms_max = sorted.last().copied();
        self.frame_ms_iqr = quantile(&sorted, 0.75)
            .zip(quantile(&sorted, 0.25))
            .map(|(third, first)| third - first);
    }

    /// What the oracle counted.
    pub fn set_errors(&mut self, wrong: u64, ambiguous: u64, samples: u64) {
        self.wrong = Some(wrong);
        self.ambiguous = Some(ambiguous);
        self.samples = Some(samples);
        // Without samples nothing can be wrong.
        self.wrong_ppm = Some(wrong as f64 * 1e6 / samples.max(1) as f64);
    }

    /// Whether it promises that none is wrong, and some are.
    pub fn breaks_promise(&self) -> bool {
        self.exact && self.wrong.is_some_and(|wrong| wrong > 0)
    }

    /// In words: the method, and the view.
    pub fn name(&self) -> String {
        name(&self.method, &self.scene, &self.camera, self.size)
    }

    /// Adds to what a reader should know.
    pub fn add_note(&mut self, note: &str) {
        if !self.note.is_empty() {
            self.note += "; ";
        }
        self.note += note;
    }

    /// Whether it belongs to that scene, camera and size.
    pub fn is_of(&self, view: &View) -> bool {
        self.scene == view.scene && self.camera == view.camera && self.size == view.size
    }

    /// Whether it is the floor: the frame without shadows.
    pub fn is_floor(&self) -> bool {
        self.method == FLOOR
    }
}

/// The method that every frame time is compared with.
pub(super) const FLOOR: &str = "none";

impl BenchReport {
    /// Adds a row, and its view if that is new. Rows of one view may come in any order:
    /// `times_none` of all of them is set as soon as `none` is there.
    pub fn push(&mut self, row: BenchRow) {
        let view = match self.views.iter().find(|view| row.is_of(view)) {
            Some(view) => view.clone(),
            None => {
                let view = View {
                    scene: row.scene.clone(),
                    camera: row.camera.clone(),
                    size: row.size,
                    lights: row.lights,
                    triangles: row.triangles,
                };
                self.views.push(view.clone());
                view
            }
        };
        self.rows.push(row);
        let floor = self.floor_ms(&view);
        for row in self.rows.iter_mut().filter(|row| row.is_of(&view)) {
            row.times_none = row.frame_ms.zip(floor).map(|(ms, floor)| ms / floor);
        }
    }

    /// Rows of a view, in the order of the run.
    pub fn rows_of<'a>(&'a self, view: &'a View) -> impl Iterator<Item = &'a BenchRow> {
        self.rows.iter().filter(|row| row.is_of(view))
    }

    /// Frame time of `none` in that view.
    pub(super) fn floor_ms(&self, view: &View) -> Option<f64> {
        let mut rows = self.rows_of(view);
        rows.find_map(|row| row.frame_ms.filter(|&ms| row.is_floor() && ms > 0.0))
    }

    /// Names of the methods, in order of first use.
    pub(super) fn methods(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.method.as_str()) {
                names.push(&row.method);
            }
        }
        names
    }
}

/// A row, in words.
pub(super) fn name(method: &str, scene: &str, camera: &str, [width, height]: [u32; 2]) -> String {
    format!("{method} in {scene}, camera {camera}, {width}x{height}")
}

/// Of sorted values, with linear interpolation between neighbours.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = share * last as f64;
    let below = sorted[place.floor() as usize];
    let above = sorted[place.ceil() as usize];
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: (&str, &str, [u32; 2]) = ("a.glb", "auto", [64, 48]);

    #[test]
    fn the_fixed_keys_are_there_and_unmeasured_ones_are_null() {
        let report = BenchReport {
            rows: vec![BenchRow::new("counter", VIEW)],
            ..BenchReport::default()
        };
        let json = serde_json::to_value(&report).unwrap();
        let row = json["rows"][0].as_object().unwrap();
        for key in ["scene", "method", "size", "camera"] {
            assert!(row.contains_key(key), "{key}");
        }
        for key in [
            "frame_ms",
            "build_ms",
            "first_frame_ms",
            "gpu_ms",
            "wrong",
            "ambiguous",
            "samples",
            "wrong_ppm",
            "times_none",
            "gpu_bytes",
            "failed",
        ] {
            assert!(row[key].is_null(), "{key}");
        }
        assert_eq!(row["size"], serde_json::json!([64, 48]));
        assert!(!row.contains_key("difference"));
        for key in [
            "command", "settings", "oracle", "when", "machine", "complete", "repeat", "views",
        ] {
            assert!(json.get(key).is_some(), "{key}");
        }
    }

    #[test]
    fn medians_and_quartiles_of_frames() {
        let mut row = BenchRow::new("counter", VIEW);
        row.set_frame_times(&[4.0, 1.0, 2.0, 3.0]);
        assert_eq!(row.frame_ms, Some(2.5));
        assert_eq!((row.frame_ms_min, row.frame_ms_max), (Some(1.0), Some(4.0)));
        assert_eq!(row.frame_ms_iqr, Some(1.5));
        assert_eq!(row.repeats, 4);
        row.set_frame_times(&[]);
        assert_eq!((row.frame_ms, row.frame_ms_iqr), (None, None));
    }

    #[test]
    fn every_row_is_related_to_the_floor_of_its_own_view_whenever_that_comes() {
        let row = |method: &str, size, ms: f64| {
            let mut row = BenchRow::new(method, ("a.glb", "auto", size));
            row.set_frame_times(&[ms]);
            row
        };
        let mut report = BenchReport::default();
        report.push(row("counter", [64, 48], 6.0));
        assert_eq!(report.rows[0].times_none, None);
        report.push(row("counter", [128, 96], 9.0));
        report.push(row("none", [64, 48], 2.0));
        assert_eq!(report.rows[0].times_none, Some(3.0));
        assert_eq!(report.rows[1].times_none, None);
        assert_eq!(report.rows[2].times_none, Some(1.0));
        assert_eq!(report.views.len(), 2);
    }

    #[test]
    fn errors_without_samples_are_none() {
        let mut row = BenchRow::new("counter", VIEW);
        row.set_errors(0, 0, 0);
        assert_eq!(row.wrong_ppm, Some(0.0));
        row.set_errors(3, 0, 1_000_000);
        assert_eq!(row.wrong_ppm, Some(3.0));
    }
}
