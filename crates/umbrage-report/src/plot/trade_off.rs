//! Time against error: one mark a method.
//!
//! Takes spots; gives a plot with time to the right and error upwards, both logarithmic, and below
//! the logarithm a lane of its own for no error at all, and, only where it is needed, one for what
//! was not judged. Better is left and down.

use super::{Frame, LogScale, Look, axes, open};
use crate::page::escape;

mod spots;

use spots::{curves, draw_curve, labels, marks};

/// How far up a spot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Its error; zero has its own lane.
    Error(f64),
    /// Nobody knows its error.
    Unknown,
}

/// One method.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Label, and key for highlighting.
    pub name: String,
    /// Time.
    pub x: f64,
    /// Least and greatest time: a whisker.
    pub span: Option<(f64, f64)>,
    /// Error.
    pub y: Height,
    /// Colour, shape, filled or open.
    pub look: Look,
    /// Tooltip; lines are kept.
    pub tip: String,
    /// Spots with the same name here are joined by a line, by this growing value.
    pub curve: Option<(String, f64)>,
}

/// The plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TradeOff {
    /// What it shows, for screen readers.
    pub title: String,
    /// Name of the x axis with its unit.
    pub x_name: String,
    /// Name of the y axis with its unit.
    pub y_name: String,
    /// A line that no time goes below, with its name.
    pub floor: Option<(f64, String)>,
    /// What is drawn; spots without a positive time are left out.
    pub spots: Vec<Spot>,
}

/// Height of the lane of zero, and of that of the unknown.
const LANES: [f64; 2] = [84.0, 56.0];
const GAP: f64 = 10.0;
/// Written in the lane of zero; the width that takes, and its height above the lane's end.
const NONE_WRONG: &str = "none wrong";
const HINT: [f64; 2] = [66.0, 6.0];

