//! Triangles to a [`World`]: welded vertices, unique edges, triangles in BVH leaf order.
//!
//! Takes a [`Mesh`]; gives a `World` in which every subtree of the BVH is a contiguous range of
//! triangles, edges are numbered by first use in that order, and **edges hold no pointers to
//! faces** (Aldridge and Woods 2004, section 2.3): triangles point to edges.

mod array;
mod boxes;
mod bvh;
mod clusters;
mod deform;
mod edges;
mod extent;
mod half_edges;
mod memory;
mod objects;
mod planes;
mod query;
mod save;
mod seen;
mod slots;
mod snap;
pub mod stages;
mod subset;
mod validate;
mod weld;

use std::time::Instant;

use glam::{DVec3, Vec3};
use thiserror::Error;

pub use array::Array;
pub use boxes::BoxCluster;
pub use bvh::{Bvh, Node};
pub use clusters::{Cluster, ClusterSide, LANES};
pub use edges::{EdgeUse, Edges};
pub use extent::Extent;
pub use memory::WorldMemory;
pub use objects::{Object, ObjectError, ObjectId, Pose};
pub use planes::{LightPoint, PlaneCluster, Planes, Side};
pub use query::{Layer, Reach, query};
pub use save::SavedWorldError;
#[doc(hidden)]
pub use save::reseal;
pub use seen::{Changes, Seen};
pub use subset::{Members, Subset};

pub(crate) use objects::EMPTY_BOX;
pub(crate) use planes::{NearLight, exact_side};
pub(crate) use subset::lanes;
pub use validate::WorldFault;

use self::stages::{Tree, Welded};
use crate::mesh::{Casting, Mesh};
use crate::place::Places;
use crate::stamp;

/// Why a mesh cannot become a world.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum WorldError {
    /// A list that must run parallel to the triangles does not.
    #[error("{casting} casting rules for {triangles} triangles: hand over one rule a triangle")]
    CastingLength {
        /// Rules given.
        casting: usize,
        /// Triangles given.
        triangles: usize,
    },
    /// An index points past the vertices.
    #[error(
        "triangle {triangle} uses vertex {vertex} of {vertices}: \
         remove the triangle or hand over the missing vertices"
    )]
    IndexOutOfRange {
        /// Offending triangle.
        triangle: usize,
        /// Its out-of-range index.
        vertex: u32,
        /// Vertices given.
        vertices: usize,
    },
    /// Residuals do not run parallel to the positions.
    #[error(
        "{residuals} residuals for {positions} positions: hand over none, or one a position, \
         as Mesh::stand does"
    )]
    ResidualsLength {
        /// Residuals given.
        residuals: usize,
        /// Positions given.
        positions: usize,
    },
    /// A position is NaN or infinite.
    #[error("vertex {vertex} is not finite: repair it before building a world")]
    NotFinite {
        /// Offending vertex.
        vertex: usize,
    },
    /// A position where 32 bits hold no distances any more.
    #[error(
        "vertex {vertex} lies beyond {limit:e} m: scale the mesh down, or move it to its origin"
    )]
    TooFar {
        /// Offending vertex.
        vertex: usize,
        /// Largest coordinate a world takes.
        limit: f32,
    },
    /// A tolerance that is none.
    #[error("a weld tolerance of {tolerance_m} m: give a finite length, zero or more")]
    Tolerance {
        /// As given.
        tolerance_m: f32,
    },
    /// More half edges than a u32 with a direction bit can number.
    #[error("{triangles} triangles in one world; the limit is {limit}: split it in cells")]
    TooManyTriangles {
        /// Triangles given.
        triangles: usize,
        /// Largest count one world takes.
        limit: usize,
    },
}

/// What was found while building, and what it cost.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WorldReport {
    /// Triangles kept.
    pub triangles: usize,
    /// Vertices handed over.
    pub vertices: usize,
    /// Distinct positions among them (-0 equals +0).
    pub welded_vertices: usize,
    /// Distinct vertex pairs that are an edge of a kept triangle.
    pub unique_edges: usize,
    /// Edges with 1, 2, 3 and 4 or more triangles.
    pub edges_by_triangles: [usize; 4],
    /// Edges with exactly two triangles that run the same way along it.
    pub opposite_wound_pairs: usize,
    /// Triangles dropped because two of their corners weld to one vertex. (A triangle with three
    /// distinct collinear corners has edges and is kept; no light ever faces it.)
    pub degenerate_triangles: usize,
    /// Kept triangles whose three vertices an earlier kept triangle also has, in any winding.
    pub duplicate_triangles: usize,
    /// Bytes of all world arrays, divided by kept triangles.
    pub bytes_per_triangle: f64,
    /// What the build cost.
    pub build_ms: BuildTimes,
}

