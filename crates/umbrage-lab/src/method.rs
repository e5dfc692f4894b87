//! The methods by name: every way of finding shadows that the lab knows.

use std::borrow::Cow;
use std::str::FromStr;

use thiserror::Error;
use umbrage_core::frame::{Distance, Extrusion, PathRule};
use umbrage_core::volume::Construction;

use crate::application::{Application, NoMask};

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
    /// Counter volumes counted by doubling and halving a mask instead of the stencil.
    Mask(MaskBuffer),
    /// Counter volumes counted at a lower resolution, the mask applied with bilinear filtering.
    LowResolution {
        /// What they are counted in.
        of: Counting,
        /// How much lower.
        divisor: Divisor,
    },
    /// A static buffer extruded by the vertex shader, for closed meshes (Brennan 2002).
    Extrude(Normals),
    /// Depth as each light sees it, compared: a cube, or one face for spots and directional lights.
    ShadowMap {
        /// Width and height of a face: [`MAP_TEXELS`], in steps of [`MAP_STEP`].
        texels: u32,
    },
    /// Any-hit rays over the world's BVH, in a compute shader.
    RayTrace,
    /// The oracle's verdicts, drawn.
    Oracle,
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

/// What counts volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Counting {
    /// The stencil.
    Stencil,
    /// A mask that is doubled and halved.
    Mask(MaskBuffer),
}

/// Where a mask is doubled and halved, and how it is normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MaskBuffer {
    /// In eight bits of its own, where three values stand for no layer, one, and more; normalised by
    /// three rectangles.
    Screen,
    /// In the alpha channel that lights add up beside, a float; normalised by three rectangles.
    Alpha,
    /// The same halved and doubled, normalised by one rectangle with the maximum blend equation.
    Max,
}

impl MaskBuffer {
    /// The layers that it can count up to before the values run out.
    pub fn layers(self) -> u32 {
        match self {
            // 1/4, 1/2, 1.
            MaskBuffer::Screen => 2,
            // From 1/2 to 2^15: the next power of two is no half float.
            MaskBuffer::Alpha => 16,
            // From 1 to 2^-14: the next power of two is a half float, but not a normal one.
            MaskBuffer::Max => 14,
        }
    }
}

/// By what the sides of the picture are divided, rounded up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Divisor {
    /// By two.
    Half,
    /// By four.
    Quarter,
}

impl Divisor {
    /// Pixels a texel of the mask is wide and high.
    pub fn pixels(self) -> u32 {
        match self {
            Divisor::Half => 2,
            Divisor::Quarter => 4,
        }
    }
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
    pub const ALL: [Method; 28] = [
        Method::Counter,
        Method::CounterZFail,
        Method::CounterFinite(Distance::Corrected),
        Method::CounterFinite(Distance::Range),
        Method::Brute,
        Method::Crow,
        Method::Mask(MaskBuffer::Screen),
        Method::Mask(MaskBuffer::Alpha),
        Method::Mask(MaskBuffer::Max),
        Self::low(Counting::Stencil, Divisor::Half),
        Self::low(Counting::Stencil, Divisor::Quarter),
        Self::low(Counting::Mask(MaskBuffer::Screen), Divisor::Half),
        Self::low(Counting::Mask(MaskBuffer::Screen), Divisor::Quarter),
        Self::low(Counting::Mask(MaskBuffer::Alpha), Divisor::Half),
        Self::low(Counting::Mask(MaskBuffer::Alpha), Divisor::Quarter),
        Self::low(Counting::Mask(MaskBuffer::Max), Divisor::Half),
        Self::low(Counting::Mask(MaskBuffer::Max), Divisor::Quarter),
        Method::Extrude(Normals::Neighbours),
        Method::Extrude(Normals::FaceWeights),
        Method::Extrude(Normals::VertexWeights),
        Method::ShadowMap { texels: 256 },
        Method::ShadowMap { texels: 512 },
        Method::ShadowMap { texels: 1024 },
        Method::ShadowMap { texels: 2048 },
        Method::ShadowMap { texels: 4096 },
        Method::RayTrace,
        Method::Oracle,
        Method::None,
    ];

