//! Colours and shapes of the methods.
//!
//! Takes the names in a report; gives each the same look in every plot of every report. What
//! stands before the first hyphen is the family: it decides colour and shape, and the place within
//! the family the dashes of its lines.

use crate::bench::{BenchReport, rows::FLOOR};
use crate::plot::{Look, Shape};

/// Families by colour; `half` and `quarter` are one, as they do the same thing.
const FAMILIES: [&[&str]; 8] = [
    &["counter"],
    &["shadowmap"],
    &["raytrace"],
    &["mask"],
    &["brute"],
    &["crow"],
    &["extrude"],
    &["half", "quarter"],
];
const SHAPES: [Shape; 8] = [
    Shape::Disc,
    Shape::Cross,
    Shape::Square,
    Shape::Up,
    Shape::Diamond,
    Shape::Down,
    Shape::Hexagon,
    Shape::Star,
];

/// The look of every method of a report.
pub(super) struct Looks(Vec<(String, Look)>);

impl Looks {
    pub(super) fn of(report: &BenchReport) -> Self {
        let mut looks: Vec<(String, Look)> = Vec::new();
        let mut strangers: Vec<&str> = Vec::new();
        for name in report.methods() {
            let family = family(name);
            let known = FAMILIES.iter().position(|names| names.contains(&family));
            let place = known.unwrap_or_else(|| {
                if !strangers.contains(&family) {
                    strangers.push(family);
                }
                // From the far end, whose colours are the least taken.
                7 - strangers.iter().position(|&one| one == family).unwrap_or(0) % 8
            });
            let colour = (!is_grey(name)).then_some(place as u8);
            let shape = if is_grey(name) {
                Shape::Disc
            } else {
                SHAPES[place]
            };
            let before = looks
                .iter()
                .filter(|(_, look)| look.colour == colour)
                .count();
            let filled = report
                .rows
                .iter()
                .any(|row| row.method == name && row.exact);
            let look = Look {
                colour,
                shape,
                dash: before as u8 % 5,
                filled,
            };
            looks.push((name.to_owned(), look));
        }
        Self(looks)
    }

    /// Of a method of that report.
    pub(super) fn get(&self, method: &str) -> Look {
        let grey = Look {
            colour: None,
            shape: Shape::Disc,
            dash: 0,
            filled: false,
        };
        let mut looks = self.0.iter();
        looks
            .find(|(name, _)| name == method)
            .map_or(grey, |(_, look)| *look)
    }
}

/// The yardsticks: no shadows, and the truth.
fn is_grey(name: &str) -> bool {
    name == FLOOR || name == "oracle"
}

fn family(name: &str) -> &str {
    name.split('-').next().unwrap_or(name)
}

/// `shadowmap-512` is at 512 on the curve `shadowmap`.
pub(super) fn curve(name: &str) -> Option<(String, f64)> {
    let (family, number) = name.rsplit_once('-')?;
    Some((
        family.to_owned(),
        number.parse().ok().filter(|n: &f64| n.is_finite())?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BenchRow;

    #[test]
    fn one_look_a_family_whatever_else_is_in_the_report() {
        let report = |methods: &[&str]| {
            let mut report = BenchReport::default();
            for method in methods {
                report.push(BenchRow::new(method, ("a", "auto", [1, 1])));
            }
            Looks::of(&report)
        };
        let few = report(&["shadowmap-512"]);
        let many = report(&[
            "new",
            "counter",
            "counter-zfail",
            "none",
            "shadowmap-512",
            "other",
        ]);
        assert_eq!(few.get("shadowmap-512"), many.get("shadowmap-512"));
        let [a, b] = ["counter", "counter-zfail"].map(|name| many.get(name));
        assert_eq!((a.colour, a.shape), (b.colour, b.shape));
        assert_ne!(a.dash, b.dash);
        assert_ne!(many.get("new").colour, many.get("other").colour);
        assert_eq!(many.get("none").colour, None);
    }

    #[test]
    fn numbered_methods_lie_on_a_curve() {
        assert_eq!(curve("shadowmap-512"), Some(("shadowmap".into(), 512.0)));
        assert_eq!(curve("mask-alpha"), None);
        assert_eq!(curve("mask-inf"), None);
    }
}
