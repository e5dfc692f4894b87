//! Plots as SVG text, styled by the page (`page/page.css`): classes and variables, no colours.
//!
//! Takes points and names; gives one `<svg>` of the asked size in CSS pixels. Every mark carries a
//! `<title>` and `data-method`, which the page's script turns into tooltips and linked
//! highlighting. Invariant: nothing that is not finite and, on a logarithmic axis, positive is
//! drawn.

mod axes;
mod labels;
mod marks;
mod scale;
mod scaling;
mod trade_off;

pub use labels::{Anchor, LabelBox, place};
pub use marks::{Look, Shape};
pub use scale::{LogScale, Tick};
pub use scaling::{Line, LinePoint, Scaling};
pub use trade_off::{Height, Spot, TradeOff};

/// The plot area between the axes, and the whole picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// Height and width of a glyph on average, in pixels at the size of `page.css`.
const GLYPH: [f64; 2] = [6.0, 13.0];

/// Width of a label in pixels, near enough to keep labels apart.
fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * GLYPH[0]
}

/// The opening tag of a picture.
fn open(class: &str, [width, height]: [f64; 2], title: &str) -> String {
    let title = crate::page::escape(title);
    format!(
        "<svg class=\"plot {class}\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" role=\"img\" aria-label=\"{title}\">"
    )
}
