//! World building: counts that are known, invariants that hold, validators that see.

mod common;

use std::collections::{HashMap, HashSet};

use common::{dense_soup, grid, strewn_soup};
use glam::Vec3;
use umbrage_core::world::{EdgeUse, World, WorldError, WorldFault};
use umbrage_core::{Casting, Mesh};

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh {
        positions: positions.iter().copied().map(Vec3::from).collect(),
        triangles: triangles.to_vec(),
        casting: vec![Casting::Both; triangles.len()],
        ..Mesh::default()
    }
}

#[test]
fn random_soups_keep_every_invariant() {
    for seed in 0..40 {
        let soup = if seed % 2 == 0 {
            dense_soup(seed, 3 + seed as usize, 200)
        } else {
            strewn_soup(seed, 300, 0.1)
        };
        let world = World::build(&soup).unwrap();
        world.validate().unwrap();
        let report = &world.report;
        assert_eq!(
            report.triangles + report.degenerate_triangles,
            soup.triangles.len()
        );
        assert_eq!(
            report.edges_by_triangles.iter().sum::<usize>(),
            report.unique_edges
        );
        for (t, &source) in world.source.iter().enumerate() {
            assert_eq!(world.corners(t as u32), soup.corners(source as usize));
            assert_eq!(world.casting[t], soup.casting[source as usize]);
        }
    }
}

/// Against the plain way to count: a map from vertex pairs to triangles.
#[test]
fn counts_are_those_of_a_map() {
    for soup in [
        dense_soup(1, 9, 3000),
        dense_soup(2, 40, 5000),
        strewn_soup(3, 30_000, 0.1),
        grid(40),
    ] {
        let world = World::build(&soup).unwrap();
        let (mut edges, mut triples) = (HashMap::new(), HashSet::new());
        let mut duplicates = 0;
        for &t in &world.triangles {
            let mut sorted = t;
            sorted.sort_unstable();
            duplicates += usize::from(!triples.insert(sorted));
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let along: &mut Vec<bool> = edges.entry((a.min(b), a.max(b))).or_default();
                along.push(a < b);
            }
        }
        let mut by_triangles = [0; 4];
        for along in edges.values() {
            by_triangles[along.len().min(4) - 1] += 1;
        }
        let alike = |along: &&Vec<bool>| along.len() == 2 && along[0] == along[1];
        let report = &world.report;
        assert_eq!(report.unique_edges, edges.len());
        assert_eq!(report.edges_by_triangles, by_triangles);
        assert_eq!(
            report.opposite_wound_pairs,
            edges.values().filter(alike).count()
        );
        assert_eq!(report.duplicate_triangles, duplicates);
        let distinct = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        let positions: HashSet<_> = soup.positions.iter().map(distinct).collect();
        assert_eq!(report.welded_vertices, positions.len());
    }
}

#[test]
fn a_grid_has_the_edges_that_euler_says() {
    let world = World::build(&grid(5)).unwrap();
    let report = &world.report;
    assert_eq!(
        (report.vertices, report.welded_vertices, report.triangles),
        (400, 121, 200)
    );
    // Vertices - edges + triangles = 1 for a disc.
    assert_eq!(report.unique_edges, 121 + 200 - 1);
    assert_eq!(report.edges_by_triangles, [40, 280, 0, 0]);
    assert_eq!(
        (report.opposite_wound_pairs, report.duplicate_triangles),
        (0, 0)
    );
}

#[test]
fn a_book_of_five_pages_is_one_edge_with_five_triangles() {
    let spine = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let pages = [
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 1.0],
    ];
    let positions: Vec<_> = spine.into_iter().chain(pages).collect();
    let triangles: Vec<[u32; 3]> = (2..7)
        .map(|v| if v % 2 == 0 { [0, 1, v] } else { [1, 0, v] })
        .collect();
    let report = World::build(&mesh(&positions, &triangles)).unwrap().report;
    assert_eq!(report.edges_by_triangles, [10, 0, 0, 1]);
}

#[test]
fn minus_zero_welds_with_zero_and_nothing_else_does() {
    let next = f32::from_bits(1);
    let soup = mesh(
        &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, -0.0],
            [next, 0.0, 0.0],
        ],
        &[[0, 1, 2], [3, 2, 1], [4, 1, 2]],
    );
    let report = World::build(&soup).unwrap().report;
    assert_eq!(report.welded_vertices, 4);
    assert_eq!(report.duplicate_triangles, 1);
    assert_eq!(report.edges_by_triangles, [2, 2, 1, 0]);
}

#[test]
fn triangles_with_two_equal_corners_are_dropped_and_collinear_ones_kept() {
    let soup = mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0; 3]],
        &[[0, 1, 3], [0, 1, 2], [1, 1, 2]],
    );
    let report = World::build(&soup).unwrap().report;
    assert_eq!((report.triangles, report.degenerate_triangles), (1, 2));
}

#[test]
fn an_empty_mesh_is_an_empty_world() {
    let world = World::build(&Mesh::default()).unwrap();
    assert!(world.bvh.nodes.is_empty() && world.triangles.is_empty());
    world.validate().unwrap();
}