    const fn low(of: Counting, divisor: Divisor) -> Self {
        Method::LowResolution { of, divisor }
    }

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
            Method::Mask(MaskBuffer::Screen) => "mask-screen".into(),
            Method::Mask(MaskBuffer::Alpha) => "mask-alpha".into(),
            Method::Mask(MaskBuffer::Max) => "mask-max".into(),
            Method::LowResolution { of, divisor } => {
                let divisor = match divisor {
                    Divisor::Half => "half",
                    Divisor::Quarter => "quarter",
                };
                match of {
                    Counting::Stencil => divisor.into(),
                    Counting::Mask(buffer) => {
                        format!("{}-{divisor}", Method::Mask(buffer).name()).into()
                    }
                }
            }
            Method::Extrude(Normals::Neighbours) => "extrude".into(),
            Method::Extrude(Normals::FaceWeights) => "extrude-face-weights".into(),
            Method::Extrude(Normals::VertexWeights) => "extrude-vertex-weights".into(),
            Method::ShadowMap { texels } => format!("shadowmap-{texels}").into(),
            Method::RayTrace => "raytrace".into(),
            Method::Oracle => "oracle".into(),
            Method::None => "none".into(),
        }
    }

    /// Whether it promises the oracle's shadows: one wrong pixel-light is a failure. A mask does so
    /// only where it can represent the layers: see [`Method::layers`].
    pub fn is_exact(self) -> bool {
        match self {
            Method::Counter
            | Method::CounterZFail
            | Method::Brute
            | Method::RayTrace
            | Method::Oracle => true,
            Method::CounterFinite(distance) => distance == Distance::Corrected,
            Method::Crow
            | Method::Mask(_)
            | Method::LowResolution { .. }
            | Method::Extrude(_)
            | Method::ShadowMap { .. }
            | Method::None => false,
        }
    }

    /// Whether it draws worlds with residuals (see [`umbrage_core::place`]); else f32 must hold the world.
    pub fn takes_residuals(self) -> bool {
        !matches!(self, Method::RayTrace | Method::ShadowMap { .. })
    }

    /// The most layers that its mask can represent on the way to a count, where it has a mask at
    /// full resolution.
    pub fn layers(self) -> Option<u32> {
        match self {
            Method::Mask(buffer) => Some(buffer.layers()),
            _ => None,
        }
    }

    /// What it counts volumes in, if it has any.
    pub fn counting(self) -> Counting {
        match self {
            Method::Mask(buffer) => Counting::Mask(buffer),
            Method::LowResolution { of, .. } => of,
            _ => Counting::Stencil,
        }
    }

    /// Whether it can leave this much of a light in its shadow.
    pub fn check(self, application: Application) -> Result<(), NoMask> {
        match (self, application) {
            (Method::Mask(_) | Method::LowResolution { .. }, _) | (_, Application::Black) => Ok(()),
            (method, application) => Err(NoMask {
                method,
                application,
            }),
        }
    }

    /// The volumes that the CPU builds for it, if it draws any.
    pub fn recipe(self) -> Option<Recipe> {
        let counter = Recipe::default();
        match self {
            Method::Counter | Method::Mask(_) | Method::LowResolution { .. } => Some(counter),
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
            Method::Extrude(_)
            | Method::ShadowMap { .. }
            | Method::RayTrace
            | Method::Oracle
            | Method::None => None,
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
        let texels = name.strip_prefix("shadowmap-").map(str::parse);
        if let Some(Ok(texels)) = texels
            && MAP_TEXELS.contains(&texels)
            && texels % MAP_STEP == 0
        {
            return Ok(Method::ShadowMap { texels });
        }
        let mut all = Self::ALL.into_iter();
        // "counter-half" says "half" in full.
        let short = name.strip_prefix("counter-");
        let short = short.filter(|rest| ["half", "quarter"].contains(rest));
        let wanted = short.unwrap_or(name);
        all.find(|method| method.name() == wanted)
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

    #[test]
    fn the_counter_at_a_lower_resolution_has_two_names() {
        assert_eq!("counter-half".parse::<Method>(), "half".parse());
        assert_eq!("counter-quarter".parse::<Method>(), "quarter".parse());
        assert!("counter-counter".parse::<Method>().is_err());
    }

    #[test]
    fn only_masks_leave_light_in_the_shadow() {
        for method in Method::ALL {
            let name = method.name();
            let masked = name.contains("mask") || name.contains("half") || name.contains("quarter");
            assert!(method.check(Application::Black).is_ok());
            for application in [Application::Ambient, Application::Attenuated] {
                assert_eq!(method.check(application).is_ok(), masked, "{name}");
            }
        }
        let refused = Method::Counter.check(Application::Ambient).unwrap_err();
        assert!(refused.to_string().contains("mask-alpha"), "{refused}");
    }
}
