//! How far from the light a finite volume ends.
//!
//! Takes a light with the quads and caps that are drawn for it; gives the distance from the light to
//! which a vertex `p` is moved along its ray, `light + max(distance, |p - light|) (p - light) / |p -
//! light|`. Infinite where no finite distance serves.
//!
//! A finite volume is right only if nothing of its end reaches into the light's range. Vertices moved
//! to the range itself (Brennan, ShaderX 2002; likewise the fixed distance of the depth-fail
//! tutorials) keep to it, but what joins them does not: the chord between two of them dips inside,
//! the more the wider it is as the light sees it ([`Distance::Range`]). The 2004 paper asks for the
//! right thing, "enough for the individual polygons to be outside the radius" (section 2).
//!
//! **The bound** ([`Distance::Corrected`]). Let `v_i = r_i u_i` be the moved corners of an edge or a
//! triangle relative to the light, `r_i >= D`, `u_i` of length 1, and `n` any unit vector with `c =
//! min u_i . n > 0`. A point between them is `x = sum l_i v_i` with `l_i >= 0`, `sum l_i = 1`, so
//! `|x| >= x . n = sum l_i r_i (u_i . n) >= D c`. With `D = R / c` it is not within the range `R`. The
//! best `n` of an edge that subtends `a` is the bisector, `c = cos(a / 2)`; that of a triangle is
//! the axis of the smallest cone around it, which is the circumscribed one or that of its widest side.
//! `c` is computed from `n` as it is, rounded or not, so nothing rests on how good `n` is; what is left
//! is the rounding of the products, some 2^-50.
//!
//! A shader moves vertices in f32: directions are off by at most 2^-21, which takes 2^-21 / c off the
//! bound, and positions by 2^-22 of the distances involved. A slack of 2^-10 is above both for `c` of at
//! least [`LEAST_COSINE`]; an edge that subtends more, and a light that shines without end, are
//! extruded to infinity.

use glam::DVec3;

use crate::light::Light;
use crate::volume::{Chain, Quad, SLACK, Volumes};
use crate::world::World;

/// Where volumes end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Extrusion {
    /// At infinity: right for every light and view.
    #[default]
    Infinite,
    /// At a distance from the light. Directional lights' volumes stay infinite.
    Finite(Distance),
}

/// How far a finite volume reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Distance {
    /// Each vertex to the light's range: wrong where an edge or cap subtends much.
    Range,
    /// So far that no far edge and no dark cap comes within the range.
    Corrected,
}

/// Below this cosine a distance is not trusted: 256 times the range.
pub const LEAST_COSINE: f64 = 1.0 / 256.0;

impl Distance {
    /// The distance for what has this least cosine, in metres; infinite where there is none.
    pub fn of(self, light: &Light, least_cosine: f64) -> f32 {
        let range = f64::from(light.range);
        if light.is_directional() || !range.is_finite() {
            return f32::INFINITY;
        }
        match self {
            Distance::Range => light.range,
            Distance::Corrected if least_cosine < LEAST_COSINE => f32::INFINITY,
            Distance::Corrected => {
                // Far from the world's origin an f32 place is known to 2^-24 of that.
                let place = light.position.abs().max_element();
                ((range * (1.0 + SLACK) + place / (1 << 20) as f64) / least_cosine) as f32
            }
        }
    }
}

/// The least cosine of the far edges of `quads`: of half the widest angle that one of them subtends.
pub fn sides_cosine(world: &World, light: &Light, quads: &[Quad]) -> f64 {
    let light = light.position;
    let cosine = |quad: &Quad| {
        let ends = quad.ends(&world.edges);
        let rays = ends.map(|v| ray(light, world.places().at(v)));
        cosine_about(rays[0] + rays[1], &rays)
    };
    quads.iter().map(cosine).fold(1.0, f64::min)
}

/// The least cosine of the caps of `chain`: of the widest half angle of a cone around one of them.
pub fn caps_cosine(world: &World, light: &Light, chain: &[Chain]) -> f64 {
    let light = light.position;
    let triangles = chain.iter().flat_map(Chain::triangles);
    let cosine = |corners: [DVec3; 3]| {
        let rays = corners.map(|p| ray(light, p));
        let [a, b, c] = rays;
        let normal = (b - a).cross(c - a);
        let axes = [normal * normal.dot(a).signum(), a + b, b + c, c + a];
        axes.map(|axis| cosine_about(axis, &rays))
            .into_iter()
            .fold(0.0, f64::max)
    };
    triangles
        .map(|t| cosine(world.corners(t.triangle())))
        .fold(1.0, f64::min)
}

/// The least cosine between an axis of any length and rays; 0 if the axis is none.
fn cosine_about(axis: DVec3, rays: &[DVec3]) -> f64 {
    let axis = axis.normalize_or_zero();
    rays.iter().map(|ray| ray.dot(axis)).fold(1.0, f64::min)
}

/// Unit direction from the light to `p`; zero where f32 has none.
fn ray(light: DVec3, p: DVec3) -> DVec3 {
    (p - light).normalize_or_zero()
}

/// What of a light's volume is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawn {
    /// That many of its quads, from the front of its list.
    Sides(u32),
    /// All quads and both caps.
    Whole,
}

/// Least cosines of the last plan, by the stamp of each light's volume and what was drawn of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Cosines(Vec<(u64, Drawn, f64)>);

impl Cosines {
    /// Makes room.
    pub(super) fn fit(&mut self, lights: usize) {
        self.0.resize(lights, (0, Drawn::Whole, 0.0));
    }

    /// How far light number `number` is extruded.
    pub(super) fn distance(
        &mut self,
        extrusion: Extrusion,
        world: &World,
        light: &Light,
        volumes: &Volumes,
        number: usize,
        drawn: Drawn,
    ) -> f32 {
        let Extrusion::Finite(distance) = extrusion else {
            return f32::INFINITY;
        };
        let stamp = volumes.lights[number].stamp;
        let known = &mut self.0[number];
        let wanted = distance == Distance::Corrected && !light.is_directional();
        if wanted && (known.0, known.1) != (stamp, drawn) {
            let quads = volumes.quads_of(number);
            let cosine = match drawn {
                Drawn::Sides(count) => sides_cosine(world, light, &quads[..count as usize]),
                Drawn::Whole => sides_cosine(world, light, quads).min(caps_cosine(
                    world,
                    light,
                    volumes.chain_of(number),
                )),
            };
            *known = (stamp, drawn, cosine);
        }
        distance.of(light, known.2)
    }
}

/// Whether the eye is outside the light's range, where finite volumes end.
pub(super) fn is_beyond_range(light: &Light, eye: DVec3) -> bool {
    let distance = (eye - light.position).length();
    !light.is_directional() && distance > f64::from(light.range)
}
