//! Hidden casters and quads out of range, against brute force in f64 that shares no code with them.

mod common;

use common::{Random, dense_soup, grid, point_light, spot, strewn_soup, sun};
use glam::{DVec3, Vec3};
use umbrage_core::volume::{
    Chain, ChainTriangle, HiddenScratch, Quad, QuadRange, QuadReach, check_closed, counter,
    drop_hidden, facing, range_first,
};
use umbrage_core::world::{Layer, Subset, World, query};
use umbrage_core::{Casting, Light, LightShape, Mesh};

fn chain(world: &World, light: &Light) -> Vec<Chain> {
    let (mut subset, mut chain) = (Subset::default(), Vec::new());
    query(world, Layer::Fixed, light, &mut subset);
    facing(world, light, &subset, &mut chain);
    chain
}

fn quads(world: &World, chain: &[Chain]) -> Vec<Quad> {
    let mut counters = vec![0; world.edges.vertices.len()];
    let mut quads = Vec::new();
    counter(world, chain, &mut counters, &mut Vec::new(), &mut quads);
    quads
}

fn triangles(chain: &[Chain]) -> Vec<u32> {
    let all = chain.iter().flat_map(Chain::triangles);
    all.map(ChainTriangle::triangle).collect()
}

/// The chain before and after, as triangles.
fn before_and_after(world: &World, light: &Light) -> (Vec<Chain>, Vec<Chain>) {
    let before = chain(world, light);
    let mut after = before.clone();
    let dropped = drop_hidden(world, light, &mut after, &mut HiddenScratch::default());
    assert_eq!(
        triangles(&before).len(),
        triangles(&after).len() + dropped as usize
    );
    (before, after)
}

/// Start and direction of the light's ray to `p`, which it reaches at 1.
fn ray(light: &Light, p: DVec3) -> (DVec3, DVec3) {
    match light.shape {
        LightShape::Directional { direction } => {
            let d = 100.0 * direction.as_dvec3();
            (p - d, d)
        }
        _ => (light.position, p - light.position),
    }
}

fn in_reach(light: &Light, p: DVec3) -> bool {
    let v = p - light.position;
    match light.shape {
        LightShape::Directional { .. } => true,
        LightShape::Point => v.length() <= f64::from(light.range),
        LightShape::Spot {
            direction,
            cos_outer,
        } => {
            v.length() <= f64::from(light.range)
                && v.normalize().dot(direction.as_dvec3()) >= f64::from(cos_outer)
        }
    }
}

/// Where the ray meets a triangle grown by `grow` in barycentric coordinates.
fn hit([a, b, c]: [DVec3; 3], start: DVec3, along: DVec3, grow: f64) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = along.cross(v);
    let determinant = u.dot(p);
    let from = (start - a) / determinant;
    let (s, q) = (from.dot(p), from.cross(u));
    let t = along.dot(q);
    let inside = s >= -grow && t >= -grow && s + t <= 1.0 + grow;
    (determinant != 0.0 && inside).then(|| v.dot(q))
}

/// Whether one of `casters` shades `p`. With `grow` above 0 in doubt yes, below 0 in doubt no.
fn shaded(world: &World, light: &Light, casters: &[u32], p: DVec3, grow: f64) -> bool {
    let (start, along) = ray(light, p);
    // Samples may lie close to where casters cross.
    let before = 1.0 - if grow > 0.0 { 1e-10 } else { 1e-7 };
    casters.iter().any(|&t| {
        hit(world.corners(t), start, along, grow).is_some_and(|at| at > 0.0 && at < before)
    })
}

fn point_of(world: &World, t: u32, r: &mut Random) -> DVec3 {
    let [a, b, c] = world.corners(t);
    let (u, v) = (f64::from(r.signed().abs()), f64::from(r.signed().abs()));
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    a + u * (b - a) + v * (c - a)
}

/// Checks one light by samples; gives how many triangles were dropped.
fn check(world: &World, light: &Light, r: &mut Random) -> usize {
    let (before, after) = before_and_after(world, light);
    check_closed(
        world,
        after.iter().flat_map(Chain::triangles),
        &quads(world, &after),
    )
    .unwrap();
    let (all, kept) = (triangles(&before), triangles(&after));
    for &t in all.iter().filter(|t| !kept.contains(t)) {
        for _ in 0..40 {
            let p = point_of(world, t, r);
            assert!(
                !in_reach(light, p) || shaded(world, light, &kept, p, 1e-6),
                "{light:?}: {p} of dropped triangle {t} is lit"
            );
        }
    }
    for _ in 0..300 {
        let p = 1.5 * r.point().as_dvec3();
        if in_reach(light, p) && shaded(world, light, &all, p, -1e-6) {
            assert!(
                shaded(world, light, &kept, p, 1e-6),
                "{light:?}: {p} is no longer in shadow"
            );
        }
    }
    all.len() - kept.len()
}

