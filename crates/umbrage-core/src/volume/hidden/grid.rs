//! Casters in the cells of a cube map around a point light, or of a map across a directional one.
//!
//! Takes casters; finds those whose cone may hold a ray. A caster missed by rounding at a cell's
//! border only fails to hide something.

use glam::{DVec2, DVec3, UVec2};

use super::sight::{Caster, Sight};
use crate::volume::cube::{face_of, to_face};

/// Cells, face after face.
#[derive(Debug, Default)]
pub(super) struct Grid {
    /// 6 for a point light, else 1.
    faces: u32,
    /// Cells along a side of a face.
    side: u32,
    /// Of face coordinates: to cells.
    low: DVec2,
    scale: DVec2,
    /// From cells to steps.
    fine: f64,
    /// First entry of each cell; one more at the end.
    first: Vec<u32>,
    entries: Vec<Entry>,
    pairs: Vec<(u32, Entry)>,
    /// Casters that can hide something, the nearest first.
    order: Vec<Entry>,
}

/// A caster in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entry {
    /// It is nowhere closer than this to the light; see [`Sight::closest`].
    pub(super) closest: f32,
    pub(super) number: u32,
    /// Its box in the face; see [`bounds_word`].
    bounds: u64,
}

/// Top bit of four 16-bit lanes.
const TOP: u64 = 0x8000_8000_8000_8000;
/// Steps of a face that a lane counts, less one.
const MOST: u16 = 0x7fff;

/// A box in four lanes of 15 bits: high corner, and the low one counted from the far end. With
/// their top bits set, subtracting a point packed as a box clears one unless the box holds it.
fn bounds_word(low: [u16; 2], high: [u16; 2]) -> u64 {
    let lanes = [high[0], high[1], MOST - low[0], MOST - low[1]];
    lanes
        .iter()
        .rev()
        .fold(0, |word, &lane| word << 16 | u64::from(lane))
}

/// Casters a cell aims at.
const PER_CELL: f64 = 1.0;

