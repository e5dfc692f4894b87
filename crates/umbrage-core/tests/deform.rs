//! Objects that deform: the world says what a world built anew of the same triangles would say, seams
//! hold, what may not part is refused, and only the lights in whose range something changed are
//! built again.

mod common;

use common::{
    Random, build, builder, chain, dense_soup, lights, point_light, random_pose, strewn_soup,
};
use glam::{DVec3, Vec3};
use umbrage_core::volume::Volumes;
use umbrage_core::world::{ObjectError, ObjectId, Pose, Reach, World};
use umbrage_core::{Casting, Light, Mesh};

/// A mesh without shared vertices, each with the number of the vertex it was a copy of: a skin that is
/// all seams.
fn all_seams(mesh: &Mesh) -> (Mesh, Vec<u32>) {
    let keys: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    let seams = Mesh {
        positions: keys.iter().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: (0..mesh.triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
        casting: mesh.casting.clone(),
        ..Mesh::default()
    };
    (seams, keys)
}

/// An object, and the vertices that stand for those of its mesh.
struct Puppet {
    id: ObjectId,
    keys: Vec<u32>,
    /// One a key.
    points: Vec<Vec3>,
}

impl Puppet {
    fn new(world: &mut World, r: &mut Random) -> Self {
        let mut mesh = match r.below(2) {
            0 => strewn_soup(r.next(), 10 + r.below(60), 0.2),
            _ => dense_soup(r.next(), 14, 40),
        };
        // Some vertices begin at one place: the lips of a closed mouth.
        for _ in 0..4 {
            let [a, b] = [0; 2].map(|_| r.below(mesh.positions.len()));
            mesh.positions[a] = mesh.positions[b];
        }
        let (seams, keys) = all_seams(&mesh);
        let pose = random_pose(r);
        let id = world.insert_deforming(&seams, &keys, &pose).unwrap();
        Self {
            id,
            keys,
            points: mesh.positions,
        }
    }

    fn positions(&self) -> Vec<Vec3> {
        self.keys.iter().map(|&k| self.points[k as usize]).collect()
    }

    fn bend(&mut self, world: &mut World, r: &mut Random) {
        for p in &mut self.points {
            *p += 0.1 * r.point();
        }
        if r.below(3) == 0 {
            let [a, b] = [0; 2].map(|_| r.below(self.points.len()));
            self.points[a] = self.points[b]; // the mouth closes
        }
        world.deform(self.id, &self.positions()).unwrap();
    }
}

fn step(world: &mut World, puppets: &mut Vec<Puppet>, r: &mut Random) {
    match r.below(5) {
        0 if puppets.len() > 2 => {
            let at = r.below(puppets.len());
            world.remove(puppets.swap_remove(at).id).unwrap();
        }
        1..=3 if !puppets.is_empty() => {
            let at = r.below(puppets.len());
            match r.below(4) {
                0 => world.pose(puppets[at].id, &random_pose(r)).unwrap(),
                _ => puppets[at].bend(world, r),
            }
        }
        _ => puppets.push(Puppet::new(world, r)),
    }
}

#[test]
fn a_deformed_world_casts_what_the_same_triangles_cast() {
    for seed in 0..6 {
        let mut world = World::build(&strewn_soup(seed, 200, 0.3)).unwrap();
        let (mut puppets, mut r) = (Vec::new(), Random(seed ^ 1234));
        let lights = lights(&mut Random(seed), 12);
        for _ in 0..30 {
            step(&mut world, &mut puppets, &mut r);
            let anew = World::build(&world.to_mesh()).unwrap();
            let (ours, theirs) = (build(&world, &lights), build(&anew, &lights));
            ours.check_closed(&world).unwrap();
            for i in 0..lights.len() {
                let what = format!("seed {seed}, light {i}");
                assert_eq!(chain(&world, &ours, i), chain(&anew, &theirs, i), "{what}");
            }
            for object in &world.objects {
                let nodes = object.extent.nodes.start as usize..object.extent.nodes.end as usize;
                for node in &world.bvh.nodes[nodes] {
                    for p in node.range().flat_map(|t| world.corners(t)) {
                        assert!(
                            p.cmpge(node.min.as_dvec3()).all()
                                && p.cmple(node.max.as_dvec3()).all()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn kept_volumes_of_deforming_objects_equal_rebuilt_ones() {
    for seed in 0..4 {
        let mut world = World::build(&strewn_soup(seed, 200, 0.3)).unwrap();
        let (mut puppets, mut r) = (Vec::new(), Random(seed ^ 4321));
        let lights = lights(&mut Random(seed), 40);
        let (mut builder, mut kept) = (builder(), Volumes::default());
        for _ in 0..50 {
            step(&mut world, &mut puppets, &mut r);
            builder.build(&world, &lights, |_| true, &mut kept);
            let anew = build(&world, &lights);
            for i in 0..lights.len() {
                assert_eq!(kept.quads_of(i), anew.quads_of(i), "seed {seed}");
                assert_eq!(kept.chain_of(i), anew.chain_of(i));
            }
        }
    }
}

/// An object that is deformed into another shape is the other shape inserted.
#[test]
fn positions_land_where_they_were_given() {
    let mut world = World::build(&Mesh::default()).unwrap();
    let mut r = Random(9);
    let mut puppet = Puppet::new(&mut world, &mut r);
    let pose = Pose::at(DVec3::new(1.0, -2.0, 0.5));
    world.pose(puppet.id, &pose).unwrap();
    puppet.bend(&mut world, &mut r);
    let at = Vec3::new(1.0, -2.0, 0.5);
    let vertices = world.vertices_of(puppet.id).unwrap();
    assert_eq!(vertices.len(), puppet.keys.len());
    for (vertex, p) in vertices.iter().zip(puppet.positions()) {
        let expected = (p.as_dvec3() + at.as_dvec3()).as_vec3();
        if let Some(vertex) = vertex {
            assert_eq!(world.positions[*vertex as usize], expected);
        }
    }
    // Triangles are those of the mesh, by source, corner by corner.
    let object = world.object(puppet.id).unwrap();
    for t in object.extent.triangles.clone() {
        let source = world.source[t as usize] as usize;
        let corners = [0, 1, 2].map(|k| vertices[3 * source + k]);
        assert_eq!(corners, world.triangles[t as usize].map(Some));
    }
}

#[test]
fn only_lights_around_a_deforming_object_are_built_again() {
    let mut world = World::build(&strewn_soup(3, 400, 0.2)).unwrap();
    let mut r = Random(12);
    let lights: Vec<Light> = (0..200)
        .map(|_| point_light(2.0 * r.point(), 0.3))
        .collect();
    let mesh = strewn_soup(9, 30, 0.05);
    let mut at: Vec<Vec3> = mesh.positions.iter().map(|p| 0.1 * *p).collect();
    let keys: Vec<u32> = (0..at.len() as u32).collect();
    let small = Mesh {
        positions: at.clone(),
        ..mesh
    };
    let pose = Pose::at(DVec3::ZERO);
    let id = world.insert_deforming(&small, &keys, &pose).unwrap();
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    builder.build(&world, &lights, |_| true, &mut volumes);
    let mut some = 0;
    for _ in 0..50 {
        let before = world.object(id).unwrap().bounds;
        let walk = 0.2 * r.point();
        at.iter_mut().for_each(|p| *p += walk + 0.02 * r.point());
        world.deform(id, &at).unwrap();
        let after = world.object(id).unwrap().bounds;
        let near = |light: &&Light| {
            let reach = Reach::new(light);
            reach.touches_box(before) || reach.touches_box(after)
        };
        let expected = lights.iter().filter(near).count();
        let built = builder.build(&world, &lights, |_| true, &mut volumes);
        assert_eq!(built, expected);
        some += expected;
    }
    assert!(some > 50 && some < 50 * lights.len() / 4, "{some}");
}

/// Whoever hands over the same positions every frame pays for nothing.
#[test]
fn a_deformation_that_changes_nothing_builds_nothing_again() {
    let mut world = World::build(&strewn_soup(3, 100, 0.2)).unwrap();
    let pose = Pose::at(DVec3::new(0.5, 0.0, 0.0));
    let id = world.insert(&hinge(), &pose).unwrap();
    let lights = [point_light(Vec3::ZERO, 5.0)];
    let (mut builder, mut volumes) = (builder(), Volumes::default());
    assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 1);
    let before = world.clone();
    let mut same = hinge().positions;
    same[0] = -Vec3::ZERO; // as equal as zero
    same[6] = Vec3::splat(7.0); // no triangle uses it
    world.deform(id, &same).unwrap();
    assert_eq!((world.stamp, &world), (before.stamp, &before));
    assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 0);
    same[2].y += 0.125;
    world.deform(id, &same).unwrap();
    assert_eq!(builder.build(&world, &lights, |_| true, &mut volumes), 1);
}

/// Two triangles that share an edge by position only.
fn hinge() -> Mesh {
    let [a, b] = [Vec3::ZERO, Vec3::X];
    Mesh {
        positions: vec![a, b, Vec3::Y, a, b, Vec3::Z, Vec3::ONE],
        triangles: vec![[0, 1, 2], [4, 3, 5]],
        casting: vec![Casting::Both; 2],
        ..Mesh::default()
    }
}

#[test]
fn what_was_welded_cannot_part_unless_keys_said_so() {
    let pose = Pose::at(DVec3::ZERO);
    let mut apart = hinge().positions;
    apart[3] += 0.25 * Vec3::Z;
    let mut world = World::build(&Mesh::default()).unwrap();
    let joined = world.insert(&hinge(), &pose).unwrap();
    let before = world.clone();
    let refused = ObjectError::Parted {
        first: 0,
        second: 3,
    };
    assert_eq!(world.deform(joined, &apart), Err(refused));
    assert_eq!((world.stamp, &world), (before.stamp, &before));

    let free = world.insert_deforming(&hinge(), &[0, 1, 2, 3, 1, 4, 5], &pose);
    let free = free.unwrap();
    world.deform(free, &apart).unwrap();
    assert_eq!(
        world.object(free).unwrap().bounds[1],
        Vec3::ONE * Vec3::new(1.0, 1.0, 1.0)
    );
    // The hinge still holds at its other end.
    apart[4] += Vec3::Y;
    assert!(matches!(
        world.deform(free, &apart),
        Err(ObjectError::Parted { .. })
    ));
    // A vertex that no triangle uses may go anywhere, as may -0.
    let mut moved = hinge().positions;
    moved[6] = Vec3::splat(9.0);
    moved[3] = -Vec3::ZERO;
    world.deform(joined, &moved).unwrap();
    assert_eq!(world.vertices_of(joined).unwrap()[6], None);
}

#[test]
fn a_deformation_that_leads_nowhere_changes_nothing() {
    let mut world = World::build(&strewn_soup(1, 100, 0.3)).unwrap();
    let pose = Pose::at(DVec3::ONE);
    let id = world.insert(&hinge(), &pose).unwrap();
    let before = world.clone();
    let mut bad = hinge().positions;
    bad[2].y = f32::NAN;
    assert!(matches!(world.deform(id, &bad), Err(ObjectError::Mesh(_))));
    let length = |what, found| ObjectError::Length {
        what,
        found,
        vertices: 7,
    };
    assert_eq!(world.deform(id, &bad[..3]), Err(length("positions", 3)));
    let refused = world.insert_deforming(&hinge(), &[0; 3], &pose);
    assert_eq!(refused, Err(length("keys", 3)));
    bad[2].y = f32::MAX;
    assert!(matches!(world.deform(id, &bad), Err(ObjectError::Mesh(_))));
    bad[2].y = World::MAX_COORDINATE;
    let far = Pose::at(DVec3::new(0.0, 1e17, 0.0));
    world.pose(id, &far).unwrap();
    assert_eq!(world.deform(id, &bad), Err(ObjectError::Pose));
    world.pose(id, &pose).unwrap();
    assert_eq!(world, before);
    world.remove(id).unwrap();
    assert_eq!(
        world.deform(id, &hinge().positions),
        Err(ObjectError::Unknown)
    );
}

/// Without the refit the tree is stale, and lights miss what moved: the checks above would see it.
#[test]
fn stale_boxes_are_noticed() {
    let mut world = World::build(&Mesh::default()).unwrap();
    let id = world.insert(&hinge(), &Pose::at(DVec3::ZERO)).unwrap();
    let light = [point_light(Vec3::new(10.3, 0.3, 0.3), 2.0)];
    let moved: Vec<Vec3> = hinge()
        .positions
        .iter()
        .map(|p| *p + 10.0 * Vec3::X)
        .collect();
    let mut stale = world.clone();
    let vertices = stale.vertices_of(id).unwrap();
    for (vertex, p) in vertices.iter().zip(&moved) {
        if let Some(vertex) = vertex {
            stale.positions.to_mut()[*vertex as usize] = *p;
        }
    }
    world.deform(id, &moved).unwrap();
    assert_eq!(world.positions, stale.positions);
    assert_eq!(build(&world, &light).chain_triangles(0).count(), 2);
    assert_eq!(build(&stale, &light).chain_triangles(0).count(), 0);
}
