//! Lights that take z-fail with both caps because the eye is on a side of their volume.

use glam::DVec3;
use umbrage_core::frame::{LightPath, ZFailReason};
use umbrage_report::profile::AdviceKind;

use super::Candidate;
use crate::setting::Setting;
use crate::verbs::profile::change::{Change, LightChange};
use crate::verbs::profile::measure::Base;

/// How far it is moved, in parts of its range.
const STEP: f64 = 0.002;
/// Most lights tried.
const MOST: usize = 3;

pub(super) fn candidates(base: &Base, setting: &Setting) -> Vec<Candidate> {
    let on_side = LightPath::ZFail(ZFailReason::EyeOnSide);
    let lights = base.drawn.iter().copied();
    let lights = lights.filter(|&light| base.lights[light].path == on_side);
    let lights = lights.filter(|&light| setting.lights[light].light.range.is_finite());
    let candidate = |light: usize| {
        let step = STEP * f64::from(setting.lights[light].light.range);
        // In no direction that edges run in.
        let by = step * DVec3::new(0.51, 0.62, 0.59);
        let name = setting.lights[light].name.clone();
        let caps = base.lights[light].work.cap_triangles;
        let text = format!(
            "{name} is drawn by z-fail with {caps} cap triangles, because the eye is on a side of its volume: an edge, the light and the eye are in line. Moved by {step:.2} m it needs no caps."
        );
        Candidate {
            kind: AdviceKind::Move,
            change: Change::Lights(vec![(light, LightChange::Moved(by))]),
            lights: vec![light],
            least_quads: 0.0,
            of: String::new(),
            words: Box::new(move |_, _| text.clone()),
        }
    };
    lights.take(MOST).map(candidate).collect()
}
