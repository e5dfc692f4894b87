//! Equal positions to one vertex.
//!
//! Takes positions; gives for each the first that equals it. Two positions weld if their bits
//! are equal, with -0 taken as +0: no tolerance, so welding never moves anything; whoever wants one
//! calls [`Mesh::weld_within`] before. Positions are
//! dealt by hash into parts whose tables fit the cache; what decides is the bits.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::Vec3;
use rayon::prelude::*;

use super::stages::Welded;
use crate::mesh::Mesh;
use crate::place::Places;

/// A position by its bits: three words, or six with its residual.
#[derive(Clone, Copy)]
struct Item<const N: usize> {
    bits: [u32; N],
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
fn hash<const N: usize>(bits: [u32; N]) -> u64 {
    // Residuals are turned into the words of their positions, by different amounts.
    let word = |axis: usize| {
        let rest = bits.get(axis + 3).copied().unwrap_or(0);
        bits[axis] ^ rest.rotate_left(7 + 6 * axis as u32)
    };
    let [x, y, z] = [word(0), word(1), word(2)];
    let xy = u64::from(x) | u64::from(y) << 32;
    let product = u128::from(xy ^ 0xa076_1d64_78bd_642f)
        * u128::from(u64::from(z).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xe703_7ed1_a0b4_28db);
    (product >> 64) as u64 ^ product as u64
}

/// For each position the number of the first that equals it; and how many distinct ones there are.
pub(super) fn weld(places: Places<'_>) -> (Vec<u32>, usize) {
    let bits = |p: Vec3| canonical(p).to_array().map(f32::to_bits);
    let position = |v: usize| bits(places.positions[v]);
    if places.residuals.is_empty() {
        return weld_by(places.positions.len(), position);
    }
    let both = |v: usize| {
        let ([x, y, z], [u, v, w]) = (position(v), bits(places.residuals[v]));
        [x, y, z, u, v, w]
    };
    weld_by(places.positions.len(), both)
}

fn weld_by<const N: usize>(
    count: usize,
    bits: impl Fn(usize) -> [u32; N] + Sync,
) -> (Vec<u32>, usize) {
    let parts = (count / PART).next_power_of_two().min(256);
    let dealt = deal(count, bits, parts);
    let vertex: Vec<AtomicU32> = (0..count as u32)
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
fn deal<const N: usize>(
    count: usize,
    bits: impl Fn(usize) -> [u32; N] + Sync,
    parts: usize,
) -> Vec<Vec<Vec<Item<N>>>> {
    let chunk = count.div_ceil(rayon::current_num_threads()).max(PART);
    let deal_chunk = |number: usize| {
        let range = number * chunk..count.min((number + 1) * chunk);
        let room = range.len() / parts * 9 / 8;
        let mut dealt: Vec<Vec<Item<N>>> = (0..parts).map(|_| Vec::with_capacity(room)).collect();
        for index in range {
            let bits = bits(index);
            // High bits choose the part, low ones the place in its table.
            let part = ((hash(bits) >> 32) * parts as u64) >> 32;
            dealt[part as usize].push(Item {
                bits,
                index: index as u32,
            });
        }
        dealt
    };
    let chunks = (0..count.div_ceil(chunk)).into_par_iter();
    chunks.map(deal_chunk).collect()
}

/// Points every item to the first that equals it; gives the number of distinct ones.
fn weld_part<'a, const N: usize>(
    chunks: impl Iterator<Item = &'a [Item<N>]> + Clone,
    vertex: &[AtomicU32],
) -> usize {
    const EMPTY: u32 = u32::MAX;
    let items: usize = chunks.clone().map(<[Item<N>]>::len).sum();
    let mut table = vec![EMPTY; (2 * items).next_power_of_two()];
    let mask = table.len() - 1;
    let mut distinct: Vec<Item<N>> = Vec::with_capacity(items);
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

/// Positions, residuals and triangles, with vertices numbered by first use in the order `source`.
/// Vertices that no kept triangle uses are left out.
pub(super) fn renumber(
    mesh: &Mesh,
    welded: &Welded,
    source: &[u32],
) -> (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>) {
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
    let residual = |&v: &u32| canonical(mesh.places().residual(v));
    let residuals = match mesh.residuals.is_empty() {
        true => Vec::new(),
        false => seen.par_iter().map(residual).collect(),
    };
    (
        seen.par_iter().map(position).collect(),
        residuals,
        triangles,
    )
}
