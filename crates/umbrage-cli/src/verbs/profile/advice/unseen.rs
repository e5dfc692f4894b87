//! Lights that show on no visible surface, and lights whose shadows hide none of their light.

use umbrage_report::profile::AdviceKind;

use super::{Candidate, named, split, verb};
use crate::setting::Setting;
use crate::verbs::profile::change::{Change, LightChange};
use crate::verbs::profile::measure::Base;

pub(super) fn candidates(base: &Base, setting: &Setting) -> Vec<Candidate> {
    let lit = |light: usize| base.lights[light].work.counts.lit_pixels;
    let unshadowed = |light: usize| base.lights[light].work.counts.lit_unshadowed;
    let has_volume = |light: usize| base.lights[light].work.quads_drawn > 0;
    let drawn = || base.drawn.iter().copied();
    let dark: Vec<usize> = drawn().filter(|&light| lit(light) == 0).collect();
    let bright: Vec<usize> = drawn()
        .filter(|&light| lit(light) > 0 && lit(light) == unshadowed(light) && has_volume(light))
        .collect();
    let off = split(base, dark).into_iter().map(|lights| {
        let who = named(setting, &lights);
        // Behind walls, or too faint?
        let hidden = lights.iter().all(|&light| unshadowed(light) > 0);
        let why = match hidden {
            true => "all it reaches here is in its shadow",
            false => "too faint or behind what it reaches",
        };
        let shows = verb(&lights, "shows", "show");
        let text = format!(
            "{who} {shows} on no visible pixel ({why}): switch off where seen from here, by a portal, a zone or a trigger."
        );
        candidate(AdviceKind::SwitchOff, lights, LightChange::Off, text)
    });
    let open = split(base, bright).into_iter().map(|lights| {
        let who = named(setting, &lights);
        let (casts, its) = (
            verb(&lights, "casts", "cast"),
            verb(&lights, "its", "their"),
        );
        let text = format!(
            "{who} {casts} no visible shadow: every pixel that {its} light can show on is lit: mark non-shadowing."
        );
        candidate(AdviceKind::NoShadows, lights, LightChange::Unshadowed, text)
    });
    off.chain(open).collect()
}

fn candidate(kind: AdviceKind, lights: Vec<usize>, change: LightChange, text: String) -> Candidate {
    Candidate {
        kind,
        change: Change::Lights(lights.iter().map(|&light| (light, change)).collect()),
        lights,
        least_quads: 0.0,
        of: String::new(),
        words: Box::new(move |_, _| text.clone()),
    }
}
