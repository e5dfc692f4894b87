//! The methods by name: every way of finding shadows that the lab knows.

use std::borrow::Cow;
use std::str::FromStr;

use thiserror::Error;

/// How shadows are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Counter volumes, z-pass from the eye count, z-fail where that is ambiguous.
    #[default]
    Counter,
    /// Counter volumes with both caps, z-fail for every light.
    CounterZFail,
    /// Depth as each light sees it, compared: a cube, or one face for spots and directional lights.
    ShadowMap {
        /// Width and height of a face: [`MAP_TEXELS`], in steps of [`MAP_STEP`].
        texels: u32,
    },
    /// Any-hit rays over the world's BVH, in a compute shader.
    RayTrace,
    /// No shadows: the floor that every frame time is compared with.
    None,
}

/// Smallest and largest shadow map, in texels a side.
pub const MAP_TEXELS: std::ops::RangeInclusive<u32> = 256..=4096;

/// Shadow maps have a multiple of so many texels a side.
pub const MAP_STEP: u32 = 64;

/// A name that is no method's.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "no method is called {name:?}; there are: {}; maps of other sizes have 256 to 4096 texels a \
     side, in steps of 64",
    Method::names().join(", ")
)]
pub struct UnknownMethod {
    /// What was asked for.
    pub name: String,
}

impl Method {
    /// All of them, in the order of `--help`; maps of the usual sizes.
    pub const ALL: [Method; 9] = [
        Method::Counter,
        Method::CounterZFail,
        Method::ShadowMap { texels: 256 },
        Method::ShadowMap { texels: 512 },
        Method::ShadowMap { texels: 1024 },
        Method::ShadowMap { texels: 2048 },
        Method::ShadowMap { texels: 4096 },
        Method::RayTrace,
        Method::None,
    ];

    /// Their names.
    pub fn names() -> Vec<Cow<'static, str>> {
        Self::ALL.iter().map(|method| method.name()).collect()
    }

    /// Its name on the command line.
    pub fn name(self) -> Cow<'static, str> {
        match self {
            Method::Counter => "counter".into(),
            Method::CounterZFail => "counter-zfail".into(),
            Method::ShadowMap { texels } => format!("shadowmap-{texels}").into(),
            Method::RayTrace => "raytrace".into(),
            Method::None => "none".into(),
        }
    }

    /// Whether it promises the oracle's shadows: one wrong pixel-light is a failure.
    pub fn is_exact(self) -> bool {
        match self {
            Method::Counter | Method::CounterZFail | Method::RayTrace => true,
            Method::ShadowMap { .. } | Method::None => false,
        }
    }

    /// Whether it draws shadow volumes that the CPU builds.
    pub fn has_volumes(self) -> bool {
        match self {
            Method::Counter | Method::CounterZFail => true,
            Method::ShadowMap { .. } | Method::RayTrace | Method::None => false,
        }
    }
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let texels = name.strip_prefix("shadowmap-").map(str::parse);
        if let Some(Ok(texels)) = texels
            && MAP_TEXELS.contains(&texels)
            && texels % MAP_STEP == 0
        {
            return Ok(Method::ShadowMap { texels });
        }
        let mut all = Self::ALL.into_iter();
        all.find(|method| method.name() == name)
            .ok_or_else(|| UnknownMethod { name: name.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_methods() {
        for method in Method::ALL {
            assert_eq!(method.name().parse(), Ok(method));
        }
        assert_eq!(
            "shadowmap-1536".parse(),
            Ok(Method::ShadowMap { texels: 1536 })
        );
        for other in [
            "shadowmap-",
            "shadowmap-100",
            "shadowmap-8192",
            "shadowmap-1000",
        ] {
            assert!(other.parse::<Method>().is_err(), "{other}");
        }
        let refused = "stencil".parse::<Method>().unwrap_err().to_string();
        assert!(refused.contains("counter-zfail"), "{refused}");
    }
}
