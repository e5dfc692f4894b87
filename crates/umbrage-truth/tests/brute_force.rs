//! The hierarchy against plain loops over all triangles, by another formula.

mod common;

use common::*;
use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Mesh, View};
use umbrage_truth::{EyeRays, NearClip, Oracle};

/// Moeller and Trumbore 1997: distance along `d` in units of `d`, and how clearly (smallest
/// barycentric coordinate, negative for a miss).
fn intersect(corners: [DVec3; 3], o: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
    let across = d.cross(e2);
    let det = e1.dot(across);
    if det.abs() < 1e-9 * e1.length() * e2.length() * d.length() {
        return None;
    }
    let s = o - corners[0];
    let u = s.dot(across) / det;
    let q = s.cross(e1);
    let v = d.dot(q) / det;
    Some((e2.dot(q) / det, u.min(v).min(1.0 - u - v)))
}

fn soup(random: &mut Random, count: usize, size: f32, offset: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..count {
        let at = offset + random.point(10.0);
        let stretch = if k % 7 == 0 { 8.0 } else { 1.0 };
        let corners = [0; 3].map(|_| at + random.point(size * stretch));
        triangle(&mut mesh, corners, Casting::Both);
    }
    mesh
}

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect()
}

/// Answers closer to an edge or an end than this are not compared.
const CLEAR: f64 = 1e-7;

#[test]
fn any_hit_equals_a_loop_over_segments() {
    let mut random = Random(1);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..40 {
        let offset = if round % 2 == 0 {
            Vec3::ZERO
        } else {
            Vec3::new(900.0, -300.0, 70.0)
        };
        let mesh = soup(&mut random, 1 + round * 20, 1.5, offset);
        let (oracle, corners) = (Oracle::new(&mesh), corners(&mesh));
        for segment in 0..300 {
            let mut from = offset + random.point(12.0);
            let to = offset + random.point(12.0);
            if segment % 3 == 0 {
                from = Vec3::new(to.x, to.y, from.z);
            }
            let (from, to) = (from.as_dvec3(), to.as_dvec3());
            let directional = segment % 2 == 0;
            let (along, light, end) = if directional {
                let towards = (to - from).as_vec3();
                (towards.as_dvec3(), sun(-towards), f64::INFINITY)
            } else {
                (to - from, point_light(to.as_vec3(), 1.0), 1.0)
            };
            let found: Vec<_> = corners
                .iter()
                .filter_map(|&c| intersect(c, from, along))
                .collect();
            let between = |&&(t, inside): &&(f64, f64), slack: f64| {
                inside > slack && t > slack && t < end - slack
            };
            let surely = found.iter().any(|h| between(&h, CLEAR));
            let maybe = found.iter().any(|h| between(&h, -CLEAR));
            if surely == maybe {
                assert_eq!(oracle.is_occluded(from.to_array(), &light), surely);
                hits += u32::from(surely);
                misses += u32::from(!surely);
            }
        }
    }
    assert!(hits > 1000 && misses > 1000, "{hits} {misses}");
}

#[test]
fn first_hits_equal_a_loop_over_triangles() {
    let mut random = Random(2);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..30 {
        let mesh = soup(&mut random, 1 + round * 30, 1.2, Vec3::ZERO);
        let (oracle, corners) = (Oracle::new(&mesh), corners(&mesh));
        let mut view = View::look_at(random.point(12.0), random.point(3.0), 1.3, 0.5, [16, 12]);
        if round % 3 == 0 {
            // Rays parallel to the axes, and a frame that is neither unit nor orthogonal.
            (view.right, view.up) = (Vec3::X, Vec3::new(0.125, 1.0, 0.0));
            view.forward = Vec3::new(0.0, 0.0, -1.25);
        }
        let rays = EyeRays::new(&view, NearClip::Clamped);
        let eye = view.eye;
        for _ in 0..200 {
            let x = f64::from(random.unit() * 8.0 + 8.0);
            let y = f64::from(random.unit() * 6.0 + 6.0);
            let hit = oracle.first_hit(&rays, x, y);
            // The direction, from the definition of the view: solve it by Cramer's rule.
            let rows = [view.right, view.up, view.forward].map(Vec3::as_dvec3);
            let wanted = DVec3::new(
                (2.0 * x / 16.0 - 1.0) / f64::from(view.scale_x),
                (1.0 - 2.0 * y / 12.0) / f64::from(view.scale_y),
                1.0,
            );
            let m = glam::DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
            let d = m.inverse() * wanted;
            let found: Vec<_> = corners
                .iter()
                .enumerate()
                .filter_map(|(k, &c)| intersect(c, eye, d).map(|(t, inside)| (t, inside, k)))
                .filter(|&(t, inside, _)| inside > -CLEAR && t > -CLEAR)
                .collect();
            if found.iter().any(|h| h.1 < CLEAR || h.0 < CLEAR) {
                continue;
            }
            let nearest = found.iter().min_by(|a, b| a.0.total_cmp(&b.0));
            match (hit, nearest) {
                (None, None) => misses += 1,
                (Some(hit), Some(&(t, _, k))) => {
                    hits += 1;
                    assert_eq!(hit.triangle as usize, k);
                    assert!((hit.distance - t).abs() < 1e-9 * t, "{} {t}", hit.distance);
                }
                (a, b) => panic!("{a:?} {b:?}"),
            }
        }
    }
    assert!(hits > 500 && misses > 500, "{hits} {misses}");
}

#[test]
fn equal_centres_do_not_stop_the_build() {
    let mut mesh = Mesh::default();
    for k in 0..5000 {
        let size = 1.0 + (k % 50) as f32;
        let corner = |x: f32, z: f32| Vec3::new(x * size, 0.0, z * size);
        let corners = [corner(-1.0, -1.0), corner(0.0, 1.0), corner(1.0, -1.0)];
        triangle(&mut mesh, corners, Casting::Both);
    }
    let oracle = Oracle::new(&mesh);
    let light = point_light(Vec3::new(0.0, 4.0, 0.0), 9.0);
    assert!(oracle.is_occluded([0.0, -4.0, 0.0], &light));
    assert!(!oracle.is_occluded(
        [80.0, -4.0, 0.0],
        &point_light(Vec3::new(80.0, 4.0, 0.0), 9.0)
    ));
}
