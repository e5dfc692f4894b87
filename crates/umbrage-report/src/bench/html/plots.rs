//! The plots of the page: each drawn twice, for wide and for narrow windows; the style shows one.

use super::looks::{Looks, curve};
use super::{short_name, tables, view_name};
use crate::bench::scaling::{Axis, Scaling as Series, scalings};
use crate::bench::{BenchReport, BenchRow, View, over_all};
use crate::figure::figure;
use crate::grouped;
use crate::page::escape;
use crate::plot::{Height, Line, LinePoint, Scaling, Spot, TradeOff};

const ERROR_AXIS: &str = "wrong pixel-lights, ppm";
/// For a phone in portrait.
const NARROW: f64 = 344.0;

/// What stands in the place of a plot of time against nothing.
const NOT_JUDGED: &str = "errors were not judged, so times are in the table only";

/// Whether any of its methods was.
fn is_judged(plot: &TradeOff) -> bool {
    plot.spots.iter().any(|spot| spot.y != Height::Unknown)
}

/// The same plot for wide and for narrow windows.
fn both(wide: [f64; 2], narrow: [f64; 2], svg: impl Fn([f64; 2]) -> String) -> String {
    format!(
        "<div class=\"wide\">{}</div><div class=\"narrow\">{}</div>",
        svg(wide),
        svg(narrow)
    )
}

/// Whether there is more than one view, with a floor to relate them by.
pub(super) fn has_over_all(report: &BenchReport) -> bool {
    report.views.len() > 1 && report.rows.iter().any(|row| row.times_none.is_some())
}

pub(super) fn over_all_section(report: &BenchReport, looks: &Looks) -> String {
    if !has_over_all(report) {
        return String::new();
    }
    let all = over_all(report);
    let spots = all.iter().filter_map(|one| {
        let x = one.times_none?;
        let (least, greatest) = one.span?;
        Some(Spot {
            name: one.method.clone(),
            x,
            span: one.span,
            y: one.wrong_ppm.map_or(Height::Unknown, Height::Error),
            look: looks.get(&one.method),
            tip: format!(
                "{}\n{} \u{d7} none ({} to {})\n{} wrong, {} ppm in all\n{} of {} views",
                one.method,
                figure(x),
                figure(least),
                figure(greatest),
                one.wrong.map_or("not judged:".to_owned(), grouped),
                one.wrong_ppm.map_or("?".to_owned(), figure),
                one.views,
                report.views.len()
            ),
            curve: curve(&one.method),
        })
    });
    let plot = TradeOff {
        title: "Time against error over all views".into(),
        x_name: "frame time, \u{d7} none (geometric mean)".into(),
        y_name: "wrong pixel-lights, ppm (sum over views)".into(),
        floor: Some((1.0, "none: the frame without shadows".into())),
        spots: spots.collect(),
    };
    if !is_judged(&plot) {
        return format!(
            "<section id=\"over-all\"><h2>Over all views</h2><p>{NOT_JUDGED}.</p>{}</section>",
            tables::over_all_table(report, &all)
        );
    }
    format!(
        "<section id=\"over-all\"><h2>Over all views</h2><div class=\"over-all\">\
         <figure>{}<figcaption>Left is faster, down is more exact; whiskers reach from the best to \
         the worst view.</figcaption></figure>{}</div></section>",
        both([740.0, 470.0], [NARROW, 470.0], |size| plot.svg(size)),
        tables::over_all_table(report, &all)
    )
}