fn lights(r: &mut Random) -> Vec<Light> {
    vec![
        point_light(0.9 * r.point(), 0.8),
        point_light(2.0 * r.point(), 2.5),
        point_light(0.9 * r.point(), f32::INFINITY),
        spot(r.point(), r.point(), 0.8, 0.9),
        spot(r.point(), r.point(), 0.1, 3.0),
        spot(r.point(), r.point(), -0.3, 1.5),
        sun(r.point()),
    ]
}

fn check_worlds(meshes: impl IntoIterator<Item = Mesh>, least_dropped: usize) {
    let mut r = Random(11);
    let mut dropped = 0;
    for mesh in meshes {
        let world = World::build(&mesh).unwrap();
        for light in lights(&mut r) {
            dropped += check(&world, &light, &mut r);
        }
    }
    assert!(
        dropped >= least_dropped,
        "{dropped} dropped triangles are too few to test anything"
    );
}

fn both_sides(mut mesh: Mesh) -> Mesh {
    mesh.casting.fill(Casting::Both);
    mesh
}

/// Appends a box; `inward`: its faces look in.
fn add_box(mesh: &mut Mesh, min: Vec3, max: Vec3, inward: bool) {
    let first = mesh.positions.len() as u32;
    for i in 0..8 {
        let pick = |bit: u32, axis: usize| {
            if i >> bit & 1 == 1 {
                max[axis]
            } else {
                min[axis]
            }
        };
        mesh.positions
            .push(Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2)));
    }
    // Counter-clockwise from outside.
    for [a, b, c, d] in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        for t in [[a, b, c], [a, c, d]] {
            let [a, b, c] = t.map(|v| first + v);
            mesh.triangles
                .push(if inward { [a, c, b] } else { [a, b, c] });
            mesh.casting.push(Casting::Front);
        }
    }
}

/// A room of boxes, some of which stand on its floor.
fn room(seed: u64) -> Mesh {
    let mut r = Random(seed);
    let mut mesh = Mesh::default();
    add_box(&mut mesh, Vec3::splat(-1.0), Vec3::splat(1.0), true);
    for i in 0..12 {
        let mut min = 0.8 * r.point();
        if i % 2 == 0 {
            min.y = -1.0;
        }
        let size = Vec3::splat(0.05) + 0.3 * r.point().abs();
        add_box(&mut mesh, min, min + size, false);
    }
    mesh
}

