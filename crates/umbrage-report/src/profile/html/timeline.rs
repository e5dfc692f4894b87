//! Where the time of the frame goes: its parts in a row, and the lights within theirs.

use super::{cost, heat, most, plan};
use crate::figure::figure;
use crate::page::escape;
use crate::profile::{LightRow, ProfileReport, Share};
use crate::sortable::{Cell, Column, Row, table};

const WIDTH: f64 = 1180.0;
const ROW: f64 = 34.0;
const LEFT: f64 = 60.0;

/// Drawing and tables.
pub(super) fn section(report: &ProfileReport) -> String {
    let frame = &report.frame;
    if frame.parts.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"timeline\"><h2>The frame</h2><p class=\"about\">Parts of the ordinary frame, and \
         the GPU time of each light one by one. What the lights save by overlapping, or lose, and the \
         remainder make the sum the frame.</p>{}{}{}</section>",
        drawing(report),
        parts("Of the frame", &frame.parts),
        parts(
            "Of building all volumes anew on one thread",
            &frame.build_parts
        )
    )
}

fn parts(caption: &str, parts: &[Share]) -> String {
    let columns = [
        Column::text("Part", "name"),
        Column::number("Time", "\u{b5}s", "us"),
        Column::number("Share", "%", "share"),
    ];
    let row = |part: &Share| Row {
        cells: vec![
            Cell::text(&part.name),
            Cell::number(figure(part.us), Some(part.us)),
            Cell::number(figure(100.0 * part.share), Some(part.share)),
        ],
        ..Row::default()
    };
    let rows: Vec<Row> = parts.iter().map(row).collect();
    table(caption, &columns, &rows)
}

/// CPU, GPU and lights, a track each.
fn drawing(report: &ProfileReport) -> String {
    let of = |name: &str| {
        let part = report.frame.parts.iter().find(|part| part.name == name);
        part.map_or(0.0, |part| part.us)
    };
    let named = |names: &[&'static str]| -> Vec<(String, f64, &'static str)> {
        let named = names
            .iter()
            .map(|name| (name.to_string(), of(name), "shared"));
        named.collect()
    };
    let cpu = named(&[
        "volumes brought up to date",
        "plan",
        "upload",
        "commands recorded",
    ]);
    let mut gpu = named(&["surface", "receivers"]);
    let lights = of("lights, one by one") + of("lights in one pass, difference");
    gpu.push(("lights".to_owned(), lights, "h2"));
    let begin: f64 = gpu.iter().take(2).map(|(_, us, _)| us).sum();
    let one_by_one: f64 = of("lights, one by one");
    let end = (report.frame.frame_ms * 1e3)
        .max(begin + one_by_one)
        .max(1.0);
    let scale = (WIDTH - LEFT) / end;
    let height = 3.0 * ROW + 22.0;
    let mut svg = format!(
        "<svg class=\"plot timeline\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"Timeline of the frame\">"
    );
    for (track, (name, bars)) in [("CPU", cpu), ("GPU", gpu)].iter().enumerate() {
        svg += &label(track, name);
        let mut at = 0.0;
        for (name, us, class) in bars {
            svg += &bar(
                track,
                at * scale,
                us * scale,
                class,
                "",
                &format!("{name}\n{} \u{b5}s", figure(*us)),
            );
            at += us;
        }
    }
    svg += &label(2, "Lights");
    let most = most(report);
    let mut at = begin;
    let mut drawn: Vec<&LightRow> = report
        .lights
        .iter()
        .filter(|l| l.gpu_us.is_some())
        .collect();
    drawn.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
    for light in drawn {
        let us = light.gpu_us.unwrap_or_default().total();
        if us > 0.0 {
            let class = format!("h{}", heat(light, most));
            svg += &bar(
                2,
                at * scale,
                us * scale,
                &class,
                &light.name,
                &plan::title(light),
            );
            at += us;
        }
    }
    for step in 0..=4 {
        let part = f64::from(step) / 4.0;
        svg += &format!(
            "<text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{} ms</text>",
            (LEFT + part * (WIDTH - LEFT)).min(WIDTH - 22.0),
            3.0 * ROW + 16.0,
            figure(part * end / 1e3)
        );
    }
    svg + "</svg>"
}

fn label(track: usize, name: &str) -> String {
    let y = (track as f64 + 0.62) * ROW;
    format!("<text class=\"name\" x=\"0\" y=\"{y:.1}\">{name}</text>")
}

fn bar(track: usize, x: f64, width: f64, class: &str, light: &str, title: &str) -> String {
    if width <= 0.0 {
        return String::new();
    }
    let of = match light {
        "" => String::new(),
        name => format!(" data-method=\"{}\"", escape(name)),
    };
    format!(
        "<g class=\"spot lamp\" tabindex=\"0\"{of}><title>{}</title>\
         <rect class=\"hit bar mark {class}\" x=\"{:.2}\" y=\"{:.1}\" width=\"{width:.2}\" height=\"{:.1}\"/></g>",
        escape(title),
        LEFT + x,
        track as f64 * ROW + 4.0,
        ROW - 8.0
    )
}