impl Grid {
    /// Replaces what was there.
    pub(super) fn fill(&mut self, sight: &Sight, casters: &[Caster]) {
        self.faces = if sight.is_point() { 6 } else { 1 };
        let side = (casters.len() as f64 / (PER_CELL * f64::from(self.faces))).sqrt();
        self.side = (side.ceil() as u32).clamp(4, if sight.is_point() { 512 } else { 2048 });
        let (mut low, mut high) = (DVec2::splat(-1.0), DVec2::splat(1.0));
        if !sight.is_point() {
            low = DVec2::INFINITY;
            high = DVec2::NEG_INFINITY;
            for ray in casters.iter().flat_map(|c| c.rays) {
                low = low.min(ray.truncate());
                high = high.max(ray.truncate());
            }
        }
        self.low = low;
        self.scale = f64::from(self.side) / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));

        self.fine = f64::from(MOST) / f64::from(self.side);
        self.pairs.clear();
        self.order.clear();
        let able = (0u32..).zip(casters).filter(|(_, c)| c.size > 0.0);
        self.order.extend(able.map(|(number, caster)| Entry {
            closest: sight.closest(caster),
            number,
            bounds: 0,
        }));
        let cells = (self.faces * self.side * self.side) as usize;
        self.first.clear();
        self.first.resize(cells + 1, 0);
        self.order.sort_unstable_by(|a, b| {
            b.closest
                .total_cmp(&a.closest)
                .then(a.number.cmp(&b.number))
        });
        let most = MOST_CELLS * casters.len() + (1 << 16);
        for i in 0..self.order.len() {
            // Casters come nearest first: those that find no room hide less than the others.
            if self.pairs.len() > most {
                break;
            }
            let entry = self.order[i];
            self.insert(entry, &casters[entry.number as usize]);
        }
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        self.entries.clear();
        self.entries.resize(self.pairs.len(), Entry::default());
        // Backwards, so that each cell keeps the order.
        for &(cell, entry) in self.pairs.iter().rev() {
            let at = &mut self.first[cell as usize];
            *at -= 1;
            self.entries[*at as usize] = entry;
        }
    }

    /// The casters whose box holds the ray, the nearest first.
    #[inline]
    pub(super) fn along(&self, ray: DVec3) -> impl Iterator<Item = Entry> {
        let face = if self.faces == 1 { 4 } else { face_of(ray) };
        let local = to_face(face, ray);
        let (cell, at) = self.place(local.truncate() / local.z);
        let at = bounds_word(at, at);
        let face = if self.faces == 1 { 0 } else { face };
        let index = ((face * self.side + cell.y) * self.side + cell.x) as usize;
        let entries = &self.entries[self.first[index] as usize..self.first[index + 1] as usize];
        let holds = move |entry: &&Entry| ((entry.bounds | TOP) - at) & TOP == TOP;
        entries.iter().filter(holds).copied()
    }

    /// The cell of a point of a face, and the point in steps.
    #[inline]
    fn place(&self, at: DVec2) -> (UVec2, [u16; 2]) {
        let at = (at - self.low) * self.scale;
        let fine = at * self.fine;
        // Casts saturate.
        (
            UVec2::new(at.x as u32, at.y as u32).min(UVec2::splat(self.side - 1)),
            [fine.x as u16, fine.y as u16].map(|step| step.min(MOST)),
        )
    }

    fn insert(&mut self, entry: Entry, caster: &Caster) {
        if self.faces == 1 {
            self.insert_in_face(entry, caster, 4, 0, &caster.rays);
            return;
        }
        let faces = caster.rays.map(face_of);
        if faces[0] == faces[1] && faces[0] == faces[2] {
            let local = caster.rays.map(|ray| to_face(faces[0], ray));
            self.insert_in_face(entry, caster, faces[0], faces[0], &local);
            return;
        }
        for face in 0..6 {
            let (mut polygon, mut len) = ([DVec3::ZERO; 16], 3);
            for (to, ray) in polygon.iter_mut().zip(caster.rays) {
                *to = to_face(face, ray);
            }
            for plane in 0..4 {
                (polygon, len) = clip(&polygon, len, plane);
            }
            if len > 0 {
                self.insert_in_face(entry, caster, face, face, &polygon[..len]);
            }
        }
    }

    /// `polygon` in the face's coordinates, inside its pyramid.
    fn insert_in_face(
        &mut self,
        mut entry: Entry,
        caster: &Caster,
        axes: u32,
        face: u32,
        polygon: &[DVec3],
    ) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in polygon {
            let at = p.truncate() / p.z.max(f64::MIN_POSITIVE);
            low = low.min(at);
            high = high.max(at);
        }
        let (low, low_step) = self.place(low);
        let (high, high_step) = self.place(high);
        entry.bounds = bounds_word(low_step, high_step);
        let few = (high.x - low.x + 1) * (high.y - low.y + 1) <= 2;
        let sides = caster.sides.map(|n| to_face(axes, n));
        let step = 1.0 / self.scale;
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                // Outside a side if the cell's corner farthest inward is.
                let outside = !few && {
                    let corner = self.low + step * DVec2::new(f64::from(x), f64::from(y));
                    sides.iter().any(|n| {
                        let far = corner
                            + DVec2::new(
                                if n.x > 0.0 { step.x } else { 0.0 },
                                if n.y > 0.0 { step.y } else { 0.0 },
                            );
                        n.dot(far.extend(1.0)) < 0.0
                    })
                };
                if !outside {
                    let cell = (face * self.side + y) * self.side + x;
                    self.first[cell as usize] += 1;
                    self.pairs.push((cell, entry));
                }
            }
        }
    }
}

/// Cells that a caster is in, in the mean: keeps the grid of a heap of large triangles small.
const MOST_CELLS: usize = 16;

/// One side of the pyramid |x| <= z, |y| <= z.
fn clip(polygon: &[DVec3; 16], len: usize, plane: usize) -> ([DVec3; 16], usize) {
    let height = |p: DVec3| p.z + if plane.is_multiple_of(2) { 1.0 } else { -1.0 } * p[plane / 2];
    let (mut out, mut count) = ([DVec3::ZERO; 16], 0);
    for i in 0..len {
        let (p, q) = (polygon[i], polygon[(i + 1) % len]);
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            out[count] = p;
            count += 1;
        }
        if (hp >= 0.0) != (hq >= 0.0) {
            out[count] = p + (q - p) * (hp / (hp - hq));
            count += 1;
        }
    }
    (out, count)
}
