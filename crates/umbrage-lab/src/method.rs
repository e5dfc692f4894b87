//! The methods by name: every way of finding shadows that the lab knows.

use std::borrow::Cow;
use std::str::FromStr;

use thiserror::Error;
use umbrage::frame::{Distance, Extrusion, PathRule};
use umbrage::volume::Construction;

/// How shadows are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Counter volumes, z-pass from the eye count, z-fail where that is ambiguous.
    #[default]
    Counter,
    /// Counter volumes with both caps, z-fail for every light.
    CounterZFail,
    /// Counter volumes that end at a distance from the light.
    CounterFinite(Distance),
    /// Every triangle its own volume.
    Brute,
    /// Edges that point to two faces (Crow 1977, Bergeron 1986).
    Crow,
    /// A static buffer extruded by the vertex shader, for closed meshes (Brennan 2002).
    Extrude(Normals),
    /// No shadows: the floor that every frame time is compared with.
    None,
}

/// Where the face normals of skinned characters come from; others find them anew always.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Normals {
    /// The posed positions of the face's corners.
    Neighbours,
    /// The normal at rest, turned by the weights of the face.
    FaceWeights,
    /// The same, turned by the weights of each vertex.
    VertexWeights,
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
    pub const ALL: [Method; 10] = [
        Method::Counter,
        Method::CounterZFail,
        Method::CounterFinite(Distance::Corrected),
        Method::CounterFinite(Distance::Range),
        Method::Brute,
        Method::Crow,
        Method::Extrude(Normals::Neighbours),
        Method::Extrude(Normals::FaceWeights),
        Method::Extrude(Normals::VertexWeights),
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
            Method::CounterFinite(Distance::Corrected) => "counter-finite".into(),
            Method::CounterFinite(Distance::Range) => "counter-finite-naive".into(),
            Method::Brute => "brute".into(),
            Method::Crow => "crow".into(),
            Method::Extrude(Normals::Neighbours) => "extrude".into(),
            Method::Extrude(Normals::FaceWeights) => "extrude-face-weights".into(),
            Method::Extrude(Normals::VertexWeights) => "extrude-vertex-weights".into(),
            Method::None => "none".into(),
        }
    }

    /// Whether it promises the oracle's shadows: one wrong pixel-light is a failure.
    pub fn is_exact(self) -> bool {
        match self {
            Method::Counter | Method::CounterZFail | Method::Brute => true,
            Method::CounterFinite(distance) => distance == Distance::Corrected,
            Method::Crow | Method::Extrude(_) | Method::None => false,
        }
    }

    /// The volumes that the CPU builds for it, if it draws any.
    pub fn recipe(self) -> Option<Recipe> {
        let counter = Recipe::default();
        match self {
            Method::Counter => Some(counter),
            Method::CounterZFail => Some(Recipe {
                path: PathRule::ZFailAlways,
                ..counter
            }),
            Method::CounterFinite(distance) => Some(Recipe {
                extrusion: Extrusion::Finite(distance),
                ..counter
            }),
            Method::Brute => Some(Recipe {
                construction: Construction::Brute,
                ..counter
            }),
            Method::Crow => Some(Recipe {
                construction: Construction::Crow,
                ..counter
            }),
            Method::Extrude(_) | Method::None => None,
        }
    }
}

/// How volumes are built and drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recipe {
    /// What makes their quads.
    pub construction: Construction,
    /// Where they end.
    pub extrusion: Extrusion,
    /// How they are counted.
    pub path: PathRule,
}

impl Default for Recipe {
    /// That of [`Method::Counter`].
    fn default() -> Self {
        Self {
            construction: Construction::Counter,
            extrusion: Extrusion::Infinite,
            path: PathRule::ZPassWhereExact,
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
