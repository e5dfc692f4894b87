//! The bodies of the fuzz targets (`tests/fuzz`), on stable and in seconds: every file of their
//! corpus, and seeded mutations of it.

#[path = "fuzz/bodies/mod.rs"]
mod bodies;
#[path = "fuzz/mutate.rs"]
mod mutate;

use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use umbrage_core::world::World;
use umbrage_core::{Casting, Mesh};

use bodies::{BODIES, Body, Outcome};
use mutate::Mutator;

/// Mutations of the corpus of each target.
const MUTATIONS: u64 = 4_000;

fn folder(target: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/fuzz/corpus").join(target)
}

/// Files of a corpus by name.
fn corpus(target: &str) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder(target)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let file = |path: PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read(path).unwrap())
    };
    paths.into_iter().map(file).collect()
}

/// Runs a body on every seed and on mutations of them; the first that panics, by name or number.
fn replay(body: Body, seeds: &[(String, Vec<u8>)], mutations: u64) -> Result<Vec<Outcome>, String> {
    let run = |bytes: &[u8], name: &dyn Fn() -> String| {
        catch_unwind(|| body(bytes)).map_err(|_| format!("{} panics", name()))
    };
    let mut outcomes = Vec::new();
    for (name, bytes) in seeds {
        outcomes.push(run(bytes, &|| name.clone())?);
    }
    let bytes: Vec<&[u8]> = seeds.iter().map(|(_, bytes)| &bytes[..]).collect();
    for seed in 0..mutations {
        let mutated = Mutator::new(seed).mutate(&bytes);
        run(&mutated, &|| format!("mutation {seed}"))?;
    }
    Ok(outcomes)
}

fn replay_target(target: &str) {
    let (_, body) = BODIES
        .into_iter()
        .find(|(name, _)| *name == target)
        .unwrap();
    let seeds = corpus(target);
    let outcomes = match replay(body, &seeds, MUTATIONS) {
        Ok(outcomes) => outcomes,
        Err(what) => panic!("{target}: {what}"),
    };
    // A corpus that no longer gets in, or that nothing is wrong with, tests nothing.
    for used in [true, false] {
        let some = outcomes.iter().any(|o| (*o == Outcome::Used) == used);
        assert!(some, "no file of {target} with used = {used}: {outcomes:?}");
    }
}

#[test]
fn gltf_files() {
    replay_target("gltf");
}

#[test]
fn obj_files() {
    replay_target("obj");
}

#[test]
fn saved_worlds() {
    replay_target("world");
}

#[test]
fn light_files() {
    replay_target("lights");
}

/// Saved worlds are written by the system itself: after a change of their format, run this with
/// `UMBRAGE_BLESS_SEEDS=1`.
#[test]
fn seeds_of_saved_worlds_are_of_this_format() {
    let bless = std::env::var_os("UMBRAGE_BLESS_SEEDS").is_some();
    for (name, mesh) in saved_meshes() {
        let file = folder("world").join(format!("{name}.world"));
        if bless {
            let world = World::build(&mesh).unwrap();
            world.save(&file, mesh.fingerprint()).unwrap();
        }
        let opened = World::open(&file, mesh.fingerprint()).map(|world| world.validate());
        assert!(matches!(opened, Ok(Ok(()))), "{name}: {opened:?}");
    }
}

/// No triangle, one, more than a cluster, edges with many triangles, and places beyond f32.
fn saved_meshes() -> [(&'static str, Mesh); 5] {
    let strip = |triangles: u32, corner: fn(u32) -> [u32; 3]| Mesh {
        positions: (0..triangles + 2)
            .map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, (i * i % 5) as f32))
            .collect(),
        triangles: (0..triangles).map(corner).collect(),
        casting: (0..triangles as usize).map(rule).collect(),
        ..Mesh::default()
    };
    fn rule(t: usize) -> Casting {
        [Casting::Both, Casting::Front, Casting::Back, Casting::None][t % 4]
    }
    let mut far = strip(3, |t| [t, t + 1, t + 2]);
    let places: Vec<DVec3> = far
        .positions
        .iter()
        .map(|p| p.as_dvec3() + 1e7 + 1e-3)
        .collect();
    far.stand(places);
    [
        ("far", far),
        ("none", Mesh::default()),
        ("one", strip(1, |t| [t, t + 1, t + 2])),
        ("strip", strip(70, |t| [t, t + 1, t + 2])),
        ("book", strip(12, |t| [0, 1, t + 2])),
    ]
}

/// The negative control: one byte in a place that only mutations reach.
#[test]
fn a_body_that_panics_is_noticed() {
    fn panics_at_a_bracket(bytes: &[u8]) -> Outcome {
        assert!(!bytes.ends_with(b"]]"));
        Outcome::Used
    }
    let seeds = corpus("lights");
    assert!(replay(panics_at_a_bracket, &seeds, 0).is_ok());
    let noticed = replay(panics_at_a_bracket, &seeds, MUTATIONS).unwrap_err();
    assert!(noticed.starts_with("mutation "), "{noticed}");
    fn panics_at_once(_: &[u8]) -> Outcome {
        panic!("on purpose")
    }
    let noticed = replay(panics_at_once, &seeds, 0).unwrap_err();
    assert_eq!(noticed, "all_kinds.json panics");
}