/// A bumpy ball; closed.
fn ball(n: u32, seed: u64) -> Mesh {
    let mut r = Random(seed);
    let mut mesh = Mesh::default();
    for ring in 0..=n {
        for step in 0..2 * n {
            let (down, around) = (
                ring as f32 / n as f32 * std::f32::consts::PI,
                step as f32 / n as f32 * std::f32::consts::PI,
            );
            let bump = if ring % n == 0 {
                0.7
            } else {
                0.6 + 0.2 * r.signed()
            };
            mesh.positions.push(
                bump * Vec3::new(
                    if ring % n == 0 {
                        0.0
                    } else {
                        down.sin() * around.cos()
                    },
                    if ring == 0 {
                        1.0
                    } else if ring == n {
                        -1.0
                    } else {
                        down.cos()
                    },
                    if ring % n == 0 {
                        0.0
                    } else {
                        down.sin() * around.sin()
                    },
                ),
            );
        }
    }
    for ring in 0..n {
        for step in 0..2 * n {
            let at = |ring: u32, step: u32| ring * 2 * n + step % (2 * n);
            let (a, b) = (at(ring, step), at(ring, step + 1));
            let (c, d) = (at(ring + 1, step), at(ring + 1, step + 1));
            mesh.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    mesh.casting = vec![Casting::Front; mesh.triangles.len()];
    mesh
}

/// Levels above each other, cells not aligned: T-junctions as seen from any light.
fn floors() -> Mesh {
    let mut mesh = grid(4);
    for (level, shift) in [(0.3, 0.5), (-0.4, 0.25)] {
        let more = grid(3);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(
            more.positions
                .iter()
                .map(|p| *p + Vec3::new(shift, 4.0 * level, shift)),
        );
        let shifted = more.triangles.iter().map(|t| t.map(|v| v + first));
        mesh.triangles.extend(shifted);
        mesh.casting.extend(more.casting);
    }
    for p in &mut mesh.positions {
        *p *= 0.25;
    }
    both_sides(mesh)
}

#[test]
fn soups_keep_their_shadows() {
    check_worlds((0..25).map(|seed| dense_soup(seed, 30, 150)), 200);
    check_worlds(
        (0..12).map(|seed| both_sides(strewn_soup(seed, 250, 0.3))),
        200,
    );
}

#[test]
fn rooms_balls_and_floors_keep_their_shadows() {
    check_worlds((0..20).map(room), 100);
    check_worlds(
        (0..8).flat_map(|seed| [ball(8, seed), both_sides(ball(8, seed))]),
        100,
    );
    check_worlds((0..8).map(|_| floors()), 100);
}

/// Dropping never adds a quad that can matter.
#[test]
fn quads_in_reach_do_not_grow() {
    let mut r = Random(5);
    for seed in 0..30 {
        let meshes = [room(seed), ball(6, seed), dense_soup(seed, 30, 150)];
        for world in meshes.map(|mesh| World::build(&mesh).unwrap()) {
            for light in lights(&mut r) {
                let (before, after) = before_and_after(&world, &light);
                let counted = [before, after].map(|chain| {
                    let mut quads = quads(&world, &chain);
                    range_first(&world, &light, &mut quads, &mut Vec::new()).reach
                });
                assert!(counted[1] <= counted[0], "{counted:?} {light:?}");
            }
        }
    }
}

/// A triangle below others, under a light far above; gives whether it was dropped.
fn drops_the_last(corners: &[[[f32; 3]; 3]], lights: &[Light]) -> Vec<bool> {
    let mut mesh = Mesh::default();
    for corners in corners {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(Vec3::from));
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.casting.push(Casting::Both);
    }
    let world = World::build(&mesh).unwrap();
    let last = (corners.len() - 1) as u32;
    lights
        .iter()
        .map(|light| {
            let (before, after) = before_and_after(&world, light);
            let has = |chain: &[Chain]| {
                let mut triangles = triangles(chain).into_iter();
                triangles.any(|t| world.source[t as usize] == last)
            };
            assert!(has(&before));
            !has(&after)
        })
        .collect()
}

/// Level triangles around the axis: at height `y`, with corners at (x, z).
fn level(y: f32, corners: [[f32; 2]; 3]) -> [[f32; 3]; 3] {
    corners.map(|[x, z]| [x, y, z])
}

const SMALL: [[f32; 2]; 3] = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
const LARGE: [[f32; 2]; 3] = [[-1.0, -1.0], [-1.0, 4.0], [4.0, -1.0]];

fn above() -> [Light; 3] {
    [
        point_light(Vec3::new(0.3, 5.0, 0.3), 50.0),
        spot(Vec3::new(0.3, 5.0, 0.3), Vec3::NEG_Y, 0.5, 50.0),
        sun(Vec3::NEG_Y),
    ]
}

#[test]
fn a_triangle_behind_another_is_dropped() {
    let pair = [level(1.0, LARGE), level(0.0, SMALL)];
    assert_eq!(drops_the_last(&pair, &above()), [true; 3]);
}

#[test]
fn a_triangle_behind_a_patch_is_dropped() {
    // The patch is split along a diagonal through the middle of what it hides; the halves share
    // an edge by position only.
    let patch = [
        level(1.0, [[-1.0, -1.0], [-1.0, 4.0], [1.5, 1.5]]),
        level(1.0, [[-1.0, -1.0], [1.5, 1.5], [4.0, -1.0]]),
        level(0.0, SMALL),
    ];
    assert_eq!(drops_the_last(&patch, &above()), [true; 3]);
}

#[test]
fn a_tiny_lit_corner_keeps_a_triangle() {
    // Seen straight from above the small triangle ends at 1.0, the large one a little before.
    let shy = [[-1.0, -1.0], [-1.0, 2.9999], [1.0 - 1e-4, -1.0]];
    let pair = [level(1e-5, shy), level(0.0, SMALL)];
    assert_eq!(drops_the_last(&pair, &above()), [false; 3]);
}

#[test]
fn a_gap_in_a_patch_keeps_a_triangle() {
    let patch = [
        level(1.0, [[-1.0, -1.0], [-1.0, 4.0], [1.5, 1.5]]),
        level(
            1.0,
            [[-1.0 + 1e-4, -1.0 - 1e-4], [1.5, 1.5 - 1e-4], [4.0, -1.0]],
        ),
        level(0.0, SMALL),
    ];
    assert_eq!(drops_the_last(&patch, &above()), [false; 3]);
}

#[test]
fn what_is_behind_hides_nothing() {
    let pair = [level(-1.0, LARGE), level(0.0, SMALL)];
    assert_eq!(drops_the_last(&pair, &above()), [false; 3]);
}

#[test]
fn a_crossing_triangle_hides_only_what_it_is_in_front_of() {
    let tilted = |low: f32| LARGE.map(|[x, z]| [x, if x < 0.0 { low } else { 2.0 }, z]);
    // Crosses the small triangle, just touches its corner from above, stays above.
    for (low, hidden) in [(-1.0, false), (-0.6, false), (-0.4, true), (0.1, true)] {
        let pair = [tilted(low), level(0.0, SMALL)];
        assert_eq!(drops_the_last(&pair, &above()), [hidden; 3], "{low}");
    }
}

/// Coplanar casters do not hide each other, whatever their winding and size.
#[test]
fn of_duplicates_one_stays() {
    for [first, second] in [[SMALL, SMALL], [LARGE, SMALL], [SMALL, LARGE]] {
        for turned in [false, true] {
            let mut second = level(0.0, second);
            if turned {
                second.swap(1, 2);
            }
            let pair = [level(0.0, first), second];
            assert_eq!(drops_the_last(&pair, &above()), [false; 3]);
        }
    }
}

#[test]
fn a_caster_seen_edge_on_hides_nothing() {
    let light = point_light(Vec3::new(-3.0, 1.0, 0.3), 50.0);
    let wall = [[2.0, -3.0, -3.0], [2.0, -3.0, 3.0], [2.0, 6.0, 0.0]];
    for off in [1e-6, 1e-2] {
        let edge_on = level(1.0 + off, LARGE);
        assert_eq!(drops_the_last(&[edge_on, wall], &[light]), [false]);
    }
}

/// Only what the light reaches must be covered.
#[test]
fn parts_out_of_range_need_no_cover() {
    let cover = level(1.0, [[-3.0, -3.0], [-3.0, 8.0], [8.0, -3.0]]);
    let floor = level(0.0, [[-50.0, -50.0], [-50.0, 150.0], [150.0, -50.0]]);
    let light = |range| point_light(Vec3::new(0.0, 3.0, 0.0), range);
    let lights = [light(3.5), light(40.0)];
    assert_eq!(drops_the_last(&[cover, floor], &lights), [true, false]);
    let narrow = |cos| spot(Vec3::new(0.0, 3.0, 0.0), Vec3::NEG_Y, cos, 100.0);
    let lights = [narrow(0.95), narrow(0.3)];
    assert_eq!(drops_the_last(&[cover, floor], &lights), [true, false]);
}

/// A chain long enough for all threads: verdicts are those of one.
#[test]
fn threads_do_not_matter() {
    let world = World::build(&both_sides(strewn_soup(9, 30_000, 0.05))).unwrap();
    let light = sun(Vec3::new(0.3, -1.0, 0.2));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let run = || before_and_after(&world, &light).1;
        pool.build().unwrap().install(run)
    };
    let one = with(1);
    assert!(triangles(&one).len() < 29_000);
    assert_eq!(one, with(4));
    // Scratch that has seen another light changes nothing either.
    let mut scratch = HiddenScratch::default();
    let other = point_light(Vec3::new(0.1, 0.2, 0.3), 0.5);
    drop_hidden(&world, &other, &mut chain(&world, &other), &mut scratch);
    let mut again = chain(&world, &light);
    drop_hidden(&world, &light, &mut again, &mut scratch);
    assert_eq!(one, again);
}

