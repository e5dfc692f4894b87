//! The head of the page: what was found, what ran, where, and how to run it again.

use crate::bench::{BenchReport, BenchRow, OverAll, over_all};
use crate::figure::{figure, plural};
use crate::page::{command, escape};

pub(super) fn head(report: &BenchReport, scenes: &[&str]) -> String {
    let mut html = String::from(
        "<header><p class=\"kicker\">Umbrage bench</p><h1>Run time against error</h1>",
    );
    html += &format!("<p class=\"lede\">{}</p>", extent(report, scenes));
    if !report.complete {
        html += "<p class=\"warning\" role=\"note\"><strong>Not complete.</strong> \
                 The run ended early, or is still going on: rows are missing.</p>";
    }
    let broken: Vec<&BenchRow> = report
        .rows
        .iter()
        .filter(|row| row.breaks_promise())
        .collect();
    if let Some(first) = broken.first() {
        html += &format!(
            "<p class=\"warning\" role=\"note\"><strong>{} of exact methods {} wrong pixel-lights</strong>, \
             where none are allowed; {} first.</p>",
            plural(broken.len(), "row"),
            if broken.len() == 1 { "has" } else { "have" },
            escape(&first.method)
        );
    }
    html += &report.machine.html(&report.when);
    html += &command(&report.command);
    html += &contents(report, scenes);
    html + "</header>"
}

/// How much was measured, and the fastest method without error.
fn extent(report: &BenchReport, scenes: &[&str]) -> String {
    if report.rows.is_empty() {
        return "No rows yet.".to_owned();
    }
    let mut text = format!(
        "{} in {} of {}",
        plural(report.methods().len(), "method"),
        plural(report.views.len(), "view"),
        plural(scenes.len(), "scene")
    );
    if report.repeat > 0 {
        text += &format!(", medians of {}", plural(report.repeat as usize, "frame"));
    }
    text += ".";
    let all = over_all(report);
    let complete = |one: &&OverAll| one.is_faultless_in(report.views.len());
    let timed = all
        .iter()
        .filter(complete)
        .filter_map(|one| Some((one.times_none?, one)));
    if let Some((times, best)) = timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
        text += &format!(
            " Fastest with no wrong pixel-light in any view: <strong>{}</strong>, \
             {}\u{202f}\u{d7} the frame without shadows.",
            escape(&best.method),
            figure(times)
        );
    }
    text
}

fn contents(report: &BenchReport, scenes: &[&str]) -> String {
    if report.rows.is_empty() {
        return String::new();
    }
    let mut html = String::from("<nav aria-label=\"Contents\">");
    if super::plots::has_over_all(report) {
        html += "<a href=\"#over-all\">Over all views</a>";
    }
    for (place, scene) in scenes.iter().enumerate() {
        html += &format!(
            "<a href=\"#scene-{place}\">{}</a>",
            escape(super::short_name(scene))
        );
    }
    if super::plots::has_scaling(report) {
        html += "<a href=\"#scaling\">How time grows</a>";
    }
    html + "<a href=\"#notes\">Reading this page</a></nav>"
}
