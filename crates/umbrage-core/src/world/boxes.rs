//! Boxes of single triangles, 64 at a time, for queries.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::clusters::LANES;
use crate::place::Places;

/// Lower and upper corners of the boxes of 64 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct BoxCluster {
    /// Lower x, y, z.
    pub min: [[f32; LANES]; 3],
    /// Upper x, y, z.
    pub max: [[f32; LANES]; 3],
}

/// Boxes of all triangles.
pub(super) fn boxes(places: Places<'_>, triangles: &[[u32; 3]]) -> Vec<BoxCluster> {
    let cluster = |triangles: &[[u32; 3]]| box_cluster(places, triangles);
    triangles.par_chunks(LANES).map(cluster).collect()
}

/// Boxes of at most 64 triangles; missing lanes are empty boxes far away.
pub(super) fn box_cluster(places: Places<'_>, triangles: &[[u32; 3]]) -> BoxCluster {
    let mut boxes = BoxCluster {
        min: [[f32::INFINITY; LANES]; 3],
        max: [[f32::INFINITY; LANES]; 3],
    };
    for (lane, t) in triangles.iter().enumerate() {
        let [low, high] = places.bounds(*t);
        for axis in 0..3 {
            boxes.min[axis][lane] = low[axis];
            boxes.max[axis][lane] = high[axis];
        }
    }
    boxes
}
