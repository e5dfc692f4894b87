//! How many casters of one light a ray from it can cross, and what becomes of a light with too many.
//!
//! Takes a light and its chain; gives a bound on its *layers*, the count at any point: each triangle
//! of the chain that the light's ray to the point crosses adds one, whichever way it is wound. A
//! stencil of eight bits takes 256 of them for none. A light that may reach that is split into
//! *parts*, chains of their own, each with few enough layers for the bits that count it. The volume
//! of any chain is closed, and a point is in shadow if it is in that of a part.
//!
//! **The bound.** The rays of a point light are the points of the six faces of a cube around it,
//! those of a directional light the points of a map across it. Of every triangle a rectangle on each
//! face is known that holds the rays which meet it. Cut a face into cells, and count for each the
//! rectangles that touch it: a ray crosses no more triangles than its cell has. So the largest count
//! bounds the layers; so does that of cells cut from a cell with too many, in place of its own; and
//! the number of triangles in the chain, which is all that most lights need. A cell's number is a
//! monotonous function of a coordinate, computed alike for rectangles and rays; rectangles are
//! padded by [`PAD`], which is far above what rounding does to a coordinate.
//!
//! **Where it is loose.** Of 256 triangles around one vertex each touches the cell of the vertex. Such
//! a light is split for nothing, which costs time and no shadow.

mod clusters;
mod projection;
mod refine;
mod split;

use self::clusters::{Seen, see};
use self::projection::Projection;
use self::refine::{Item, Refining, Window};
use super::{Chain, ChainTriangle};
use crate::light::Light;
use crate::world::World;

/// How many layers the mask can hold in which a host counts volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LayerLimit {
    /// Of a light that is counted in one go.
    pub whole: u32,
    /// Of each part of a light that has more; at least 1.
    pub part: u32,
}

impl LayerLimit {
    /// A stencil of eight bits, of which one remembers the parts that were counted before.
    pub const STENCIL: Self = Self {
        whole: 255,
        part: 127,
    };
    /// None: lights are never split.
    pub const NONE: Self = Self {
        whole: u32::MAX,
        part: u32::MAX,
    };
}

impl Default for LayerLimit {
    fn default() -> Self {
        Self::STENCIL
    }
}

/// Added to rectangles on every side, as a share of the face.
const PAD: f64 = 1e-9;

/// How often a cell is cut again.
const LEVELS: u32 = 5;

/// Scratch; keep it between lights.
#[derive(Debug, Default)]
pub(super) struct Layers {
    seen: Vec<Seen>,
    casters: Vec<ChainTriangle>,
    items: Vec<Item>,
    split: split::Split,
}

impl Layers {
    /// A bound on the layers of `chain`, as tight as it takes to be at most `most`.
    pub(super) fn bound(
        &mut self,
        world: &World,
        light: &Light,
        chain: &[Chain],
        most: u32,
    ) -> u32 {
        let casters = chain.iter().map(Chain::len).sum::<usize>() as u32;
        if casters <= most {
            return casters;
        }
        see(world, light, chain, &mut self.seen);
        let layers = self.seen.iter().map(|seen| seen.layers).sum();
        if layers <= most {
            return layers;
        }
        let projection = Projection::new(world, light, chain, &self.seen);
        let mut bound = 0;
        for face in projection.faces() {
            projection.clusters(face, &mut self.items);
            let mut layers = Refining::new(most, 1, |_, _| true, |_| ()).bound(&self.items);
            if layers > most {
                projection.triangles(face, &mut self.casters, &mut self.items);
                let touches = |item: &Item, window: &Window| {
                    projection.touches(face, self.casters[item.number as usize], window)
                };
                let mut refining = Refining::new(most, LEVELS, touches, |_| ());
                layers = layers.min(refining.bound(&self.items));
            }
            bound = bound.max(layers);
        }
        bound.min(casters)
    }
}
