//! Worlds with residuals: the same answers as near zero, bit for bit where positions allow it.

mod common;

use common::{Random, build, point_light, strewn_soup, sun};
use glam::{DVec3, Vec3};
use umbrage_core::frame::{FramePlan, PlanOptions};
use umbrage_core::world::{Layer, LightPoint, Planes, Reach, Subset, World, WorldError, query};
use umbrage_core::{Light, LightShape, Mesh, View};

/// A multiple of what the soup below is rounded to, so that adding it is exact in 48 bits.
const FAR: DVec3 = DVec3::new(8_388_608.0, -4_194_304.0, 2_097_152.0);

/// A soup on a lattice of 1/4096 m, and the same far away.
fn near_and_far(seed: u64) -> [Mesh; 2] {
    let mut near = strewn_soup(seed, 300, 0.3);
    for p in &mut near.positions {
        *p = (*p * 4096.0).round() / 4096.0;
    }
    let mut far = near.clone();
    far.stand(near.positions.iter().map(|p| p.as_dvec3() + FAR));
    [near, far]
}

fn lights(seed: u64, by: DVec3) -> Vec<Light> {
    let mut r = Random(seed);
    let mut lights = vec![sun(r.point())];
    lights.extend((0..12).map(|_| {
        let at = (2.0 * r.point() * 4096.0).round() / 4096.0;
        point_light(at.as_dvec3() + by, 1.5)
    }));
    lights
}

#[test]
fn volumes_far_away_are_those_near_zero() {
    for seed in 0..10 {
        let [near, far] = near_and_far(seed);
        assert!(near.residuals.is_empty() && far.residuals.len() == far.positions.len());
        let [near, far] = [near, far].map(|mesh| World::build(&mesh).unwrap());
        assert_eq!(near.report.welded_vertices, far.report.welded_vertices);
        assert_eq!(
            near.report.edges_by_triangles,
            far.report.edges_by_triangles
        );
        // The trees may differ, and with them the order: triangles by their number in the mesh.
        let chains = [(&near, DVec3::ZERO), (&far, FAR)].map(|(world, by)| {
            let lights = lights(seed, by);
            let volumes = build(world, &lights);
            volumes.check_closed(world).unwrap();
            let chain = |light: usize| {
                let triangles = volumes.chain_triangles(light);
                let mut chain: Vec<_> = triangles
                    .map(|t| (world.source[t.triangle() as usize], t.coefficient()))
                    .collect();
                chain.sort_unstable();
                (chain, volumes.quads_of(light).len())
            };
            (0..lights.len()).map(chain).collect::<Vec<_>>()
        });
        // A box that was rounded outward may let in what does not reach the light.
        for (near, far) in chains[0].iter().zip(&chains[1]) {
            assert!(near.0.iter().all(|t| far.0.binary_search(t).is_ok()));
        }
        assert_eq!(chains[0][0], chains[1][0], "the sun reaches everything");
    }
}

#[test]
fn paths_and_eye_counts_far_away_are_those_near_zero() {
    let [near, far] = near_and_far(3).map(|mesh| World::build(&mesh).unwrap());
    let mut r = Random(9);
    for _ in 0..50 {
        let (eye, target) = (r.point().as_dvec3(), r.point().as_dvec3());
        let plans = [(&near, DVec3::ZERO), (&far, FAR)].map(|(world, by)| {
            let lights: Vec<Light> = lights(3, by)
                .into_iter()
                .map(|light| Light {
                    range: 50.0,
                    ..light
                })
                .collect();
            let view = View::look_at(eye + by, target + by, 1.0, 0.01, [64, 64]);
            let mut plan = FramePlan::default();
            plan.make(
                world,
                &lights,
                &build(world, &lights),
                &view,
                &PlanOptions::default(),
            );
            plan.lights
                .iter()
                .map(|l| (l.path, l.scissor))
                .collect::<Vec<_>>()
        });
        assert_eq!(plans[0], plans[1]);
    }
}

