//! The triangles that a light's map shows: those in its range that cast, by the exact facing test
//! that volumes are built with, sorted by the face they can be in.

use std::ops::Range;

use rayon::prelude::*;
use umbrage_core::Light;
use umbrage_core::volume::{Chain, ChainTriangle, facing};
use umbrage_core::world::{Layer, Subset, World, query};

use super::face::Face;

/// Casters of one light.
#[derive(Clone, Debug, Default)]
pub(super) struct Casters {
    /// Numbers in the world, face after face; one may be in several faces.
    pub(super) triangles: Vec<u32>,
    /// Each face's share.
    pub(super) faces: Vec<Range<u32>>,
}

/// What a query needs, reused from light to light.
#[derive(Default)]
struct Scratch {
    subset: Subset,
    chain: Vec<Chain>,
}

/// Casters of several lights with the faces of their maps, in parallel.
pub(super) fn casters(world: &World, lights: &[(&Light, &[Face])]) -> Vec<Casters> {
    let of = |scratch: &mut Scratch, (light, faces): &(&Light, &[Face])| {
        let Scratch { subset, chain } = scratch;
        chain.clear();
        for layer in [Layer::Fixed, Layer::Objects] {
            query(world, layer, light, subset);
            facing(world, light, subset, chain);
        }
        let mut found = Casters::default();
        for face in *faces {
            let first = found.triangles.len() as u32;
            let casting = chain.iter().flat_map(Chain::triangles);
            found.triangles.extend(
                casting
                    .map(ChainTriangle::triangle)
                    .filter(|&t| face.meets(world.corners(t).map(glam::DVec3::as_vec3))),
            );
            found.faces.push(first..found.triangles.len() as u32);
        }
        found
    };
    lights.par_iter().map_init(Scratch::default, of).collect()
}