/// Milliseconds a build stage took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildTimes {
    /// Equal positions found.
    pub weld: f64,
    /// Unique edges found.
    pub edges: f64,
    /// obvhs build.
    pub bvh: f64,
    /// Triangles and vertices renumbered, planes computed.
    pub order: f64,
    /// All of it.
    pub total: f64,
}

/// A world that lights can query: fixed triangles, and objects that can be added, moved and
/// removed. All arrays hold the fixed part first, then the objects.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Positions, numbered by first use in the fixed part and in each object; distinct but in objects
    /// that deform.
    pub positions: Array<Vec3>,
    /// What f32 leaves of each position (see [`place`](crate::place)); empty in a world that f32
    /// holds: then objects are rounded to f32 as well.
    pub residuals: Array<Vec3>,
    keeps_residuals: bool,
    /// Three vertices a triangle, as wound in the mesh, in BVH leaf order.
    pub triangles: Array<[u32; 3]>,
    /// The triangle's number in the mesh it was built from.
    pub source: Array<u32>,
    /// One rule a triangle.
    pub casting: Array<Casting>,
    /// Unique edges and each triangle's use of them.
    pub edges: Edges,
    /// What the counter needs to know inside each 64 triangles.
    pub clusters: Array<Cluster>,
    /// Plane equations of the triangles.
    pub planes: Planes,
    /// Boxes of the triangles.
    pub boxes: Array<BoxCluster>,
    /// Boxes over ranges of triangles: a tree over the fixed ones, and a tree an object.
    pub bvh: Bvh,
    /// The share of the fixed triangles.
    pub fixed: Extent,
    /// Slots for objects, free ones among them.
    pub objects: Vec<Object>,
    /// When the fixed part was built.
    pub fixed_stamp: u64,
    /// When the world last changed: two worlds with the same stamp are equal.
    pub stamp: u64,
    /// What was found.
    pub report: WorldReport,
}

/// Of what is in them; when that changed does not count.
impl PartialEq for World {
    fn eq(&self, other: &Self) -> bool {
        let places = |world: &Self| -> Vec<(Extent, [Vec3; 2])> {
            let objects = world.objects.iter();
            objects.map(|o| (o.extent.clone(), o.bounds)).collect()
        };
        self.positions == other.positions
            && self.residuals == other.residuals
            && self.triangles == other.triangles
            && self.source == other.source
            && self.casting == other.casting
            && self.edges == other.edges
            && self.clusters == other.clusters
            && self.planes == other.planes
            && self.boxes == other.boxes
            && self.bvh == other.bvh
            && self.fixed == other.fixed
            && places(self) == places(other)
            && self.report == other.report
    }
}

impl World {
    /// Largest number of triangles in one world: three half edges each must fit 31 bits.
    pub const MAX_TRIANGLES: usize = (1 << 31) / 3;

    /// Largest coordinate of a vertex, in metres: squared distances and areas, which trees and
    /// queries compare, stay finite in f32.
    pub const MAX_COORDINATE: f32 = (1u64 << 60) as f32;

    /// Builds a world. Deterministic; in debug builds every invariant is checked.
    pub fn build(mesh: &Mesh) -> Result<Self, WorldError> {
        check_input(mesh)?;
        let (world, _) = Self::build_welded(mesh, stages::weld);
        #[cfg(debug_assertions)]
        if let Err(fault) = world.validate() {
            panic!("World::build broke an invariant: {fault}");
        }
        Ok(world)
    }

    /// Names what triangles there are, wherever they stand: the same for as long as the fixed part
    /// is the same and no object comes or goes.
    pub fn topology(&self) -> Vec<u64> {
        let placed = self.objects.iter().map(|object| object.placed);
        std::iter::once(self.fixed_stamp).chain(placed).collect()
    }

    /// Builds a world of a mesh that was checked; `weld` says which vertices are one.
    fn build_welded(mesh: &Mesh, weld: impl FnOnce(&Mesh) -> Welded) -> (Self, Welded) {
        let start = Instant::now();
        let mut clock = Stopwatch(start);
        let mut report = WorldReport {
            vertices: mesh.positions.len(),
            ..WorldReport::default()
        };

        let welded = weld(mesh);
        report.welded_vertices = welded.count;
        report.triangles = welded.kept.len();
        report.degenerate_triangles = mesh.triangles.len() - welded.kept.len();
        report.build_ms.weld = clock.lap();

        let Tree { bvh, source } = stages::tree(mesh, &welded);
        report.build_ms.bvh = clock.lap();

        let ordered = stages::order(mesh, &welded, &source);
        report.build_ms.order = clock.lap();

        let joined = stages::edges(&ordered);
        report.unique_edges = joined.counts.edges;
        report.edges_by_triangles = joined.counts.by_triangles;
        report.opposite_wound_pairs = joined.counts.opposite_wound_pairs;
        report.duplicate_triangles = joined.counts.duplicate_triangles;
        report.build_ms.edges = clock.lap();

        let mut world = Self {
            positions: ordered.positions.into(),
            keeps_residuals: !mesh.residuals.is_empty(),
            residuals: ordered.residuals.into(),
            triangles: ordered.triangles.into(),
            source: source.into(),
            casting: ordered.casting.into(),
            edges: joined.edges,
            clusters: joined.clusters.into(),
            planes: ordered.planes,
            boxes: ordered.boxes.into(),
            bvh,
            report,
            ..Self::default()
        }
        .without_objects();
        world.report.bytes_per_triangle =
            world.bytes() as f64 / world.triangles.len().max(1) as f64;
        world.report.build_ms.total = start.elapsed().as_secs_f64() * 1e3;
        (world, welded)
    }

