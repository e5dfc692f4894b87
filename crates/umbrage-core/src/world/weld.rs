//! Equal positions to one vertex.
//!
//! Takes positions; gives for each the first that equals it. Two positions weld if their f32 bits
//! are equal, with -0 taken as +0: no tolerance, so welding never moves anything; whoever wants one
//! calls [`Mesh::weld_within`] before. Positions are
//! dealt by hash into parts whose tables fit the cache; what decides is the bits.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::Vec3;
use rayon::prelude::*;

use super::stages::Welded;
use crate::mesh::Mesh;

#[derive(Clone, Copy)]
struct Item {
    bits: [u32; 3],
    index: u32,
}

/// Positions a part: their table and what it points to fit a second-level cache.
const PART: usize = 1 << 13;

/// Adding +0 turns -0 into +0 and leaves every other value alone.
#[inline]
fn canonical(p: Vec3) -> Vec3 {
    p + Vec3::ZERO
}

/// Folded multiplication (as in wyhash): all bits of the result depend on all bits of the position.
#[inline]
fn hash([x, y, z]: [u32; 3]) -> u64 {
    let xy = u64::from(x) | u64::from(y) << 32;
    let product = u128::from(xy ^ 0xa076_1d64_78bd_642f)
        * u128::from(u64::from(z).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xe703_7ed1_a0b4_28db);
    (product >> 64) as u64 ^ product as u64
}

/// For each position the number of the first that equals it; and how many distinct ones there are.
pub(super) fn weld(positions: &[Vec3]) -> (Vec<u32>, usize) {
    let parts = (positions.len() / PART).next_power_of_two().min(256);
    let dealt = deal(positions, parts);
    let vertex: Vec<AtomicU32> = (0..positions.len() as u32)
        .into_par_iter()
        .map(AtomicU32::new)
        .collect();
    let count = (0..parts)
        .into_par_iter()
        .map(|part| weld_part(dealt.iter().map(|chunk| &chunk[part][..]), &vertex))
        .sum();
    let vertex = vertex.into_par_iter().map(AtomicU32::into_inner);
    (vertex.collect(), count)
}

/// By chunk of positions, then by part: in each, indices ascend.
fn deal(positions: &[Vec3], parts: usize) -> Vec<Vec<Vec<Item>>> {
    let chunk = positions
        .len()
        .div_ceil(rayon::current_num_threads())
        .max(PART);
    let deal_chunk = |(number, positions): (usize, &[Vec3])| {
        let room = positions.len() / parts * 9 / 8;
        let mut dealt: Vec<Vec<Item>> = (0..parts).map(|_| Vec::with_capacity(room)).collect();
        for (index, &p) in (number * chunk..).zip(positions) {
            let bits = canonical(p).to_array().map(f32::to_bits);
            // High bits choose the part, low ones the place in its table.
            let part = ((hash(bits) >> 32) * parts as u64) >> 32;
            dealt[part as usize].push(Item {
                bits,
                index: index as u32,
            });
        }
        dealt
    };
    positions
        .par_chunks(chunk)
        .enumerate()
        .map(deal_chunk)
        .collect()
}

/// Points every item to the first that equals it; gives the number of distinct ones.
fn weld_part<'a>(chunks: impl Iterator<Item = &'a [Item]> + Clone, vertex: &[AtomicU32]) -> usize {
    const EMPTY: u32 = u32::MAX;
    let items: usize = chunks.clone().map(<[Item]>::len).sum();
    let mut table = vec![EMPTY; (2 * items).next_power_of_two()];
    let mask = table.len() - 1;
    let mut distinct: Vec<Item> = Vec::with_capacity(items);
    for item in chunks.flatten() {
        let mut at = hash(item.bits) as usize & mask;
        loop {
            match table[at] {
                EMPTY => {
                    table[at] = distinct.len() as u32;
                    distinct.push(*item);
                    break;
                }
                found if distinct[found as usize].bits == item.bits => {
                    vertex[item.index as usize].store(distinct[found as usize].index, Relaxed);
                    break;
                }
                _ => at = (at + 1) & mask,
            }
        }
    }
    distinct.len()
}

/// Positions and triangles with vertices numbered by first use in the order `source`.
/// Vertices that no kept triangle uses are left out.
pub(super) fn renumber(mesh: &Mesh, welded: &Welded, source: &[u32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut triangles: Vec<[u32; 3]> = source
        .par_iter()
        .map(|&t| mesh.triangles[t as usize].map(|v| welded.vertex[v as usize]))
        .collect();
    let mut number = vec![UNSEEN; mesh.positions.len()];
    let mut seen = Vec::with_capacity(welded.count);
    for v in triangles.as_flattened_mut() {
        let slot = &mut number[*v as usize];
        if *slot == UNSEEN {
            *slot = seen.len() as u32;
            seen.push(*v);
        }
        *v = *slot;
    }
    let position = |&v: &u32| canonical(mesh.positions[v as usize]);
    (seen.par_iter().map(position).collect(), triangles)
}
