//! Every light with all its figures.

use crate::figure::figure_or_dash;
use crate::grouped;
use crate::profile::{LightRow, ProfileReport};
use crate::sortable::{Cell, Column, Row, filtered_table};

/// A column, and what it shows of a light.
type Field = (Column, fn(&LightRow) -> Cell);

fn us(value: Option<f64>) -> Cell {
    Cell::number(figure_or_dash(value), value)
}

fn count(value: u64) -> Cell {
    Cell::number(grouped(value), Some(value as f64))
}

const FIELDS: [Field; 24] = [
    (Column::number("Frame", "% of it", "frame_share"), |l| {
        us(l.frame_share.map(|share| 100.0 * share))
    }),
    (Column::number("Own", "\u{b5}s, frame", "frame_us"), |l| {
        us(l.frame_us)
    }),
    (
        Column::number("Volume", "\u{b5}s, GPU", "gpu_us.volume"),
        |l| us(l.gpu_us.map(|gpu| gpu.volume)),
    ),
    (
        Column::number("Light", "\u{b5}s, GPU", "gpu_us.light"),
        |l| us(l.gpu_us.map(|gpu| gpu.light)),
    ),
    (Column::number("Built", "\u{b5}s, CPU", "cpu_us"), |l| {
        us(Some(l.cpu_us.total()))
    }),
    (Column::number("Query", "\u{b5}s", "cpu_us.query"), |l| {
        us(Some(l.cpu_us.query))
    }),
    (Column::number("Facing", "\u{b5}s", "cpu_us.facing"), |l| {
        us(Some(l.cpu_us.facing))
    }),
    (Column::number("Hidden", "\u{b5}s", "cpu_us.hidden"), |l| {
        us(Some(l.cpu_us.hidden))
    }),
    (Column::number("Layers", "\u{b5}s", "cpu_us.layers"), |l| {
        us(Some(l.cpu_us.layers))
    }),
    (
        Column::number("Counters", "\u{b5}s", "cpu_us.counters"),
        |l| us(Some(l.cpu_us.counters)),
    ),
    (
        Column::number("Emission", "\u{b5}s", "cpu_us.emission"),
        |l| us(Some(l.cpu_us.emission)),
    ),
    (Column::number("Upload", "\u{b5}s", "cpu_us.upload"), |l| {
        us(Some(l.cpu_us.upload))
    }),
    (
        Column::number("Subset", "triangles", "subset_triangles"),
        |l| count(l.subset_triangles),
    ),
    (
        Column::number("Facing", "triangles", "facing_triangles"),
        |l| count(l.facing_triangles),
    ),
    (Column::number("Quads", "built", "quads"), |l| {
        count(l.quads)
    }),
    (Column::number("Quads", "drawn", "quads_drawn"), |l| {
        count(l.quads_drawn)
    }),
    (Column::number("Caps", "triangles", "cap_triangles"), |l| {
        count(l.cap_triangles)
    }),
    (
        Column::number("Volume", "fragments", "volume_fragments"),
        |l| count(l.volume_fragments),
    ),
    (
        Column::number("Covered", "samples", "light_fragments"),
        |l| count(l.light_fragments),
    ),
    (Column::number("Shaded", "samples", "shaded_samples"), |l| {
        count(l.shaded_samples)
    }),
    (Column::number("Lit", "pixels", "lit_pixels"), |l| {
        count(l.lit_pixels)
    }),
    (
        Column::number("Shadowed", "pixels", "shadowed_pixels"),
        |l| count(l.shadowed_pixels),
    ),
    (Column::number("Range", "m", "range"), |l| {
        us(l.range.map(f64::from))
    }),
    (
        Column::number("Needed", "m, range", "range_needed_m"),
        |l| us(Some(l.range_needed_m)),
    ),
];

/// All lights, the costliest first; then what they leave of the frame.
pub(super) fn lights(report: &ProfileReport) -> String {
    let mut columns = vec![Column::text("Light", "name"), Column::text("Path", "path")];
    columns.extend(FIELDS.iter().map(|(column, _)| *column));
    let mut lights: Vec<&LightRow> = report.lights.iter().collect();
    lights.sort_by(|a, b| super::cost(b).total_cmp(&super::cost(a)));
    let row = |light: &&LightRow| {
        let mut path = light.path.clone();
        path += if light.cached { ", kept" } else { ", rebuilt" };
        if light.path == "skipped" {
            path.clone_from(&light.path);
        }
        if !light.reason.is_empty() {
            path += &format!(": {}", light.reason);
        }
        let mut cells = vec![
            Cell {
                tags: vec![("", light.kind.clone())],
                ..Cell::text(&light.name)
            },
            Cell::text(path),
        ];
        cells.extend(FIELDS.iter().map(|(_, of)| of(light)));
        Row {
            classes: Vec::new(),
            method: light.name.clone(),
            cells,
        }
    };
    let mut rows: Vec<Row> = lights.iter().map(row).collect();
    rows.extend(remainder(report));
    format!(
        "<section id=\"lights\"><h2>Lights</h2>{}</section>",
        filtered_table(
            "light-table",
            "Each light's own; the last row is what the lights leave of the frame, and of building all volumes",
            &columns,
            &rows
        )
    )
}

/// So that the columns add up to the frame.
fn remainder(report: &ProfileReport) -> Option<Row> {
    let frame_us = report.frame.frame_ms * 1e3;
    if report.lights.is_empty() || frame_us <= 0.0 {
        return None;
    }
    let own: Option<f64> = report.lights.iter().map(|l| l.frame_us).sum();
    let built: f64 = report.lights.iter().map(|l| l.cpu_us.total()).sum();
    let left = own.map(|own| frame_us - own);
    let mut cells = vec![
        Cell::text("remainder"),
        Cell::text("all that is not one light's"),
    ];
    cells.extend(FIELDS.iter().map(|(column, _)| match column.key {
        "frame_share" => us(left.map(|us| 100.0 * us / frame_us)),
        "frame_us" => us(left),
        "cpu_us" => us(Some(report.frame.build_us - built)),
        _ => Cell::default(),
    }));
    Some(Row {
        classes: vec!["floor"],
        method: String::new(),
        cells,
    })
}
