//! Rectangles to the largest number that lie over one point, bounded from above.
//!
//! Takes rectangles on a face and a limit; counts them by cell, and cuts a cell with more than the
//! limit into cells of its own. What cannot be cut with profit is a *leaf*, and handed on.

use glam::DVec2;

/// A triangle or several, and the rectangle that holds the rays which may meet them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Item {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    /// Triangles.
    pub(super) weight: u32,
    /// Which.
    pub(super) number: u32,
}

/// A part of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

/// Cells along a side of a window.
const SIDE: usize = 16;

/// Items looked at, as a multiple of those given: beyond that cells are not cut again.
const BUDGET: usize = 64;
const LEAST_BUDGET: usize = 1 << 14;

/// Cuts windows until they have few enough items, or cutting gains nothing.
pub(super) struct Refining<T, L> {
    most: u32,
    levels: u32,
    /// Whether an item whose rectangle touches a window may touch it itself.
    touches: T,
    /// Told the items of each leaf that has more than the limit somewhere.
    leaf: L,
    budget: usize,
}

impl<T: Fn(&Item, &Window) -> bool, L: FnMut(&[Item])> Refining<T, L> {
    /// Of `levels` cells in cells.
    pub(super) fn new(most: u32, levels: u32, touches: T, leaf: L) -> Self {
        Self {
            most,
            levels,
            touches,
            leaf,
            budget: 0,
        }
    }

    /// The largest weight over any point, or more.
    pub(super) fn bound(&mut self, items: &[Item]) -> u32 {
        self.budget = BUDGET * items.len() + LEAST_BUDGET;
        let everywhere = Window {
            low: DVec2::NEG_INFINITY,
            high: DVec2::INFINITY,
        };
        self.window(items, everywhere, self.levels)
    }

    fn window(&mut self, items: &[Item], window: Window, levels: u32) -> u32 {
        let weight = items.iter().map(|item| item.weight).sum();
        if weight <= self.most {
            return weight;
        }
        if self.budget < items.len() {
            (self.leaf)(items);
            return weight;
        }
        self.budget -= items.len();
        let grid = Grid::over(items, window);
        let counts = grid.count(items);
        let mut most = counts.iter().copied().fold(0, u32::max);
        if most <= self.most {
            return most;
        }
        // Where most items lie over most cells, cells of cells are no better.
        let covered: u64 = counts.iter().map(|&count| u64::from(count)).sum();
        let is_full = 4 * covered > 3 * u64::from(weight) * (SIDE * SIDE) as u64;
        if is_full || levels <= 1 {
            (self.leaf)(items);
            return most;
        }
        most = 0;
        for (number, &count) in counts.iter().enumerate() {
            if count <= self.most {
                most = most.max(count);
                continue;
            }
            let cell = grid.cell(number % SIDE, number / SIDE);
            let meets = |item: &&Item| item.meets(&cell) && (self.touches)(item, &cell);
            let inside: Vec<Item> = items.iter().filter(meets).copied().collect();
            most = most.max(self.window(&inside, cell, levels - 1));
        }
        most
    }
}

impl Item {
    fn meets(&self, window: &Window) -> bool {
        self.low.cmple(window.high).all() && self.high.cmpge(window.low).all()
    }
}

/// Cells over the part of a window that items lie in.
struct Grid {
    window: Window,
    scale: DVec2,
}

impl Grid {
    fn over(items: &[Item], window: Window) -> Self {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for item in items {
            low = low.min(item.low);
            high = high.max(item.high);
        }
        let window = Window {
            low: low.max(window.low),
            high: high.min(window.high),
        };
        let size = (window.high - window.low).max(DVec2::splat(f64::MIN_POSITIVE));
        Self {
            window,
            scale: (SIDE as f64 / size).min(DVec2::splat(f64::MAX)),
        }
    }

    /// Monotonous in the point.
    #[inline]
    fn place(&self, at: DVec2) -> [usize; 2] {
        let at = (at - self.window.low) * self.scale;
        // Casts saturate.
        [at.x as usize, at.y as usize].map(|cell| cell.min(SIDE - 1))
    }

    /// The weight that touches each cell, row after row: by the corners of rectangles, summed up.
    fn count(&self, items: &[Item]) -> [u32; SIDE * SIDE] {
        const ROW: usize = SIDE + 1;
        let mut sums = [0u32; ROW * ROW];
        for item in items {
            let ([x0, y0], [x1, y1]) = (self.place(item.low), self.place(item.high));
            for (x, y, weight) in [
                (x0, y0, item.weight),
                (x1 + 1, y1 + 1, item.weight),
                (x1 + 1, y0, item.weight.wrapping_neg()),
                (x0, y1 + 1, item.weight.wrapping_neg()),
            ] {
                let sum = &mut sums[y * ROW + x];
                *sum = sum.wrapping_add(weight);
            }
        }
        let mut counts = [0; SIDE * SIDE];
        for y in 0..SIDE {
            let mut row = 0u32;
            for x in 0..SIDE {
                row = row.wrapping_add(sums[y * ROW + x]);
                let above = if y == 0 {
                    0
                } else {
                    counts[(y - 1) * SIDE + x]
                };
                counts[y * SIDE + x] = row.wrapping_add(above);
            }
        }
        counts
    }

    fn cell(&self, x: usize, y: usize) -> Window {
        let at = |x: usize, y: usize| self.window.low + DVec2::new(x as f64, y as f64) / self.scale;
        Window {
            low: at(x, y),
            high: at(x + 1, y + 1),
        }
    }
}
