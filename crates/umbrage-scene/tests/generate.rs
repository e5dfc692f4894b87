//! Generated worlds: the same every time, of the size asked for, and as odd as they claim.

use std::collections::HashMap;

use glam::Vec3;
use umbrage_scene::{Scene, SceneError, Soup, open};

fn build(spec: &str) -> Scene {
    open(spec, &()).unwrap()
}

fn bits(soup: &Soup) -> Vec<[u32; 3]> {
    soup.positions
        .iter()
        .map(|p| p.to_array().map(f32::to_bits))
        .collect()
}

/// How many triangles lie on each edge once vertices are welded by position.
fn edges(soup: &Soup) -> HashMap<[[u32; 3]; 2], u32> {
    let key = bits(soup);
    let mut edges = HashMap::new();
    for t in &soup.triangles {
        for i in 0..3 {
            let mut edge = [key[t[i] as usize], key[t[(i + 1) % 3] as usize]];
            edge.sort_unstable();
            *edges.entry(edge).or_insert(0) += 1;
        }
    }
    edges
}

#[test]
fn a_seed_gives_the_same_world_and_another_seed_another() {
    for name in ["city?triangles=20000", "soup?", "field?n=32"] {
        let [a, b, c] = [1, 1, 2].map(|seed| build(&format!("gen:{name}&seed={seed}")));
        let [ka, kb, kc] = [&a, &b, &c].map(|s| bits(&s.soup().unwrap()));
        assert!(ka == kb && a.lights == b.lights, "{name}");
        assert!(ka != kc && a.lights != c.lights, "{name}");
    }
}

#[test]
fn triangles_and_lights_are_as_many_as_asked_for() {
    for asked in [1, 100, 1_000, 7_777, 100_000, 300_000] {
        let scene = build(&format!("gen:city?triangles={asked}&lights=100"));
        assert_eq!(
            (scene.soup().unwrap().triangles.len(), scene.lights.len()),
            (asked, 100)
        );
    }
    let scene = build("gen:soup?triangles=2000&lights=8");
    assert_eq!(
        (scene.soup().unwrap().triangles.len(), scene.lights.len()),
        (2000, 8)
    );
    let scene = build("gen:field?n=20&lights=5");
    assert_eq!(
        (scene.soup().unwrap().triangles.len(), scene.lights.len()),
        (800, 5)
    );
}

#[test]
fn a_larger_city_has_the_same_lamps_and_the_same_density() {
    let small = build("gen:city?triangles=100000&lights=200");
    let large = build("gen:city?triangles=400000&lights=200");
    assert_eq!(small.lights, large.lights);
    assert_eq!(small.meshes[0], large.meshes[0]);
    let more = build("gen:city?triangles=100000&lights=300");
    assert_eq!(small.lights[..], more.lights[..200]);
    let ratio = large.instances.len() as f64 / small.instances.len() as f64;
    assert!((3.6..4.4).contains(&ratio), "{ratio}");
    for light in &small.lights {
        assert!((12.0..=18.0).contains(&light.range.unwrap()));
    }
    assert_eq!(build("gen:city?moon=1&lights=0").lights.len(), 1);
}

/// The volume under the signed faces of a mesh: positive if they face outward.
fn volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let tetra = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(tetra).sum()
}

#[test]
fn houses_are_closed_and_face_outward() {
    let scene = build("gen:city?triangles=8000&lights=0");
    let mesh = &scene.meshes[0];
    let facade = |t: usize| scene.materials[mesh.materials[t] as usize].name != "tin roof";
    let walls: Vec<[u32; 3]> = (0..mesh.triangles.len())
        .filter(|&t| facade(t))
        .map(|t| mesh.triangles[t])
        .collect();
    // Six houses of about 9 x 13 x 9 m, less the walls' slant under sheet roofs.
    let volume = volume(&mesh.positions, &walls);
    assert!((2000.0..9000.0).contains(&volume), "{volume}");
    let up = mesh.triangles[..2].iter().all(|t| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).y > 0.0
    });
    assert!(up, "the street faces up");
    assert!(scene.materials.iter().any(|m| m.double_sided));
}

#[test]
fn the_soup_has_edges_with_one_to_twelve_triangles_and_duplicates() {
    let scene = build("gen:soup");
    let soup = scene.soup().unwrap();
    let mut seen = [0; 13];
    for &count in edges(&soup).values() {
        assert!(count <= 12, "an edge has {count} triangles");
        seen[count as usize] += 1;
    }
    assert!(seen[1..].iter().all(|&n| n > 0), "{seen:?}");

    let key = bits(&soup);
    let mut faces = HashMap::new();
    for t in &soup.triangles {
        let mut face = t.map(|v| key[v as usize]);
        face.sort_unstable();
        *faces.entry(face).or_insert(0) += 1;
    }
    assert!(faces.values().any(|&n| n > 1), "no duplicates");
    assert!(soup.positions.iter().all(|p| p.abs().max_element() <= 7.0));
    let mut materials = soup.material.clone();
    materials.sort_unstable();
    materials.dedup();
    assert_eq!(materials, [0, 1]);
}

#[test]
fn unknown_names_keys_and_values_list_the_valid_ones() {
    let text = |spec: &str| open(spec, &()).unwrap_err().to_string();
    assert!(matches!(
        open("gen:town", &()),
        Err(SceneError::UnknownGenerator { .. })
    ));
    assert!(text("gen:town").contains("city, soup, field"));
    for spec in [
        "gen:city?tris=5",
        "gen:city?lights=-1",
        "gen:city?triangles",
        "gen:city?moon=2",
    ] {
        let text = text(spec);
        assert!(
            text.contains("triangles") && text.contains("moon"),
            "{text}"
        );
    }
}

#[test]
fn what_can_be_opened_is_found_and_what_cannot_is_refused_alike() {
    assert!(umbrage_scene::find("gen:city?triangles=5e7").is_ok());
    assert!(umbrage_scene::find("../../data/worlds/stormkeep.glb").is_ok());
    for spec in [
        "gen:forest",
        "gen:soup?trees=3",
        "no/such.glb",
        "Cargo.toml",
        "src",
    ] {
        let found = umbrage_scene::find(spec).unwrap_err();
        let opened = umbrage_scene::open(spec, &()).unwrap_err();
        assert_eq!(found.to_string(), opened.to_string());
    }
}
