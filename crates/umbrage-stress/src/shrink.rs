//! Shrinking: from a case that fails to one in which nothing can be left out.
//!
//! Takes a case and a test that says whether a case fails in the same way; gives a smaller one that
//! does. Lights and views are left out one at a time, triangles by delta debugging (Zeller and
//! Hildebrandt, "Simplifying and isolating failure-inducing input", IEEE Transactions on Software
//! Engineering 28, 2002), and what is left is made as plain as the failure allows.

use umbrage_core::{Casting, Mesh};

use crate::case::Case;

/// The smallest case found. `fails` must hold for `case`.
pub fn shrink(case: &Case, fails: &mut dyn FnMut(&Case) -> bool) -> Case {
    let mut best = case.clone();
    loop {
        let before = weight(&best);
        fewer(&mut best, |case| &mut case.lights, fails);
        fewer(&mut best, |case| &mut case.views, fails);
        fewer(&mut best, |case| &mut case.points, fails);
        fewer_triangles(&mut best, fails);
        plainer_rules(&mut best, fails);
        if weight(&best) == before {
            return best;
        }
    }
}

/// What shrinks.
fn weight(case: &Case) -> [usize; 5] {
    let rules = case.mesh.casting.iter();
    let odd = rules.filter(|rule| matches!(rule, Casting::None | Casting::Back));
    [
        case.mesh.triangles.len(),
        case.lights.len(),
        case.views.len(),
        case.points.len(),
        odd.count(),
    ]
}

/// Leaves out members of a list, one at a time.
fn fewer<T: Clone>(
    best: &mut Case,
    list: fn(&mut Case) -> &mut Vec<T>,
    fails: &mut dyn FnMut(&Case) -> bool,
) {
    for k in (0..list(best).len()).rev() {
        let mut candidate = best.clone();
        list(&mut candidate).remove(k);
        if fails(&candidate) {
            *best = candidate;
        }
    }
}

/// Leaves out ever smaller runs of triangles.
fn fewer_triangles(best: &mut Case, fails: &mut dyn FnMut(&Case) -> bool) {
    let mut run = best.mesh.triangles.len().div_ceil(2);
    while run > 0 {
        let mut first = 0;
        while first < best.mesh.triangles.len() {
            let end = (first + run).min(best.mesh.triangles.len());
            let candidate = Case {
                mesh: without(&best.mesh, first..end),
                ..best.clone()
            };
            if fails(&candidate) {
                *best = candidate;
            } else {
                first = end;
            }
        }
        run = if run == 1 { 0 } else { run.div_ceil(2) };
    }
}

/// The mesh without some triangles, and without vertices that then are of no use.
fn without(mesh: &Mesh, out: std::ops::Range<usize>) -> Mesh {
    let mut left = Mesh::default();
    let mut place = vec![u32::MAX; mesh.positions.len()];
    for t in (0..mesh.triangles.len()).filter(|t| !out.contains(t)) {
        let corners = mesh.triangles[t].map(|v| {
            let at = &mut place[v as usize];
            if *at == u32::MAX {
                *at = left.positions.len() as u32;
                left.positions.push(mesh.positions[v as usize]);
                left.residuals.extend(mesh.residuals.get(v as usize));
            }
            *at
        });
        left.triangles.push(corners);
        left.casting.push(mesh.casting[t]);
    }
    left
}

/// Gives triangles rules that a file's materials can say.
fn plainer_rules(best: &mut Case, fails: &mut dyn FnMut(&Case) -> bool) {
    for t in 0..best.mesh.triangles.len() {
        let rule = best.mesh.casting[t];
        if matches!(rule, Casting::Front | Casting::Both) {
            continue;
        }
        let [a, b, c] = best.mesh.triangles[t];
        for (corners, rule) in [
            ([a, c, b], Casting::Front),
            ([a, b, c], Casting::Both),
            ([a, b, c], Casting::Front),
        ] {
            let mut candidate = best.clone();
            candidate.mesh.triangles[t] = corners;
            candidate.mesh.casting[t] = rule;
            if fails(&candidate) {
                *best = candidate;
                break;
            }
        }
    }
}
