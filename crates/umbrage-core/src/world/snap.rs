//! Positions that are nearly equal to equal ones.
//!
//! Takes a mesh and a tolerance; moves each position to the first earlier one that is within the
//! tolerance and stays where it is. What stays keeps its bits, and no two of those are within the
//! tolerance of each other, so doing it again moves nothing. The result does not depend on the
//! number of threads. It is what depth-fail tutorials do with the vertices of a loaded model, in a
//! grid instead of all against all.
//!
//! A step before [`World::build`], which itself welds by bits and moves nothing: so whatever else
//! sees the mesh, an oracle or a fingerprint, sees the geometry that casts.

use std::collections::HashMap;

use glam::DVec3;

use super::{WorldError, weld};
use crate::mesh::Mesh;
use crate::place::Places;

#[cfg(doc)]
use super::World;

impl Mesh {
    /// Moves positions that are within `tolerance_m` of an earlier one onto that, so that cracks of
    /// that width close and a world finds their edges shared. Triangles that lose a corner to it
    /// are left out by [`World::build`] as degenerate. Gives the number of positions moved.
    ///
    /// This changes the geometry, by up to the tolerance: judge shadows by the mesh as it is now.
    ///
    /// # Errors
    /// [`WorldError::Tolerance`].
    pub fn weld_within(&mut self, tolerance_m: f32) -> Result<usize, WorldError> {
        self.weld_first_within(self.positions.len(), tolerance_m)
    }

    /// [`Mesh::weld_within`] among the first `count` vertices: of a mesh in which others move.
    ///
    /// # Errors
    /// As [`Mesh::weld_within`].
    ///
    /// # Panics
    /// If there are fewer vertices.
    pub fn weld_first_within(
        &mut self,
        count: usize,
        tolerance_m: f32,
    ) -> Result<usize, WorldError> {
        if !(tolerance_m >= 0.0 && tolerance_m.is_finite()) {
            return Err(WorldError::Tolerance { tolerance_m });
        }
        if tolerance_m == 0.0 {
            return Ok(0);
        }
        let Places {
            positions,
            residuals,
        } = self.places();
        let (first, _) = weld::weld(Places {
            positions: &positions[..count],
            residuals: residuals.get(..count).unwrap_or_default(),
        });
        let mut grid = Grid::new(f64::from(tolerance_m));
        let mut moved = 0;
        for (i, &first) in first.iter().enumerate() {
            let p = self.places().at(i as u32);
            if !p.is_finite() {
                continue; // refused by World::build
            }
            // Where its equal went, the mesh holds already.
            let to = match first as usize == i {
                true => grid.place(i as u32, p),
                false => first,
            };
            moved += usize::from(self.places().at(to) != p);
            self.positions[i] = self.positions[to as usize];
            if !self.residuals.is_empty() {
                self.residuals[i] = self.residuals[to as usize];
            }
        }
        Ok(moved)
    }
}

/// The positions that stay, by cell.
struct Grid {
    tolerance: f64,
    /// The last that was placed in each cell.
    last: HashMap<Cell, u32>,
    /// Number and place.
    staying: Vec<(u32, DVec3)>,
    /// The one placed in the same cell before.
    before: Vec<u32>,
}

/// Bits of its whole numbers in f64: what divides by a tiny tolerance overflows any integer.
type Cell = [u64; 3];

const NONE: u32 = u32::MAX;

impl Grid {
    fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            last: HashMap::new(),
            staying: Vec::new(),
            before: Vec::new(),
        }
    }

    /// Wide enough that what is near a position is mostly in its own cell, in two along an axis at
    /// most: two f32 that differ by no more than the tolerance are less than 2^24 cells from zero,
    /// where f64 tells neighbours apart. Narrow enough that few of those that stay share one.
    fn cell(&self, p: DVec3) -> Cell {
        let number = (p / (4.0 * self.tolerance)).floor();
        // Adding zero turns -0 into 0.
        number.to_array().map(|x| (x + 0.0).to_bits())
    }

    /// To whom vertex `v` at `at` goes: to the first that stays within the tolerance, or itself.
    fn place(&mut self, v: u32, at: DVec3) -> u32 {
        // Above what the subtraction is rounded by where neighbouring floats can be this near.
        let reach = DVec3::splat(self.tolerance * 1.0001);
        let (low, high) = (self.cell(at - reach), self.cell(at + reach));
        let mut found = NONE;
        for x in either(low[0], high[0]) {
            for y in either(low[1], high[1]) {
                for z in either(low[2], high[2]) {
                    let mut next = self.last.get(&[x, y, z]).copied().unwrap_or(NONE);
                    while next != NONE {
                        let (_, other) = self.staying[next as usize];
                        if (other - at).length_squared() <= self.tolerance * self.tolerance {
                            found = found.min(next);
                        }
                        next = self.before[next as usize];
                    }
                }
            }
        }
        if let Some(&(to, _)) = self.staying.get(found as usize) {
            return to;
        }
        let number = self.staying.len() as u32;
        let before = self.last.insert(self.cell(at), number);
        self.before.push(before.unwrap_or(NONE));
        self.staying.push((v, at));
        v
    }
}

/// Both, or the one that they are.
fn either(low: u64, high: u64) -> impl Iterator<Item = u64> {
    std::iter::once(low).chain((high != low).then_some(high))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Most positions that one look into a cell compares with.
    fn longest(grid: &Grid) -> usize {
        let chain = |&last: &u32| {
            let next = |&at: &u32| Some(grid.before[at as usize]).filter(|&next| next != NONE);
            std::iter::successors(Some(last), next).count()
        };
        grid.last.values().map(chain).max().unwrap_or(0)
    }

    /// A lattice with a floor at zero and one vertex very far out.
    fn lattice() -> Vec<Vec3> {
        let place = |i: u32| Vec3::new((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32);
        let near = (0..64_000).map(|i| 0.1 * (place(i) - Vec3::splat(20.0)));
        near.chain([Vec3::splat(3e38)]).collect()
    }

    #[test]
    fn a_tiny_tolerance_compares_few_and_moves_nothing() {
        for tolerance in [f32::from_bits(1), 1e-30, 1e-12] {
            let mut grid = Grid::new(f64::from(tolerance));
            for (v, p) in (0..).zip(lattice()) {
                assert_eq!(grid.place(v, p.as_dvec3()), v);
            }
            assert_eq!(longest(&grid), 1, "{tolerance}");
            let mut mesh = Mesh {
                positions: lattice(),
                ..Mesh::default()
            };
            assert_eq!(mesh.weld_within(tolerance), Ok(0));
            assert_eq!(mesh.positions, lattice());
        }
    }

    /// The count sees crowding: a cell as wide as the lattice holds what lies in it.
    #[test]
    fn crowded_cells_are_noticed() {
        let mut grid = Grid::new(1e-30);
        for (v, p) in (0..).zip(lattice()) {
            grid.place(v, p.as_dvec3());
        }
        let cells = grid.staying.iter().map(|(_, p)| (p / 1.0).floor());
        let mut crowded = Grid::new(1e-30);
        for (number, cell) in (0..).zip(cells) {
            let before = crowded
                .last
                .insert(cell.to_array().map(f64::to_bits), number);
            crowded.before.push(before.unwrap_or(NONE));
        }
        assert!(longest(&crowded) >= 1000, "{}", longest(&crowded));
    }
}