impl TradeOff {
    /// As an SVG element of that width and height in pixels.
    pub fn svg(&self, size: [f64; 2]) -> String {
        let spots: Vec<&Spot> = self
            .spots
            .iter()
            .filter(|spot| spot.x > 0.0 && spot.x.is_finite())
            .collect();
        let unknown = spots.iter().any(|spot| spot.y == Height::Unknown);
        let frame = Frame {
            left: 50.0,
            right: size[0] - 12.0,
            top: 30.0,
            bottom: size[1] - 40.0,
        };
        let unknown_top = frame.bottom - if unknown { LANES[1] } else { 0.0 };
        let zero_bottom = unknown_top - if unknown { GAP } else { 0.0 };
        let zero_top = zero_bottom - LANES[0];
        let log = Frame {
            bottom: zero_top - GAP,
            ..frame
        };

        let times = spots.iter().flat_map(|spot| {
            let (least, greatest) = spot.span.unwrap_or((spot.x, spot.x));
            [spot.x, least, greatest]
        });
        let times = times.chain(self.floor.iter().map(|floor| floor.0));
        let errors = spots.iter().filter_map(|spot| match spot.y {
            Height::Error(error) => Some(error),
            Height::Unknown => None,
        });
        let x = LogScale::around(times, 0.06, [frame.left, frame.right]);
        let y = LogScale::around(errors, 0.1, [log.bottom, log.top]);
        let at = |spot: &Spot| {
            let up = match spot.y {
                Height::Error(error) if error > 0.0 => y.at(error),
                Height::Error(_) => (zero_top + zero_bottom) / 2.0,
                Height::Unknown => (unknown_top + frame.bottom) / 2.0,
            };
            [x.at(spot.x), up]
        };

        let mut svg = open("trade-off", size, &self.title);
        let lane = |top: f64, bottom: f64, tick: &str, hint: &str| {
            format!(
                "<rect class=\"lane\" x=\"{}\" y=\"{top}\" width=\"{}\" height=\"{}\"/>\
                 <text class=\"tick\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{tick}</text>\
                 <text class=\"hint\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{hint}</text>",
                frame.left,
                frame.right - frame.left,
                bottom - top,
                frame.left - 7.0,
                (top + bottom) / 2.0 + 4.0,
                frame.right - 6.0,
                bottom - HINT[1],
            )
        };
        svg += &lane(zero_top, zero_bottom, "0", NONE_WRONG);
        if unknown {
            svg += &lane(unknown_top, frame.bottom, "?", "not judged");
        }
        svg += &axes::x_axis(&x, &frame, &self.x_name);
        svg += &axes::y_axis(&y, &log, &self.y_name);
        svg += &format!(
            "<path class=\"axis\" d=\"M{} {}H{}\"/>",
            log.left, log.bottom, log.right
        );
        if let Some((time, name)) = &self.floor {
            let x = x.at(*time);
            svg += &format!(
                "<path class=\"floor\" d=\"M{x:.1} {}V{}\"><title>{}</title></path>",
                frame.top,
                frame.bottom,
                escape(name)
            );
        }
        let curves = curves(&spots, at);
        svg += &curves.iter().map(draw_curve).collect::<String>();
        svg += &marks(&spots, at, &x);
        let whiskers = spots.iter().filter_map(|spot| {
            let (least, greatest) = spot.span.filter(|span| span.0 > 0.0)?;
            Some([least, greatest].map(|time| [x.at(time), at(spot)[1]]))
        });
        let hint_y = zero_bottom - HINT[1] - 3.0;
        let segments = curves.iter().flat_map(|curve| curve.places.windows(2));
        let lines: Vec<[[f64; 2]; 2]> = segments
            .map(|pair| [pair[0], pair[1]])
            .chain(whiskers)
            .chain([[[frame.right - HINT[0], hint_y], [frame.right, hint_y]]])
            .collect();
        svg += &labels(&spots, at, &lines, &frame);
        svg + "</svg>"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Shape;

    fn spot(name: &str, x: f64, y: Height) -> Spot {
        let look = Look {
            colour: Some(0),
            shape: Shape::Disc,
            dash: 0,
            filled: true,
        };
        let span = Some((x * 0.9, x * 1.1));
        Spot {
            name: name.into(),
            x,
            span,
            y,
            look,
            tip: name.into(),
            curve: None,
        }
    }

    #[test]
    fn zero_has_its_lane_below_every_error_and_the_unknown_below_that() {
        let plot = TradeOff {
            spots: vec![
                spot("rough", 2.0, Height::Error(1e-3)),
                spot("exact", 3.0, Height::Error(0.0)),
                spot("unjudged", 4.0, Height::Unknown),
            ],
            ..TradeOff::default()
        };
        let svg = plot.svg([500.0, 400.0]);
        let heights: Vec<f64> = svg
            .split("<circle class=\"mark\"")
            .skip(1)
            .map(|rest| {
                rest.split("cy=\"")
                    .nth(1)
                    .unwrap()
                    .split('"')
                    .next()
                    .unwrap()
            })
            .map(|text| text.parse().unwrap())
            .collect();
        assert!(heights.is_sorted() && heights.len() == 3, "{heights:?}");
        assert_eq!(svg.matches("class=\"lane\"").count(), 2);
    }

    #[test]
    fn only_zero_errors_or_nothing_at_all_still_make_a_plot_of_finite_numbers() {
        let mut plot = TradeOff {
            spots: vec![spot("a", 2.0, Height::Error(0.0))],
            ..Default::default()
        };
        for _ in 0..2 {
            let svg = plot.svg([350.0, 300.0]);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert!(svg.ends_with("</svg>") && svg.contains("class=\"lane\""));
            plot.spots.clear();
        }
        plot.spots.push(spot("b", f64::NAN, Height::Error(0.0)));
        assert!(!plot.svg([350.0, 300.0]).contains("NaN"));
    }

    #[test]
    fn names_are_escaped() {
        let name = "<b a=\"'&\">";
        let plot = TradeOff {
            spots: vec![spot(name, 2.0, Height::Error(1.0))],
            ..Default::default()
        };
        let svg = plot.svg([350.0, 300.0]);
        assert!(!svg.contains("<b"), "{svg}");
        assert!(svg.contains("data-method=\"&lt;b a=&quot;&#39;&amp;&quot;&gt;\""));
    }
}
