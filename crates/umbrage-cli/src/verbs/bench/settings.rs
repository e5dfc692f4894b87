//! What was asked, as text for the report: options in one spelling, and the command line.
//!
//! Two runs are comparable if their settings are the same text, so every option that decides what
//! is drawn is named in it, with its default where it was not given.

use std::ffi::OsString;

use clap::ValueEnum;
use umbrage_lab::Cull;

use crate::actor::ActorChoice;
use crate::args::BenchArgs;
use crate::values::{LightChoice, RangeChoice};

/// The options beside scenes, cameras, sizes and methods, which each row names.
pub(super) fn settings(args: &BenchArgs) -> String {
    let (world, run) = (&args.world, &args.run);
    let choice = |value: Option<clap::builder::PossibleValue>| {
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    };
    let lights = match &args.lights {
        LightChoice::Scene => "scene".to_owned(),
        LightChoice::Seeded { count, seed } => format!("{count}:{seed}"),
        LightChoice::File(path) => path.to_string_lossy().into_owned(),
    };
    let range = match world.range {
        RangeChoice::Auto => "auto".to_owned(),
        RangeChoice::Metres(range) => range.to_string(),
    };
    let weld = match world.weld {
        0.0 => "exact".to_owned(),
        within => within.to_string(),
    };
    let culls = run.culls();
    let off: Vec<&str> = Cull::ALL
        .into_iter()
        .filter(|&step| !culls.has(step))
        .map(Cull::name)
        .collect();
    let mut pairs = vec![
        ("casters", choice(world.casters.to_possible_value())),
        ("range", range),
        ("lights", lights),
        ("weld", weld),
        ("time", world.time.to_string()),
        ("shadows", choice(run.shadows.to_possible_value())),
    ];
    pairs.extend(args.play.map(|fps| ("play", fps.to_string())));
    pairs.extend(args.near.map(|near| ("near", near.to_string())));
    if !off.is_empty() {
        pairs.push(("no-cull", off.join(",")));
    }
    pairs.extend(world.actors.iter().map(|one| ("actor", actor(one))));
    let words = pairs.iter().map(|(name, value)| format!("{name}={value}"));
    words.collect::<Vec<_>>().join(" ")
}

fn actor(ActorChoice { file, placement }: &ActorChoice) -> String {
    let at = placement.at;
    let (turn, scale, speed) = (
        placement.turn_rad.to_degrees(),
        placement.scale,
        placement.speed,
    );
    format!(
        "{file}?at={},{},{}&turn={turn}&scale={scale}&speed={speed}",
        at.x, at.y, at.z
    )
}

/// How a program was called, for a shell; what is no Unicode is shown as well as can be.
pub(crate) fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quoted = |word: OsString| {
        let word = word.to_string_lossy().into_owned();
        match word.chars().all(plain) && !word.is_empty() {
            true => word,
            false => format!("'{}'", word.replace('\'', "'\\''")),
        }
    };
    let words = arguments.skip(1).map(quoted);
    let words: Vec<String> = std::iter::once("umbrage".to_owned()).chain(words).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Verb};
    use clap::Parser;

    fn of(options: &str) -> String {
        let line = format!("umbrage bench a.glb{options}");
        match Cli::parse_from(line.split(' ')).verb {
            Verb::Bench(args) => settings(&args),
            _ => panic!("not bench"),
        }
    }

    #[test]
    fn the_same_options_have_one_spelling_and_others_another() {
        let plain = "casters=material range=auto lights=scene weld=exact time=0 shadows=black";
        assert_eq!(of(""), plain);
        assert_eq!(of(" --casters material --time 0.0 --range auto"), plain);
        assert_eq!(
            of(" --methods none --size 8x8 --repeat 9 --threads 2"),
            plain
        );
        assert_eq!(of(" --lights 64"), of(" --lights 64:0"));
        assert_eq!(
            of(" --no-cull cache,view"),
            of(" --no-cull view --no-cull cache")
        );
        for other in [
            " --casters both",
            " --range 5",
            " --time 1",
            " --lights 64:1",
            " --weld 0.1",
            " --shadows ambient",
            " --play 30",
            " --near 1",
            " --no-cull all",
            " --actor man.glb?at=1,2,3",
        ] {
            assert_ne!(of(other), plain, "{other}");
        }
    }

    #[test]
    fn a_command_line_is_one_for_a_shell() {
        let words = ["umbrage.exe", "bench", "gen:city?a=1&b", "it's", ""];
        let line = command_line(words.into_iter().map(OsString::from));
        assert_eq!(line, "umbrage bench 'gen:city?a=1&b' 'it'\\''s' ''");
    }
}
