//! Saved worlds: the same when opened, and refused when they are not what they should be.

mod common;

use std::fs;
use std::path::PathBuf;

use glam::Vec3;

use common::{grid, strewn_soup};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::world::{EdgeUse, Node, SavedWorldError, World};
use umbrage_core::{Casting, Fingerprint, Light, LightShape, Mesh};

/// A path in a folder of its own, removed with it.
struct Place(PathBuf);

impl Place {
    fn new(test: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("umbrage-save-{test}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn file(&self) -> PathBuf {
        self.0.join("world")
    }

    fn saved(&self, mesh: &Mesh) -> World {
        let world = World::build(mesh).unwrap();
        world.save(&self.file(), mesh.fingerprint()).unwrap();
        world
    }

    fn open(&self, fingerprint: Fingerprint) -> Result<World, SavedWorldError> {
        World::open(&self.file(), fingerprint)
    }

    /// Replaces the file: one that is mapped must not change.
    fn put(&self, bytes: &[u8]) {
        let part = self.0.join("part");
        fs::write(&part, bytes).unwrap();
        fs::rename(part, self.file()).unwrap();
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        // Left behind at worst: it is the system's temporary folder.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn opened_is_what_was_built() {
    let place = Place::new("round");
    for mesh in [
        Mesh::default(),
        grid(1),
        grid(20),
        strewn_soup(3, 1000, 0.1),
    ] {
        let built = place.saved(&mesh);
        let opened = place.open(mesh.fingerprint()).unwrap();
        assert!(built == opened, "{} triangles", mesh.triangles.len());
        assert!(opened.triangles.is_mapped() && !built.triangles.is_mapped());
        opened.validate().unwrap();
        // The opened one is mapped still while another is saved over it.
        place.saved(&grid(3));
        assert!(built == opened);
    }
    assert_eq!(
        place.0.read_dir().unwrap().count(),
        1,
        "nothing left beside"
    );
}

#[test]
fn a_flipped_byte_is_refused_or_harmless() {
    let place = Place::new("flip");
    let mesh = grid(1);
    let built = place.saved(&mesh);
    let whole = fs::read(place.file()).unwrap();
    let mut harmless = 0;
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        place.put(&bytes);
        match place.open(mesh.fingerprint()) {
            Ok(opened) => {
                assert!(opened == built, "byte {at}");
                harmless += 1;
            }
            Err(SavedWorldError::Io(error)) => panic!("byte {at}: {error}"),
            Err(error) => assert!(error.to_string().contains(": "), "{error}"),
        }
    }
    // At most 63 bytes of padding before each of ten arrays.
    assert!(harmless < 63 * 10, "{harmless}");
}

#[test]
fn an_incomplete_file_is_refused_at_every_length() {
    let place = Place::new("short");
    let mesh = grid(1);
    place.saved(&mesh);
    let whole = fs::read(place.file()).unwrap();
    for length in 0..whole.len() {
        place.put(&whole[..length]);
        let error = place.open(mesh.fingerprint()).unwrap_err();
        assert!(
            match error {
                SavedWorldError::NotASavedWorld => length < 16,
                SavedWorldError::Truncated { found, expected } =>
                    found == length as u64 && found < expected,
                _ => false,
            },
            "{length} bytes: {error}"
        );
    }
    place.put(&[&whole[..], b"more"].concat());
    let error = place.open(mesh.fingerprint()).unwrap_err();
    assert!(matches!(error, SavedWorldError::Truncated { .. }));
}

#[test]
fn what_is_wrong_is_said() {
    let place = Place::new("said");
    let mesh = grid(1);
    let missing = place.open(mesh.fingerprint()).unwrap_err();
    assert!(matches!(missing, SavedWorldError::Io(_)), "{missing}");
    let folder = World::open(&place.0, mesh.fingerprint()).unwrap_err();
    assert!(matches!(folder, SavedWorldError::NotASavedWorld));
    place.saved(&mesh);
    let stale = place.open(grid(3).fingerprint()).unwrap_err();
    assert!(matches!(stale, SavedWorldError::Stale), "{stale}");

    let whole = fs::read(place.file()).unwrap();
    let with = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] = byte;
        place.put(&bytes);
        place.open(mesh.fingerprint()).unwrap_err()
    };
    assert!(matches!(with(0, b'x'), SavedWorldError::NotASavedWorld));
    let turned = with(
        if cfg!(target_endian = "little") {
            8
        } else {
            11
        },
        1,
    );
    assert!(matches!(turned, SavedWorldError::OtherByteOrder));
    assert!(matches!(
        with(
            if cfg!(target_endian = "little") {
                12
            } else {
                15
            },
            99
        ),
        SavedWorldError::OtherVersion { found: 99, .. }
    ));
    let last = with(whole.len() - 1, 77);
    assert!(
        matches!(last, SavedWorldError::Damaged { section: "nodes" }),
        "{last}"
    );
}

