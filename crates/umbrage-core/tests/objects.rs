//! Objects that come, move and go: the world says what a world built anew would say, and volumes
//! are built again only where something in a light's range changed.

mod common;

use common::{
    Random, build, builder, chain, dense_soup, lights, point_light, random_pose, strewn_soup,
};
use glam::{DQuat, DVec3, Vec3};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{LANES, Layer, ObjectError, ObjectId, Pose, Reach, Subset, World, query};
use umbrage_core::{Cull, Light, Mesh};

/// A world and what happens to it.
struct Play {
    world: World,
    objects: Vec<ObjectId>,
    random: Random,
}

impl Play {
    fn new(seed: u64) -> Self {
        Self {
            world: World::build(&strewn_soup(seed, 300, 0.3)).unwrap(),
            objects: Vec::new(),
            random: Random(seed ^ 77),
        }
    }

    /// One random change.
    fn step(&mut self) {
        let r = &mut self.random;
        match r.below(4) {
            0 if self.objects.len() > 2 => {
                let at = r.below(self.objects.len());
                self.world.remove(self.objects.swap_remove(at)).unwrap();
            }
            1 | 2 if !self.objects.is_empty() => {
                let at = self.objects[r.below(self.objects.len())];
                let pose = random_pose(r);
                self.world.pose(at, &pose).unwrap();
            }
            _ => {
                let seed = r.next();
                let mesh = match r.below(2) {
                    0 => strewn_soup(seed, 20 + r.below(150), 0.2),
                    _ => dense_soup(seed, 12, 40),
                };
                let pose = random_pose(r);
                self.objects.push(self.world.insert(&mesh, &pose).unwrap());
            }
        }
    }
}

#[test]
fn a_world_with_objects_casts_what_the_same_triangles_cast() {
    for seed in 0..6 {
        let mut play = Play::new(seed);
        let lights = lights(&mut Random(seed), 12);
        for _ in 0..25 {
            play.step();
            let anew = World::build(&play.world.to_mesh()).unwrap();
            let (ours, theirs) = (build(&play.world, &lights), build(&anew, &lights));
            ours.check_closed(&play.world).unwrap();
            for i in 0..lights.len() {
                assert_eq!(
                    chain(&play.world, &ours, i),
                    chain(&anew, &theirs, i),
                    "seed {seed}, light {i}"
                );
                let [a, b] = [&ours, &theirs].map(|v| v.lights[i].subset_triangles);
                assert_eq!(a, b);
            }
        }
    }
}

#[test]
fn kept_volumes_equal_rebuilt_ones() {
    for seed in 0..6 {
        let mut play = Play::new(seed);
        let mut lights = lights(&mut Random(seed), 40);
        let (mut builder, mut kept) = (builder(), Volumes::default());
        builder.build(&play.world, &lights, |_| true, &mut kept);
        for step in 0..60 {
            match step % 5 {
                4 => {
                    let at = 1 + play.random.below(lights.len() - 1);
                    lights[at].position += 0.2 * play.random.point().as_dvec3();
                }
                _ => play.step(),
            }
            builder.build(&play.world, &lights, |_| true, &mut kept);
            let anew = build(&play.world, &lights);
            for i in 0..lights.len() {
                assert_eq!(kept.quads_of(i), anew.quads_of(i), "seed {seed}, {step}");
                assert_eq!(kept.chain_of(i), anew.chain_of(i));
                let [a, b] = [&kept, &anew].map(|v| &v.lights[i]);
                assert_eq!(a.subset_triangles, b.subset_triangles);
                assert_eq!(a.facing_triangles, b.facing_triangles);
            }
        }
    }
}

#[test]
fn only_lights_in_whose_range_something_moved_are_built_again() {
    let mut world = World::build(&strewn_soup(3, 400, 0.2)).unwrap();
    let mut r = Random(12);
    let lights: Vec<Light> = (0..200)
        .map(|_| point_light(2.0 * r.point(), 0.3))
        .collect();
    let object = strewn_soup(9, 30, 0.05);
    let small = Mesh {
        positions: object.positions.iter().map(|p| 0.1 * *p).collect(),
        ..object
    };
    let id = world.insert(&small, &Pose::at(DVec3::ZERO)).unwrap();
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    let first = builder.build(&world, &lights, |_| true, &mut volumes);
    assert_eq!(first, lights.len());
    for _ in 0..50 {
        // Nothing changed: nothing is built, and nothing is to be copied.
        let version = volumes.quads_version();
        assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 0);
        assert_eq!(volumes.quads_since(version).count(), 0);
        assert!(volumes.lights.iter().all(|l| l.cached));

        let before = world.object(id).unwrap().bounds;
        let pose = Pose::at(1.5 * r.point().as_dvec3());
        world.pose(id, &pose).unwrap();
        let after = world.object(id).unwrap().bounds;
        let near = |light: &&Light| {
            let reach = Reach::new(light);
            reach.touches_box(before) || reach.touches_box(after)
        };
        let expected = lights.iter().filter(near).count();
        let built = builder.build(&world, &lights, |_| true, &mut volumes);
        assert_eq!(built, expected);
        assert!(expected < lights.len() / 4, "{expected} is not only some");
    }
}

