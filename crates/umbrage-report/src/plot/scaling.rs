//! How time grows: one line a method, both axes logarithmic, so that a straight line is a power
//! and a slope of one is proportional.
//!
//! Takes lines; gives a plot with each name at the right end of its line, pushed apart vertically
//! where lines end close to each other.

use super::{Frame, GLYPH, LogScale, Look, axes, open, text_width};
use crate::page::escape;

/// One place on a line.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePoint {
    /// What grows.
    pub x: f64,
    /// Time.
    pub y: f64,
    /// Tooltip; lines are kept.
    pub tip: String,
}

/// One method.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Label, and key for highlighting.
    pub name: String,
    /// Colour, shape, dashes.
    pub look: Look,
    /// By growing x.
    pub points: Vec<LinePoint>,
}

/// The plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scaling {
    /// What it shows, for screen readers.
    pub title: String,
    /// Name of the x axis.
    pub x_name: String,
    /// Name of the y axis with its unit.
    pub y_name: String,
    /// What is drawn; points that are not positive are left out.
    pub lines: Vec<Line>,
}

impl Scaling {
    /// As an SVG element of that width and height in pixels.
    pub fn svg(&self, size: [f64; 2]) -> String {
        let points = |line: &Line| {
            let good = |p: &LinePoint| p.x > 0.0 && p.y > 0.0 && p.x.is_finite() && p.y.is_finite();
            line.points
                .iter()
                .filter(|&p| good(p))
                .cloned()
                .collect::<Vec<_>>()
        };
        let lines: Vec<(&Line, Vec<LinePoint>)> = self
            .lines
            .iter()
            .map(|line| (line, points(line)))
            .filter(|(_, points)| !points.is_empty())
            .collect();
        let widest = lines
            .iter()
            .map(|(line, _)| text_width(&line.name))
            .fold(0.0, f64::max);
        let frame = Frame {
            left: 50.0,
            right: size[0] - (widest + 24.0).min(size[0] * 0.4),
            top: 30.0,
            bottom: size[1] - 40.0,
        };
        let all = || lines.iter().flat_map(|(_, points)| points);
        let x = LogScale::around(all().map(|p| p.x), 0.04, [frame.left, frame.right]);
        let y = LogScale::around(all().map(|p| p.y), 0.06, [frame.bottom, frame.top]);

        let mut svg = open("scaling", size, &self.title);
        svg += &axes::x_axis(&x, &frame, &self.x_name);
        svg += &axes::y_axis(&y, &frame, &self.y_name);
        let mut ends = Vec::new();
        for (line, points) in &lines {
            let places: Vec<[f64; 2]> = points.iter().map(|p| [x.at(p.x), y.at(p.y)]).collect();
            let data: Vec<String> = places
                .iter()
                .map(|[x, y]| format!("{x:.1} {y:.1}"))
                .collect();
            let (name, classes) = (escape(&line.name), line.look.classes());
            svg += &format!(
                "<path class=\"curve {classes}\" data-method=\"{name}\" d=\"M{}\"/>",
                data.join("L")
            );
            for (point, &place) in points.iter().zip(&places) {
                svg += &format!(
                    "<g class=\"spot {classes}\" data-method=\"{name}\" tabindex=\"0\">\
                     <title>{}</title><circle class=\"hit\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"10\"/>{}</g>",
                    escape(&point.tip),
                    place[0],
                    place[1],
                    line.look.mark(place)
                );
            }
            ends.extend(places.last().map(|&end| (end, name)));
        }
        ends.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
        let wanted: Vec<f64> = ends.iter().map(|(end, _)| end[1]).collect();
        for ((end, name), y) in ends
            .iter()
            .zip(spread(&wanted, GLYPH[1], frame.top, frame.bottom))
        {
            let text_x = frame.right + 14.0;
            svg += &format!(
                "<path class=\"leader\" data-method=\"{name}\" d=\"M{:.1} {:.1}L{:.1} {y:.1}\"/>\
                 <text class=\"label\" data-method=\"{name}\" x=\"{text_x:.1}\" y=\"{:.1}\">{name}</text>",
                end[0] + 6.0,
                end[1],
                text_x - 3.0,
                y + 4.0
            );
        }
        svg + "</svg>"
    }
}

/// Moves sorted heights apart by at least `step` and as little as needed, from `top` to `bottom`
/// as long as there is room.
fn spread(wanted: &[f64], step: f64, top: f64, bottom: f64) -> Vec<f64> {
    // Heaps of labels that touch, each as (sum of what its members want it to begin at, members).
    let mut heaps: Vec<(f64, usize)> = Vec::new();
    let begin = |&(sum, count): &(f64, usize)| {
        let height = (count - 1) as f64 * step;
        (sum / count as f64).min(bottom - height).max(top)
    };
    for &height in wanted {
        heaps.push((height, 1));
        while let [.., a, b] = heaps[..]
            && begin(&a) + a.1 as f64 * step > begin(&b)
        {
            heaps.truncate(heaps.len() - 2);
            heaps.push((a.0 + b.0 - (a.1 * b.1) as f64 * step, a.1 + b.1));
        }
    }
    let places = |heap: &(f64, usize)| {
        let from = begin(heap);
        (0..heap.1).map(move |k| from + k as f64 * step)
    };
    heaps.iter().flat_map(places).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Shape;

    #[test]
    fn labels_that_touch_are_moved_apart_around_their_middle() {
        assert_eq!(spread(&[50.0, 100.0], 12.0, 0.0, 200.0), [50.0, 100.0]);
        assert_eq!(spread(&[50.0, 50.0], 12.0, 0.0, 200.0), [44.0, 56.0]);
        assert_eq!(spread(&[0.0, 1.0], 12.0, 0.0, 200.0), [0.0, 12.0]);
        assert_eq!(spread(&[199.0, 200.0], 12.0, 0.0, 200.0), [188.0, 200.0]);
        let crowd = spread(&[50.0, 51.0, 60.0, 90.0, 91.0], 12.0, 0.0, 200.0);
        assert!(
            crowd.windows(2).all(|pair| pair[1] - pair[0] >= 11.999),
            "{crowd:?}"
        );
        assert_eq!(spread(&[], 12.0, 0.0, 200.0), [0.0; 0]);
    }

    #[test]
    fn a_line_a_method_and_points_that_are_not_positive_left_out() {
        let look = Look {
            colour: None,
            shape: Shape::Cross,
            dash: 1,
            filled: false,
        };
        let point = |x, y| LinePoint {
            x,
            y,
            tip: "tip".into(),
        };
        let points = vec![point(1.0, 2.0), point(2.0, 0.0), point(4.0, 8.0)];
        let line = |name: &str, points| Line {
            name: name.into(),
            look,
            points,
        };
        let plot = Scaling {
            lines: vec![line("a", points), line("b", vec![point(f64::NAN, 1.0)])],
            ..Scaling::default()
        };
        let svg = plot.svg([400.0, 300.0]);
        assert_eq!(svg.matches("class=\"spot").count(), 2);
        assert_eq!(svg.matches("class=\"curve").count(), 1);
        assert!(!svg.contains("NaN"));
        assert!(!Scaling::default().svg([400.0, 300.0]).contains("NaN"));
    }
}