#[test]
fn part_of_a_chain_is_hidden_by_that_part_only() {
    let mut r = Random(3);
    let world = World::build(&room(3)).unwrap();
    for light in lights(&mut r) {
        let mut part = chain(&world, &light);
        for clusters in &mut part {
            clusters.wound &= 0x5555_5555_5555_5555;
        }
        part.retain(|clusters| !clusters.is_empty());
        let all = triangles(&part);
        drop_hidden(&world, &light, &mut part, &mut HiddenScratch::default());
        let kept = triangles(&part);
        for &t in all.iter().filter(|t| !kept.contains(t)) {
            let p = point_of(&world, t, &mut r);
            assert!(!in_reach(&light, p) || shaded(&world, &light, &kept, p, 1e-6));
        }
    }
}

/// Points of out-of-range quads, sampled: none is in reach; and segments between points in reach
/// never cross one.
#[test]
fn quads_behind_the_prefix_do_not_matter() {
    let mut r = Random(8);
    let (mut beyond, mut aside) = (0, 0);
    for seed in 0..30 {
        let world = World::build(&strewn_soup(seed, 200, 0.4)).unwrap();
        for light in lights(&mut r) {
            let mut sorted = quads(&world, &chain(&world, &light));
            let unsorted = sorted.clone();
            let prefix = range_first(&world, &light, &mut sorted, &mut Vec::new());
            let class = |q: &Quad| {
                let ends = q.ends(&world.edges).map(|v| world.places().at(v));
                QuadReach::new(&light).of_edge(ends)
            };
            let mut stable = unsorted.clone();
            stable.sort_by_key(class);
            assert_eq!(sorted, stable);
            let count = |c| unsorted.iter().filter(|q| class(q) == c).count() as u32;
            assert_eq!(prefix.reach, count(QuadRange::Reach));
            assert_eq!(prefix.range, prefix.reach + count(QuadRange::Range));
            beyond += count(QuadRange::Beyond);
            aside += count(QuadRange::Range);

            let all = sorted.len() as u32;
            for _ in 0..40 {
                let [eye, seen] = [0; 2].map(|_| 1.5 * r.point().as_dvec3());
                let drawn = prefix.for_eye(&light, eye, all);
                if !in_reach(&light, seen) {
                    continue;
                }
                for q in &sorted[drawn as usize..] {
                    let ends = q.ends(&world.edges).map(|v| world.places().at(v));
                    assert!(!crosses(&light, ends, eye, seen), "{light:?} {eye} {seen}");
                }
            }
        }
    }
    assert!(beyond > 500 && aside > 500, "{beyond} {aside}");
}

