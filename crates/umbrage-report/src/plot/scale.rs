//! A logarithmic axis.
//!
//! Takes values and the pixels to spread them over; gives places and ticks.

/// Positive values to pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogScale {
    /// Decimal logarithms of both ends.
    ends: [f64; 2],
    /// Pixels of both ends; the second may be the smaller, as upwards on a screen.
    pixels: [f64; 2],
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// In pixels.
    pub at: f64,
    /// Its value as text; null for a tick between those.
    pub label: Option<String>,
}

impl LogScale {
    /// Holds all `values` that are positive and finite, with `room` (a share of the span) at both
    /// ends; a decade around 1 where there are none, and at least half a decade.
    pub fn around(values: impl IntoIterator<Item = f64>, room: f64, pixels: [f64; 2]) -> Self {
        let logs = values.into_iter().filter(|v| *v > 0.0 && v.is_finite());
        let mut ends = logs
            .map(f64::log10)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], log| {
                [low.min(log), high.max(log)]
            });
        if ends[0] > ends[1] {
            ends = [-0.5, 0.5];
        }
        let span = ends[1] - ends[0];
        let widen = if span < 0.5 { (0.5 - span) / 2.0 } else { 0.0 } + span.max(0.5) * room;
        Self {
            ends: [ends[0] - widen, ends[1] + widen],
            pixels,
        }
    }

    /// Where a positive value is, in pixels.
    pub fn at(&self, value: f64) -> f64 {
        let share = (value.log10() - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Ticks from the first end to the second, with labels at least `apart` pixels from each
    /// other: every decade, or 1, 2 and 5 of each where there is room.
    pub fn ticks(&self, apart: f64) -> Vec<Tick> {
        let decade = ((self.pixels[1] - self.pixels[0]) / (self.ends[1] - self.ends[0])).abs();
        let labelled: &[u32] = if decade * 2.0_f64.log10() >= apart {
            &[1, 2, 5]
        } else if decade * 3.0_f64.log10() >= apart {
            &[1, 3]
        } else {
            &[1]
        };
        let every = (apart / decade).ceil().max(1.0) as i32;
        let mut ticks = Vec::new();
        for exponent in self.ends[0].floor() as i32..=self.ends[1].floor() as i32 {
            for digit in 1..10 {
                let log = f64::from(exponent) + f64::from(digit).log10();
                let minor = digit > 1 && decade < 40.0;
                if log < self.ends[0] || log > self.ends[1] || minor {
                    continue;
                }
                let has_label = labelled.contains(&digit) && exponent.rem_euclid(every) == 0;
                ticks.push(Tick {
                    at: self.at(10_f64.powf(log)),
                    label: has_label.then(|| round_number(digit, exponent)),
                });
            }
        }
        ticks
    }
}

/// `digit` times ten to `exponent`, as on an axis: 0.02, 5, 20k, 1M.
fn round_number(digit: u32, exponent: i32) -> String {
    let zeros = |count: i32| "0".repeat(count as usize);
    match exponent {
        ..-4 => format!("{digit}e{exponent}"),
        -4..0 => format!("0.{}{digit}", zeros(-exponent - 1)),
        0..4 => format!("{digit}{}", zeros(exponent)),
        4..6 => format!("{digit}{}k", zeros(exponent - 3)),
        6..9 => format!("{digit}{}M", zeros(exponent - 6)),
        9..12 => format!("{digit}{}G", zeros(exponent - 9)),
        _ => format!("{digit}e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_inside_and_order_is_kept() {
        let scale = LogScale::around([3.0, 700.0, 0.0, f64::NAN], 0.05, [0.0, 100.0]);
        let [low, high] = [3.0, 700.0].map(|v| scale.at(v));
        assert!(0.0 < low && low < high && high < 100.0, "{low} {high}");
        let up = LogScale::around([1.0, 10.0], 0.0, [100.0, 0.0]);
        assert_eq!([1.0, 10.0].map(|v| up.at(v)), [100.0, 0.0]);
    }

    #[test]
    fn one_value_or_none_still_has_an_axis_with_labels() {
        for values in [vec![], vec![4.2], vec![1e-3], vec![2.5e6]] {
            let scale = LogScale::around(values.iter().copied(), 0.06, [0.0, 300.0]);
            let labels = scale.ticks(40.0).into_iter().filter(|t| t.label.is_some());
            assert!(labels.count() > 0, "{values:?}");
        }
    }

    #[test]
    fn labels_keep_their_distance() {
        for top in [3.0, 20.0, 1e3, 1e6, 1e12] {
            let scale = LogScale::around([1.0, top], 0.0, [0.0, 300.0]);
            let ticks = scale.ticks(38.0);
            let at: Vec<f64> = ticks
                .iter()
                .filter(|t| t.label.is_some())
                .map(|t| t.at)
                .collect();
            assert!(at.windows(2).all(|w| w[1] - w[0] >= 37.0), "{top}: {at:?}");
        }
    }

    #[test]
    fn round_numbers_are_short() {
        let texts = [(2, -2), (5, 0), (1, 3), (2, 4), (1, 6), (1, -7)];
        let texts = texts.map(|(digit, exponent)| round_number(digit, exponent));
        assert_eq!(texts, ["0.02", "5", "1000", "20k", "1M", "1e-7"]);
    }
}
