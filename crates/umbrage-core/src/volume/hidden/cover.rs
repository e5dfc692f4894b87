//! The proof that a caster is hidden: nearer casters, one after the other, are taken away from
//! what the light sees of it, until nothing is left.
//!
//! Takes casters and their grid; decides one caster. The region to cover starts as the part of it
//! within the light's reach, a convex polygon in its plane. The ray through the region's middle
//! must meet a nearer caster; the part of the region inside that one's three sides and behind its
//! plane is covered; the convex pieces outside remain. A ray that meets nothing nearer proves that
//! the caster is seen; a piece too many leaves the question open, and the caster counts as seen.
//!
//! **Tolerance.** A remainder thinner than [`SLIVER`] of the distance counts as covered.

use glam::DVec3;

use super::grid::Grid;
use super::reach::ReachPlanes;
use super::sight::{Caster, Sight};

/// Thickness of a remainder that counts as covered, relative to its distance from the light.
const SLIVER: f64 = 1e-12;

/// Casters looked at for each cut.
const CHOICES: usize = 4;

/// Cuts tried on one caster before it counts as seen.
const CUTS: usize = 64;

/// A point of the caster in question: its ray, and its closeness along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) ray: DVec3,
    pub(super) closeness: f64,
}

/// What one thread needs to decide.
#[derive(Clone, Debug, Default)]
pub(super) struct Cover {
    /// Pieces that remain to be covered, end to end.
    points: Vec<Point>,
    /// Where each starts.
    starts: Vec<usize>,
    piece: Vec<Point>,
    inside: Vec<Point>,
    heights: Vec<f64>,
    /// The caster that hid one last.
    latest: u32,
}

/// All that decisions look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene<'a> {
    pub(super) sight: &'a Sight,
    pub(super) casters: &'a [Caster],
    pub(super) grid: &'a Grid,
    pub(super) reach: &'a ReachPlanes,
}

/// What became of a caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The light may see it.
    Seen,
    /// Every light ray that meets it within reach meets another first.
    Hidden,
}

impl Cover {
    /// Makes verdicts independent of earlier ones.
    pub(super) fn forget(&mut self) {
        self.latest = u32::MAX;
    }

    /// Decides caster `number`.
    pub(super) fn decide(&mut self, scene: &Scene, number: usize) -> Verdict {
        let caster = &scene.casters[number];
        if caster.size == 0.0 {
            return Verdict::Seen;
        }
        self.points.clear();
        self.starts.clear();
        self.piece.clear();
        self.piece.extend(caster.rays.map(|ray| Point {
            ray,
            closeness: caster.plane.dot(ray),
        }));
        scene
            .reach
            .clip(&mut self.piece, caster.plane, &mut self.inside);
        if self.piece.is_empty() {
            return Verdict::Hidden;
        }
        // Neighbours tend to be hidden by the same caster.
        let middle = middle(&self.piece);
        if let Some(nearer) = scene.casters.get(self.latest as usize)
            && scene.hides(nearer, &middle)
            && self.piece.iter().all(|p| scene.covers(nearer, caster, p))
        {
            return Verdict::Hidden;
        }
        // Most casters that are seen show it at their middle or near a corner.
        match scene.best_nearer(&self.piece, caster) {
            None => return Verdict::Seen,
            Some((number, covered)) if covered == self.piece.len() => {
                self.latest = number;
                return Verdict::Hidden;
            }
            _ => {}
        }
        let mut probes = self.piece.iter().map(|p| Point {
            ray: p.ray + 0.03 * (middle.ray - p.ray),
            closeness: p.closeness + 0.03 * (middle.closeness - p.closeness),
        });
        if probes.any(|probe| !scene.any_nearer(&probe)) {
            return Verdict::Seen;
        }
        self.starts.push(0);
        self.points.extend_from_slice(&self.piece);
        for _ in 0..CUTS {
            let Some(start) = self.starts.pop() else {
                return Verdict::Hidden;
            };
            self.piece.clear();
            self.piece.extend(self.points.drain(start..));
            let Some((number, covered)) = scene.best_nearer(&self.piece, caster) else {
                return Verdict::Seen;
            };
            if covered == self.piece.len() {
                continue;
            }
            let nearer = &scene.casters[number as usize];
            for side in nearer.sides {
                self.heights.clear();
                self.heights.extend(self.piece.iter().map(|p| {
                    let height = side.dot(p.ray);
                    snap(height, SLIVER * scene.sight.distance(p.ray))
                }));
                self.cut();
            }
            let tilt = scene.sight.length(nearer.plane - caster.plane);
            self.heights.clear();
            self.heights.extend(self.piece.iter().map(|p| {
                let ahead = nearer.plane.dot(p.ray) - p.closeness;
                snap(ahead, SLIVER * tilt * scene.sight.distance(p.ray))
            }));
            self.cut();
        }
        Verdict::Seen
    }

