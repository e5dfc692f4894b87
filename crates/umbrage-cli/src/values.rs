//! Option values: text to types, with messages that say what would have been right.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use glam::DVec3;
use umbrage_core::InstructionSet;
use umbrage_core::world::World;
use umbrage_lab::Cull;
use umbrage_lab::gpu::AdapterChoice;
use umbrage_lab::method::UnknownMethod;

/// `WxH` in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(pub(crate) [u32; 2]);

/// Widest and highest picture: the limit that every adapter must offer.
const MAX_SIDE: u32 = 8192;

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text
            .split_once(['x', 'X'])
            .map(|(w, h)| [w, h].map(str::parse::<u32>));
        match sides {
            Some([Ok(w), Ok(h)]) if (1..=MAX_SIDE).contains(&w) && (1..=MAX_SIDE).contains(&h) => {
                Ok(Self([w, h]))
            }
            Some([Ok(_), Ok(_)]) => Err(format!("each side must be 1 to {MAX_SIDE} pixels")),
            _ => Err("expected WIDTHxHEIGHT in pixels, as in 1280x720".to_owned()),
        }
    }
}

/// `x,y,z`: a world position in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point(pub(crate) DVec3);

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text).as_deref() {
            Some(&[x, y, z]) => Ok(Self(DVec3::new(x, y, z))),
            _ => Err("expected three numbers, as in 1.5,0,-20".to_owned()),
        }
    }
}

/// `--no-cull`: one step, or all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NoCull(pub(crate) Option<Cull>);

impl FromStr for NoCull {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self(None));
        }
        let step = Cull::ALL.into_iter().find(|step| step.name() == text);
        step.map(|step| Self(Some(step))).ok_or_else(|| {
            let names: Vec<&str> = Cull::ALL.iter().map(|step| step.name()).collect();
            format!("expected all or one of {}", names.join(", "))
        })
    }
}

/// `--instructions`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Instructions(pub(crate) InstructionSet);

impl FromStr for Instructions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut all = InstructionSet::ALL.into_iter();
        let found = all.find(|set| set.name() == text).map(Self);
        found.ok_or_else(|| "expected portable, avx2 or avx512".to_owned())
    }
}

/// `--camera`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraChoice {
    /// The scene's camera of this number, from 0.
    Index(usize),
    /// The scene's camera of this name.
    Name(String),
    /// A standpoint found with rays.
    Auto,
    /// World positions in metres.
    Free {
        eye: DVec3,
        target: DVec3,
        /// Vertical angle of view, if given.
        fovy_deg: Option<f64>,
    },
}

impl FromStr for CameraChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        if !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit()) {
            return text
                .parse()
                .map(Self::Index)
                .map_err(|_| "no scene has that many cameras".to_owned());
        }
        let (eye, target, fovy_deg) = match numbers(text).as_deref() {
            Some(&[x, y, z, tx, ty, tz]) => (DVec3::new(x, y, z), DVec3::new(tx, ty, tz), None),
            Some(&[x, y, z, tx, ty, tz, fovy]) => {
                (DVec3::new(x, y, z), DVec3::new(tx, ty, tz), Some(fovy))
            }
            Some(others) => {
                let given = others.len();
                return Err(format!(
                    "{given} numbers; expected eye and target, x,y,z,tx,ty,tz[,fovy_deg]"
                ));
            }
            None if text.trim().is_empty() => {
                return Err(
                    "expected a number, a name, auto, or x,y,z,tx,ty,tz[,fovy_deg]".to_owned(),
                );
            }
            None => return Ok(Self::Name(text.to_owned())),
        };
        let most = f64::from(World::MAX_COORDINATE);
        if eye.abs().max(target.abs()).max_element() > most {
            return Err(format!("eye and target must lie within {most:e} m"));
        }
        if eye == target {
            return Err("eye and target are the same point".to_owned());
        }
        if fovy_deg.is_some_and(|fovy| !(1.0..=170.0).contains(&fovy)) {
            return Err("the vertical angle of view must be 1 to 170 degrees".to_owned());
        }
        Ok(Self::Free {
            eye,
            target,
            fovy_deg,
        })
    }
}

/// A camera with the text it was chosen by, for reports.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedCamera {
    pub(crate) text: String,
    pub(crate) choice: CameraChoice,
}

impl FromStr for NamedCamera {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(Self {
            text: text.to_owned(),
            choice: text.parse()?,
        })
    }
}

/// `--lights`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LightChoice {
    /// The scene's own, or 64 seeded ones where it has none.
    Scene,
    /// This many, placed by this seed.
    Seeded { count: usize, seed: u64 },
    /// From a light file; see [`umbrage_scene::light_file`].
    File(PathBuf),
}

impl FromStr for LightChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "scene" {
            return Ok(Self::Scene);
        }
        if text.to_ascii_lowercase().ends_with(".json") {
            return Ok(Self::File(text.into()));
        }
        let (count, seed) = text.split_once(':').unwrap_or((text, "0"));
        match (count.parse(), seed.parse()) {
            (Ok(count), Ok(seed)) if count <= MAX_SEEDED => Ok(Self::Seeded { count, seed }),
            (Ok(_), Ok(_)) => Err(format!("at most {MAX_SEEDED} seeded lights")),
            _ => Err(
                "expected scene, a count as in 256 or 256:7 (seed 7), or a .json file".to_owned(),
            ),
        }
    }
}