/// Checksums say that the file is as it was written. What was written may still be wrong.
#[test]
fn numbers_that_point_outside_are_refused() {
    let place = Place::new("outside");
    let mesh = grid(4);
    let good = World::build(&mesh).unwrap();
    let refused = |expected: &str, damage: &dyn Fn(&mut World)| {
        let mut world = good.clone();
        damage(&mut world);
        world.save(&place.file(), mesh.fingerprint()).unwrap();
        match place.open(mesh.fingerprint()) {
            Err(SavedWorldError::Invalid { section, .. }) => assert_eq!(section, expected),
            other => panic!("{expected}: {:?}", other.map(|_| "opened")),
        }
    };
    let far = u32::MAX;
    refused("positions", &|w| w.positions.to_mut()[3].x = f32::NAN);
    refused("triangles", &|w| w.triangles.to_mut()[100][1] = 81);
    refused("source", &|w| w.source.to_mut()[100] = 128);
    refused("source", &|w| w.source.to_mut().push(0));
    refused("casting", &|w| w.casting.to_mut().truncate(100));
    refused("edges", &|w| w.edges.vertices.to_mut()[7][0] = far);
    refused("sides", &|w| {
        w.edges.sides.to_mut()[1][2][63] = EdgeUse(far);
    });
    refused("clusters", &|w| {
        w.clusters.to_mut()[0].sides[1].partner[9] = 64;
    });
    refused("clusters", &|w| w.clusters.to_mut().truncate(1));
    refused("planes", &|w| w.planes.clusters.to_mut().truncate(1));
    refused("boxes", &|w| w.boxes.to_mut().truncate(1));
    refused("nodes", &|w| w.bvh.nodes.to_mut().clear());
    refused("nodes", &|w| w.bvh.nodes.to_mut()[0].count = far);
    refused("nodes", &|w| w.bvh.nodes.to_mut()[0].second = far);
    refused("nodes", &|w| w.bvh.nodes.to_mut()[0].second = 1);
    refused("nodes", &|w| {
        let leaf = w.bvh.nodes.iter().position(Node::is_leaf).unwrap();
        w.bvh.nodes.to_mut()[leaf].first = far;
    });
    refused("nodes", &|w| {
        let leaf = w.bvh.nodes.iter().position(Node::is_leaf).unwrap();
        w.bvh.nodes.to_mut()[leaf].second = leaf as u32;
    });
}

/// Lanes beyond the last triangle must stay empty: nothing knows their corners.
#[test]
fn lanes_without_a_triangle_stay_empty() {
    let place = Place::new("lanes");
    let mesh = grid(1);
    for lane in 0..64 {
        let mut world = World::build(&mesh).unwrap();
        world.clusters.to_mut()[0].casts_front |= 1 << lane;
        world.save(&place.file(), mesh.fingerprint()).unwrap();
        assert_eq!(place.open(mesh.fingerprint()).is_ok(), lane < 8, "{lane}");
    }
}

/// Found by fuzzing saved worlds: with a radius below zero the bound on rounding is too, and a
/// triangle faces the light and away from it. Its volume closes still.
#[test]
fn planes_that_face_both_ways_close_their_volumes() {
    let place = Place::new("planes");
    let mut mesh = grid(4);
    mesh.casting.fill(Casting::Both);
    let lights = [0.0, 0.5].map(|height| Light {
        position: Vec3::new(0.3, height, 0.2).into(),
        range: f32::INFINITY,
        shape: LightShape::Point,
    });
    for radius in [-1e9, f32::NEG_INFINITY, f32::NAN, f32::INFINITY] {
        let mut world = World::build(&mesh).unwrap();
        for planes in world.planes.clusters.to_mut() {
            planes.radius = radius;
        }
        world.save(&place.file(), mesh.fingerprint()).unwrap();
        let opened = place.open(mesh.fingerprint()).unwrap();
        let mut volumes = Volumes::default();
        VolumeBuilder::default().settle(&opened, &lights, |_| true, &mut volumes);
        volumes.check_closed(&opened).unwrap();
    }
}
