//! Positions in f64, kept as two f32 each.
//!
//! A vertex stands at `position + residual`, exactly: the position is the f64 rounded to f32, the
//! residual is what that leaves, rounded to f32. Together they have 48 bits: a fortieth of a
//! micrometre at 10,000 km. Where f32 holds every vertex there are no residuals, and nothing is paid
//! for them.
//!
//! **Why no cells.** A world cut in cells with origins of their own needs each border vertex to come
//! out alike from both sides. Here every vertex is in the arrays once, wherever it stands, and
//! neighbours share it as they share any other: there is no border. On the GPU a vertex relative to
//! the eye is `(p - eye) + (r - eye_r)`: near the eye the first difference is exact (Sterbenz), far
//! from it both are rounded to 2^-24 of the distance.

use glam::{DVec3, Vec3};

/// Position and residual of a point. Every f64 whose residual is not zero lies strictly between the
/// f32 before and after its position.
#[inline]
pub fn split(p: DVec3) -> [Vec3; 2] {
    // Adding zero turns -0 into 0.
    let position = p.as_vec3() + Vec3::ZERO;
    [position, (p - position.as_dvec3()).as_vec3() + Vec3::ZERO]
}

/// Where the vertices of a mesh or world stand.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// Rounded to f32.
    pub positions: &'a [Vec3],
    /// What that leaves; empty, or one a position.
    pub residuals: &'a [Vec3],
}

impl Places<'_> {
    /// Vertex `v`, exactly.
    #[inline]
    pub fn at(&self, v: u32) -> DVec3 {
        let position = self.positions[v as usize].as_dvec3();
        match self.residuals.is_empty() {
            true => position,
            false => position + self.residuals[v as usize].as_dvec3(),
        }
    }

    /// Lower and upper corner of a box around vertices: tight, or outward by the last bit where an
    /// f32 is not enough.
    #[inline]
    pub fn bounds(&self, vertices: [u32; 3]) -> [Vec3; 2] {
        let [a, b, c] = vertices.map(|v| self.positions[v as usize]);
        if self.residuals.is_empty() {
            return [a.min(b).min(c), a.max(b).max(c)];
        }
        let [a, b, c] = vertices.map(|v| around(self.positions[v as usize], self.residual(v)));
        [a[0].min(b[0]).min(c[0]), a[1].max(b[1]).max(c[1])]
    }

    /// What f32 leaves of vertex `v`.
    #[inline]
    pub fn residual(&self, v: u32) -> Vec3 {
        self.residuals
            .get(v as usize)
            .copied()
            .unwrap_or(Vec3::ZERO)
    }
}

/// The f32 before and after `position + residual`, or the position itself if there is no residual.
fn around(position: Vec3, residual: Vec3) -> [Vec3; 2] {
    let outward = |i: usize, below: bool| match residual[i].total_cmp(&0.0) {
        std::cmp::Ordering::Less if below => position[i].next_down(),
        std::cmp::Ordering::Greater if !below => position[i].next_up(),
        _ => position[i],
    };
    [true, false].map(|below| Vec3::from_array([0, 1, 2].map(|i| outward(i, below))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_halves_are_the_whole() {
        let p = DVec3::new(1e7 + 0.001, -123.456_789_012, 3.0);
        let [position, residual] = split(p);
        let places = Places {
            positions: &[position],
            residuals: &[residual],
        };
        assert!((places.at(0) - p).abs().max_element() < 4e-8);
        assert_eq!(split(places.at(0)), [position, residual]);
        let [low, high] = places.bounds([0; 3]).map(Vec3::as_dvec3);
        assert!(low.cmple(places.at(0)).all() && high.cmpge(places.at(0)).all());
        assert_eq!((low.z, high.z), (3.0, 3.0));
        assert!(high.x - low.x <= 1.0);
    }
}
