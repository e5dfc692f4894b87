//! Lights that stand at one place.

use umbrage_core::LightShape;
use umbrage_report::profile::AdviceKind;

use super::{Candidate, cost};
use crate::setting::Setting;
use crate::verbs::profile::change::{Change, LightChange};
use crate::verbs::profile::measure::Base;

/// Lights this near each other, in parts of the shorter range, look like one.
const NEAR: f64 = 0.01;
/// Most pairs tried.
const MOST: usize = 3;

pub(super) fn candidates(base: &Base, setting: &Setting) -> Vec<Candidate> {
    let lights = &setting.lights;
    let points = base.drawn.iter().copied();
    let points = points.filter(|&light| lights[light].light.shape == LightShape::Point);
    let points: Vec<usize> = points.collect();
    let mut pairs = Vec::new();
    let mut used = vec![false; lights.len()];
    for (i, &a) in points.iter().enumerate() {
        for &b in &points[i + 1..] {
            let [one, other] = [a, b].map(|light| &lights[light].light);
            let near = NEAR * f64::from(one.range.min(other.range));
            let apart = one.position.distance(other.position);
            if apart > near || used[a] || used[b] {
                continue;
            }
            (used[a], used[b]) = (true, true);
            // The longer range stays.
            pairs.push(match one.range >= other.range {
                true => [a, b],
                false => [b, a],
            });
        }
    }
    pairs.sort_by(|a, b| cost(base, b[1]).total_cmp(&cost(base, a[1])));
    let candidate = |[kept, gone]: [usize; 2]| {
        let [kept_name, gone_name] = [kept, gone].map(|light| lights[light].name.clone());
        let text = format!(
            "{gone_name} stands where {kept_name} does: one light with the power of both looks the same."
        );
        Candidate {
            kind: AdviceKind::Merge,
            change: Change::Lights(vec![(kept, LightChange::Takes(gone))]),
            lights: vec![kept, gone],
            least_quads: 0.0,
            of: String::new(),
            words: Box::new(move |_, _| text.clone()),
        }
    };
    pairs.into_iter().take(MOST).map(candidate).collect()
}
