//! The report as one self-contained page.
//!
//! Takes a report; gives HTML: what ran where, each method over all views, then scene by scene the
//! plots of time against error, the table of all figures and the difference pictures, then how
//! time grows, and what the words mean. An empty or partial report is a page too.

mod head;
mod looks;
mod pictures;
mod plots;
mod tables;

use super::{BenchReport, View};
use crate::grouped;
use crate::page::{escape, page};
use looks::Looks;

/// The page; it loads nothing.
pub fn html(report: &BenchReport) -> String {
    let looks = Looks::of(report);
    let mut scenes: Vec<&str> = Vec::new();
    for view in &report.views {
        if !scenes.contains(&view.scene.as_str()) {
            scenes.push(&view.scene);
        }
    }
    let mut body = head::head(report, &scenes);
    body += "<main>";
    body += &plots::over_all_section(report, &looks);
    for (place, scene) in scenes.iter().enumerate() {
        body += &scene_section(report, scene, place, &looks);
    }
    body += &plots::scaling_section(report, &looks);
    body += NOTES;
    body += "</main>";
    page("Umbrage bench: run time against error", &body)
}

fn scene_section(report: &BenchReport, scene: &str, place: usize, looks: &Looks) -> String {
    let views: Vec<&View> = report
        .views
        .iter()
        .filter(|view| view.scene == scene)
        .collect();
    let mut html = format!(
        "<section id=\"scene-{place}\"><h2>{}</h2><p class=\"about\">{}</p><div class=\"plots\">",
        escape(short_name(scene)),
        escape(&about(scene, &views))
    );
    for view in &views {
        html += &plots::view_figure(report, view, looks);
    }
    html += "</div>";
    html += &tables::scene_table(report, scene, &views);
    for view in &views {
        html += &pictures::pictures(report, view);
    }
    html + "</section>"
}

fn about(scene: &str, views: &[&View]) -> String {
    let named = if short_name(scene) == scene {
        String::new()
    } else {
        format!("{scene}: ")
    };
    match views.first() {
        Some(view) => format!(
            "{named}{} lights, {} triangles",
            grouped(view.lights),
            grouped(view.triangles)
        ),
        None => named,
    }
}

/// `stormkeep` for `data/worlds/stormkeep.glb`; a generated scene in full.
fn short_name(scene: &str) -> &str {
    if scene.starts_with("gen:") {
        return scene;
    }
    let file = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    match file.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => file,
    }
}

/// Camera and size.
fn view_name(view: &View) -> String {
    let [width, height] = view.size;
    format!("camera {}, {width} \u{d7} {height}", view.camera)
}

const NOTES: &str = "<section id=\"notes\"><h2>Reading this page</h2><dl class=\"notes\">\
<div><dt>Pixel-light</dt><dd>One pixel and one light that its surface is in range of and faces. \
Errors are counted over all of them, never averaged.</dd></div>\
<div><dt>Wrong</dt><dd>The method and the oracle, an exact ray cast of the triangles as loaded, \
disagree on whether the light reaches the surface. ppm: in a million pixel-lights.</dd></div>\
<div><dt>Ambiguous</dt><dd>They disagree, but the oracle\u{2019}s own answer changes when the eye ray \
moves within the rasteriser\u{2019}s precision. Not counted as wrong.</dd></div>\
<div><dt>Exact</dt><dd>A method that promises no wrong pixel-lights: a filled mark. \
Others have open ones.</dd></div>\
<div><dt>Floor</dt><dd>Method none: the same frame, fully lit, without shadows. \
\u{d7} none is a frame time as a multiple of it; over all views, the geometric mean.</dd></div>\
<div><dt>Times</dt><dd>Medians of whole frames after one that warms up. \
Whiskers reach from the fastest to the slowest frame. First: that one, in which everything that is \
kept is made.</dd></div>\
<div><dt>Volumes</dt><dd>CPU time of the shadow volumes: made anew, in the first frame; or, where \
time runs on from frame to frame, the median of bringing them up to date.</dd></div>\
</dl></section>";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BenchRow;

    fn row(scene: &str, method: &str, ms: f64, wrong: u64) -> BenchRow {
        let mut row = BenchRow::new(method, (scene, "auto", [64, 48]));
        row.set_frame_times(&[ms, ms * 1.1]);
        row.set_errors(wrong, 0, 1_000_000);
        row
    }

    #[test]
    fn hostile_names_stay_text() {
        let mut report = BenchReport {
            command: "umbrage bench '</pre><script>'".into(),
            ..Default::default()
        };
        let mut hostile = row("<script>&\"'.glb", "<img onerror='x'>", 1.0, 0);
        hostile.note = "<script>".into();
        report.push(hostile);
        let html = html(&report);
        // The page's own script is the only one.
        assert_eq!(html.matches("<script>").count(), 1);
        assert!(!html.contains("<img onerror"));
        assert!(html.contains("&lt;script&gt;&amp;&quot;&#39;"));
    }

    #[test]
    fn an_empty_report_is_a_page_that_says_so() {
        let html = html(&BenchReport::default());
        assert!(html.contains("No rows") && html.ends_with("</html>\n"));
    }

    #[test]
    fn a_partial_report_says_so_and_a_complete_one_does_not() {
        let mut report = BenchReport::default();
        report.push(row("a.glb", "counter", 2.0, 0));
        assert!(html(&report).contains("Not complete"));
        report.complete = true;
        assert!(!html(&report).contains("Not complete"));
    }

    #[test]
    fn a_failed_row_stands_in_the_table_with_its_reason_and_in_no_plot() {
        let mut report = BenchReport::default();
        report.push(row("a.glb", "counter", 2.0, 0));
        let mut failed = BenchRow::new("raytrace", ("a.glb", "auto", [64, 48]));
        failed.failed = Some("no compute shaders".into());
        report.push(failed);
        let html = html(&report);
        assert!(html.contains("no compute shaders"));
        assert!(!html.contains("data-method=\"raytrace\" tabindex"));
        assert!(html.contains("data-method=\"counter\" tabindex"));
    }

    #[test]
    fn times_alone_make_a_table_and_no_plot_of_errors() {
        let mut report = BenchReport::default();
        for (scene, ms) in [("a.glb", 2.0), ("b.glb", 3.0)] {
            for method in ["none", "counter"] {
                let mut timed = BenchRow::new(method, (scene, "auto", [64, 48]));
                timed.set_frame_times(&[ms]);
                report.push(timed);
            }
        }
        let unjudged = html(&report);
        assert!(
            unjudged.contains("errors were not judged") && !unjudged.contains("class=\"lane\"")
        );
        report.push(row("a.glb", "brute", 4.0, 0));
        assert!(html(&report).contains("class=\"lane\""));
    }

    #[test]
    fn growth_is_plotted_only_where_something_grows() {
        let mut report = BenchReport::default();
        report.push(row("a.glb", "counter", 2.0, 0));
        assert!(!html(&report).contains("id=\"scaling\""));
        let mut larger = row("a.glb", "counter", 4.0, 0);
        larger.size = [128, 96];
        report.push(larger);
        assert!(html(&report).contains("id=\"scaling\""));
    }

    #[test]
    fn names_of_scenes_are_short() {
        assert_eq!(short_name("data/worlds/storm.keep.glb"), "storm.keep");
        assert_eq!(short_name("gen:city?lights=8"), "gen:city?lights=8");
        assert_eq!(short_name(".glb"), ".glb");
    }
}