/// A micrometre decides at 10,000 km.
#[test]
fn sides_are_exact_far_away() {
    let mut mesh = Mesh::default();
    let corners = [[0.0, 0.1, 0.0], [0.0, 0.1, 8.0], [8.0, 0.1, 0.0]].map(|p| DVec3::from(p) + FAR);
    mesh.stand(corners);
    let places = mesh.places();
    let planes = Planes::new(places, &[[0, 1, 2]]);
    let exact = [0, 1, 2].map(|v| places.at(v));
    let height = exact[0].y - FAR.y;
    for (off, side) in [(0.0, 0), (1e-6, 1), (-1e-6, -1)] {
        let light = point_light(FAR + DVec3::new(3.0, height + off, 2.0), 9.0);
        assert_eq!(planes.side(0, &LightPoint::new(&light), || exact), side);
    }
}

#[test]
fn a_query_loses_nothing_far_away() {
    let [_, far] = near_and_far(5);
    let world = World::build(&far).unwrap();
    world.validate().unwrap();
    for light in lights(5, FAR) {
        let reach = Reach::new(&light);
        for t in 0..world.triangles.len() as u32 {
            let corners = world.corners(t);
            let inside = |p: &DVec3| p.distance(light.position) <= f64::from(light.range);
            if corners.iter().any(inside) {
                assert!(reach.touches(world.bounds(t)));
            }
        }
    }
}

/// Found by the stress campaign: where a world of centimetres is far away the middle of a box is no
/// f32, and cones lost what was in it.
#[test]
fn a_cone_loses_nothing_far_away() {
    let [near, mut mesh] = near_and_far(5);
    let cos_outer = 0.7;
    let (mut subset, mut reached) = (Subset::default(), 0);
    let (mut r, lights) = (Random(11), lights(5, DVec3::ZERO));
    for _ in 0..30 {
        let by = 5e6 * r.point().as_dvec3();
        mesh.stand(near.positions.iter().map(|p| p.as_dvec3() / 64.0 + by));
        let world = World::build(&mesh).unwrap();
        for light in &lights[1..] {
            let direction = r.point().normalize();
            let spot = Light {
                position: light.position / 64.0 + by,
                range: 1.5 / 64.0,
                shape: LightShape::Spot {
                    direction,
                    cos_outer,
                },
            };
            query(&world, Layer::Fixed, &spot, &mut subset);
            let found: Vec<u32> = subset.triangles().collect();
            let in_cone = |p: &DVec3| {
                let v = p - spot.position;
                v.length() <= f64::from(spot.range)
                    && v.dot(direction.as_dvec3()) >= f64::from(cos_outer) * v.length()
            };
            for t in 0..world.triangles.len() as u32 {
                if world.corners(t).iter().any(in_cone) {
                    assert!(found.binary_search(&t).is_ok(), "{spot:?} lost {t}");
                    reached += 1;
                }
            }
        }
    }
    assert!(reached > 50, "{reached}");
}

/// Positions that are one in f32 and two in f64 stay two.
#[test]
fn welding_sees_residuals() {
    let mut mesh = Mesh {
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        casting: vec![Default::default(); 2],
        ..Mesh::default()
    };
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + FAR);
    let apart = corners.map(|p| p + DVec3::new(0.001, 0.0, 0.0));
    mesh.stand(corners.into_iter().chain(apart));
    let world = World::build(&mesh).unwrap();
    assert_eq!(world.report.welded_vertices, 6);
    assert_eq!(world.positions[0], world.positions[3]);
    mesh.weld_within(0.01).unwrap();
    assert_eq!(World::build(&mesh).unwrap().report.welded_vertices, 3);
}

#[test]
fn a_saved_world_keeps_residuals() {
    let [_, far] = near_and_far(7);
    let world = World::build(&far).unwrap();
    let file = std::env::temp_dir().join(format!("umbrage_large_{}.world", std::process::id()));
    world.save(&file, far.fingerprint()).unwrap();
    let opened = World::open(&file, far.fingerprint()).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(opened, world);
    let rounded = Mesh {
        residuals: Vec::new(),
        ..far.clone()
    };
    assert_ne!(rounded.fingerprint(), far.fingerprint());
}

#[test]
fn residuals_without_positions_are_refused() {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO; 3],
        residuals: vec![Vec3::ZERO; 2],
        triangles: vec![[0, 1, 2]],
        casting: vec![Default::default()],
    };
    let error = World::build(&mesh).unwrap_err();
    assert!(matches!(
        error,
        WorldError::ResidualsLength {
            residuals: 2,
            positions: 3
        }
    ));
}
