//! Names beside their marks, kept apart.
//!
//! Takes marks, lines, and the box that labels must stay in; gives a box for each name. Greedy, after the
//! candidate positions of J. Christensen, J. Marks, S. Shieber, "An empirical study of algorithms
//! for point-feature label placement", 1995: marks with the least room around them first, each at
//! the position that covers least of marks, lines and other labels, near ones before far ones.
//! Invariant: no label leaves the bounds unless it is larger than they are.

use super::{GLYPH, text_width};

/// A mark that wants a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Middle of the mark.
    pub at: [f64; 2],
    /// What to write.
    pub text: String,
}

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelBox {
    /// Left and top.
    pub min: [f64; 2],
    /// Right and bottom.
    pub max: [f64; 2],
}

impl LabelBox {
    /// Area that two boxes share.
    pub fn overlap(&self, other: &Self) -> f64 {
        let side =
            |k: usize| (self.max[k].min(other.max[k]) - self.min[k].max(other.min[k])).max(0.0);
        side(0) * side(1)
    }

    /// The nearest point of the box.
    pub fn nearest(&self, to: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| to[k].clamp(self.min[k], self.max[k]))
    }

    fn widened(mut self, by: f64) -> Self {
        self.min[0] -= by;
        self.max[0] += by;
        self
    }

    fn around(at: [f64; 2], radius: f64) -> Self {
        Self {
            min: at.map(|x| x - radius),
            max: at.map(|x| x + radius),
        }
    }

    /// Moved as little as needed to lie within `bounds`.
    fn kept_in(mut self, bounds: &Self) -> Self {
        for k in [0, 1] {
            let over = (self.max[k] - bounds.max[k]).max(0.0);
            let move_by = (bounds.min[k] - (self.min[k] - over)).max(0.0) - over;
            self.min[k] += move_by;
            self.max[k] += move_by;
        }
        self
    }
}

/// Radius of a mark, with some air.
const MARK: f64 = 6.5;

/// Air to the left and right of a label, so that two of them do not read as one.
const AIR: f64 = 5.0;

/// One box for each anchor, in their order. `lines` had better not be covered.
pub fn place(anchors: &[Anchor], lines: &[[[f64; 2]; 2]], bounds: &LabelBox) -> Vec<LabelBox> {
    let dots: Vec<[f64; 2]> = lines.iter().flat_map(dotted).collect();
    let marks: Vec<LabelBox> = anchors
        .iter()
        .map(|a| LabelBox::around(a.at, MARK))
        .collect();
    let near = |i: usize| {
        let [x, y] = anchors[i].at;
        let close = |other: &&Anchor| {
            (other.at[0] - x).abs() < text_width(&anchors[i].text) && (other.at[1] - y).abs() < 40.0
        };
        anchors.iter().filter(close).count()
    };
    let mut order: Vec<usize> = (0..anchors.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(near(i)));

    let mut placed: Vec<Option<LabelBox>> = vec![None; anchors.len()];
    for i in order {
        let cost = |label: &LabelBox, rank: usize| {
            let others = placed
                .iter()
                .flatten()
                .map(|other| label.widened(AIR).overlap(other) * 2.0);
            // Its own mark is not to be covered either.
            let covered = marks.iter().map(|mark| label.overlap(mark) * 3.0);
            let crossed = dots.iter().filter(|&&dot| label.nearest(dot) == dot);
            let crossed = crossed.count() as f64 * DOT * 2.0;
            others.chain(covered).sum::<f64>() + crossed + rank as f64 * 4.0
        };
        let best = candidates(&anchors[i])
            .enumerate()
            .map(|(rank, label)| (label.kept_in(bounds), rank))
            .map(|(label, rank)| (cost(&label, rank), label))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        placed[i] = best.map(|(_, label)| label);
    }
    placed.into_iter().flatten().collect()
}

/// Distance of the points that stand for a line.
const DOT: f64 = 4.0;

