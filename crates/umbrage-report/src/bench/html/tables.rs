//! The tables of the page: all figures of a scene, and the ranking over all views.

#[cfg(test)]
mod tests;

use super::{short_name, view_name};
use crate::bench::terminal::by_time;
use crate::bench::{BenchReport, BenchRow, OverAll, View};
use crate::figure::{NONE, count_or_dash, figure_or_dash};
use crate::grouped;
use crate::sortable::{Cell, Column, Row, table};

type Field = (Column, fn(&BenchRow) -> Cell);

const CAMERA: Field = (Column::text("Camera", "camera"), |row| {
    Cell::text(&row.camera)
});
const SIZE: Field = (Column::number("Size", "pixels", "size"), |row| {
    let [width, height] = row.size;
    let pixels = f64::from(width) * f64::from(height);
    Cell::number(format!("{width}\u{d7}{height}"), Some(pixels))
});
const LIGHTS: Field = (Column::number("Lights", "", "lights"), |row| {
    count(Some(row.lights))
});
const TRIANGLES: Field = (Column::number("Triangles", "", "triangles"), |row| {
    count(Some(row.triangles))
});

const FRAMES: Field = (Column::number("Frames", "timed", "repeats"), |row| {
    count(Some(u64::from(row.repeats)))
});

const FIGURES: [Field; 13] = [
    (Column::number("Frame", "ms, median", "frame_ms"), |row| {
        time(row.frame_ms)
    }),
    (Column::number("Fastest", "ms", "frame_ms_min"), |row| {
        time(row.frame_ms_min)
    }),
    (Column::number("Slowest", "ms", "frame_ms_max"), |row| {
        time(row.frame_ms_max)
    }),
    (Column::number("Spread", "ms, IQR", "frame_ms_iqr"), |row| {
        time(row.frame_ms_iqr)
    }),
    (
        Column::number("Frame", "\u{d7} none", "times_none"),
        |row| time(row.times_none),
    ),
    (Column::number("Volumes", "ms, CPU", "build_ms"), |row| {
        time(row.build_ms)
    }),
    (
        Column::number("First", "ms, frame", "first_frame_ms"),
        |row| time(row.first_frame_ms),
    ),
    (Column::number("GPU", "ms", "gpu_ms"), |row| {
        time(row.gpu_ms)
    }),
    (Column::number("Wrong", "pixel-lights", "wrong"), |row| {
        count(row.wrong)
    }),
    (Column::number("Wrong", "ppm", "wrong_ppm"), |row| {
        time(row.wrong_ppm)
    }),
    (
        Column::number("Ambiguous", "pixel-lights", "ambiguous"),
        |row| count(row.ambiguous),
    ),
    (Column::number("Judged", "pixel-lights", "samples"), |row| {
        count(row.samples)
    }),
    (Column::number("Memory", "MiB, GPU", "gpu_bytes"), |row| {
        time(row.gpu_bytes.map(|bytes| bytes as f64 / (1024.0 * 1024.0)))
    }),
];

const NOTE: Field = (Column::text("Note", "note"), |row| match &row.failed {
    Some(why) => Cell {
        shown: row.note.clone(),
        tags: vec![("bad", format!("failed: {why}"))],
        ..Cell::default()
    },
    None => Cell::text(&row.note),
});

fn time(value: Option<f64>) -> Cell {
    Cell::number(figure_or_dash(value), value)
}

fn count(value: Option<u64>) -> Cell {
    Cell::number(count_or_dash(value), value.map(|value| value as f64))
}

