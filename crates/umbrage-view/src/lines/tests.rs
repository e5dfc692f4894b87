use umbrage_core::volume::VolumeBuilder;
use umbrage_core::{Casting, Mesh};

use super::*;

/// A square of two triangles one metre below a lamp, and `fins` more triangles below it on one of its sides.
fn lamp_over_square(fins: u32) -> (World, Light, Volumes) {
    let mut positions = vec![
        Vec3::new(-1.0, 0.0, -1.0),
        Vec3::new(-1.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, -1.0),
    ];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for fin in 0..fins {
        positions.push(Vec3::new(0.5, -0.1 * (fin + 1) as f32, 0.0));
        triangles.push([0, 1, 4 + fin]);
    }
    let mesh = Mesh {
        positions,
        casting: vec![Casting::Both; triangles.len()],
        triangles,
        ..Mesh::default()
    };
    let world = World::build(&mesh).unwrap();
    let light = Light {
        position: DVec3::new(0.0, 1.0, 0.0),
        range: 8.0,
        shape: LightShape::Point,
    };
    let mut volumes = Volumes::default();
    let mut builder = VolumeBuilder::new(umbrage_core::Culls::NONE);
    builder.settle(&world, &[light], |_| true, &mut volumes);
    (world, light, volumes)
}

#[test]
fn a_volume_has_four_lines_a_quad_that_end_at_the_range() {
    let (world, light, volumes) = lamp_over_square(0);
    let quads = volumes.quads_of(0);
    assert_eq!(quads.len(), 4);
    let anchor = DVec3::new(100.0, 0.0, 0.0);
    let mut lines = Lines::new(anchor);
    lines.volume(&world, &light, quads, ZPASS);
    assert_eq!(lines.lines.len(), 4 * quads.len());
    let from_lamp = |p: Vec3| (p.as_dvec3() + anchor - light.position).length();
    let longest = lines
        .lines
        .iter()
        .map(|l| from_lamp(l.to))
        .fold(0.0, f64::max);
    // The world is smaller than the range: sides end where it would.
    assert!((longest - 8.0_f64.sqrt()).abs() < 1e-4, "{longest}");
    assert!(lines.lines.iter().all(|line| line.color == ZPASS));
}

#[test]
fn silhouettes_have_a_line_an_edge_in_the_colour_of_its_counter() {
    for (fins, most) in [(0, 0), (1, 1), (2, 2)] {
        let (world, _, volumes) = lamp_over_square(fins);
        let mut lines = Lines::default();
        lines.silhouettes(&world, volumes.quads_of(0));
        let mut edges: Vec<u32> = volumes.quads_of(0).iter().map(|q| q.0.edge()).collect();
        edges.sort_unstable();
        edges.dedup();
        assert_eq!(lines.lines.len(), edges.len());
        let level = |line: &Line| MULTIPLICITY.iter().position(|c| *c == line.color);
        let highest = lines.lines.iter().filter_map(level).max();
        assert_eq!(highest, Some(most), "{fins} fins");
    }
}

#[test]
fn the_subset_has_three_lines_a_triangle_and_boxes_twelve_a_box() {
    let (world, light, volumes) = lamp_over_square(2);
    let mut lines = Lines::default();
    lines.subset(&world, &light, &volumes, 0);
    assert_eq!(lines.lines.len(), 3 * 4);
    assert!(lines.lines.iter().all(|line| line.color == CASTER));
    let mut lines = Lines::default();
    lines.boxes(&world, &light);
    assert_eq!(lines.lines.len(), 12);
    // A lamp out of reach has neither.
    let far = Light {
        position: DVec3::Y * 100.0,
        ..light
    };
    let mut lines = Lines::default();
    lines.subset(&world, &far, &Volumes::empty(1), 0);
    lines.boxes(&world, &far);
    assert!(lines.lines.is_empty());
}
