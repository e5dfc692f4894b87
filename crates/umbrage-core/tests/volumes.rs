//! Queries, facing, counters: against the plainest possible versions.

mod common;

use std::collections::BTreeMap;

use common::{Random, dense_soup, grid, point_light, spot, strewn_soup, sun};
use glam::{DVec3, Vec3};
use umbrage_core::place::Places;
use umbrage_core::volume::{
    Chain, ChainTriangle, Quad, VolumeBuilder, Volumes, brute, check_closed, counter, facing,
    plain_counter,
};
use umbrage_core::world::{Layer, LightPoint, Planes, Reach, Subset, World, query};
use umbrage_core::{Casting, Light};

fn subset(world: &World, light: &Light) -> Subset {
    let mut subset = Subset::default();
    query(world, Layer::Fixed, light, &mut subset);
    subset
}

fn chain(world: &World, light: &Light) -> Vec<Chain> {
    let mut chain = Vec::new();
    facing(world, light, &subset(world, light), &mut chain);
    chain
}

fn triangles(chain: &[Chain]) -> Vec<ChainTriangle> {
    chain.iter().flat_map(Chain::triangles).collect()
}

fn lights(seed: u64) -> Vec<Light> {
    let mut r = Random(seed);
    vec![
        point_light(r.point(), 0.3),
        point_light(2.0 * r.point(), 1.0),
        point_light(r.point(), f32::INFINITY),
        spot(r.point(), r.point(), 0.8, 0.9),
        spot(r.point(), r.point(), 0.1, 3.0),
        sun(r.point()),
    ]
}

#[test]
fn a_query_returns_what_the_reach_touches() {
    for seed in 0..20 {
        let world = World::build(&strewn_soup(seed, 500, 0.08)).unwrap();
        for light in lights(seed) {
            let reach = Reach::new(&light);
            let all = 0..world.triangles.len() as u32;
            let touched: Vec<u32> = all.filter(|&t| reach.touches(world.bounds(t))).collect();
            let found: Vec<u32> = subset(&world, &light).triangles().collect();
            if matches!(light.shape, umbrage_core::LightShape::Spot { .. }) {
                // A node outside the cone takes all its triangles with it.
                assert!(
                    found.iter().all(|t| touched.binary_search(t).is_ok()),
                    "{light:?}"
                );
            } else {
                assert_eq!(found, touched, "{light:?}");
            }
        }
    }
}

/// Points of triangles, sampled: one within the light's reach puts its triangle in the subset.
#[test]
fn a_query_loses_no_triangle_in_reach() {
    for seed in 0..20 {
        let mut r = Random(seed);
        let world = World::build(&strewn_soup(seed, 300, 0.2)).unwrap();
        for light in lights(seed) {
            let found: Vec<u32> = subset(&world, &light).triangles().collect();
            for t in 0..world.triangles.len() as u32 {
                let [a, b, c] = world.corners(t);
                let (u, v) = (f64::from(r.signed().abs()), f64::from(r.signed().abs()));
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                let p = a + u * (b - a) + v * (c - a);
                if in_reach(&light, p) {
                    assert!(found.binary_search(&t).is_ok(), "{light:?} lost {t} at {p}");
                }
            }
        }
    }
}

fn in_reach(light: &Light, p: DVec3) -> bool {
    let v = p - light.position;
    match light.shape {
        umbrage_core::LightShape::Directional { .. } => true,
        umbrage_core::LightShape::Point => v.length() <= f64::from(light.range),
        umbrage_core::LightShape::Spot {
            direction,
            cos_outer,
        } => {
            v.length() <= f64::from(light.range)
                && v.normalize().dot(direction.as_dvec3()) >= f64::from(cos_outer)
        }
    }
}

#[test]
fn a_small_range_takes_a_small_part() {
    let world = World::build(&grid(20)).unwrap();
    let found = subset(&world, &point_light(Vec3::new(0.5, 0.5, 0.5), 1.0));
    assert!(found.len() <= 18, "{} triangles within 1 m", found.len());
}