#[test]
fn lights_that_nobody_wants_wait_until_somebody_does() {
    let world = World::build(&strewn_soup(5, 300, 0.3)).unwrap();
    let lights = lights(&mut Random(5), 20);
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    let left = |light: &Light| light.position.x < 0.0;
    let built = builder.build(&world, &lights, left, &mut volumes);
    assert_eq!(built, lights.iter().filter(|l| left(l)).count());
    let rest = builder.build(&world, &lights, |l| !left(l), &mut volumes);
    assert_eq!(built + rest, lights.len());
    let anew = build(&world, &lights);
    for i in 0..lights.len() {
        assert_eq!(volumes.quads_of(i), anew.quads_of(i));
    }
}

#[test]
fn another_world_or_another_set_of_steps_rebuilds_everything() {
    let [one, other] = [1, 2].map(|seed| World::build(&strewn_soup(seed, 200, 0.3)).unwrap());
    let lights = lights(&mut Random(5), 20);
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    builder.build(&one, &lights, |_| true, &mut volumes);
    assert_eq!(builder.build(&other, &lights, |_| true, &mut volumes), 20);
    assert_eq!(builder.build(&other, &lights, |_| true, &mut volumes), 0);
    builder.culls = builder.culls.with(Cull::Hidden);
    assert_eq!(builder.build(&other, &lights, |_| true, &mut volumes), 20);
    builder.culls = builder.culls.without(Cull::Cache);
    assert_eq!(builder.build(&other, &lights, |_| true, &mut volumes), 20);
    assert_eq!(builder.build(&other, &lights, |_| true, &mut volumes), 20);
}

/// Every triangle lies in the boxes above it, and is found by a light that touches it.
#[test]
fn posed_objects_are_where_the_tree_says() {
    let mut play = Play::new(8);
    for _ in 0..40 {
        play.step();
        let world = &play.world;
        for object in &world.objects {
            for node in
                &world.bvh.nodes[object.extent.nodes.start as usize..][..object.extent.nodes.len()]
            {
                for corner in node.range().flat_map(|t| world.corners(t)) {
                    assert!(
                        corner.cmpge(node.min.as_dvec3()).all()
                            && corner.cmple(node.max.as_dvec3()).all()
                    );
                }
            }
        }
        let mut subset = Subset::default();
        for light in lights(&mut play.random, 6) {
            query(world, Layer::Objects, &light, &mut subset);
            let reach = Reach::new(&light);
            let objects = world.objects.iter();
            let expected: Vec<u32> = objects
                .flat_map(|o| o.extent.triangles.clone())
                .filter(|&t| reach.touches(world.bounds(t)))
                .collect();
            let found: Vec<u32> = subset.triangles().collect();
            assert!(expected.iter().all(|t| found.contains(t)));
        }
    }
}

#[test]
fn slots_are_used_again_and_old_names_stay_dead() {
    let mut world = World::build(&strewn_soup(1, 100, 0.3)).unwrap();
    let mesh = strewn_soup(2, 90, 0.2);
    let pose = Pose::at(DVec3::ONE);
    let first = world.insert(&mesh, &pose).unwrap();
    let size = world.triangles.len();
    assert_eq!(size % LANES, 90 % LANES);
    for _ in 0..20 {
        let id = world.insert(&mesh, &pose).unwrap();
        world.remove(id).unwrap();
        assert_eq!(world.remove(id), Err(ObjectError::Unknown));
        assert_eq!(world.pose(id, &pose), Err(ObjectError::Unknown));
    }
    assert!(world.triangles.len() < 2 * size + LANES);
    assert_eq!(world.to_mesh().triangles.len(), 190);
    world.pose(first, &Pose::at(DVec3::ZERO)).unwrap();
}

