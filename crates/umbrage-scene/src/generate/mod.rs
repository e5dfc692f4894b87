//! Generated worlds: `NAME?key=value&...`, the same for the same specification everywhere.
//!
//! Takes a specification; gives a [`Scene`]. Generators use only sums, products, quotients and
//! square roots, which are exactly rounded on every machine, so their bits can be compared.

mod city;
mod field;
mod house;
mod rng;
mod shape;
mod soup;

use crate::{Progress, Scene, SceneError};

/// A key that a generator takes, and the bounds of its value.
struct Key {
    name: &'static str,
    low: u64,
    high: u64,
    default: u64,
}

const fn key(name: &'static str, low: u64, high: u64, default: u64) -> Key {
    Key {
        name,
        low,
        high,
        default,
    }
}

const LIGHTS: u64 = 65_536;

/// Keys, in the order in which the generator takes their values.
const CITY: [Key; 4] = [
    key("triangles", 1, 50_000_000, 100_000),
    key("lights", 0, LIGHTS, 256),
    key("seed", 0, u64::MAX, 1),
    key("moon", 0, 1, 0),
];
const SOUP: [Key; 3] = [
    key("triangles", 1, 10_000_000, 2_000),
    key("lights", 0, LIGHTS, 8),
    key("seed", 0, u64::MAX, 1),
];
const FIELD: [Key; 3] = [
    key("n", 1, 4_096, 512),
    key("lights", 0, LIGHTS, 64),
    key("seed", 0, u64::MAX, 1),
];

/// A generator with the values of its keys.
enum World {
    City([u64; 4]),
    Soup([u64; 3]),
    Field([u64; 3]),
}

fn parse(spec: &str) -> Result<World, SceneError> {
    let (name, query) = spec.split_once('?').unwrap_or((spec, ""));
    match name {
        "city" => values(name, query, &CITY).map(World::City),
        "soup" => values(name, query, &SOUP).map(World::Soup),
        "field" => values(name, query, &FIELD).map(World::Field),
        _ => Err(SceneError::UnknownGenerator {
            name: name.to_owned(),
            known: "city, soup, field".to_owned(),
        }),
    }
}

/// Whether a specification names a world, without building it.
pub(crate) fn check(spec: &str) -> Result<(), SceneError> {
    parse(spec).map(|_| ())
}

/// Builds the world that a specification names (without its `gen:`).
pub(crate) fn generate(spec: &str, progress: &dyn Progress) -> Result<Scene, SceneError> {
    let mut scene = match parse(spec)? {
        World::City([triangles, lights, seed, moon]) => {
            city::build(triangles, lights as usize, seed, moon == 1, progress)
        }
        World::Soup([triangles, lights, seed]) => {
            soup::build(triangles as usize, lights as usize, seed)
        }
        World::Field([n, lights, seed]) => field::build(n as u32, lights as usize, seed, progress),
    };
    scene.name = format!("gen:{spec}");
    scene.report.nodes = scene.instances.len() as u64;
    Ok(scene)
}

/// The value of every key: its default unless the query gives one within its bounds.
fn values<const N: usize>(
    generator: &str,
    query: &str,
    keys: &[Key; N],
) -> Result<[u64; N], SceneError> {
    let fail = |what: String| {
        let describe = |k: &Key| format!("{}={} ({} to {})", k.name, k.default, k.low, k.high);
        let known = keys.iter().map(describe).collect::<Vec<_>>().join(", ");
        SceneError::GeneratorKey {
            generator: generator.to_owned(),
            what,
            known,
        }
    };
    let mut values = std::array::from_fn(|i| keys[i].default);
    for pair in query.split('&').filter(|p| !p.is_empty()) {
        let (name, text) = pair.split_once('=').unwrap_or((pair, ""));
        let Some(i) = keys.iter().position(|k| k.name == name) else {
            return Err(fail(format!("unknown key {name:?}")));
        };
        let value = whole_number(text).filter(|v| (keys[i].low..=keys[i].high).contains(v));
        values[i] = value.ok_or_else(|| fail(format!("{name}={text:?} is out of bounds")))?;
    }
    Ok(values)
}

/// Digits, or a whole number written with an exponent, as in 1e6.
fn whole_number(text: &str) -> Option<u64> {
    let with_exponent = || {
        let value: f64 = text.parse().ok()?;
        (value.fract() == 0.0 && (0.0..1e15).contains(&value)).then_some(value as u64)
    };
    text.parse().ok().or_else(with_exponent)
}

#[cfg(test)]
mod tests {
    use super::whole_number;

    #[test]
    fn numbers_may_have_an_exponent_but_no_fraction() {
        for (text, value) in [("40", 40), ("1e6", 1_000_000), ("2.5e3", 2500), ("0", 0)] {
            assert_eq!(whole_number(text), Some(value), "{text}");
        }
        for text in [
            "", "1.5", "-1", "1e-3", "nan", "inf", "1e300", "1e6 ", "six",
        ] {
            assert_eq!(whole_number(text), None, "{text}");
        }
        assert_eq!(whole_number("18446744073709551615"), Some(u64::MAX));
    }
}