fn planes_of(corners: &[Vec3; 3]) -> Planes {
    let places = Places {
        positions: corners,
        residuals: &[],
    };
    Planes::new(places, &[[0, 1, 2]])
}

/// On integer coordinates the determinant is exact in i64: sides must agree with it, also where
/// the light is in the plane.
#[test]
fn sides_are_exact() {
    let mut r = Random(7);
    let mut in_plane = 0;
    for _ in 0..20_000 {
        let scale = [3, 10, 1000][r.below(3)];
        let mut point = || [0; 3].map(|_| r.below(2 * scale + 1) as i64 - scale as i64);
        let [a, b, c, l] = [point(), point(), point(), point()];
        let minus = |p: [i64; 3], q: [i64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let (u, v, w) = (minus(b, a), minus(c, a), minus(l, a));
        let n = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        let exact = (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]).signum() as i8;
        in_plane += u32::from(exact == 0);
        let f = |p: [i64; 3]| Vec3::from(p.map(|x| x as f32));
        let corners = [f(a), f(b), f(c)];
        let planes = planes_of(&corners);
        let corners = corners.map(Vec3::as_dvec3);
        let light = LightPoint::new(&point_light(f(l), 1.0));
        assert_eq!(
            planes.side(0, &light, || corners),
            exact,
            "{a:?} {b:?} {c:?} {l:?}"
        );
    }
    assert!(
        in_plane > 150,
        "{in_plane} lights in the plane are too few to test that case"
    );
}

/// One ulp decides, far from the origin too.
#[test]
fn one_ulp_off_the_plane_is_off_the_plane() {
    for far in [0.0f32, 1e3, 1e6] {
        let corners = [[0.0, 1.0, 0.0], [0.0, 1.0, 8.0], [8.0, 1.0, 0.0]]
            .map(|p| Vec3::from(p) + Vec3::new(far, 0.0, -far));
        let planes = planes_of(&corners);
        let corners = corners.map(Vec3::as_dvec3);
        for (y, side) in [(1.0f32, 0), (1.0f32.next_up(), 1), (1.0f32.next_down(), -1)] {
            let light = point_light(Vec3::new(far + 3.0, y, 2.0 - far), 9.0);
            assert_eq!(planes.side(0, &LightPoint::new(&light), || corners), side);
        }
        let grazing = sun(Vec3::new(1.0, 0.0, 0.3));
        assert_eq!(planes.side(0, &LightPoint::new(&grazing), || corners), 0);
    }
}

/// The boundary by the definition: directed vertex pairs, summed.
fn boundary(world: &World, chain: &[ChainTriangle]) -> BTreeMap<[u32; 2], i32> {
    let mut sums = BTreeMap::new();
    for t in chain {
        let [a, b, c] = world.triangles[t.triangle() as usize];
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let sign = if from < to { 1 } else { -1 };
            *sums.entry([from.min(to), from.max(to)]).or_insert(0) += sign * t.coefficient();
        }
    }
    sums.retain(|_, sum| *sum != 0);
    sums
}

fn as_sums(world: &World, quads: &[Quad]) -> BTreeMap<[u32; 2], i32> {
    let mut sums = BTreeMap::new();
    for quad in quads {
        let [from, to] = quad.ends(&world.edges);
        let sign = if from < to { 1 } else { -1 };
        *sums.entry([from.min(to), from.max(to)]).or_insert(0) += sign;
    }
    sums.retain(|_, sum| *sum != 0);
    sums
}

