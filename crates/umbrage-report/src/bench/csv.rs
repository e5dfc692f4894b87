//! The rows as comma-separated values (RFC 4180), for spreadsheets and data frames.
//!
//! Columns are the keys of the JSON rows, with `size` as `width` and `height`; what is null there
//! is empty here. Numbers keep all their digits.

use super::{BenchReport, BenchRow};

type Column = (&'static str, fn(&BenchRow) -> String);

const COLUMNS: [Column; 23] = [
    ("scene", |row| row.scene.clone()),
    ("method", |row| row.method.clone()),
    ("width", |row| row.size[0].to_string()),
    ("height", |row| row.size[1].to_string()),
    ("camera", |row| row.camera.clone()),
    ("frame_ms", |row| optional(row.frame_ms)),
    ("frame_ms_min", |row| optional(row.frame_ms_min)),
    ("frame_ms_max", |row| optional(row.frame_ms_max)),
    ("frame_ms_iqr", |row| optional(row.frame_ms_iqr)),
    ("times_none", |row| optional(row.times_none)),
    ("build_ms", |row| optional(row.build_ms)),
    ("first_frame_ms", |row| optional(row.first_frame_ms)),
    ("gpu_ms", |row| optional(row.gpu_ms)),
    ("wrong", |row| optional(row.wrong)),
    ("ambiguous", |row| optional(row.ambiguous)),
    ("samples", |row| optional(row.samples)),
    ("wrong_ppm", |row| optional(row.wrong_ppm)),
    ("exact", |row| row.exact.to_string()),
    ("lights", |row| row.lights.to_string()),
    ("triangles", |row| row.triangles.to_string()),
    ("repeats", |row| row.repeats.to_string()),
    ("gpu_bytes", |row| optional(row.gpu_bytes)),
    ("note", note),
];

/// One line a row below a line of names; lines end in CR LF, as the RFC has it.
pub fn csv(report: &BenchReport) -> String {
    let mut text = String::new();
    line(
        &mut text,
        COLUMNS.iter().map(|(name, _)| (*name).to_owned()),
    );
    for row in &report.rows {
        line(&mut text, COLUMNS.iter().map(|(_, value)| value(row)));
    }
    text
}

fn optional(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// The note, and why the row failed.
fn note(row: &BenchRow) -> String {
    match &row.failed {
        Some(why) if row.note.is_empty() => format!("failed: {why}"),
        Some(why) => format!("failed: {why}; {}", row.note),
        None => row.note.clone(),
    }
}

fn line(text: &mut String, fields: impl Iterator<Item = String>) {
    for (place, field) in fields.enumerate() {
        if place > 0 {
            text.push(',');
        }
        if field.contains(['"', ',', '\r', '\n']) {
            *text += &format!("\"{}\"", field.replace('"', "\"\""));
        } else {
            *text += &field;
        }
    }
    text.push_str("\r\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_commas_and_line_ends_are_quoted_and_nothing_else() {
        let mut text = String::new();
        let fields = ["plain", "a,b", "say \"so\"", "two\nlines", ""];
        line(&mut text, fields.map(str::to_owned).into_iter());
        assert_eq!(text, "plain,\"a,b\",\"say \"\"so\"\"\",\"two\nlines\",\r\n");
    }

    #[test]
    fn a_line_for_each_row_with_empty_fields_for_null() {
        let mut report = BenchReport::default();
        let mut row = BenchRow::new("counter", ("gen:city?lights=8", "1,2,3,0,0,0", [64, 48]));
        row.set_frame_times(&[2.5]);
        row.failed = Some("out of memory".into());
        report.push(row);
        let text = csv(&report);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].starts_with("scene,method,width,height,camera,frame_ms,"));
        let start = "gen:city?lights=8,counter,64,48,\"1,2,3,0,0,0\",2.5,2.5,2.5,0,,,,,";
        assert!(lines[1].starts_with(start), "{}", lines[1]);
        assert!(lines[1].ends_with(",failed: out of memory"));
    }

    #[test]
    fn without_rows_the_names_alone() {
        assert_eq!(csv(&BenchReport::default()).lines().count(), 1);
    }
}
