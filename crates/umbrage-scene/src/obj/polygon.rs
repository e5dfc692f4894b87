//! A concave polygon as triangles.
//!
//! Takes the corners of a polygon; gives `corners - 2` triangles of its winding, by cutting ears in
//! the plane that it faces most. Convex polygons and those of more than [`MOST_EARS`] corners are
//! left alone, since they may become a fan; what has no ear left becomes one too, whose boundary is
//! the polygon's. Source: Meisters, "Polygons have ears", 1975.

use glam::{DVec2, DVec3, Vec3};

/// Cutting ears takes quadratic to cubic time, so it is bounded.
const MOST_EARS: usize = 256;

/// Appends the triangles of a concave polygon with `count` corners at `place(0..count)`; false if
/// it is to be a fan.
pub(super) fn cut(
    count: usize,
    place: impl Fn(usize) -> Vec3,
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    if !(4..=MOST_EARS).contains(&count) {
        return false;
    }
    let flat = flatten(count, &place);
    let at = |i: usize| flat[i % count];
    let concave = (0..count).any(|i| turn(at(i + count - 1), at(i), at(i + 1)) < 0.0);
    if concave {
        cut_ears(&flat, triangles);
    }
    concave
}

/// The corners in the plane of two axes, turned so that the polygon winds counter-clockwise.
fn flatten(count: usize, place: &impl Fn(usize) -> Vec3) -> Vec<DVec2> {
    let first = place(0).as_dvec3();
    let corners: Vec<DVec3> = (0..count).map(|i| place(i).as_dvec3() - first).collect();
    let normal: DVec3 = (0..count)
        .map(|i| corners[i].cross(corners[(i + 1) % count]))
        .sum();
    let axis = normal.abs().max_position();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let sign = if normal[axis] < 0.0 { -1.0 } else { 1.0 };
    corners
        .iter()
        .map(|c| DVec2::new(c[u] * sign, c[v]))
        .collect()
}

/// Twice the signed area of a triangle; positive if it turns left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

fn cut_ears(flat: &[DVec2], triangles: &mut Vec<[u32; 3]>) {
    let mut left: Vec<u32> = (0..flat.len() as u32).collect();
    while left.len() > 3 {
        let n = left.len();
        let corner = |i: usize| left[i % n];
        let at = |i: usize| flat[corner(i) as usize];
        let is_ear = |i: &usize| {
            let [a, b, c] = [at(i + n - 1), at(*i), at(i + 1)];
            let inside =
                |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            let others = (i + 2..i + n - 1)
                .map(at)
                .filter(|p| ![a, b, c].contains(p));
            turn(a, b, c) > 0.0 && !others.into_iter().any(inside)
        };
        let Some(ear) = (0..n).find(is_ear) else {
            break;
        };
        triangles.push([corner(ear + n - 1), corner(ear), corner(ear + 1)]);
        left.remove(ear);
    }
    triangles.extend(left[1..].windows(2).map(|w| [left[0], w[0], w[1]]));
}