#[test]
fn quads_are_the_boundary_of_the_chain() {
    for seed in 0..60 {
        let world = World::build(&dense_soup(seed, 4 + seed as usize / 2, 150)).unwrap();
        let mut counters = vec![0; world.edges.vertices.len()];
        for light in lights(seed) {
            let cast = chain(&world, &light);
            let (mut quads, mut plain, mut touched) = (Vec::new(), Vec::new(), Vec::new());
            counter(&world, &cast, &mut counters, &mut touched, &mut quads);
            assert!(
                counters.iter().all(|&c| c == 0),
                "counters must end as they began"
            );
            let by_triangle = triangles(&cast);
            assert_eq!(as_sums(&world, &quads), boundary(&world, &by_triangle));
            check_closed(&world, by_triangle.iter().copied(), &quads).unwrap();
            plain_counter(&world, &cast, &mut counters, &mut plain);
            let mut sorted = quads.clone();
            sorted.sort_unstable();
            plain.sort_unstable();
            assert_eq!(
                sorted, plain,
                "the fast counter must give the plain one's quads"
            );
            let mut each = Vec::new();
            brute(&world.edges, by_triangle.iter().copied(), &mut each);
            assert_eq!(each.len(), 3 * by_triangle.len());

            // Counters of disjoint parts add up.
            let (first, second) = cast.split_at(cast.len() / 3);
            let (mut of_first, mut of_second) = (Vec::new(), Vec::new());
            counter(&world, first, &mut counters, &mut touched, &mut of_first);
            counter(&world, second, &mut counters, &mut touched, &mut of_second);
            let mut sum = as_sums(&world, &of_first);
            for (edge, count) in as_sums(&world, &of_second) {
                *sum.entry(edge).or_insert(0) += count;
            }
            sum.retain(|_, count| *count != 0);
            assert_eq!(sum, as_sums(&world, &quads));

            if !quads.is_empty() {
                assert!(check_closed(&world, by_triangle.iter().copied(), &quads[1..]).is_err());
            }
        }
    }
}

#[test]
fn casting_rules_choose_the_side() {
    let mut soup = grid(1);
    let (above, below) = (Vec3::new(0.2, 2.0, 0.3), Vec3::new(0.2, -2.0, 0.3));
    for (rule, from_above, from_below) in [
        (Casting::None, 0, 0),
        (Casting::Front, 8, 0),
        (Casting::Both, 8, 8),
        (Casting::Back, 0, 8),
    ] {
        soup.casting.fill(rule);
        let world = World::build(&soup).unwrap();
        for (position, expected) in [(above, from_above), (below, from_below)] {
            let light = point_light(position, 9.0);
            assert_eq!(
                triangles(&chain(&world, &light)).len(),
                expected,
                "{rule:?}"
            );
        }
    }
}

#[test]
fn an_edge_of_three_facing_triangles_gives_its_quad_more_than_once() {
    // Three pages wound alike along the spine, all facing the light.
    let mut soup = dense_soup(0, 0, 0);
    soup.positions = [
        [0., 0., 0.],
        [0., 0., 1.],
        [1., 0., 0.5],
        [1., 0.3, 0.5],
        [1., -0.3, 0.5],
    ]
    .map(Vec3::from)
    .to_vec();
    soup.triangles = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]];
    soup.casting = vec![Casting::Both; 3];
    let world = World::build(&soup).unwrap();
    let light = point_light(Vec3::new(0.5, 5.0, 0.5), 20.0);
    let mut volumes = Volumes::default();
    VolumeBuilder::default().build(&world, &[light], |_| true, &mut volumes);
    let counts: Vec<i32> = as_sums(&world, volumes.quads_of(0)).into_values().collect();
    assert_eq!(
        counts.iter().filter(|c| c.abs() == 3).count(),
        1,
        "{counts:?}"
    );
    assert_eq!(volumes.quads_of(0).len(), 3 + 6);
}

#[test]
fn unwanted_lights_cost_nothing_and_disturb_nothing() {
    let world = World::build(&strewn_soup(3, 400, 0.1)).unwrap();
    let all: Vec<Light> = (0..40).flat_map(lights).collect();
    let mut builder = VolumeBuilder::default();
    let (mut whole, mut part) = (Volumes::default(), Volumes::default());
    builder.build(&world, &all, |_| true, &mut whole);
    builder.build(&world, &all, |light| light.range < 1.5, &mut part);
    for (i, light) in all.iter().enumerate() {
        let expected = if light.range < 1.5 {
            whole.quads_of(i)
        } else {
            &[]
        };
        assert_eq!(part.quads_of(i), expected);
    }
    whole.check_closed(&world).unwrap();
}