    /// A new world, all of whose triangles are fixed.
    fn without_objects(mut self) -> Self {
        self.fixed = Extent {
            vertices: 0..self.positions.len() as u32,
            triangles: 0..self.triangles.len() as u32,
            edges: 0..self.edges.vertices.len() as u32,
            nodes: 0..self.bvh.nodes.len() as u32,
        };
        self.stamp = stamp::next();
        self.fixed_stamp = self.stamp;
        self
    }

    /// The roots of the trees over one layer's triangles, in the order of the triangles.
    pub fn roots(&self, layer: Layer) -> impl Iterator<Item = u32> {
        let (fixed, objects) = match layer {
            Layer::Fixed => (Some(&self.fixed), &[][..]),
            Layer::Objects => (None, &self.objects[..]),
        };
        let extents = fixed.into_iter().chain(objects.iter().map(|o| &o.extent));
        extents.filter_map(|extent| extent.nodes.clone().next())
    }

    /// The three corners of triangle `t`.
    #[inline]
    pub fn corners(&self, t: u32) -> [DVec3; 3] {
        self.triangles[t as usize].map(|v| self.places().at(v))
    }

    /// A box around triangle `t`.
    #[inline]
    pub fn bounds(&self, t: u32) -> [Vec3; 2] {
        self.places().bounds(self.triangles[t as usize])
    }

    /// Where the vertices stand.
    #[inline]
    pub fn places(&self) -> Places<'_> {
        Places {
            positions: &self.positions,
            residuals: &self.residuals,
        }
    }

    /// Keeps 48 bits of positions from now on, also of objects: for a world whose objects will stand
    /// where f32 is too coarse, though its fixed part does not.
    pub fn keep_residuals(&mut self) {
        self.keeps_residuals = true;
        if self.residuals.len() < self.positions.len() {
            let residuals = self.residuals.to_mut();
            residuals.resize(self.positions.len(), Vec3::ZERO);
            self.stamp = stamp::next();
        }
    }
}

fn check_input(mesh: &Mesh) -> Result<(), WorldError> {
    let triangles = mesh.triangles.len();
    if mesh.casting.len() != triangles {
        return Err(WorldError::CastingLength {
            casting: mesh.casting.len(),
            triangles,
        });
    }
    if triangles > World::MAX_TRIANGLES {
        return Err(WorldError::TooManyTriangles {
            triangles,
            limit: World::MAX_TRIANGLES,
        });
    }
    let residuals = mesh.residuals.len();
    if residuals > 0 && residuals != mesh.positions.len() {
        return Err(WorldError::ResidualsLength {
            residuals,
            positions: mesh.positions.len(),
        });
    }
    for list in [&mesh.positions, &mesh.residuals] {
        check_positions(list.iter().map(|p| p.as_dvec3()))?;
    }
    let vertices = mesh.positions.len();
    for (triangle, indices) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = indices.iter().find(|&&v| v as usize >= vertices) {
            return Err(WorldError::IndexOutOfRange {
                triangle,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}

/// That a world can hold vertices at these positions.
fn check_positions(positions: impl IntoIterator<Item = DVec3>) -> Result<(), WorldError> {
    let found = positions
        .into_iter()
        .enumerate()
        .find(|(_, p)| !is_place(*p));
    let Some((vertex, p)) = found else {
        return Ok(());
    };
    let limit = World::MAX_COORDINATE;
    Err(match p.as_vec3().is_finite() {
        true => WorldError::TooFar { vertex, limit },
        false => WorldError::NotFinite { vertex },
    })
}

/// Whether a world can hold a vertex there.
fn is_place(p: DVec3) -> bool {
    let most = DVec3::splat(World::MAX_COORDINATE.into());
    p.abs().cmple(most).all()
}

struct Stopwatch(Instant);

impl Stopwatch {
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let ms = (now - self.0).as_secs_f64() * 1e3;
        self.0 = now;
        ms
    }
}
