//! The profile as one self-contained page.
//!
//! Takes a report; gives HTML: what would save time, the scene from above and as it is seen, every
//! light in a table that sorts and filters, the costliest in pictures, and where the frame's time
//! goes. An empty report is a page too.

mod plan;
mod tables;
mod timeline;

use super::{Advice, LightRow, ProfileReport, Saving};
use crate::bench::Picture;
use crate::figure::{figure, plural};
use crate::grouped;
use crate::page::{command, data_uri, escape, page};

/// The page; it loads nothing.
pub fn html(report: &ProfileReport) -> String {
    let mut body = head(report);
    body += "<main>";
    body += &advice(report);
    body += &views(report);
    body += &tables::lights(report);
    body += &thumbnails(report);
    body += &timeline::section(report);
    body += &notes(report);
    body += "</main>";
    page("Umbrage profile: what each light costs", &body)
}

fn head(report: &ProfileReport) -> String {
    let drawn = report.lights.iter().filter(|l| l.path != "skipped").count();
    let [width, height] = report.size;
    let lede = format!(
        "{}: {}, of which this view draws {}. A frame of {width} \u{d7} {height} takes \
         <strong>{} ms</strong>; building all volumes anew on one thread {} ms.",
        escape(&report.scene),
        plural(report.lights.len(), "light"),
        grouped(drawn as u64),
        figure(report.frame.frame_ms),
        figure(report.frame.build_us / 1e3),
    );
    format!(
        "<header><p class=\"kicker\">Umbrage profile</p><h1>What each light costs</h1>\
         <p class=\"lede\">{lede}</p>{}{}<nav aria-label=\"Contents\"><a href=\"#advice\">Advice</a>\
         <a href=\"#views\">Plan</a><a href=\"#lights\">Lights</a><a href=\"#timeline\">Frame</a>\
         <a href=\"#notes\">How it was measured</a></nav></header>",
        report.machine.html(&report.when),
        command(&report.command)
    )
}

/// Cost of a light for the page: in a frame, or where that was not measured, of a build.
fn cost(light: &LightRow) -> f64 {
    light.frame_us.unwrap_or(light.cpu_us.total())
}

/// 0 to 5: how costly, by halves of the costliest.
fn heat(light: &LightRow, most: f64) -> usize {
    match cost(light) / most {
        share if share > 0.0 => 5 - (-share.log2()).clamp(0.0, 5.0) as usize,
        _ => 0,
    }
}

fn most(report: &ProfileReport) -> f64 {
    let all = report.lights.iter().map(cost);
    all.fold(f64::MIN_POSITIVE, f64::max)
}

fn advice(report: &ProfileReport) -> String {
    let mut html = String::from("<section id=\"advice\"><h2>What would make it cheaper</h2>");
    if report.advice.is_empty() {
        return html
            + "<p class=\"about\">Nothing that would save a measurable time.</p></section>";
    }
    html += "<p class=\"about\">Seen from this view. Savings are predicted from the figures below";
    html += match report.advice.iter().any(|one| one.measured.is_some()) {
        true => ", and measured with the advice applied.</p>",
        false => "; --verify measures them.</p>",
    };
    html += "<ol class=\"advice\">";
    for one in &report.advice {
        html += &format!(
            "<li>{}<small>{}</small></li>",
            escape(&one.text),
            escape(&savings(one))
        );
    }
    html + "</ol></section>"
}

/// Predicted, and measured where it was.
fn savings(advice: &Advice) -> String {
    let of = |saving: &Saving| {
        let build = format!("{} \u{b5}s of a build", figure(saving.build_us));
        match saving.frame_us {
            Some(frame) => format!("{} \u{b5}s of a frame, {build}", figure(frame)),
            None => build,
        }
    };
    let predicted = format!("Saves {}", of(&advice.predicted));
    match (&advice.measured, advice.frame_ratio.or(advice.build_ratio)) {
        (Some(measured), Some(ratio)) => format!(
            "{predicted}. Measured: {}, {} times the prediction.",
            of(measured),
            figure(ratio)
        ),
        _ => format!("{predicted}."),
    }
}

fn image(picture: &Picture, alt: &str) -> String {
    let [width, height] = picture.size;
    format!(
        "<img src=\"{}\" width=\"{width}\" height=\"{height}\" alt=\"{}\">",
        data_uri("image/png", &picture.png),
        escape(alt)
    )
}

fn views(report: &ProfileReport) -> String {
    let mut html =
        String::from("<section id=\"views\"><h2>From above, and as seen</h2><div class=\"views\">");
    if let Some(plan) = &report.pictures.plan {
        html += &plan::plan_figure(report, plan);
    }
    if let Some(frame) = &report.pictures.frame {
        html += &format!(
            "<figure>{}<figcaption>The frame that was measured.</figcaption></figure>",
            image(frame, "The lit frame")
        );
    }
    html + "</div></section>"
}

fn thumbnails(report: &ProfileReport) -> String {
    let mut html = String::new();
    for one in &report.pictures.lights {
        let Some(light) = report.lights.get(one.light) else {
            continue;
        };
        let name = escape(&light.name);
        html += &format!(
            "<figure data-method=\"{name}\"><div class=\"pair\">{}{}</div><figcaption><b>{name}</b> {} \
             \u{b5}s; {} lit pixels, {} volume fragments</figcaption></figure>",
            image(&one.lit, &format!("{}: its light alone", light.name)),
            image(
                &one.overdraw,
                &format!("{}: overdraw of its volume", light.name)
            ),
            figure(cost(light)),
            grouped(light.lit_pixels),
            grouped(light.volume_fragments),
        );
    }
    if html.is_empty() {
        return html;
    }
    format!(
        "<section id=\"costliest\"><h2>The costliest lights</h2><p class=\"about\">Left: the light \
         alone, exposed as the frame. Right: fragments of its volume, from black through blue, green \
         and red to white.</p><div class=\"thumbnails\">{html}</div></section>"
    )
}

fn notes(report: &ProfileReport) -> String {
    let how = report.how.iter();
    let how: String = how.map(|line| format!("<p>{}</p>", escape(line))).collect();
    format!(
        "<section id=\"notes\"><h2>How it was measured</h2>{how}<p>{} each.</p></section>",
        plural(report.rounds as usize, "round")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_report_is_a_page_and_hostile_names_stay_text() {
        assert!(html(&ProfileReport::default()).contains("Nothing that would save"));
        let light = LightRow {
            name: "<script>&\"'".into(),
            ..LightRow::default()
        };
        let report = ProfileReport {
            lights: vec![light],
            scene: "<img onerror='x'>".into(),
            ..ProfileReport::default()
        };
        let html = html(&report);
        assert!(!html.contains("<img onerror") && !html.contains("<script>&"));
    }

    #[test]
    fn heat_halves_from_step_to_step() {
        let light = |us: f64| LightRow {
            frame_us: Some(us),
            ..LightRow::default()
        };
        let heats = [64.0, 33.0, 31.0, 9.0, 0.5, 0.0].map(|us| heat(&light(us), 64.0));
        assert_eq!(heats, [5, 5, 4, 3, 0, 0]);
    }
}
