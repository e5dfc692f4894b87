//! Equal positions to one vertex.
//!
//! Takes positions; gives each one's welded number. Two positions weld if their f32 bits are
//! equal, with -0 taken as +0: no tolerance, so welding never moves anything.

use glam::Vec3;
use rdst::{RadixKey, RadixSort};

use crate::mesh::Mesh;

pub(super) struct Welded {
    /// Welded number of each position.
    pub(super) vertex: Vec<u32>,
    /// How many distinct ones there are.
    pub(super) count: usize,
}

#[derive(Clone, Copy, Debug)]
struct Keyed {
    bits: [u32; 3],
    index: u32,
}

impl RadixKey for Keyed {
    const LEVELS: usize = 12;

    #[inline]
    fn get_level(&self, level: usize) -> u8 {
        (self.bits[level / 4] >> (8 * (level % 4))) as u8
    }
}

/// Adding +0 turns -0 into +0 and leaves every other value alone.
#[inline]
fn canonical(p: Vec3) -> Vec3 {
    p + Vec3::ZERO
}

pub(super) fn weld(positions: &[Vec3]) -> Welded {
    let mut keyed: Vec<Keyed> = positions
        .iter()
        .enumerate()
        .map(|(index, &p)| Keyed {
            bits: canonical(p).to_array().map(f32::to_bits),
            index: index as u32,
        })
        .collect();
    keyed.radix_sort_unstable();
    let mut vertex = vec![0; positions.len()];
    let mut count = 0;
    for (i, key) in keyed.iter().enumerate() {
        if i > 0 && key.bits != keyed[i - 1].bits {
            count += 1;
        }
        vertex[key.index as usize] = count;
    }
    Welded {
        vertex,
        count: if positions.is_empty() {
            0
        } else {
            count as usize + 1
        },
    }
}

/// Positions and triangles with vertices numbered by first use in the order `source`.
/// Vertices that no kept triangle uses are left out.
pub(super) fn renumber(mesh: &Mesh, welded: &Welded, source: &[u32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut number = vec![UNSEEN; welded.count];
    let mut positions = Vec::with_capacity(welded.count);
    let triangles = source
        .iter()
        .map(|&t| {
            mesh.triangles[t as usize].map(|v| {
                let slot = &mut number[welded.vertex[v as usize] as usize];
                if *slot == UNSEEN {
                    *slot = positions.len() as u32;
                    positions.push(canonical(mesh.positions[v as usize]));
                }
                *slot
            })
        })
        .collect();
    (positions, triangles)
}
