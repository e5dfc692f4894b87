//! How time grows: rows that differ in one thing only.
//!
//! Takes the rows; gives, for lights, triangles and pixels, the series of frame times over it,
//! each of at least two different values. Invariant: within a series nothing else differs: same
//! method, camera, and size or scene; generated scenes may differ in the one parameter.

use std::collections::BTreeMap;

use super::{BenchReport, BenchRow};
use crate::grouped;

/// What grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Lights,
    Triangles,
    Pixels,
}

impl Axis {
    pub(super) const ALL: [Self; 3] = [Self::Lights, Self::Triangles, Self::Pixels];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Lights => "lights",
            Self::Triangles => "triangles",
            Self::Pixels => "pixels",
        }
    }

    fn value(self, row: &BenchRow) -> u64 {
        match self {
            Self::Lights => row.lights,
            Self::Triangles => row.triangles,
            Self::Pixels => u64::from(row.size[0]) * u64::from(row.size[1]),
        }
    }

    /// What must be equal within a series, in words: one reading for each way of growing.
    fn sames(self, row: &BenchRow) -> Vec<String> {
        let BenchRow {
            camera,
            lights,
            triangles,
            ..
        } = row;
        let [lights, triangles] = [lights, triangles].map(|count| grouped(*count));
        let size = format!("{}x{}", row.size[0], row.size[1]);
        match self {
            Self::Pixels => vec![format!("{}, camera {camera}", row.scene)],
            Self::Lights => vec![format!(
                "{}, {triangles} triangles, camera {camera}, {size}",
                without(&row.scene, "lights")
            )],
            Self::Triangles => parameters(&row.scene)
                .filter(|&name| name != "lights")
                .map(|name| {
                    let scene = without(&row.scene, name);
                    format!("{scene}, {lights} lights, camera {camera}, {size}")
                })
                .collect(),
        }
    }
}

/// Frame times of all methods over one axis, in what is otherwise one view.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scaling {
    /// What all its rows have in common.
    pub(super) same: String,
    /// (method, points by growing x as (x, row index)); two points or more each.
    pub(super) lines: Vec<(String, Vec<(f64, usize)>)>,
}

/// All series over `axis`, in order of what they have in common.
pub(super) fn scalings(report: &BenchReport, axis: Axis) -> Vec<Scaling> {
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, row) in report.rows.iter().enumerate() {
        if row.frame_ms.is_some() && axis.value(row) > 0 {
            for same in axis.sames(row) {
                groups.entry(same).or_default().push(index);
            }
        }
    }
    let scaling = |(same, members): (String, Vec<usize>)| {
        let line = |method: &str| {
            let of_method = members.iter().filter(|&&i| report.rows[i].method == method);
            let mut points: Vec<(u64, usize)> = of_method
                .map(|&i| (axis.value(&report.rows[i]), i))
                .collect();
            points.sort_unstable();
            points.dedup_by_key(|point| point.0);
            let points: Vec<(f64, usize)> =
                points.into_iter().map(|(x, i)| (x as f64, i)).collect();
            (points.len() > 1).then(|| (method.to_owned(), points))
        };
        let lines: Vec<_> = report.methods().into_iter().filter_map(line).collect();
        (!lines.is_empty()).then_some(Scaling { same, lines })
    };
    groups.into_iter().filter_map(scaling).collect()
}

/// Names of the parameters of `gen:NAME?key=value&...`; none for a file.
fn parameters(scene: &str) -> impl Iterator<Item = &str> {
    let list = scene
        .strip_prefix("gen:")
        .and_then(|rest| rest.split_once('?'))
        .map_or("", |(_, list)| list);
    list.split('&')
        .filter_map(|pair| Some(pair.split_once('=')?.0))
}

/// A generated scene without one of its parameters; any other as it is.
fn without(scene: &str, parameter: &str) -> String {
    match scene.split_once('?') {
        Some((name, list)) if scene.starts_with("gen:") => {
            let others: Vec<&str> = list
                .split('&')
                .filter(|pair| pair.split('=').next() != Some(parameter))
                .collect();
            match others.as_slice() {
                [] => name.to_owned(),
                others => format!("{name}?{}", others.join("&")),
            }
        }
        _ => scene.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(rows: &[(&str, u64, u64, [u32; 2])]) -> BenchReport {
        let mut report = BenchReport::default();
        for &(scene, lights, triangles, size) in rows {
            let mut row = BenchRow::new("counter", (scene, "auto", size));
            row.set_frame_times(&[1.0]);
            (row.lights, row.triangles) = (lights, triangles);
            report.push(row);
        }
        report
    }

    #[test]
    fn only_what_differs_in_that_alone_is_a_series() {
        let rows = report(&[
            ("gen:city?triangles=1000&lights=64", 64, 1000, [64, 48]),
            ("gen:city?triangles=1000&lights=8", 8, 1000, [64, 48]),
            ("gen:city?triangles=4000&lights=8", 8, 4000, [64, 48]),
            ("gen:city?triangles=4000&lights=8", 8, 4000, [128, 96]),
            ("a.glb", 8, 1000, [64, 48]),
            ("b.glb", 16, 2000, [64, 48]),
        ]);
        let xs = |axis| -> Vec<Vec<f64>> {
            let all = scalings(&rows, axis);
            let lines = all.iter().flat_map(|one| &one.lines);
            lines
                .map(|(_, points)| points.iter().map(|p| p.0).collect())
                .collect()
        };
        assert_eq!(xs(Axis::Lights), [[8.0, 64.0]]);
        assert_eq!(xs(Axis::Triangles), [[1000.0, 4000.0]]);
        assert_eq!(xs(Axis::Pixels), [[3072.0, 12288.0]]);
    }

    #[test]
    fn two_scenes_that_differ_in_more_are_no_series() {
        let rows = report(&[
            ("a.glb", 8, 1000, [64, 48]),
            ("b.glb", 16, 1000, [64, 48]),
            ("gen:city?seed=1&triangles=10", 16, 10, [64, 48]),
            ("gen:city?seed=2&triangles=20", 16, 20, [64, 48]),
        ]);
        for axis in Axis::ALL {
            assert_eq!(scalings(&rows, axis), [], "{axis:?}");
        }
    }

    #[test]
    fn a_failed_row_has_no_point() {
        let mut rows = report(&[("a.glb", 8, 9, [64, 48]), ("a.glb", 8, 9, [128, 96])]);
        assert_eq!(scalings(&rows, Axis::Pixels).len(), 1);
        rows.rows[1].frame_ms = None;
        assert_eq!(scalings(&rows, Axis::Pixels), []);
    }
}
