//! Closed meshes: boxes and balls, in each other and through each other.

use glam::Vec3;

use super::placed::{furnish, near};
use super::soup::Rules;
use crate::case::{Case, look, point};
use crate::rng::Random;

/// Boxes and balls with the light in one of them, often in several.
pub(super) fn closed(random: &mut Random) -> Case {
    let rules = Rules::any(random);
    let mut case = boxes(random, rules);
    for _ in 0..random.count(0, 2) {
        let (at, radius) = (random.point(3.0), random.within(0.3, 3.0));
        ball(&mut case, random, rules, at, radius);
    }
    furnish(&mut case, random);
    let inside = case.corners(random.below(case.mesh.triangles.len()))[0];
    let inward = random.point(0.4);
    let range = random.within(1.0, 30.0);
    case.lights.push(point(inside + inward, range));
    if random.one_in(2) {
        let eye = inside + random.point(0.5);
        let near = near(&case);
        case.views[0] = look(eye, eye + random.direction(), near);
    }
    case
}

/// Boxes on a lattice of 1/4, nested, apart, through each other, or sharing faces.
pub(super) fn boxes(random: &mut Random, rules: Rules) -> Case {
    let mut case = Case::default();
    for _ in 0..random.count(1, 4) {
        let on_lattice = |p: Vec3| (p * 4.0).round() * 0.25;
        let low = on_lattice(random.point(3.0));
        let size = on_lattice(random.point(2.0).abs()) + 0.25;
        let outwards = !random.one_in(4);
        let p =
            |k: usize| low + size * Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
        for [a, b, c, d] in FACES.map(|face| face.map(p)) {
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let rule = rules.of_one(random);
                case.triangle(if outwards { [a, b, c] } else { [a, c, b] }, rule);
            }
        }
    }
    case
}

/// Of a box, counter-clockwise from outside; bits 0, 1, 2 of a corner's number say high in x, y, z.
const FACES: [[usize; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// An octahedron, or one whose faces were cut in four.
fn ball(case: &mut Case, random: &mut Random, rules: Rules, at: Vec3, radius: f32) {
    let mut faces: Vec<[Vec3; 3]> = Vec::new();
    for [x, y, z] in [0, 1, 2, 3, 4, 5, 6, 7].map(|k| [k & 1, k >> 1 & 1, k >> 2]) {
        let sign = |bit: i32| 1.0 - 2.0 * bit as f32;
        let [a, b, c] = [Vec3::X * sign(x), Vec3::Y * sign(y), Vec3::Z * sign(z)];
        faces.push(if (x + y + z) % 2 == 0 {
            [a, b, c]
        } else {
            [a, c, b]
        });
    }
    if random.one_in(2) {
        let cut = |[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    for face in faces {
        let rule = rules.of_one(random);
        case.triangle(face.map(|p| at + p * radius), rule);
    }
}
