//! The bound on layers is one, parts are few-layered, closed and together the whole, and what is
//! kept of them is what would be built.

mod common;

use common::{Random, dense_soup, grid, lights, point_light, random_pose, strewn_soup, sun, torus};
use glam::{DVec3, Vec3};
use umbrage_core::volume::{Chain, LayerLimit, VolumeBuilder, Volumes};
use umbrage_core::world::World;
use umbrage_core::{Casting, Cull, Culls, Light, LightShape, Mesh};

const FEW: LayerLimit = LayerLimit { whole: 4, part: 2 };

fn build(world: &World, lights: &[Light], layers: LayerLimit) -> Volumes {
    let mut volumes = Volumes::default();
    builder(layers).build(world, lights, |_| true, &mut volumes);
    volumes
}

fn builder(layers: LayerLimit) -> VolumeBuilder {
    let mut builder = common::builder();
    builder.layers = layers;
    builder
}

/// How many triangles of a chain the light's ray through `target` meets.
fn layers_along(world: &World, light: &Light, chain: &[Chain], target: DVec3) -> u32 {
    let (origin, ray) = match light.shape {
        LightShape::Directional { direction } => {
            let ray = direction.as_dvec3();
            (target - 100.0 * ray, ray)
        }
        _ => (light.position, target - light.position),
    };
    let meets = |t: u32| {
        let [a, b, c] = world.corners(t).map(|p| p - origin);
        let on = |p: DVec3, q: DVec3| p.cross(q).dot(ray);
        let sides = [on(a, b), on(b, c), on(c, a)];
        let ahead = (a + b + c).dot((b - a).cross(c - a)) * ray.dot((b - a).cross(c - a)) > 0.0;
        ahead && (sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0))
    };
    let triangles = chain.iter().flat_map(Chain::triangles);
    triangles.filter(|t| meets(t.triangle())).count() as u32
}

/// The most layers of a chain along rays through points of its own triangles.
fn most_layers(world: &World, light: &Light, chain: &[Chain], r: &mut Random) -> u32 {
    let triangles: Vec<_> = chain.iter().flat_map(Chain::triangles).collect();
    let mut most = 0;
    for _ in 0..60.min(2 * triangles.len()) {
        let [a, b, c] = world.corners(triangles[r.below(triangles.len())].triangle());
        let (mut u, mut v) = (0.5 + 0.5 * r.signed(), 0.5 + 0.5 * r.signed());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        most = most.max(layers_along(
            world,
            light,
            chain,
            a + f64::from(u) * (b - a) + f64::from(v) * (c - a),
        ));
    }
    most
}

fn soups() -> Vec<Mesh> {
    let mut meshes = vec![grid(6), torus(24, Casting::Both), torus(40, Casting::Front)];
    for seed in 0..6 {
        meshes.push(dense_soup(seed, 40, 400));
        meshes.push(strewn_soup(seed, 500, 0.1));
        meshes.push(strewn_soup(seed, 500, 0.6));
    }
    meshes
}

#[test]
fn no_ray_meets_more_than_the_bound_nor_more_of_a_part_than_allowed() {
    let (mut r, mut split, mut reached) = (Random(3), 0, 0);
    for mesh in soups() {
        let world = World::build(&mesh).unwrap();
        let lights = lights(&mut r, 10);
        for limit in [FEW, LayerLimit { whole: 30, part: 7 }, LayerLimit::STENCIL] {
            let volumes = build(&world, &lights, limit);
            volumes.check_closed(&world).unwrap();
            for (i, (light, volume)) in lights.iter().zip(&volumes.lights).enumerate() {
                let most = most_layers(&world, light, volumes.chain_of(i), &mut r);
                assert!(
                    most <= volume.layers_bound,
                    "{most} of {}",
                    volume.layers_bound
                );
                assert!(volume.layers_bound <= volume.facing_triangles);
                reached += u32::from(most > 0 && most == volume.layers_bound);
                assert!(volume.parts.len() != 1);
                assert!(volume.layers_bound <= limit.whole || volume.parts.len() > 1);
                if volume.facing_triangles <= limit.whole {
                    assert!(volume.parts.is_empty());
                }
                for part in &volume.parts {
                    let chain = volumes.chain_of_part(part);
                    assert!(most_layers(&world, light, chain, &mut r) <= limit.part);
                    split += 1;
                }
                if !volume.parts.is_empty() {
                    let parts = volume.parts.iter().flat_map(|p| volumes.chain_of_part(p));
                    let mut together: Vec<_> = parts.flat_map(Chain::triangles).collect();
                    together.sort_by_key(|t| t.0);
                    assert!(together.iter().copied().eq(volumes.chain_triangles(i)));
                }
            }
        }
    }
    // A bound of one less would not hold, nor would whole lights pass for parts.
    assert!(
        split > 500 && reached > 5,
        "{split} parts, {reached} bounds reached"
    );
}

