//! Time against error: one mark a method.
//!
//! Takes spots; gives a plot with time to the right and error upwards, both logarithmic, and below
//! the logarithm a lane of its own for no error at all, and, only where it is needed, one for what
//! was not judged. Better is left and down.

use super::{Anchor, Frame, GLYPH, LabelBox, LogScale, Look, axes, open, place};
use crate::page::escape;

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
        let y = LogScale::around(errors, 0.08, [log.bottom, log.top]);
        let at = |spot: &Spot| {
            let up = match spot.y {
                Height::Error(error) if error > 0.0 => y.at(error),
                Height::Error(_) => (zero_top + zero_bottom) / 2.0,
                Height::Unknown => (unknown_top + frame.bottom) / 2.0,
            };
            [x.at(spot.x), up]
        };

        let mut svg = open("trade-off", size, &self.title);
        let lane = |top: f64, bottom: f64, name: &str| {
            format!(
                "<rect class=\"lane\" x=\"{}\" y=\"{top}\" width=\"{}\" height=\"{}\"/>\
                 <text class=\"tick\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{name}</text>",
                frame.left,
                frame.right - frame.left,
                bottom - top,
                frame.left - 7.0,
                (top + bottom) / 2.0 + 4.0
            )
        };
        svg += &lane(zero_top, zero_bottom, "0");
        if unknown {
            svg += &lane(unknown_top, frame.bottom, "?");
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
        svg += &curves(&spots, at);
        svg += &marks(&spots, at, &x);
        svg += &labels(&spots, at, &frame);
        svg + "</svg>"
    }
}

fn curves(spots: &[&Spot], at: impl Fn(&Spot) -> [f64; 2]) -> String {
    let mut svg = String::new();
    let mut done: Vec<&str> = Vec::new();
    for spot in spots {
        let Some((name, _)) = &spot.curve else {
            continue;
        };
        if done.contains(&name.as_str()) {
            continue;
        }
        done.push(name);
        let mut points: Vec<(f64, [f64; 2])> = spots
            .iter()
            .filter_map(|other| match &other.curve {
                Some((same, value)) if same == name => Some((*value, at(other))),
                _ => None,
            })
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let data: Vec<String> = points
            .iter()
            .map(|(_, [x, y])| format!("{x:.1} {y:.1}"))
            .collect();
        if data.len() > 1 {
            let classes = Look {
                dash: 0,
                ..spot.look
            }
            .classes();
            svg += &format!(
                "<path class=\"curve {classes}\" d=\"M{}\"/>",
                data.join("L")
            );
        }
    }
    svg
}

fn marks(spots: &[&Spot], at: impl Fn(&Spot) -> [f64; 2], x: &LogScale) -> String {
    let mut svg = String::new();
    for spot in spots {
        let [px, py] = at(spot);
        svg += &format!(
            "<g class=\"spot {}\" data-method=\"{}\" tabindex=\"0\"><title>{}</title>\
             <circle class=\"hit\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"11\"/>",
            spot.look.classes(),
            escape(&spot.name),
            escape(&spot.tip)
        );
        if let Some((least, greatest)) = spot.span.filter(|span| span.0 > 0.0) {
            let [from, to] = [least, greatest].map(|time| x.at(time));
            svg += &format!(
                "<path class=\"whisker\" d=\"M{from:.1} {py:.1}H{to:.1}M{from:.1} {:.1}v5M{to:.1} {:.1}v5\"/>",
                py - 2.5,
                py - 2.5
            );
        }
        svg += &spot.look.mark([px, py]);
        svg += "</g>";
    }
    svg
}

fn labels(spots: &[&Spot], at: impl Fn(&Spot) -> [f64; 2], frame: &Frame) -> String {
    let anchors: Vec<Anchor> = spots
        .iter()
        .map(|spot| Anchor {
            at: at(spot),
            text: spot.name.clone(),
        })
        .collect();
    let bounds = LabelBox {
        min: [frame.left + 2.0, frame.top - 4.0],
        max: [frame.right, frame.bottom - 1.0],
    };
    let mut svg = String::new();
    for (anchor, label) in anchors.iter().zip(place(&anchors, &bounds)) {
        let [x, y] = anchor.at;
        let [near_x, near_y] = label.nearest(anchor.at);
        let name = escape(&anchor.text);
        let (dx, dy) = (near_x - x, near_y - y);
        let away = dx.hypot(dy);
        if away > 11.0 {
            // From the rim of the mark to the label.
            let [from_x, from_y] = [x + dx / away * 6.0, y + dy / away * 6.0];
            svg += &format!(
                "<path class=\"leader\" data-method=\"{name}\" d=\"M{from_x:.1} {from_y:.1}L{near_x:.1} {near_y:.1}\"/>"
            );
        }
        // Flush to the side of its mark, whatever the true width of the font.
        let (text_x, side) = if label.min[0] >= x {
            (label.min[0], "start")
        } else if label.max[0] <= x {
            (label.max[0], "end")
        } else {
            ((label.min[0] + label.max[0]) / 2.0, "middle")
        };
        svg += &format!(
            "<text class=\"label\" data-method=\"{name}\" x=\"{text_x:.1}\" y=\"{:.1}\" text-anchor=\"{side}\">{name}</text>",
            label.max[1] - GLYPH[1] * 0.24
        );
    }
    svg
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
