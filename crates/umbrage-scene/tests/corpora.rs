//! Real files, where they are: set `UMBRAGE_SCENES` to a folder of scenes with their statistics
//! (`STATS_*.tsv`: file, bytes, tris, verts, welded, nodes, meshnodes, inst_tris, lights, ...).
//! Without it these tests pass and check nothing.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use umbrage_scene::SceneError;

fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os("UMBRAGE_SCENES")?);
    assert!(folder.is_dir(), "UMBRAGE_SCENES is no folder");
    Some(folder)
}

/// Triangles, flattened triangles and lights of a file.
fn counts(path: &Path) -> Result<[u64; 3], String> {
    let scene = umbrage_scene::load(path, &()).map_err(|e| e.to_string())?;
    let soup = scene.soup().map_err(|e| e.to_string())?;
    let used: HashSet<u32> = scene.instances.iter().map(|i| i.mesh).collect();
    let stored = used
        .iter()
        .map(|&m| scene.meshes[m as usize].triangles.len() as u64)
        .sum();
    Ok([
        stored,
        soup.triangles.len() as u64,
        scene.lights.len() as u64,
    ])
}

/// Compares every file of a table; those in `refused` must give an error instead.
fn check(table: &str, refused: &[&str]) {
    let Some(folder) = folder() else { return };
    let text = std::fs::read_to_string(folder.join(table)).unwrap();
    let mut checked = 0;
    let mut wrong = Vec::new();
    for row in text.lines().skip(1) {
        let columns: Vec<&str> = row.split('\t').collect();
        let file = columns[0].strip_prefix("dev/").unwrap_or(columns[0]);
        if !folder.join(file).exists() || columns[2] == "ERR" {
            continue;
        }
        let expected = [2, 7, 8].map(|c| columns.get(c).and_then(|v| v.parse().ok()));
        let found = counts(&folder.join(file));
        checked += 1;
        let same =
            |found: &[u64; 3]| (0..3).all(|i| expected[i].is_none_or(|e: u64| e == found[i]));
        let right = match refused.iter().any(|r| file.ends_with(r)) {
            true => found.is_err(),
            false => found.as_ref().is_ok_and(same),
        };
        if !right {
            wrong.push(format!("{file}: expected {expected:?}, found {found:?}"));
        }
    }
    assert!(checked > 0, "no file of {table} was found");
    assert!(
        wrong.is_empty(),
        "{} of {checked}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn worlds_have_the_triangles_and_lights_of_their_statistics() {
    check("STATS_worlds.tsv", &[]);
}

#[test]
fn nasty_files_have_the_triangles_of_their_statistics() {
    // Indices of vertices that are not there, a number that is none, and UTF-16.
    let refused = [
        "invalid-relative-texture-index.obj",
        "invalid-relative-vertex-index.obj",
        "issue-140-zero-face-idx.obj",
        "number_formats.obj",
        "box_UTF16BE.obj",
    ];
    check("STATS_nasty.tsv", &refused);
}

/// Loads a file and flattens it at rest and in motion.
fn load_and_move(path: &Path) -> Result<(), SceneError> {
    let scene = umbrage_scene::load(path, &())?;
    scene.soup()?;
    for time_s in [0.0, 0.3, 1e9] {
        scene.soup_posed(&scene.posed(time_s), None)?;
    }
    Ok(())
}

#[test]
fn every_file_gives_a_scene_or_an_error_that_names_it() {
    let Some(folder) = folder() else { return };
    let (mut folders, mut files) = (vec![folder], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if let Err(error) = load_and_move(&path) {
                let name = path.file_stem().unwrap().to_string_lossy().into_owned();
                let message = error.to_string();
                assert!(message.contains(&name), "names no file: {message}");
                assert!(message.contains("; "), "has no remedy: {message}");
            }
            files += 1;
        }
    }
    assert!(files > 0);
}
