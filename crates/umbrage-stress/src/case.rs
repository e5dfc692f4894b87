//! One placement to try: triangles, lights and views.
//!
//! Takes what a family drew from its random numbers; gives plain data that both checks and the
//! shrinker work on. The one place where lights and views are made, so that a change of their types
//! ends here.

use std::fmt;
use std::str::FromStr;

use glam::{DVec3, Vec3};
use thiserror::Error;
use umbrage_core::{Casting, Light, LightShape, Mesh, View};

/// Pictures of rendered cases.
pub const SIZE: [u32; 2] = [64, 48];

/// What one case is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Case {
    /// Triangles.
    pub mesh: Mesh,
    /// Lights.
    pub lights: Vec<Light>,
    /// Views.
    pub views: Vec<View>,
    /// Where the node stands from which a file places the vertices. Everything else here is relative
    /// to zero.
    pub origin: DVec3,
    /// Points asked for beside the sampled ones.
    pub points: Vec<DVec3>,
    /// Seeds the sampled points.
    pub sampling: u64,
}

/// The name of a case: it comes back with its family and seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CaseId {
    /// Index into [`FAMILIES`](crate::families::FAMILIES).
    pub family: usize,
    /// Of its random numbers.
    pub seed: u64,
}

/// A text that names no case.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "{text:?} is no case: give FAMILY:SEED as the report names it, with one of the families {families}"
)]
pub struct NoCase {
    text: String,
    families: String,
}

impl fmt::Display for CaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = crate::families::FAMILIES[self.family].name;
        write!(f, "{name}:{:x}", self.seed)
    }
}

impl FromStr for CaseId {
    type Err = NoCase;

    fn from_str(text: &str) -> Result<Self, NoCase> {
        let parse = || {
            let (name, seed) = text.split_once(':')?;
            Some(Self {
                family: crate::families::named(name)?,
                seed: u64::from_str_radix(seed, 16).ok()?,
            })
        };
        parse().ok_or_else(|| NoCase {
            text: text.to_owned(),
            families: crate::families::names().join(", "),
        })
    }
}

impl CaseId {
    /// The case, the same every time.
    pub fn make(self) -> Case {
        let mut random = crate::rng::Random::new(self.seed);
        let mut case = (crate::families::FAMILIES[self.family].make)(&mut random);
        case.sampling = random.bits();
        case
    }
}

/// A light that shines all around.
pub fn point(position: Vec3, range: f32) -> Light {
    Light {
        position: position.as_dvec3(),
        range,
        shape: LightShape::Point,
    }
}

/// A cone about a direction of any length.
pub fn spot(position: Vec3, range: f32, direction: Vec3, cos_outer: f32) -> Light {
    Light {
        position: position.as_dvec3(),
        range,
        shape: LightShape::Spot {
            direction: direction.normalize(),
            cos_outer,
        },
    }
}

/// Parallel light along a direction of any length.
pub fn sun(direction: Vec3) -> Light {
    Light {
        position: DVec3::ZERO,
        range: f32::INFINITY,
        shape: LightShape::Directional {
            direction: direction.normalize(),
        },
    }
}

/// A view from `eye` towards `target`.
pub fn look(eye: impl Into<DVec3>, target: impl Into<DVec3>, near: f32) -> View {
    View::look_at(eye, target, 1.2, near, SIZE)
}

impl Case {
    /// Adds a triangle; its vertices are its own, equal positions are one to the world.
    pub fn triangle(&mut self, corners: [Vec3; 3], casting: Casting) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(corners);
        if !self.mesh.residuals.is_empty() {
            self.mesh.residuals.extend([Vec3::ZERO; 3]);
        }
        self.mesh.triangles.push([first, first + 1, first + 2]);
        self.mesh.casting.push(casting);
    }

    /// Adds a parallelogram: `at`, `at + u`, `at + u + v`, `at + v`.
    pub fn quad(&mut self, at: Vec3, u: Vec3, v: Vec3, casting: Casting) {
        let far = at + u + v;
        self.triangle([at, at + u, far], casting);
        self.triangle([at, far, at + v], casting);
    }

    /// The corners of triangle `t`, as f32 rounds them: what families draw from.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.mesh.corners(t).map(DVec3::as_vec3)
    }

    /// Lowest and highest corner of the box around the mesh; a unit box if it is empty.
    pub fn bounds(&self) -> [DVec3; 2] {
        let places = self.mesh.places();
        let places = || (0..self.mesh.positions.len() as u32).map(|v| places.at(v));
        match self.mesh.positions.is_empty() {
            true => [DVec3::ZERO, DVec3::ONE],
            false => [
                places().fold(DVec3::INFINITY, DVec3::min),
                places().fold(DVec3::NEG_INFINITY, DVec3::max),
            ],
        }
    }

    /// Length of the diagonal of that box.
    pub fn size(&self) -> f32 {
        let [low, high] = self.bounds();
        (high - low).as_vec3().length().max(f32::MIN_POSITIVE)
    }
}