#[test]
fn a_pose_that_leads_nowhere_changes_nothing() {
    let mut world = World::build(&strewn_soup(1, 100, 0.3)).unwrap();
    let mesh = strewn_soup(2, 90, 0.2);
    let id = world.insert(&mesh, &Pose::at(DVec3::ONE)).unwrap();
    let before = world.clone();
    let zero = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    for pose in [
        Pose::at(DVec3::new(f64::NAN, 0.0, 0.0)),
        Pose::at(DVec3::new(1e300, 0.0, 0.0)),
        Pose {
            rotation: zero,
            translation: DVec3::ZERO,
        },
    ] {
        assert_eq!(world.pose(id, &pose), Err(ObjectError::Pose));
        assert_eq!(world.insert(&mesh, &pose), Err(ObjectError::Pose));
    }
    let broken = Mesh {
        casting: Vec::new(),
        ..mesh
    };
    assert!(matches!(
        world.insert(&broken, &Pose::at(DVec3::ONE)),
        Err(ObjectError::Mesh(_))
    ));
    assert_eq!(world.positions, before.positions);
    assert_eq!(world.stamp, before.stamp);
}

#[test]
fn an_object_may_stand_in_an_empty_world_or_be_empty() {
    let mut world = World::build(&Mesh::default()).unwrap();
    let empty = world
        .insert(&Mesh::default(), &Pose::at(DVec3::ONE))
        .unwrap();
    let mesh = strewn_soup(2, 90, 0.2);
    world.insert(&mesh, &Pose::at(DVec3::ZERO)).unwrap();
    let lights = lights(&mut Random(1), 10);
    let volumes = build(&world, &lights);
    volumes.check_closed(&world).unwrap();
    assert!(!volumes.quads_of(0).is_empty());
    world.remove(empty).unwrap();
}

/// As an editor does: what was inserted is gone with the copy of the world it was inserted in.
#[test]
fn a_world_taken_back_takes_its_volumes_back() {
    let mut world = World::build(&strewn_soup(1, 100, 0.3)).unwrap();
    let lights = lights(&mut Random(3), 30);
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    builder.build(&world, &lights, |_| true, &mut volumes);
    let saved = world.clone();
    let id = world
        .insert(&strewn_soup(2, 90, 0.2), &Pose::at(DVec3::ZERO))
        .unwrap();
    let bounds = world.object(id).unwrap().bounds;
    let near = |light: &&Light| Reach::new(light).touches_box(bounds);
    let touched = lights.iter().filter(near).count();
    assert!(touched > 0 && touched < lights.len());
    for world in [&world, &saved, &world, &saved] {
        let built = builder.build(world, &lights, |_| true, &mut volumes);
        assert_eq!(built, touched);
        let anew = build(world, &lights);
        for i in 0..lights.len() {
            assert_eq!(volumes.quads_of(i), anew.quads_of(i));
        }
    }
}

/// Hidden casters are looked for once lights stand still, within the budget, and moving objects do
/// not lift it.
#[test]
fn lights_settle_within_the_budget() {
    let mut world = World::build(&strewn_soup(4, 900, 0.5)).unwrap();
    let lights: Vec<Light> = (0..12)
        .map(|i| point_light(Vec3::splat(0.02 * i as f32), 2.0))
        .collect();
    let id = world
        .insert(&strewn_soup(2, 20, 0.1), &Pose::at(DVec3::ZERO))
        .unwrap();
    let (mut builder, mut volumes) = (VolumeBuilder::default(), Volumes::default());
    builder.build(&world, &lights, |_| true, &mut volumes);
    let plain: Vec<u32> = volumes.lights.iter().map(|l| l.facing_triangles).collect();
    let settled = |volumes: &Volumes| {
        let lights = volumes.lights.iter().zip(&plain);
        lights
            .filter(|(l, plain)| l.facing_triangles < **plain)
            .count()
    };
    // Room for three of them in each build.
    builder.hidden_budget = 3 * plain.iter().max().unwrap() + 3;
    let mut before = 0;
    for step in 1..=4 {
        let pose = Pose::at(DVec3::new(0.0, 0.0, 1e-3 * f64::from(step)));
        world.pose(id, &pose).unwrap();
        builder.build(&world, &lights, |_| true, &mut volumes);
        let now = settled(&volumes);
        assert!((before + 1..=before + 4).contains(&now), "{before} {now}");
        before = now;
        volumes.check_closed(&world).unwrap();
    }
    builder.settle(&world, &lights, |_| true, &mut volumes);
    assert_eq!(settled(&volumes), lights.len());
    assert_eq!(builder.settle(&world, &lights, |_| true, &mut volumes), 0);
    let mut at_once = Volumes::default();
    VolumeBuilder::default().settle(&world, &lights, |_| true, &mut at_once);
    for i in 0..lights.len() {
        assert_eq!(volumes.quads_of(i), at_once.quads_of(i));
    }

    // One beyond the budget waits for settle.
    builder.hidden_budget = plain.iter().min().unwrap() - 30;
    let mut small = Volumes::default();
    assert_eq!(builder.build(&world, &lights, |_| true, &mut small), 12);
    assert_eq!(builder.build(&world, &lights, |_| true, &mut small), 0);
    assert_eq!(settled(&small), 0);
}