    /// Splits the piece where its heights change sign: what is below goes onto the stack.
    fn cut(&mut self) {
        if self.heights.iter().all(|h| *h >= 0.0) {
            return;
        }
        let start = self.points.len();
        self.inside.clear();
        let n = self.piece.len();
        for i in 0..n {
            let j = if i + 1 == n { 0 } else { i + 1 };
            let (p, q) = (self.piece[i], self.piece[j]);
            let (hp, hq) = (self.heights[i], self.heights[j]);
            if hp >= 0.0 {
                self.inside.push(p);
            }
            if hp <= 0.0 {
                self.points.push(p);
            }
            if hp * hq < 0.0 {
                let t = hp / (hp - hq);
                let crossing = Point {
                    ray: p.ray + t * (q.ray - p.ray),
                    closeness: p.closeness + t * (q.closeness - p.closeness),
                };
                self.inside.push(crossing);
                self.points.push(crossing);
            }
        }
        if self.points.len() - start >= 3 {
            self.starts.push(start);
        } else {
            self.points.truncate(start);
        }
        std::mem::swap(&mut self.piece, &mut self.inside);
    }
}

/// Zero if within `tolerance` of it.
#[inline]
fn snap(height: f64, tolerance: f64) -> f64 {
    if height.abs() <= tolerance {
        0.0
    } else {
        height
    }
}

fn middle(piece: &[Point]) -> Point {
    let share = 1.0 / piece.len() as f64;
    Point {
        ray: share * piece.iter().map(|p| p.ray).sum::<DVec3>(),
        closeness: share * piece.iter().map(|p| p.closeness).sum::<f64>(),
    }
}

impl Scene<'_> {
    /// Casters that may be nearer at a point, the nearest first.
    fn candidates(&self, at: &Point) -> impl Iterator<Item = (u32, &Caster)> {
        let own = (at.closeness / self.sight.distance(at.ray)) as f32;
        self.grid
            .along(at.ray)
            .take_while(move |entry| entry.closest > own)
            .map(|entry| (entry.number, &self.casters[entry.number as usize]))
    }

    /// Whether `other` is nearer at a point, by a margin. On an edge that two share, both are.
    #[inline]
    fn hides(&self, other: &Caster, at: &Point) -> bool {
        other.plane.dot(at.ray) > at.closeness + self.sight.nearer
            && other.sides.iter().all(|n| n.dot(at.ray) >= 0.0)
    }

    /// Whether `other` is at least as near at a point of `own`, within tolerance.
    #[inline]
    fn covers(&self, other: &Caster, own: &Caster, at: &Point) -> bool {
        let slack = -SLIVER * self.sight.distance(at.ray);
        other.sides.iter().all(|n| n.dot(at.ray) >= slack) && {
            let ahead = other.plane.dot(at.ray) - at.closeness;
            ahead >= 0.0 || ahead >= slack * self.sight.length(other.plane - own.plane)
        }
    }

    /// Whether a caster is nearer at a point.
    fn any_nearer(&self, at: &Point) -> bool {
        self.candidates(at).any(|(_, other)| self.hides(other, at))
    }

    /// Of the casters nearer at the middle of a piece of `own`, the one that covers the most of
    /// its corners, and how many; the larger of two.
    fn best_nearer(&self, piece: &[Point], own: &Caster) -> Option<(u32, usize)> {
        let at = middle(piece);
        let mut best: Option<(u32, usize)> = None;
        let nearer = self.candidates(&at).filter(|(_, c)| self.hides(c, &at));
        for (number, other) in nearer.take(CHOICES) {
            let covered = piece.iter().filter(|p| self.covers(other, own, p)).count();
            if covered == piece.len() {
                return Some((number, covered));
            }
            let better = best.is_none_or(|(b, most)| {
                (covered, other.size) > (most, self.casters[b as usize].size)
            });
            if better {
                best = Some((number, covered));
            }
        }
        best
    }
}