/// Level triangles above each other.
fn stack(count: usize, step: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count as u32 {
        let y = step * i as f32;
        let corners = [[-1.0, -1.0], [0.0, 1.0], [1.0, -1.0]];
        mesh.positions
            .extend(corners.map(|[x, z]| Vec3::new(x, y, z)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        mesh.casting.push(Casting::Both);
    }
    mesh
}

#[test]
fn stacks_are_divided_from_256_on() {
    for step in [0.01, 0.0] {
        for (count, parts) in [(255, 0), (256, 3), (257, 3), (512, 5), (700, 6)] {
            let world = World::build(&stack(count, step)).unwrap();
            for light in [
                point_light(Vec3::new(0.1, 20.0, 0.0), 100.0),
                sun(Vec3::NEG_Y),
            ] {
                let volumes = build(&world, &[light], LayerLimit::STENCIL);
                let volume = &volumes.lights[0];
                assert_eq!(volume.layers_bound as usize, count);
                assert_eq!(volume.parts.len(), parts);
                volumes.check_closed(&world).unwrap();
                let whole = build(&world, &[light], LayerLimit::NONE);
                assert!(whole.lights[0].parts.is_empty());
            }
        }
    }
}

/// Many casters, few layers: cells tell them apart.
#[test]
fn wide_worlds_are_not_divided() {
    for mesh in [
        grid(40),
        torus(80, Casting::Front),
        strewn_soup(1, 20_000, 0.01),
    ] {
        let world = World::build(&mesh).unwrap();
        let lights = [
            point_light(Vec3::new(0.1, 3.0, 0.2), 100.0),
            sun(Vec3::new(0.1, -1.0, 0.2)),
        ];
        for volume in build(&world, &lights, LayerLimit::STENCIL).lights {
            assert!(volume.facing_triangles > 1000 && volume.parts.is_empty());
            assert!(volume.layers_bound <= 255);
        }
    }
}

/// A light on, in and beside triangles, close and far.
#[test]
fn the_bound_holds_wherever_the_light_is() {
    let mut r = Random(8);
    for seed in 0..20 {
        let mesh = dense_soup(seed, 30, 200);
        let world = World::build(&mesh).unwrap();
        let corner = world.positions[r.below(world.positions.len())];
        let near = [0.0, 1e-7, 1e-4, 0.1, 50.0];
        let lights = near.map(|by| point_light(corner + by * r.point(), 1e3));
        let volumes = build(&world, &lights, FEW);
        for (i, light) in lights.iter().enumerate() {
            let most = most_layers(&world, light, volumes.chain_of(i), &mut r);
            assert!(most <= volumes.lights[i].layers_bound);
        }
    }
}

#[test]
fn kept_parts_equal_rebuilt_ones() {
    let mut r = Random(5);
    let mut world = World::build(&strewn_soup(2, 300, 0.5)).unwrap();
    let ids = [1, 2].map(|seed| {
        let mesh = strewn_soup(seed, 60, 0.3);
        world.insert(&mesh, &random_pose(&mut r)).unwrap()
    });
    let mut lights = lights(&mut r, 20);
    for culls in [Culls::EVERY, Culls::EVERY.without(Cull::Hidden)] {
        let (mut builder, mut kept) = (VolumeBuilder::new(culls), Volumes::default());
        builder.layers = FEW;
        let mut parts = 0;
        for step in 0..40 {
            match step % 4 {
                3 => {
                    let at = 1 + r.below(lights.len() - 1);
                    lights[at].position += 0.2 * r.point().as_dvec3();
                }
                _ => world.pose(ids[step % 2], &random_pose(&mut r)).unwrap(),
            }
            builder.settle(&world, &lights, |_| true, &mut kept);
            kept.check_closed(&world).unwrap();
            let (mut other, mut anew) = (VolumeBuilder::new(culls), Volumes::default());
            other.layers = FEW;
            other.settle(&world, &lights, |_| true, &mut anew);
            for i in 0..lights.len() {
                assert_eq!(kept.quads_of(i), anew.quads_of(i), "step {step}");
                assert_eq!(kept.chain_of(i), anew.chain_of(i));
                let [a, b] = [&kept, &anew].map(|v| &v.lights[i]);
                assert_eq!(a.layers_bound, b.layers_bound);
                assert_eq!(a.parts.len(), b.parts.len());
                for (a, b) in a.parts.iter().zip(&b.parts) {
                    assert_eq!(kept.quads_of_part(a), anew.quads_of_part(b));
                    assert_eq!(kept.chain_of_part(a), anew.chain_of_part(b));
                }
                parts += a.parts.len();
            }
        }
        assert!(parts > 100);
    }
}

/// Another limit is another volume.
#[test]
fn changing_the_limit_rebuilds() {
    let world = World::build(&strewn_soup(2, 400, 0.6)).unwrap();
    let lights = lights(&mut Random(1), 10);
    let (mut builder, mut volumes) = (builder(FEW), Volumes::default());
    assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 10);
    assert!(volumes.lights.iter().any(|light| !light.parts.is_empty()));
    builder.layers = LayerLimit::STENCIL;
    assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 10);
    assert!(volumes.lights.iter().all(|light| light.parts.is_empty()));
}
