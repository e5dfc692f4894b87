//! Marks of a plot: a colour and a shape for each method.
//!
//! Colours are classes `c0` to `c7` and `grey`, given a value a theme by the page. What promises
//! exactness is filled, the rest is open, so neither colour nor shape alone carries that.

/// Outline of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A circle.
    Disc,
    /// On its side.
    Square,
    /// On its corner.
    Diamond,
    /// Pointing up.
    Up,
    /// Pointing down.
    Down,
    /// With six corners.
    Hexagon,
    /// Two crossed lines; has no inside, so it is drawn as a disc where it is filled.
    Cross,
    /// Three crossed lines; likewise.
    Star,
}

/// How a method is drawn everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// `c0` to `c7`; null is grey.
    pub colour: Option<u8>,
    /// Of its marks.
    pub shape: Shape,
    /// Dash pattern of its lines: 0 (solid) to 4.
    pub dash: u8,
    /// Filled: promises exactness.
    pub filled: bool,
}

impl Look {
    /// Classes of an element drawn like this.
    pub(crate) fn classes(&self) -> String {
        let colour = self
            .colour
            .map_or("grey".to_owned(), |c| format!("c{}", c % 8));
        let fill = if self.filled { "filled" } else { "open" };
        format!("{colour} {fill} d{}", self.dash.min(4))
    }

    /// Its outline around a point, as an SVG element.
    pub(crate) fn mark(&self, [x, y]: [f64; 2]) -> String {
        let path = |data: String| format!("<path class=\"mark\" d=\"{data}\"/>");
        let lines = |angles: &[f64]| {
            let mut data = String::new();
            for angle in angles {
                let (sin, cos) = angle.to_radians().sin_cos();
                let [dx, dy] = [4.6 * cos, 4.6 * sin];
                data += &format!("M{:.1} {:.1}L{:.1} {:.1}", x - dx, y - dy, x + dx, y + dy);
            }
            path(data)
        };
        let corners = |points: &[[f64; 2]]| {
            let mut data = String::new();
            for (place, [dx, dy]) in points.iter().enumerate() {
                let command = if place == 0 { 'M' } else { 'L' };
                data += &format!("{command}{:.1} {:.1}", x + dx, y + dy);
            }
            path(data + "Z")
        };
        match self.shape {
            Shape::Square => corners(&[[-3.9, -3.9], [3.9, -3.9], [3.9, 3.9], [-3.9, 3.9]]),
            Shape::Diamond => corners(&[[0.0, -5.4], [5.4, 0.0], [0.0, 5.4], [-5.4, 0.0]]),
            Shape::Up => corners(&[[0.0, -5.0], [4.8, 3.6], [-4.8, 3.6]]),
            Shape::Down => corners(&[[0.0, 5.0], [4.8, -3.6], [-4.8, -3.6]]),
            Shape::Hexagon => corners(&[
                [-2.5, -4.4],
                [2.5, -4.4],
                [5.0, 0.0],
                [2.5, 4.4],
                [-2.5, 4.4],
                [-5.0, 0.0],
            ]),
            Shape::Cross if !self.filled => lines(&[45.0, 135.0]),
            Shape::Star if !self.filled => lines(&[30.0, 90.0, 150.0]),
            Shape::Disc | Shape::Cross | Shape::Star => {
                format!("<circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.4\"/>")
            }
        }
    }
}
