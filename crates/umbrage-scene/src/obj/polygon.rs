//! A concave polygon as triangles.
//!
//! Takes the corners of a polygon; gives `corners - 2` triangles of its winding, by cutting ears in
//! the plane that it faces most. Convex polygons are left alone, since they may become a fan; what
//! has no ear left becomes one too, whose boundary is the polygon's. Polygons of more than
//! [`MOST_EARS`] corners are halved again and again: a fan of very many triangles at one vertex takes
//! trees quadratic time. Source: Meisters, "Polygons have ears", 1975.

use glam::{DVec2, DVec3, Vec3};

/// Cutting ears takes quadratic time, so corners are bounded.
const MOST_EARS: usize = 256;
/// Corners tried as ears for each that there is, or it would be cubic time. Two are common.
const TRIED: usize = 8;

/// Appends the triangles of a concave or very long polygon with `count` corners at
/// `place(0..count)`; false if it is to be a fan.
pub(super) fn cut(
    count: usize,
    place: impl Fn(usize) -> Vec3,
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    if count < 4 {
        return false;
    }
    if count > MOST_EARS {
        halve(0..count as u32 - 1, triangles);
        return true;
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

/// Appends the triangles between the chord from the first to the last corner and those between.
fn halve(corners: std::ops::Range<u32>, triangles: &mut Vec<[u32; 3]>) {
    let (first, last) = (corners.start, corners.end);
    if last - first < 2 {
        return;
    }
    let middle = first + (last - first) / 2;
    triangles.push([first, middle, last]);
    halve(first..middle, triangles);
    halve(middle..last, triangles);
}

fn cut_ears(flat: &[DVec2], triangles: &mut Vec<[u32; 3]>) {
    let mut left: Vec<u32> = (0..flat.len() as u32).collect();
    let (mut from, mut tries) = (0, TRIED * flat.len());
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
        let tried = (0..n.min(tries)).position(|k| is_ear(&((from + k) % n)));
        let Some(tried) = tried else {
            break;
        };
        let ear = (from + tried) % n;
        tries -= tried + 1;
        triangles.push([corner(ear + n - 1), corner(ear), corner(ear + 1)]);
        left.remove(ear);
        // Its neighbours may be ears now.
        from = ear.saturating_sub(1);
    }
    triangles.extend(left[1..].windows(2).map(|w| [left[0], w[0], w[1]]));
}
