//! The families of cases: each a kind of geometry or placement in which shadow volumes break.
//!
//! Takes random numbers; gives a [`Case`]. One file a theme. A case is small, so that a hundred
//! thousand of them are checked in minutes and a failure is nearly minimal as it is found.

mod closed;
mod coplanar;
mod eyes;
mod layers;
mod numbers;
mod placed;
mod soup;
mod touching;

use crate::case::Case;
use crate::rng::Random;

/// One kind of case.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name in options and reports.
    pub name: &'static str,
    /// What is in it, in a line.
    pub about: &'static str,
    /// The case of a stream of random numbers.
    pub make: fn(&mut Random) -> Case,
}

const fn family(name: &'static str, about: &'static str, make: fn(&mut Random) -> Case) -> Family {
    Family { name, about, make }
}

/// All of them.
pub const FAMILIES: [Family; 17] = [
    family(
        "soup",
        "triangles between few points: any number on an edge, any winding, self-intersecting",
        soup::soup,
    ),
    family(
        "fans",
        "1 to 12 triangles on an edge, duplicates",
        soup::fans,
    ),
    family(
        "casting",
        "front, back, both and none mixed on shared edges",
        soup::casting,
    ),
    family(
        "overlaps",
        "coplanar overlaps, duplicates, turned duplicates, T-junctions",
        coplanar::overlaps,
    ),
    family(
        "lattice",
        "everything on a lattice of few points: lights, eyes and vertices in common planes",
        coplanar::lattice,
    ),
    family("slivers", "triangles of aspect up to 1e7", numbers::slivers),
    family("scales", "worlds of 1e-6 to 1e6 m", numbers::scales),
    family("far", "f32 coordinates up to 1e7 m from zero", numbers::far),
    family(
        "origins",
        "f64 places up to 1e7 m from zero, details down to millimetres",
        numbers::origins,
    ),
    family(
        "lights-on",
        "lights on vertices, on edges, on faces, in the planes of triangles",
        touching::on,
    ),
    family(
        "lights-beside",
        "lights one ulp to either side of vertices, edges and planes, and some hundreds off",
        touching::beside,
    ),
    family(
        "closed",
        "nested and intersecting closed meshes, lights inside",
        closed::closed,
    ),
    family(
        "shapes",
        "spots, suns and points of ranges from everything to nothing",
        placed::shapes,
    ),
    family(
        "eyes",
        "eyes on volume sides, in planes of quads and casters, at the light, one ulp off",
        eyes::eyes,
    ),
    family("near", "near planes that cut sides", eyes::near),
    family("layers", "20 to 255 layers", layers::layers),
    family("deep", "256 to 700 layers", layers::deep),
];

/// The names of all families.
pub fn names() -> Vec<&'static str> {
    FAMILIES.iter().map(|family| family.name).collect()
}

/// Index of a family.
pub fn named(name: &str) -> Option<usize> {
    FAMILIES.iter().position(|family| family.name == name)
}