/// All rows of a scene, view by view, methods by growing time.
pub(super) fn scene_table(report: &BenchReport, scene: &str, views: &[&View]) -> String {
    let rows: Vec<&BenchRow> = report
        .rows
        .iter()
        .filter(|row| row.scene == scene)
        .collect();
    let mut fields: Vec<Field> = Vec::new();
    let differ = |of: fn(&BenchRow, &BenchRow) -> bool| rows.windows(2).any(|w| !of(w[0], w[1]));
    // What is the same in every row is in the heading of the section.
    if differ(|a, b| a.camera == b.camera) {
        fields.push(CAMERA);
    }
    if differ(|a, b| a.size == b.size) {
        fields.push(SIZE);
    }
    if differ(|a, b| a.lights == b.lights) {
        fields.push(LIGHTS);
    }
    if differ(|a, b| a.triangles == b.triangles) {
        fields.push(TRIANGLES);
    }
    fields.extend(FIGURES);
    let with_times = rows.iter().filter(|row| row.frame_ms.is_some());
    if with_times
        .into_iter()
        .any(|row| row.repeats != report.repeat)
    {
        fields.push(FRAMES);
    }
    if rows
        .iter()
        .any(|row| row.failed.is_some() || !row.note.is_empty())
    {
        fields.push(NOTE);
    }
    // A column in which nothing was measured says nothing.
    fields.retain(|(column, of)| !column.numeric || rows.iter().any(|row| of(row).value.is_some()));

    let mut columns = vec![Column::text("Method", "method")];
    columns.extend(fields.iter().map(|(column, _)| *column));
    let mut body = Vec::new();
    for view in views {
        let mut of_view: Vec<&BenchRow> = report.rows_of(view).collect();
        of_view.sort_by(|a, b| by_time(a, b));
        let best = of_view
            .iter()
            .position(|row| row.wrong == Some(0) && row.frame_ms.is_some());
        for (place, row) in of_view.into_iter().enumerate() {
            let mut line = line(row, best == Some(place));
            if place == 0 {
                line.classes.push("start");
            }
            line.cells.extend(fields.iter().map(|(_, of)| of(row)));
            body.push(line);
        }
    }
    let caption = match views {
        [view] => format!("{}, {}", short_name(scene), view_name(view)),
        _ => short_name(scene).to_owned(),
    };
    table(&caption, &columns, &body)
}

/// The row with its head, marked for what it is.
fn line(row: &BenchRow, is_best: bool) -> Row {
    let mut tags = Vec::new();
    let mut classes = Vec::new();
    if row.is_floor() {
        classes.push("floor");
        tags.push(("", "floor".to_owned()));
    }
    if is_best {
        classes.push("best");
        tags.push(("good", "fastest, none wrong".to_owned()));
    }
    if row.breaks_promise() {
        classes.push("broken");
        tags.push(("bad", "must be 0 wrong".to_owned()));
    }
    if row.failed.is_some() {
        classes.push("failed");
    }
    let head = Cell {
        tags,
        ..Cell::text(&row.method)
    };
    Row {
        classes,
        method: row.method.clone(),
        cells: vec![head],
    }
}

/// Methods by growing time over all views.
pub(super) fn over_all_table(report: &BenchReport, all: &[OverAll]) -> String {
    let columns = [
        Column::text("Method", "method"),
        Column::number("Frame", "\u{d7} none", "times_none"),
        Column::number("Wrong", "ppm, sum", "wrong_ppm"),
        Column::number("Views", "", "views"),
    ];
    let time_of = |one: &OverAll| one.times_none.unwrap_or(f64::INFINITY);
    let mut sorted: Vec<&OverAll> = all.iter().collect();
    sorted.sort_by(|a, b| time_of(a).total_cmp(&time_of(b)));
    let in_all = |one: &OverAll| one.views == report.views.len();
    let best = sorted
        .iter()
        .position(|one| one.times_none.is_some() && one.is_faultless_in(report.views.len()));
    let row = |(place, one): (usize, &&OverAll)| {
        let is_best = best == Some(place);
        let views = one.views as u64;
        let shown = if in_all(one) {
            grouped(views)
        } else {
            format!("{views} of {}", report.views.len())
        };
        let wrong = match one.wrong_ppm {
            Some(ppm) => Cell::number(figure_or_dash(Some(ppm)), Some(ppm)),
            None => Cell::number(NONE.to_owned(), None),
        };
        Row {
            classes: if is_best { vec!["best"] } else { vec![] },
            method: one.method.clone(),
            cells: vec![
                Cell::text(&one.method),
                time(one.times_none),
                wrong,
                Cell::number(shown, Some(views as f64)),
            ],
        }
    };
    let rows: Vec<Row> = sorted.iter().enumerate().map(row).collect();
    table("By time, fastest first", &columns, &rows)
}