fn dotted(&[from, to]: &[[f64; 2]; 2]) -> impl Iterator<Item = [f64; 2]> {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let steps = (dx.hypot(dy) / DOT).ceil().clamp(1.0, 1000.0);
    (0..=steps as u32).map(move |step| {
        let share = f64::from(step) / steps;
        [from[0] + dx * share, from[1] + dy * share]
    })
}

/// Positions around a mark: right, left, above, below, the corners; then the same further out.
fn candidates(anchor: &Anchor) -> impl Iterator<Item = LabelBox> {
    let [x, y] = anchor.at;
    let size = [text_width(&anchor.text), GLYPH[1]];
    let rings = [0.0, 14.0, 28.0, 42.0, 56.0];
    let sides = [
        [1.0, 0.0],
        [-1.0, 0.0],
        [0.0, -1.0],
        [0.0, 1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, -1.0],
        [-1.0, 1.0],
    ];
    rings.into_iter().flat_map(move |ring| {
        sides.into_iter().map(move |[dx, dy]: [f64; 2]| {
            // Sideways a label stays close; up and down it may move away row by row.
            let away = [MARK + ring * 0.35, MARK + ring];
            let middle = [
                x + dx * (away[0] + size[0] / 2.0),
                y + dy * (away[1] + size[1] / 2.0),
            ];
            LabelBox {
                min: [middle[0] - size[0] / 2.0, middle[1] - size[1] / 2.0],
                max: [middle[0] + size[0] / 2.0, middle[1] + size[1] / 2.0],
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: LabelBox = LabelBox {
        min: [0.0, 0.0],
        max: [500.0, 300.0],
    };

    fn anchors(points: &[[f64; 2]]) -> Vec<Anchor> {
        let names = [
            "counter",
            "counter-zfail",
            "brute",
            "raytrace",
            "shadowmap-1024",
            "crow",
        ];
        let named = points.iter().zip(names.iter().cycle());
        named
            .map(|(&at, &name)| Anchor {
                at,
                text: name.to_owned(),
            })
            .collect()
    }

    /// Largest area that two labels share.
    fn worst_overlap(boxes: &[LabelBox]) -> f64 {
        let pairs = (0..boxes.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| boxes[i].overlap(&boxes[j]))
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_lone_mark_has_its_name_to_the_right() {
        let label = place(&anchors(&[[100.0, 100.0]]), &[], &BOUNDS)[0];
        assert!(label.min[0] > 100.0 && label.min[1] < 100.0 && label.max[1] > 100.0);
    }

    #[test]
    fn a_crowd_in_one_row_is_staggered_without_overlap() {
        let points = [100.0, 104.0, 112.0, 118.0, 130.0, 131.0].map(|x| [x, 150.0]);
        let boxes = place(&anchors(&points), &[], &BOUNDS);
        assert_eq!(worst_overlap(&boxes), 0.0, "{boxes:?}");
        // Negative control: all to the right of their marks, they do overlap.
        let naive: Vec<LabelBox> = anchors(&points)
            .iter()
            .map(|a| candidates(a).next().unwrap())
            .collect();
        assert!(worst_overlap(&naive) > 0.0);
    }

    #[test]
    fn a_label_moves_out_of_the_way_of_a_line() {
        let mark = anchors(&[[100.0, 100.0]]);
        let beside = place(&mark, &[], &BOUNDS)[0];
        let line = [[80.0, 100.0], [180.0, 100.0]];
        let away = place(&mark, &[line], &BOUNDS)[0];
        assert!(beside.min[1] < 100.0 && beside.max[1] > 100.0);
        assert!(away.max[1] < 100.0 || away.min[1] > 100.0, "{away:?}");
    }

    #[test]
    fn labels_stay_in_bounds() {
        let corners = [[1.0, 1.0], [499.0, 1.0], [1.0, 299.0], [499.0, 299.0]];
        for label in place(&anchors(&corners), &[], &BOUNDS) {
            for k in [0, 1] {
                assert!(label.min[k] >= BOUNDS.min[k] && label.max[k] <= BOUNDS.max[k]);
            }
        }
        assert!(place(&[], &[], &BOUNDS).is_empty());
    }
}
