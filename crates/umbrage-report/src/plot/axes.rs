//! Axes: grid lines, ticks and their labels.
//!
//! Takes scales and the plot area; gives SVG. Names of axes are horizontal text: that of y stands
//! above its ticks, that of x below them, flush right.

use super::{Frame, LogScale};
use crate::page::escape;

/// Vertical lines over the plot area, values below it.
pub(super) fn x_axis(scale: &LogScale, frame: &Frame, name: &str) -> String {
    let mut svg = String::new();
    for tick in scale.ticks(44.0) {
        let (x, top, bottom) = (tick.at, frame.top, frame.bottom);
        match tick.label {
            Some(label) => {
                svg += &format!(
                    "<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\"/>\
                     <text class=\"tick\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                    bottom + 16.0
                );
            }
            None => svg += &format!("<path class=\"axis\" d=\"M{x:.1} {bottom}v4\"/>"),
        }
    }
    let Frame {
        left,
        right,
        bottom,
        ..
    } = *frame;
    svg += &format!(
        "<path class=\"axis\" d=\"M{left} {bottom}H{right}\"/>\
         <text class=\"name\" x=\"{right}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
        bottom + 33.0,
        escape(name)
    );
    svg
}

/// Horizontal lines over the plot area, values to the left of it.
pub(super) fn y_axis(scale: &LogScale, frame: &Frame, name: &str) -> String {
    let Frame {
        left, right, top, ..
    } = *frame;
    let mut svg = String::new();
    for tick in scale.ticks(26.0) {
        let y = tick.at;
        match tick.label {
            Some(label) => {
                svg += &format!(
                    "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/>\
                     <text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                    left - 7.0,
                    y + 4.0
                );
            }
            None => svg += &format!("<path class=\"axis\" d=\"M{left} {y:.1}h-4\"/>"),
        }
    }
    svg += &format!(
        "<text class=\"name\" x=\"2\" y=\"{:.1}\">{}</text>",
        top - 11.0,
        escape(name)
    );
    svg
}
