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
    /// A static buffer extruded by the vertex shader, for closed meshes (Brennan 2002).
    Extrude,
    /// No shadows: the floor that every frame time is compared with.
    None,
}

/// A name that is no method's.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("no method is called {name:?}; there are: {}", Method::names().join(", "))]
pub struct UnknownMethod {
    /// What was asked for.
    pub name: String,
}

impl Method {
    /// All of them, in the order of `--help`; maps with one example.
    pub const ALL: [Method; 4] = [
        Method::Counter,
        Method::CounterZFail,
        Method::Extrude,
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
            Method::Extrude => "extrude".into(),
            Method::None => "none".into(),
        }
    }

    /// Whether it promises the oracle's shadows: one wrong pixel-light is a failure.
    pub fn is_exact(self) -> bool {
        match self {
            Method::Counter | Method::CounterZFail => true,
            Method::Extrude | Method::None => false,
        }
    }

    /// Whether it draws shadow volumes that the CPU builds.
    pub fn has_volumes(self) -> bool {
        match self {
            Method::Counter | Method::CounterZFail => true,
            Method::Extrude | Method::None => false,
        }
    }
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
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
        let refused = "stencil".parse::<Method>().unwrap_err().to_string();
        assert!(refused.contains("counter-zfail"), "{refused}");
    }
}