/// Time against error in one view.
pub(super) fn view_figure(report: &BenchReport, view: &View, looks: &Looks) -> String {
    let spots = report.rows_of(view).filter_map(|row| {
        Some(Spot {
            name: row.method.clone(),
            x: row.frame_ms?,
            span: row.frame_ms_min.zip(row.frame_ms_max),
            y: row.wrong_ppm.map_or(Height::Unknown, Height::Error),
            look: looks.get(&row.method),
            tip: tip(row),
            curve: curve(&row.method),
        })
    });
    let plot = TradeOff {
        title: format!(
            "Time against error, {}, {}",
            short_name(&view.scene),
            view_name(view)
        ),
        x_name: "frame time, ms".into(),
        y_name: ERROR_AXIS.into(),
        floor: report
            .floor_ms(view)
            .map(|ms| (ms, format!("none: {} ms without shadows", figure(ms)))),
        spots: spots.collect(),
    };
    let missing = if plot.spots.is_empty() {
        Some("no method has figures")
    } else if !is_judged(&plot) {
        Some(NOT_JUDGED)
    } else {
        None
    };
    if let Some(missing) = missing {
        return format!(
            "<figure><figcaption>{}: {missing}.</figcaption></figure>",
            escape(&view_name(view))
        );
    }
    format!(
        "<figure><figcaption>{}</figcaption>{}</figure>",
        escape(&view_name(view)),
        both([546.0, 410.0], [NARROW, 420.0], |size| plot.svg(size))
    )
}

/// What a mark says when pointed at.
fn tip(row: &BenchRow) -> String {
    let mut lines = vec![row.method.clone()];
    if let Some(ms) = row.frame_ms {
        let span = row.frame_ms_min.zip(row.frame_ms_max);
        let span = span.map_or_else(String::new, |(least, greatest)| {
            format!(" ({} to {})", figure(least), figure(greatest))
        });
        lines.push(format!("{} ms{span}", figure(ms)));
    }
    lines.extend(
        row.times_none
            .map(|times| format!("{} \u{d7} none", figure(times))),
    );
    match (row.wrong, row.ambiguous, row.samples) {
        (Some(wrong), Some(ambiguous), Some(samples)) => lines.push(format!(
            "{} wrong, {} ambiguous\nof {} pixel-lights",
            grouped(wrong),
            grouped(ambiguous),
            grouped(samples)
        )),
        _ => lines.push("not judged".to_owned()),
    }
    lines.join("\n")
}

/// Whether anything was measured at two lights, triangles or sizes.
pub(super) fn has_scaling(report: &BenchReport) -> bool {
    Axis::ALL
        .into_iter()
        .any(|axis| !scalings(report, axis).is_empty())
}

pub(super) fn scaling_section(report: &BenchReport, looks: &Looks) -> String {
    if !has_scaling(report) {
        return String::new();
    }
    let mut html = String::from(
        "<section id=\"scaling\"><h2>How time grows</h2><p class=\"about\">Rows that differ in one \
         thing only; both axes logarithmic.</p><div class=\"plots three\">",
    );
    for axis in Axis::ALL {
        for series in scalings(report, axis) {
            html += &scaling_figure(report, axis, &series, looks);
        }
    }
    html + "</div></section>"
}

fn scaling_figure(report: &BenchReport, axis: Axis, series: &Series, looks: &Looks) -> String {
    let line = |(method, points): &(String, Vec<(f64, usize)>)| Line {
        name: method.clone(),
        look: looks.get(method),
        points: points
            .iter()
            .map(|&(x, index)| LinePoint {
                x,
                y: report.rows[index].frame_ms.unwrap_or(0.0),
                tip: format!(
                    "{} {}\n{}",
                    grouped(x as u64),
                    axis.name(),
                    tip(&report.rows[index])
                ),
            })
            .collect(),
    };
    let same = match series.same.split_once(", ") {
        Some((scene, rest)) => format!("{}, {rest}", short_name(scene)),
        None => series.same.clone(),
    };
    let plot = Scaling {
        title: format!("Time against {}, {same}", axis.name()),
        x_name: axis.name().into(),
        y_name: "frame time, ms".into(),
        lines: series.lines.iter().map(line).collect(),
    };
    format!(
        "<figure><figcaption><b>Time against {}</b> {}</figcaption>{}</figure>",
        axis.name(),
        escape(&same),
        both([546.0, 360.0], [NARROW, 380.0], |size| plot.svg(size))
    )
}
