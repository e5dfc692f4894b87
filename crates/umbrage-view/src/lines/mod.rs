//! Lines in space: what the debug views draw over the picture, as plain data.
//!
//! Takes a world, lights and their volumes; gives segments relative to an anchor near the eye, so
//! that f32 holds them wherever the world stands.

mod draw;

use glam::{DVec3, Vec3};
use umbrage_core::volume::{Quad, Volumes};
use umbrage_core::world::{Layer, Reach, Subset, World, query};
use umbrage_core::{Light, LightShape};

pub(crate) use draw::LinePass;

/// A segment.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Line {
    /// From the anchor.
    pub(crate) from: Vec3,
    pub(crate) to: Vec3,
    /// Red, green, blue, alpha, as on the screen.
    pub(crate) color: [u8; 4],
}

/// Segments that stand relative to one place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    pub(crate) anchor: DVec3,
    pub(crate) lines: Vec<Line>,
}

pub(crate) const ZPASS: [u8; 4] = [70, 230, 90, 160];
pub(crate) const ZFAIL: [u8; 4] = [255, 70, 60, 160];
/// Of edges whose counter is 1, 2, 3, and more, either way.
pub(crate) const MULTIPLICITY: [[u8; 4]; 4] = [
    [240, 240, 240, 255],
    [255, 225, 40, 255],
    [255, 140, 20, 255],
    [255, 40, 40, 255],
];
const BOX: [u8; 4] = [90, 200, 255, 120];
pub(crate) const CASTER: [u8; 4] = [255, 165, 60, 230];
pub(crate) const OTHER: [u8; 4] = [80, 130, 255, 150];
/// A node with no more triangles is drawn; those above it are not.
const TRIANGLES_A_BOX: u32 = 64;

impl Lines {
    pub(crate) fn new(anchor: DVec3) -> Self {
        Self {
            anchor,
            lines: Vec::new(),
        }
    }

    fn push(&mut self, from: DVec3, to: DVec3, color: [u8; 4]) {
        let [from, to] = [from, to].map(|p| (p - self.anchor).as_vec3());
        self.lines.push(Line { from, to, color });
    }

    /// The four edges of each quad of a light's volume. Sides end at its range; those of a light
    /// without one, where the world does.
    pub(crate) fn volume(&mut self, world: &World, light: &Light, quads: &[Quad], color: [u8; 4]) {
        let across = bounds(world).map(|[low, high]| low.distance(high));
        let length = f64::from(light.range.min(across.unwrap_or(0.0)));
        let far = |p: DVec3| match light.shape {
            LightShape::Directional { direction } => {
                p + direction.as_dvec3() * f64::from(across.unwrap_or(0.0))
            }
            _ => {
                let ray = p - light.position;
                let distance = ray.length().max(f64::MIN_POSITIVE);
                light.position + ray * (length / distance).max(1.0)
            }
        };
        for quad in quads {
            let [a, b] = ends(world, *quad);
            let [far_a, far_b] = [far(a), far(b)];
            for (from, to) in [(a, b), (a, far_a), (b, far_b), (far_a, far_b)] {
                self.push(from, to, color);
            }
        }
    }

    /// Each silhouette edge once, in the colour of its counter.
    pub(crate) fn silhouettes(&mut self, world: &World, quads: &[Quad]) {
        let mut sorted = quads.to_vec();
        sorted.sort_unstable_by_key(|quad| quad.0.edge());
        for units in sorted.chunk_by(|a, b| a.0.edge() == b.0.edge()) {
            let [a, b] = ends(world, units[0]);
            self.push(
                a,
                b,
                MULTIPLICITY[(units.len() - 1).min(MULTIPLICITY.len() - 1)],
            );
        }
    }

    /// The largest BVH nodes of up to 64 triangles that the light may reach, and larger leaves.
    pub(crate) fn boxes(&mut self, world: &World, light: &Light) {
        let reach = Reach::new(light);
        let mut stack: Vec<u32> = [Layer::Fixed, Layer::Objects]
            .into_iter()
            .flat_map(|layer| world.roots(layer))
            .collect();
        while let Some(number) = stack.pop() {
            let node = &world.bvh.nodes[number as usize];
            if !reach.touches_box([node.min, node.max]) {
                continue;
            }
            match node.is_leaf() || node.count <= TRIANGLES_A_BOX {
                true => self.one_box([node.min, node.max]),
                false => stack.extend([number + 1, node.second]),
            }
        }
    }

    fn one_box(&mut self, corners: [Vec3; 2]) {
        let corner = |bits: usize| {
            let pick = |axis: usize| corners[bits >> axis & 1][axis];
            Vec3::new(pick(0), pick(1), pick(2)).as_dvec3()
        };
        for bits in 0..8_usize {
            for axis in (0..3).filter(|axis| bits >> axis & 1 == 0) {
                self.push(corner(bits), corner(bits | 1 << axis), BOX);
            }
        }
    }

    /// The edges of each triangle that the light's query returns; casters, which are those of its
    /// chain, apart from the others.
    pub(crate) fn subset(
        &mut self,
        world: &World,
        light: &Light,
        volumes: &Volumes,
        number: usize,
    ) {
        let casters: Vec<u32> = volumes
            .chain_triangles(number)
            .map(umbrage_core::volume::ChainTriangle::triangle)
            .collect();
        let mut subset = Subset::default();
        let mut others = Vec::new();
        for layer in [Layer::Fixed, Layer::Objects] {
            query(world, layer, light, &mut subset);
            others.extend(
                subset
                    .triangles()
                    .filter(|t| casters.binary_search(t).is_err()),
            );
        }
        // Casters last: they stand before what shares an edge with them.
        for (triangles, color) in [(&others, OTHER), (&casters, CASTER)] {
            for &triangle in triangles {
                let [a, b, c] = world.corners(triangle);
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    self.push(from, to, color);
                }
            }
        }
    }
}

fn ends(world: &World, quad: Quad) -> [DVec3; 2] {
    quad.ends(&world.edges).map(|v| world.places().at(v))
}

/// A box around all triangles; nothing in an empty world.
pub(crate) fn bounds(world: &World) -> Option<[Vec3; 2]> {
    [Layer::Fixed, Layer::Objects]
        .into_iter()
        .flat_map(|layer| world.roots(layer))
        .map(|root| &world.bvh.nodes[root as usize])
        .map(|node| [node.min, node.max])
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

#[cfg(test)]
mod tests;
