//! `--actor`: a second scene to place in the first, from text.
//!
//! Takes `FILE?key=value&...`, as generated worlds are written; gives a file and a placement. The
//! first question mark of a generated world is its own. Every message says which key, and what would
//! have been right.

use std::str::FromStr;

use umbrage_scene::rig::Placement;
use umbrage_scene::{LoadReport, Scene, SceneError};

use crate::progress::Bar;
use crate::values::Point;

/// One `--actor`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ActorChoice {
    pub(crate) file: String,
    pub(crate) placement: Placement,
}

/// What may follow the file.
const KEYS: &str = "at=X,Y,Z (metres), turn=DEGREES, scale=S (above 0) and speed=METRES_PER_SECOND";

impl FromStr for ActorChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // A generated world has a question mark of its own.
        let own = text.find('?').filter(|_| text.starts_with("gen:"));
        let start = own.map_or(0, |own| own + 1);
        let (file, keys) = match text[start..].rfind('?') {
            Some(at) => (&text[..start + at], &text[start + at + 1..]),
            None => (text, ""),
        };
        if file.is_empty() {
            return Err(format!("expected a file, and after a ? any of {KEYS}"));
        }
        let mut placement = Placement::default();
        let mut seen = Vec::new();
        for pair in keys.split('&').filter(|pair| !pair.is_empty()) {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(format!("{pair:?} is no key=value; known are {KEYS}"));
            };
            if seen.contains(&key) {
                return Err(format!("{key} is given twice"));
            }
            seen.push(key);
            let number = || {
                let number = value.parse().ok().filter(|n: &f64| n.is_finite());
                number.ok_or_else(|| format!("{key}={value}: expected a number"))
            };
            match key {
                "at" => {
                    let point: Result<Point, String> = value.parse();
                    placement.at = point.map_err(|why| format!("at={value}: {why}"))?.0;
                }
                "turn" => placement.turn_rad = number()?.to_radians(),
                "scale" => {
                    placement.scale = number()?;
                    if placement.scale <= 0.0 {
                        return Err(format!("scale={value}: must be above 0"));
                    }
                }
                "speed" => placement.speed = number()?,
                _ => return Err(format!("unknown key {key:?}; known are {KEYS}")),
            }
        }
        Ok(Self {
            file: file.to_owned(),
            placement,
        })
    }
}

/// Opens a scene with actors in it, and says what was odd about it.
pub(crate) fn open(spec: &str, actors: &[ActorChoice], bar: &Bar) -> Result<Scene, SceneError> {
    let mut scene = umbrage_scene::open(spec, bar)?;
    for actor in actors {
        let placed = umbrage_scene::open(&actor.file, bar)?;
        scene.place(placed, &actor.placement);
    }
    for oddity in oddities(&scene.report) {
        bar.say(&format!("{}: {oddity}", scene.name));
    }
    Ok(scene)
}

/// What loading skipped or repaired: a few words each.
pub(crate) fn oddities(report: &LoadReport) -> Vec<String> {
    let words = |(name, count): (&str, u64)| format!("{}: {count}", name.replace('_', " "));
    report.oddities().into_iter().map(words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn actors() {
        let parse = |text: &str| text.parse::<ActorChoice>();
        let plain = parse("man.glb").unwrap();
        assert_eq!(
            (plain.file.as_str(), plain.placement),
            ("man.glb", Placement::default())
        );
        let full = parse("a/man.glb?at=1,-2.5,3e2&turn=-90&scale=36&speed=40").unwrap();
        let expected = Placement {
            at: DVec3::new(1.0, -2.5, 300.0),
            turn_rad: -std::f64::consts::FRAC_PI_2,
            scale: 36.0,
            speed: 40.0,
        };
        assert_eq!(full.placement, expected);
        for (text, file, scale) in [
            ("gen:field", "gen:field", 1.0),
            ("gen:field?n=2", "gen:field?n=2", 1.0),
            ("gen:field?n=2?scale=2", "gen:field?n=2", 2.0),
            ("gen:field??scale=2", "gen:field?", 2.0),
        ] {
            let actor = parse(text).unwrap();
            let found = (actor.file.as_str(), actor.placement.scale);
            assert_eq!(found, (file, scale), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_with_an_actor_is_said() {
        for (text, said) in [
            ("", "expected a file"),
            ("?at=1,2,3", "expected a file"),
            ("man.glb?at=1,2", "at=1,2: expected three numbers"),
            ("man.glb?turn=left", "turn=left: expected a number"),
            ("man.glb?turn=inf", "expected a number"),
            ("man.glb?scale=0", "must be above 0"),
            ("man.glb?scale=-1", "must be above 0"),
            ("man.glb?scale=1&scale=2", "scale is given twice"),
            ("man.glb?size=2", "unknown key \"size\"; known are at=X,Y,Z"),
            ("man.glb?walk", "is no key=value"),
        ] {
            let error = text.parse::<ActorChoice>().unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
