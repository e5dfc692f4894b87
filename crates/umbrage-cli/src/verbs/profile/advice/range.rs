//! Ranges that reach farther than the light shows.

use umbrage_report::profile::AdviceKind;

use super::{Candidate, named, split, verb};
use crate::setting::Setting;
use crate::verbs::profile::change::{Change, LightChange};
use crate::verbs::profile::measure::Base;

/// A range is that much longer than it need be: what is needed was found in half floats.
const MARGIN: f64 = 1.01;
/// A range is worth shortening below this part of it.
const WORTH: f64 = 0.8;

/// Lights that have other advice, `taken`, get none about their range.
pub(super) fn candidates(base: &Base, setting: &Setting, taken: &[usize]) -> Vec<Candidate> {
    let shorter = |light: usize| -> Option<f32> {
        let range = f64::from(setting.lights[light].light.range);
        let needed = base.lights[light].work.counts.range_needed_m;
        let wanted = rounded_up(needed * MARGIN);
        let is_worth = needed > 0.0 && wanted < WORTH * range;
        is_worth.then_some(wanted as f32)
    };
    let lights = base.drawn.iter().copied();
    let lights = lights.filter(|light| !taken.contains(light) && shorter(*light).is_some());
    let groups = split(base, lights.collect());
    groups
        .into_iter()
        .map(|lights| {
            let changes: Vec<(usize, LightChange)> = lights
                .iter()
                .filter_map(|&light| Some((light, LightChange::Range(shorter(light)?))))
                .collect();
            let who = named(setting, &lights);
            let range = |light: usize| setting.lights[light].light.range;
            let ranges = match changes[..] {
                [(light, LightChange::Range(to))] => {
                    format!("range {} m could be {} m", metres(range(light)), metres(to))
                }
                _ => {
                    let to = |change: &LightChange| match change {
                        LightChange::Range(to) => *to,
                        _ => 0.0,
                    };
                    let was: f32 = changes.iter().map(|(light, _)| range(*light)).sum();
                    let now: f32 = changes.iter().map(|(_, change)| to(change)).sum();
                    format!("ranges could be {:.0}% of what they are", 100.0 * now / was)
                }
            };
            let of = lights.clone();
            let reaches = verb(&lights, "reaches", "reach");
            let words = move |base: &Base, after: &[crate::verbs::profile::measure::Work]| {
                let sum = |of_light: &dyn Fn(usize) -> u32| -> u64 {
                    of.iter().map(|&light| u64::from(of_light(light))).sum()
                };
                let before = sum(&|light| base.lights[light].work.subset);
                let now = sum(&|light| after[light].subset);
                format!(
                    "{who} {reaches} behind what can be seen: {ranges} with the same lit pixels, and {} triangles in it instead of {}.",
                    umbrage_report::grouped(now),
                    umbrage_report::grouped(before)
                )
            };
            Candidate {
                kind: AdviceKind::ShorterRange,
                change: Change::Lights(changes),
                lights,
                least_quads: 0.0,
                of: String::new(),
                words: Box::new(words),
            }
        })
        .collect()
}

/// To two digits, upwards.
fn rounded_up(metres: f64) -> f64 {
    if metres <= 0.0 {
        return 0.0;
    }
    let step = 10f64.powf(metres.log10().floor() - 1.0);
    (metres / step).ceil() * step
}

fn metres(m: f32) -> String {
    match m {
        m if m >= 10.0 => format!("{m:.0}"),
        m => format!("{m:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_two_digits() {
        for (from, to) in [
            (11.21, 12.0),
            (0.0432, 0.044),
            (99.1, 100.0),
            (1234.0, 1300.0),
        ] {
            assert!((rounded_up(from) / to - 1.0).abs() < 1e-6, "{from}");
        }
    }
}
