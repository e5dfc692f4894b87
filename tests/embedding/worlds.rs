//! Worlds as a host hands them over: files, places far away, objects that deform.

use umbrage::{Error, Mesh, Pose, World};

use crate::host_depth::common::Triangles;

#[test]
fn a_cached_world_is_that_of_the_meshes_it_is_asked_for() {
    let folder = std::env::temp_dir().join(format!("umbrage_cached_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporaries");
    let path = folder.join("hall.world");
    for pillars in [3, 3, 4] {
        let hall = Triangles::hall(5.0, pillars);
        let mesh = [Mesh::new(&hall.positions, &hall.indices)];
        let cached = World::cached(&path, &mesh).expect("a world");
        let built = World::build(&mesh).expect("a world");
        assert_eq!(cached.snapshot(), built.snapshot(), "{pillars} pillars");
        assert_eq!(cached.sources(), built.sources());
    }
    let picture = folder.join("somebodys.png");
    let bytes = vec![7; 10_000];
    std::fs::write(&picture, &bytes).expect("it can be written");
    let refused = World::cached(&picture, &[]);
    assert!(matches!(refused, Err(Error::Save(_))), "{refused:?}");
    assert_eq!(std::fs::read(&picture).ok(), Some(bytes));
    std::fs::remove_dir_all(&folder).expect("it can be removed");
}

#[test]
fn meshes_far_from_zero_keep_their_places() {
    let mut cube = Triangles::default();
    cube.add_box([-0.125; 3], [0.125; 3]);
    let far = [1e7 + 0.0625, 0.0, -3e6];
    let mesh = Mesh::new(&cube.positions, &cube.indices).origin(far);
    let (positions, triangles, casting) = World::build(&[mesh]).expect("a world").snapshot();
    assert_eq!((triangles.len(), casting.len()), (12, 12));
    let offset = |p: &[f64; 3], axis: usize| (p[axis] - far[axis]).abs();
    assert!(
        positions
            .iter()
            .all(|p| (0..3).all(|axis| offset(p, axis) == 0.125))
    );
}

#[test]
fn objects_deform_where_keys_say_that_vertices_may_part() {
    let mut world = World::build(&[]).expect("a world of nothing");
    let quad = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0; 3],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    let mesh = Mesh::new(&quad, &[0, 1, 2, 3, 4, 5]);
    let pose = Pose::at([0.0, 0.0, 2.0]);
    let mut apart = quad;
    apart[3] = [0.0, 0.0, 1.0];
    let rigid = world.insert(&mesh, &pose).expect("an object");
    assert!(matches!(world.deform(rigid, &apart), Err(Error::Object(_))));
    assert!(matches!(
        world.deform(rigid, &apart[..5]),
        Err(Error::Object(_))
    ));
    let free = world
        .insert_deforming(&mesh, &[0, 1, 2, 3, 4, 5], &pose)
        .expect("an object");
    world.deform(free, &apart).expect("its keys differ");
    let (positions, ..) = world.snapshot();
    assert!(positions.contains(&[0.0, 0.0, 3.0]));
    assert_eq!(
        world
            .corners_of(Some(free))
            .map(|corners| corners.len())
            .ok(),
        Some(6)
    );
}
