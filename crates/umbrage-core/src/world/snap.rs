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

use glam::{DVec3, Vec3};

use super::{WorldError, weld};
use crate::mesh::Mesh;

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
        if !(tolerance_m >= 0.0 && tolerance_m.is_finite()) {
            return Err(WorldError::Tolerance { tolerance_m });
        }
        if tolerance_m == 0.0 {
            return Ok(0);
        }
        let (first, _) = weld::weld(&self.positions);
        let mut grid = Grid::new(f64::from(tolerance_m));
        let mut moved = 0;
        for (i, &first) in first.iter().enumerate() {
            let p = self.positions[i];
            if !p.is_finite() {
                continue; // refused by World::build
            }
            let to = match first as usize == i {
                true => grid.place(p),
                // Where its equal went; the mesh holds that already.
                false => self.positions[first as usize],
            };
            moved += usize::from(to != p);
            self.positions[i] = to;
        }
        Ok(moved)
    }
}

/// The positions that stay, by cell.
struct Grid {
    tolerance: f64,
    /// The last that was placed in each cell.
    last: HashMap<[i64; 3], u32>,
    staying: Vec<Vec3>,
    /// The one placed in the same cell before.
    before: Vec<u32>,
}

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
    /// most.
    fn cell(&self, p: DVec3) -> [i64; 3] {
        (p / (4.0 * self.tolerance))
            .floor()
            .to_array()
            .map(|x| x as i64)
    }

    /// Where `p` goes: to the first that stays within the tolerance, or nowhere.
    fn place(&mut self, p: Vec3) -> Vec3 {
        let at = p.as_dvec3();
        // Above what the subtraction is rounded by where neighbouring floats can be this near.
        let reach = DVec3::splat(self.tolerance * 1.0001);
        let (low, high) = (self.cell(at - reach), self.cell(at + reach));
        let mut found = NONE;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut next = self.last.get(&[x, y, z]).copied().unwrap_or(NONE);
                    while next != NONE {
                        let other = self.staying[next as usize].as_dvec3();
                        if (other - at).length_squared() <= self.tolerance * self.tolerance {
                            found = found.min(next);
                        }
                        next = self.before[next as usize];
                    }
                }
            }
        }
        if let Some(&to) = self.staying.get(found as usize) {
            return to;
        }
        let number = self.staying.len() as u32;
        let before = self.last.insert(self.cell(at), number);
        self.before.push(before.unwrap_or(NONE));
        self.staying.push(p);
        p
    }
}