const MAX_SEEDED: usize = 1 << 20;

/// `--range`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RangeChoice {
    /// Each light's own; from its intensity where it has none.
    Auto,
    /// The same for all lights but directional ones.
    Metres(f32),
}

impl FromStr for RangeChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        metres(text)
            .map(Self::Metres)
            .map_err(|why| format!("{why}, or auto"))
    }
}

/// A length above zero, in metres.
pub(crate) fn metres(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(length) if length > 0.0 && length.is_finite() => Ok(length),
        _ => Err("expected a length in metres, above 0".to_owned()),
    }
}

/// `--time`, in seconds.
pub(crate) fn time(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time.is_finite() => Ok(time),
        _ => Err("expected a time in seconds, as in 2.5".to_owned()),
    }
}

/// `--ratio`.
pub(crate) fn ratio(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if factor >= 1.0 && factor.is_finite() => Ok(factor),
        _ => Err("expected a factor of at least 1, as in 1.2 for a fifth more".to_owned()),
    }
}

/// `--play`.
pub(crate) fn fps(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(fps) if fps > 0.0 && fps.is_finite() => Ok(fps),
        _ => Err("expected frames a second, above 0".to_owned()),
    }
}

/// `--limit`.
pub(crate) fn seconds(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(time) if time >= 0.0 && time.is_finite() => Ok(time),
        _ => Err("expected seconds, 0 or more".to_owned()),
    }
}

/// `--weld`: a tolerance in metres, 0 for exact.
pub(crate) fn weld(text: &str) -> Result<f32, String> {
    match text {
        "exact" => Ok(0.0),
        _ => metres(text).map_err(|why| format!("{why}, or exact")),
    }
}

/// `--adapter`.
pub(crate) fn adapter(text: &str) -> Result<AdapterChoice, String> {
    match text {
        "" => Err("expected auto, cpu, or part of an adapter's name".to_owned()),
        "auto" => Ok(AdapterChoice::Auto),
        "cpu" => Ok(AdapterChoice::Cpu),
        name => Ok(AdapterChoice::Name(name.to_owned())),
    }
}

/// `--method`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Method(pub(crate) umbrage_lab::lab::Method);

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let method: Result<_, UnknownMethod> = text.parse();
        method.map(Self).map_err(|why| why.to_string())
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.name())
    }
}

/// Finite numbers between commas; none if any part is something else.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let parts = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()));
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("1920x1080".parse(), Ok(Size([1920, 1080])));
        for bad in [
            "",
            "1280",
            "1280x",
            "x720",
            "0x10",
            "10x9000",
            "-1x5",
            "1280x720x2",
            "12.5x3",
        ] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn cameras() {
        let parse = |text: &str| text.parse::<CameraChoice>();
        assert_eq!(parse("auto"), Ok(CameraChoice::Auto));
        assert_eq!(parse("3"), Ok(CameraChoice::Index(3)));
        assert_eq!(
            parse("Porch, left"),
            Ok(CameraChoice::Name("Porch, left".to_owned()))
        );
        let (eye, target) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, -6.5));
        assert_eq!(
            parse("1,2,3,4,5,-6.5"),
            Ok(CameraChoice::Free {
                eye,
                target,
                fovy_deg: None
            })
        );
        let fovy_deg = Some(75.0);
        assert_eq!(
            parse("1, 2, 3, 4, 5, -6.5, 75"),
            Ok(CameraChoice::Free {
                eye,
                target,
                fovy_deg
            })
        );
        for bad in [
            "",
            "1,2,3",
            "1,2,3,1,2,3",
            "0,0,0,1,0,0,0",
            "0,0,0,1,0,0,180",
            "99999999999999999999999",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lights() {
        assert_eq!("scene".parse(), Ok(LightChoice::Scene));
        assert_eq!(
            "256".parse(),
            Ok(LightChoice::Seeded {
                count: 256,
                seed: 0
            })
        );
        assert_eq!(
            "256:7".parse(),
            Ok(LightChoice::Seeded {
                count: 256,
                seed: 7
            })
        );
        assert_eq!("a/b.json".parse(), Ok(LightChoice::File("a/b.json".into())));
        for bad in ["", "many", "-1", "5:", ":5", "5:x", "99999999"] {
            assert!(bad.parse::<LightChoice>().is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges_and_points() {
        assert_eq!("auto".parse(), Ok(RangeChoice::Auto));
        assert_eq!("12.5".parse(), Ok(RangeChoice::Metres(12.5)));
        for bad in ["", "0", "-3", "inf", "nan", "12m"] {
            assert!(bad.parse::<RangeChoice>().is_err(), "{bad}");
        }
        assert_eq!("1e5,-2,0".parse(), Ok(Point(DVec3::new(1e5, -2.0, 0.0))));
        assert!("1,2".parse::<Point>().is_err() && "1,2,inf".parse::<Point>().is_err());
    }

    #[test]
    fn adapters() {
        assert_eq!(adapter("auto"), Ok(AdapterChoice::Auto));
        assert_eq!(adapter("cpu"), Ok(AdapterChoice::Cpu));
        assert_eq!(
            adapter("radeon"),
            Ok(AdapterChoice::Name("radeon".to_owned()))
        );
        assert!(adapter("").is_err());
    }
}