#[test]
fn bad_input_is_named() {
    let good = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let mut short = good.clone();
    short.casting.clear();
    assert_eq!(
        World::build(&short).unwrap_err(),
        WorldError::CastingLength {
            casting: 0,
            triangles: 1
        }
    );
    let mut beyond = good.clone();
    beyond.triangles[0][1] = 3;
    assert_eq!(
        World::build(&beyond).unwrap_err(),
        WorldError::IndexOutOfRange {
            triangle: 0,
            vertex: 3,
            vertices: 3
        }
    );
    let mut nan = good;
    nan.positions[2].y = f32::NAN;
    assert_eq!(
        World::build(&nan).unwrap_err(),
        WorldError::NotFinite { vertex: 2 }
    );
}

/// Each validator has something that turns it red.
#[test]
fn validators_see_each_broken_invariant() {
    let good = World::build(&grid(3)).unwrap();
    let broken = |damage: &dyn Fn(&mut World)| {
        let mut world = good.clone();
        damage(&mut world);
        world.validate().unwrap_err()
    };
    assert!(matches!(
        broken(&|w| w.casting.to_mut().truncate(1)),
        WorldFault::Length { .. }
    ));
    assert!(matches!(
        broken(&|w| {
            let u = &mut w.edges.sides.to_mut()[0][1][3];
            *u = EdgeUse::new(u.edge(), u.sign() > 0);
        }),
        WorldFault::EdgeUse {
            triangle: 3,
            side: 1,
            ..
        }
    ));
    assert!(matches!(
        broken(&|w| {
            let [a, b] = w.edges.vertices[0];
            w.edges.vertices.to_mut().push([a, b]);
        }),
        WorldFault::EdgeNotUnique { .. }
    ));
    assert!(matches!(
        broken(&|w| w.positions.to_mut()[5] = w.positions[4]),
        WorldFault::NotWelded { .. }
    ));
    assert!(matches!(
        broken(&|w| w.clusters.to_mut()[0].sides[2].paired ^= 4),
        WorldFault::Cluster {
            triangle: 2,
            side: 2
        }
    ));
    assert!(matches!(
        broken(&|w| w.bvh.nodes.to_mut()[0].max.x -= 1.0),
        WorldFault::OutsideBox { node: 0, .. }
    ));
    assert!(matches!(
        broken(&|w| w.bvh.nodes.to_mut()[0].count -= 1),
        WorldFault::Range { .. }
    ));
}

/// The rule, all against all.
fn snapped(positions: &[Vec3], tolerance: f64) -> Vec<Vec3> {
    let mut staying: Vec<Vec3> = Vec::new();
    let snap = |&p: &Vec3| {
        let near = |q: &&Vec3| (q.as_dvec3() - p.as_dvec3()).length() <= tolerance;
        match staying.iter().find(near) {
            Some(&q) => q,
            None => {
                staying.push(p);
                p
            }
        }
    };
    positions.iter().map(snap).collect()
}

#[test]
fn welding_by_tolerance_moves_to_the_first_that_is_near() {
    for (seed, far) in (0..12).zip([0.0, 1e3, -1e6].into_iter().cycle()) {
        let mut soup = strewn_soup(seed, 300, 0.1);
        for p in &mut soup.positions {
            *p += Vec3::new(far, 0.0, -far);
        }
        for tolerance in [1e-30f32, 1e-6, 0.003, 0.02, 0.3, 10.0, 1e30] {
            let mut welded = soup.clone();
            let moved = welded.weld_within(tolerance).unwrap();
            assert!(welded.positions == snapped(&soup.positions, tolerance.into()));
            let pairs = soup.positions.iter().zip(&welded.positions);
            assert_eq!(moved, pairs.filter(|(p, q)| p != q).count());
            assert_eq!(welded.clone().weld_within(tolerance), Ok(0));
            let world = World::build(&welded).unwrap();
            assert!(world.triangles.len() <= soup.triangles.len());
        }
    }
}

/// Two cells of a floor that miss each other by a hair share an edge once they are welded.
#[test]
fn welding_by_tolerance_closes_cracks() {
    let mut floor = grid(2);
    for (i, p) in floor.positions.iter_mut().enumerate() {
        p.x += 1e-5 * (i % 7) as f32;
    }
    let cracked = World::build(&floor).unwrap().report;
    assert!(cracked.edges_by_triangles[0] > 40);
    let before = floor.fingerprint();
    assert!(floor.weld_within(1e-3).unwrap() > 0);
    let whole = World::build(&floor).unwrap().report;
    assert_eq!(whole.edges_by_triangles, [16, 40, 0, 0]);
    assert_eq!((whole.welded_vertices, whole.degenerate_triangles), (25, 0));
    // So a saved world of one is not taken for the other's.
    assert_ne!(floor.fingerprint(), before);
    // Wider than a cell, nothing is left of it.
    floor.weld_within(100.0).unwrap();
    let gone = World::build(&floor).unwrap().report;
    assert_eq!((gone.triangles, gone.degenerate_triangles), (0, 32));
}

#[test]
fn a_tolerance_is_a_length() {
    for tolerance in [-1.0, f32::NAN, f32::INFINITY] {
        let refused = grid(1).weld_within(tolerance).unwrap_err();
        assert!(matches!(refused, WorldError::Tolerance { .. }));
        assert!(refused.to_string().contains("finite length"));
    }
    let mut floor = grid(1);
    floor.positions[0].x = f32::NAN;
    let kept = floor.clone();
    assert_eq!(floor.weld_within(0.0), Ok(0));
    assert_eq!(floor.weld_within(1e-3), Ok(0));
    assert!(World::build(&floor).is_err() && kept.triangles == floor.triangles);
}