/// Whether a segment crosses the quad of an edge (an infinite one).
fn crosses(light: &Light, ends: [DVec3; 2], from: DVec3, to: DVec3) -> bool {
    let [a, b] = ends;
    let apex = light.position;
    let normal = (a - apex).cross(b - apex);
    let (h, k) = (normal.dot(from - apex), normal.dot(to - apex));
    if h * k >= 0.0 {
        return false;
    }
    let p = from + (to - from) * (h / (h - k));
    let inside = normal.dot((a - apex).cross(p - apex)) >= 0.0
        && normal.dot((p - apex).cross(b - apex)) >= 0.0;
    // Beyond the edge, in the plane of the wedge.
    let outward = (b - a).cross(normal);
    let sign = outward.dot(a - apex).signum();
    inside && sign * outward.dot(p - a) >= 0.0
}

/// Negative control of the crossing test: quads in reach are crossed.
#[test]
fn quads_of_the_prefix_do_matter() {
    let mut r = Random(2);
    let world = World::build(&strewn_soup(1, 200, 0.4)).unwrap();
    let light = point_light(Vec3::ZERO, 1.5);
    let mut list = quads(&world, &chain(&world, &light));
    let prefix = range_first(&world, &light, &mut list, &mut Vec::new());
    let crossed = list[..prefix.reach as usize].iter().filter(|q| {
        let ends = q.ends(&world.edges).map(|v| world.places().at(v));
        (0..50).any(|_| crosses(&light, ends, r.point().as_dvec3(), r.point().as_dvec3()))
    });
    assert!(crossed.count() > 20);
}

/// A light within 3e-7 m of a corner of a triangle of metres: as seen by the other corners it is in
/// the plane, where `plane . r` is rounding of more than the margin by which a caster must be nearer.
/// The triangle hid itself, and cast no shadow at all.
#[test]
fn a_light_beside_a_corner_does_not_let_the_triangle_hide_itself() {
    let found = [
        (
            [
                Vec3::new(3.3333712, -1.128706, -2.4958916),
                Vec3::new(1.8849528, -0.24019098, -3.2375653),
                Vec3::new(2.4892647, -1.0304615, -1.989162),
            ],
            Vec3::new(3.333371, -1.128706, -2.4958913),
        ),
        (
            [
                Vec3::new(1.5801172, -3.5471287, 0.650249),
                Vec3::new(3.223247, -2.8404763, 1.4731326),
                Vec3::new(2.5183792, -4.611724, 0.8934684),
            ],
            Vec3::new(1.5801172, -3.5471284, 0.650249),
        ),
    ];
    for (positions, light) in found {
        let mesh = Mesh {
            positions: positions.to_vec(),
            triangles: vec![[0, 1, 2]],
            casting: vec![Casting::Both],
            ..Mesh::default()
        };
        let world = World::build(&mesh).unwrap();
        let (before, after) = before_and_after(&world, &point_light(light, 5.0));
        assert_eq!(triangles(&before), [0]);
        assert_eq!(triangles(&after), [0], "seen from {light}");
    }
}
