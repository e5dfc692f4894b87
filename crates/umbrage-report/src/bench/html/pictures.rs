//! Difference pictures of a view, side by side.

use super::view_name;
use crate::bench::{BenchReport, BenchRow, Picture, View};
use crate::grouped;
use crate::page::{data_uri, escape};

/// A grid of pictures; nothing where no row has one.
pub(super) fn pictures(report: &BenchReport, view: &View) -> String {
    let mut html = String::new();
    for row in report.rows_of(view) {
        if let Some(difference) = &row.difference {
            html += &picture(row, difference);
        }
    }
    if html.is_empty() {
        return html;
    }
    format!(
        "<h3>Where they differ from the oracle <small>{}</small></h3>\
         <p class=\"about key\"><span class=\"swatch wrong\"></span>wrong, paler with more lights \
         <span class=\"swatch ambiguous\"></span>ambiguous \
         <span class=\"swatch agrees\"></span>agrees. A picture shows the worst pixel of each block.</p>\
         <div class=\"pictures\">{html}</div>",
        escape(&view_name(view))
    )
}

fn picture(row: &BenchRow, difference: &Picture) -> String {
    let [width, height] = difference.size;
    let count = |value: Option<u64>, word: &str| match value {
        Some(value) => format!("{} {word}", grouped(value)),
        None => format!("{word} not counted"),
    };
    let (wrong, ambiguous) = (count(row.wrong, "wrong"), count(row.ambiguous, "ambiguous"));
    let method = escape(&row.method);
    let image = format!(
        "<img src=\"{}\" width=\"{width}\" height=\"{height}\" \
         alt=\"{method}: {wrong}, {ambiguous}\">",
        data_uri("image/png", &difference.png)
    );
    format!(
        "<figure data-method=\"{method}\">{image}<figcaption><b>{method}</b> {wrong}, {ambiguous}\
         </figcaption></figure>"
    )
}
