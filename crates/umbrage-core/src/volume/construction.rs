//! Ways from a chain to quads, for comparison: one call for all of them.

use super::{Chain, Crow, LayerLimit, Quad, brute, counter};
use crate::world::World;

/// How a chain becomes quads. All go through the same query, facing, sorting by range, cache, eye
/// count, plan and caps.
///
/// The steps that drop hidden casters belong to the counter: a baseline has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Construction {
    /// Signed edge counters: the boundary of the chain, and no more.
    #[default]
    Counter,
    /// Three quads for every triangle of the chain. Exact, and five times the quads on game maps.
    Brute,
    /// Edges with two face pointers. Right on two-manifolds; elsewhere a volume may be open, which
    /// [`Volumes::check_closed`](super::Volumes::check_closed) tells, and shadows be wrong.
    Crow,
}

/// A construction with what it knows of the world.
pub(super) struct Makes<'a> {
    pub(super) construction: Construction,
    /// Up to date if the construction is [`Construction::Crow`].
    pub(super) crow: &'a Crow,
    /// What parts are made for.
    pub(super) layers: LayerLimit,
}

impl Makes<'_> {
    /// Appends the quads of `chain`; `marks` must fit.
    pub(super) fn quads(
        &self,
        world: &World,
        chain: &[Chain],
        marks: &mut Marks,
        quads: &mut Vec<Quad>,
    ) {
        match self.construction {
            Construction::Counter => {
                counter(world, chain, &mut marks.counters, &mut marks.touched, quads);
            }
            Construction::Brute => {
                brute(&world.edges, chain.iter().flat_map(Chain::triangles), quads);
            }
            Construction::Crow => {
                self.crow
                    .silhouette(world, chain, &mut marks.coefficients, quads);
            }
        }
    }
}

/// What a construction notes of edges and triangles on its way; zero before and after.
#[derive(Debug, Default)]
pub(super) struct Marks {
    counters: Vec<i32>,
    touched: Vec<Quad>,
    coefficients: Vec<i8>,
}

impl Marks {
    /// Makes room for a world.
    pub(super) fn fit(&mut self, world: &World, construction: Construction) {
        match construction {
            Construction::Counter => self.counters.resize(world.edges.vertices.len(), 0),
            Construction::Brute => {}
            Construction::Crow => self.coefficients.resize(world.triangles.len(), 0),
        }
    }
}
