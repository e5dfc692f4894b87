//! Plain triangles, as a host hands them over.

use bytemuck::{CheckedBitPattern, NoUninit};
use glam::{DVec3, Vec3};

use crate::place::{Places, split};

/// Which sides of a triangle cast shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, CheckedBitPattern, NoUninit)]
#[repr(u8)]
pub enum Casting {
    /// Casts nothing.
    None = 0,
    /// Casts where its front (counter-clockwise side) faces the light: glTF single-sided.
    #[default]
    Front = 1,
    /// Casts whichever side faces the light: glTF `doubleSided`.
    Both = 2,
    /// Casts where its back faces the light: volumes from the faces turned away
    /// (Aldridge and Woods 2004, section 2, figure 2). On a closed mesh their sides are those of
    /// [`Casting::Front`], and outside of it so are their shadows; see [`volume`](crate::volume).
    Back = 3,
}

impl Casting {
    /// The coefficient of a triangle in the chain whose boundary the counters are:
    /// +1 taken as wound, -1 taken with reversed winding, 0 left out.
    ///
    /// `facing` is the side of the triangle's plane that the light is on: +1 front, -1 back,
    /// 0 in the plane.
    #[inline]
    pub fn coefficient(self, facing: i8) -> i8 {
        match self {
            Casting::None => 0,
            Casting::Front => facing.max(0),
            Casting::Both => facing,
            Casting::Back => facing.min(0),
        }
    }
}

/// A triangle soup: any winding, any connectivity, duplicates and holes allowed.
///
/// Positions are world space, in metres, relative to an origin that the host keeps. Those that f32
/// cannot hold come with [`Mesh::residuals`]; [`Mesh::stand`] makes both from f64.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions; equal positions may appear many times.
    pub positions: Vec<Vec3>,
    /// What f32 leaves of each position: a vertex stands at the sum. Empty where f32 holds them all.
    pub residuals: Vec<Vec3>,
    /// Three indices into `positions` a triangle; counter-clockwise seen from its front.
    pub triangles: Vec<[u32; 3]>,
    /// One rule a triangle.
    pub casting: Vec<Casting>,
}

impl Mesh {
    /// Where the vertices stand.
    #[inline]
    pub fn places(&self) -> Places<'_> {
        Places {
            positions: &self.positions,
            residuals: &self.residuals,
        }
    }

    /// The three corners of triangle `t`.
    #[inline]
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.places().at(v))
    }

    /// Moves vertices from `first` on to f64 places: to 48 bits if the mesh has residuals, else to f32.
    pub fn put(&mut self, first: usize, places: impl IntoIterator<Item = DVec3>) {
        for (v, p) in (first..).zip(places) {
            let [position, residual] = split(p);
            self.positions[v] = position;
            if let Some(old) = self.residuals.get_mut(v) {
                *old = residual;
            }
        }
    }

    /// Replaces positions and residuals by those of f64 places, to 48 bits each. There are no
    /// residuals if f32 holds every place.
    pub fn stand(&mut self, places: impl IntoIterator<Item = DVec3>) {
        let both = places.into_iter().map(|p| <(Vec3, Vec3)>::from(split(p)));
        (self.positions, self.residuals) = both.collect();
        if self.residuals.iter().all(|r| *r == Vec3::ZERO) {
            self.residuals.clear();
        }
    }
}
