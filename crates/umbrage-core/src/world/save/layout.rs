//! What stands where in a saved world.
//!
//! A [`Head`] of fixed size, then the arrays as they are in memory, each at a multiple of
//! [`ALIGNMENT`]. Whatever changes the head, an element type or what an array means changes
//! [`VERSION`].

use bytemuck::{Pod, Zeroable};

use super::super::{BuildTimes, WorldReport};
use crate::fingerprint::{Fingerprint, checksum};

pub(super) const MAGIC: [u8; 8] = *b"umbrageW";
pub(super) const VERSION: u32 = 2;
pub(super) const BYTE_ORDER: u32 = 0x0102_0304;
/// Of arrays in the file: a cache line, which the widest element type asks for.
pub(super) const ALIGNMENT: usize = 64;

/// The arrays, in file order.
#[derive(Clone, Copy, Debug)]
pub(super) enum Section {
    Positions,
    Residuals,
    Triangles,
    Source,
    Casting,
    Edges,
    Sides,
    Clusters,
    Planes,
    Boxes,
    Nodes,
}

impl Section {
    pub(super) const ALL: [Self; 11] = [
        Self::Positions,
        Self::Residuals,
        Self::Triangles,
        Self::Source,
        Self::Casting,
        Self::Edges,
        Self::Sides,
        Self::Clusters,
        Self::Planes,
        Self::Boxes,
        Self::Nodes,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Residuals => "residuals",
            Self::Triangles => "triangles",
            Self::Source => "source",
            Self::Casting => "casting",
            Self::Edges => "edges",
            Self::Sides => "sides",
            Self::Clusters => "clusters",
            Self::Planes => "planes",
            Self::Boxes => "boxes",
            Self::Nodes => "nodes",
        }
    }
}

/// The same in every version.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Preamble {
    pub(super) magic: [u8; 8],
    pub(super) byte_order: u32,
    pub(super) version: u32,
}

/// The first bytes of the file.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Head {
    pub(super) preamble: Preamble,
    /// Of `contents`.
    pub(super) checksum: u64,
    pub(super) contents: Contents,
}

impl Head {
    pub(super) fn new(contents: Contents) -> Self {
        Self {
            preamble: Preamble {
                magic: MAGIC,
                byte_order: BYTE_ORDER,
                version: VERSION,
            },
            checksum: checksum(bytemuck::bytes_of(&contents)),
            contents,
        }
    }
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Contents {
    /// Length of the whole file.
    pub(super) file_bytes: u64,
    pub(super) fingerprint: Fingerprint,
    /// By number of the [`Section`].
    pub(super) sections: [Placed; Section::ALL.len()],
    pub(super) report: SavedReport,
}

/// An array in the file.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Placed {
    /// From the start of the file.
    pub(super) offset: u64,
    pub(super) bytes: u64,
    pub(super) element_bytes: u64,
    pub(super) checksum: u64,
}

/// A [`WorldReport`] of fixed layout.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SavedReport {
    counts: [u64; 11],
    bytes_per_triangle: f64,
    /// weld, edges, bvh, order, total.
    build_ms: [f64; 5],
}

impl From<&WorldReport> for SavedReport {
    fn from(report: &WorldReport) -> Self {
        let [one, two, three, more] = report.edges_by_triangles;
        let times = &report.build_ms;
        Self {
            counts: [
                report.triangles,
                report.vertices,
                report.welded_vertices,
                report.unique_edges,
                one,
                two,
                three,
                more,
                report.opposite_wound_pairs,
                report.degenerate_triangles,
                report.duplicate_triangles,
            ]
            .map(|count| count as u64),
            bytes_per_triangle: report.bytes_per_triangle,
            build_ms: [times.weld, times.edges, times.bvh, times.order, times.total],
        }
    }
}

impl From<&SavedReport> for WorldReport {
    fn from(saved: &SavedReport) -> Self {
        let [
            triangles,
            vertices,
            welded_vertices,
            unique_edges,
            one,
            two,
            three,
            more,
            opposite_wound_pairs,
            degenerate_triangles,
            duplicate_triangles,
        ] = saved.counts.map(|count| count as usize);
        let [weld, edges, bvh, order, total] = saved.build_ms;
        Self {
            triangles,
            vertices,
            welded_vertices,
            unique_edges,
            edges_by_triangles: [one, two, three, more],
            opposite_wound_pairs,
            degenerate_triangles,
            duplicate_triangles,
            bytes_per_triangle: saved.bytes_per_triangle,
            build_ms: BuildTimes {
                weld,
                edges,
                bvh,
                order,
                total,
            },
        }
    }
}
