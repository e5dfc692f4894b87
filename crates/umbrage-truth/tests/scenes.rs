//! Verdicts on scenes whose shadows are known.

mod common;

use common::*;
use glam::{DVec3, Vec3};
use umbrage_core::{Casting, Light, LightShape, Mesh, View};
use umbrage_truth::{EyeRays, NearClip, Oracle, Verdict};

/// Calls `check` with the point seen in and the verdict of every pixel with a surface.
fn each_pixel(
    mesh: &Mesh,
    view: &View,
    light: &Light,
    mut check: impl FnMut(DVec3, u32, Verdict),
) -> u32 {
    let oracle = Oracle::new(mesh);
    let rays = EyeRays::new(view, NearClip::Clamped);
    let mut seen = 0;
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let verdict = oracle.verdict(&rays, x, y, light);
            match oracle.first_hit(&rays, x, y) {
                Some(hit) => {
                    seen += 1;
                    check(DVec3::from_array(hit.point), hit.triangle, verdict);
                }
                None => assert_eq!(verdict, Verdict::Background),
            }
        }
    }
    seen
}

#[test]
fn a_square_shadows_a_square() {
    let mesh = floor_and_square(Casting::Front);
    let light = point_light(Vec3::new(0.0, 3.0, 0.0), 100.0);
    let (mut lit, mut shadowed) = (0, 0);
    each_pixel(
        &mesh,
        &looking_down([200, 150]),
        &light,
        |p, triangle, verdict| {
            let on_floor = triangle < 2;
            let inside = on_floor && p.x.abs() < 1.5 && p.z.abs() < 1.5;
            assert_eq!(
                verdict,
                if inside {
                    Verdict::Shadowed
                } else {
                    Verdict::Lit
                },
                "{p}"
            );
            shadowed += u32::from(inside);
            lit += u32::from(!inside);
        },
    );
    assert!(lit > 10_000 && shadowed > 500, "{lit} {shadowed}");
}

#[test]
fn a_directional_light_shifts_the_square() {
    let mesh = floor_and_square(Casting::Front);
    let light = sun(Vec3::new(1.0, -1.0, 0.5));
    let mut shadowed = 0;
    each_pixel(
        &mesh,
        &looking_down([200, 150]),
        &light,
        |p, triangle, verdict| {
            let inside = triangle < 2 && (p.x - 1.0).abs() < 1.0 && (p.z - 0.5).abs() < 1.0;
            assert_eq!(
                verdict,
                if inside {
                    Verdict::Shadowed
                } else {
                    Verdict::Lit
                },
                "{p}"
            );
            shadowed += u32::from(inside);
        },
    );
    assert!(shadowed > 300);
}

#[test]
fn casting_rules_pick_the_side() {
    // Under the square's middle, out of the eye's line to it.
    for (rule, from_above, from_below) in [
        (Casting::None, false, false),
        (Casting::Front, true, false),
        (Casting::Back, false, true),
        (Casting::Both, true, true),
    ] {
        let mut mesh = Mesh::default();
        plate(&mut mesh, [-1.0; 2], [1.0; 2], 1.0, rule);
        let oracle = Oracle::new(&mesh);
        let (above, below) = (Vec3::new(0.1, 4.0, 0.2), Vec3::new(0.1, -4.0, 0.2));
        let occluded = |from: Vec3, to: Vec3| {
            let light = point_light(to, 100.0);
            oracle.is_occluded(from.as_dvec3().to_array(), &light)
        };
        assert_eq!(occluded(below, above), from_above, "{rule:?}");
        assert_eq!(occluded(above, below), from_below, "{rule:?}");
        assert!(!occluded(above, above + Vec3::Y));
        let from = below.as_dvec3().to_array();
        assert_eq!(
            oracle.is_occluded(from, &sun(Vec3::NEG_Y)),
            from_above,
            "{rule:?}"
        );
        assert!(!oracle.is_occluded(from, &sun(Vec3::Y)), "{rule:?}");
        // In the plane: no side faces the light, nothing is crossed.
        assert!(!occluded(below, Vec3::new(0.5, 1.0, 0.5)), "{rule:?}");
        assert!(
            !oracle.is_occluded([-3.0, 1.0, 0.0], &sun(Vec3::NEG_X)),
            "{rule:?}"
        );
    }
}

#[test]
fn spots_end_at_their_cone_and_range() {
    let mut mesh = Mesh::default();
    plate(&mut mesh, [-10.0; 2], [10.0; 2], 0.0, Casting::Front);
    let position = Vec3::new(0.0, 2.0, 0.0);
    // Half angle with cosine 0.8: a disc of radius 1.5 on the floor; range 2.25: radius 1.03.
    for (range, radius) in [(100.0, 1.5), (2.25, 1.0625f64.sqrt())] {
        let shape = LightShape::Spot {
            direction: Vec3::NEG_Y,
            cos_outer: 0.8,
        };
        let light = Light {
            position: position.into(),
            range,
            shape,
        };
        let mut inside = 0;
        each_pixel(&mesh, &looking_down([160, 120]), &light, |p, _, verdict| {
            let distance = p.x.hypot(p.z);
            if (distance - radius).abs() > 1e-6 {
                let within = distance < radius;
                inside += u32::from(within);
                let expected = if within {
                    Verdict::Lit
                } else {
                    Verdict::OutOfRange
                };
                assert_eq!(verdict, expected, "{p}");
            }
        });
        assert!(inside > 100);
    }
}

/// A tilted plane of lattice points, exactly coplanar in f32 at any of the offsets used.
fn tilted_lattice(mesh: &mut Mesh, offset: Vec3, cells: i32, casting: Casting) {
    let corner =
        |i: i32, j: i32| offset + Vec3::new(i as f32, (i + 2 * j) as f32 * 0.25, j as f32) * 0.5;
    for i in -cells..cells {
        for j in -cells..cells {
            let [a, b, c, d] =
                [[i, j], [i, j + 1], [i + 1, j + 1], [i + 1, j]].map(|[i, j]| corner(i, j));
            quad(mesh, [a, b, c, d], casting);
        }
    }
}

#[test]
fn a_plane_far_away_does_not_shadow_itself() {
    for offset in [
        Vec3::ZERO,
        Vec3::new(1e5, -7e4, 9e4),
        Vec3::new(-3.0, 2f32.powi(20), 5.0),
    ] {
        let mut mesh = Mesh::default();
        tilted_lattice(&mut mesh, offset, 8, Casting::Both);
        // The same plane again, in other triangles.
        tilted_lattice(
            &mut mesh,
            offset + Vec3::new(0.5, 0.125, 0.0),
            5,
            Casting::Both,
        );
        let (eye, at) = (offset + Vec3::new(1.0, 4.0, 2.0), offset);
        let view = View::look_at(eye, at, 1.0, 0.1, [120, 90]);
        for light in [
            point_light(offset + Vec3::new(0.5, 3.0, -0.5), 100.0),
            point_light(offset + Vec3::new(3.0, 2.5, 2.0), 100.0),
            sun(Vec3::new(0.3, -1.0, -0.2)),
        ] {
            let seen = each_pixel(&mesh, &view, &light, |p, _, verdict| {
                assert_eq!(verdict, Verdict::Lit, "{p} {light:?}");
            });
            assert!(seen > 5000, "{seen}");
        }
    }
}

#[test]
fn coincident_triangles_are_one_surface() {
    let mut random = Random(5);
    for _ in 0..200 {
        let offset = random.point(1e4);
        let corners = [0; 3].map(|_| offset + random.point(5.0));
        let mut mesh = Mesh::default();
        for winding in [[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 1, 2]] {
            triangle(&mut mesh, winding.map(|k: usize| corners[k]), Casting::Both);
        }
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(normal) = normal.try_normalize() else {
            continue;
        };
        let eye = centre + normal * 7.0 + random.point(3.0);
        let light = point_light(centre + normal * 2.0 + random.point(1.0), 1e3);
        let view = View::look_at(eye, centre, 0.8, 0.1, [24, 24]);
        each_pixel(&mesh, &view, &light, |_, triangle, verdict| {
            assert_eq!((triangle, verdict), (0, Verdict::Lit));
        });
    }
}

/// An eye at (0, 0, 8) looking along -z, 45 degrees to each side: on z = 0 a pixel of a 64 x 64
/// image is exactly 0.25 wide.
fn square_view() -> View {
    View {
        eye: Vec3::new(0.0, 0.0, 8.0).into(),
        right: Vec3::X,
        up: Vec3::Y,
        forward: Vec3::NEG_Z,
        near: 1.0,
        scale_x: 1.0,
        scale_y: 1.0,
        size: [64, 64],
    }
}

#[test]
fn rays_through_shared_edges_and_corners_hit() {
    // Edges and corners of the grid lie exactly on pixel centres.
    let mut mesh = Mesh::default();
    let p = |i: i32, j: i32| Vec3::new(i as f32 * 0.25 + 0.125, j as f32 * 0.25 + 0.125, 0.0);
    for i in -40..40 {
        for j in -40..40 {
            quad(
                &mut mesh,
                [p(i, j), p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)],
                Casting::Both,
            );
        }
    }
    let behind = |z| Vec3::new(0.0, 0.0, z);
    let light = point_light(behind(4.0), 100.0);
    let seen = each_pixel(&mesh, &square_view(), &light, |p, _, verdict| {
        assert_eq!((p.z, verdict), (0.0, Verdict::Lit));
    });
    assert_eq!(seen, 64 * 64);
    // Light through the same edges and corners does not leak.
    let oracle = Oracle::new(&mesh);
    for i in -64..64 {
        for j in -64..64 {
            let at = [f64::from(i) * 0.125, f64::from(j) * 0.125];
            let light = point_light(Vec3::new(at[0] as f32, at[1] as f32, 4.0), 100.0);
            assert!(oracle.is_occluded([at[0], at[1], -4.0], &light));
            assert!(oracle.is_occluded([at[0], at[1], -4.0], &sun(Vec3::NEG_Z)));
        }
    }
}

#[test]
fn a_box_keeps_its_light() {
    let inside = point_light(Vec3::new(0.3, 0.2, -0.1), 100.0);
    let outside = point_light(Vec3::new(4.0, 5.0, 3.0), 100.0);
    let from_inside = View::look_at(Vec3::new(0.5, 0.5, 0.5), Vec3::ZERO, 2.0, 0.1, [40, 30]);
    let from_outside = View::look_at(Vec3::new(5.0, 4.0, 6.0), Vec3::ZERO, 1.2, 0.1, [80, 60]);
    let mut mesh = Mesh::default();
    closed_box(
        &mut mesh,
        Vec3::splat(-1.0),
        Vec3::splat(1.0),
        Casting::Both,
    );
    let all = |view: &View, light: &Light, expected: Verdict| {
        each_pixel(&mesh, view, light, |_, _, verdict| {
            assert_eq!(verdict, expected);
        });
    };
    all(&from_inside, &inside, Verdict::Lit);
    all(&from_outside, &inside, Verdict::FacingAway);
    all(&from_outside, &outside, Verdict::Lit);
    // The outer light faces the inner sides of three walls, and is shut out by the other three.
    each_pixel(&mesh, &from_inside, &outside, |p, _, verdict| {
        let faces = p.min_element() < -1.0 + 1e-9;
        let expected = if faces {
            Verdict::Shadowed
        } else {
            Verdict::FacingAway
        };
        assert_eq!(verdict, expected, "{p}");
    });

    // A floor through and around the box: dark inside for the outer light, and the other way
    // round, if the crossed side casts.
    for casting in [Casting::Both, Casting::Front, Casting::Back] {
        let mut mesh = Mesh::default();
        plate(&mut mesh, [-9.0; 2], [9.0; 2], -0.5, Casting::None);
        closed_box(&mut mesh, Vec3::splat(-1.0), Vec3::splat(1.0), casting);
        let expected = |crossed: bool| {
            if crossed {
                Verdict::Shadowed
            } else {
                Verdict::Lit
            }
        };
        each_pixel(&mesh, &from_inside, &outside, |_, triangle, verdict| {
            if triangle < 2 {
                assert_eq!(verdict, expected(casting != Casting::Back), "{casting:?}");
            }
        });
        each_pixel(&mesh, &from_outside, &inside, |_, triangle, verdict| {
            if triangle < 2 {
                assert_eq!(verdict, expected(casting != Casting::Front), "{casting:?}");
            }
        });
    }
}

#[test]
fn the_near_plane_cuts_only_when_asked() {
    let mut mesh = Mesh::default();
    let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let wall = |z: f32| {
        [
            p(-9.0, -9.0, z),
            p(9.0, -9.0, z),
            p(9.0, 9.0, z),
            p(-9.0, 9.0, z),
        ]
    };
    quad(&mut mesh, wall(0.0), Casting::Both);
    quad(&mut mesh, wall(7.5), Casting::Both);
    let oracle = Oracle::new(&mesh);
    let distance = |near| {
        let rays = EyeRays::new(&square_view(), near);
        oracle.first_hit(&rays, 20.5, 30.5).map(|hit| hit.distance)
    };
    assert_eq!(distance(NearClip::Clamped), Some(0.5));
    assert_eq!(distance(NearClip::Clipped), Some(8.0));
}

#[test]
fn triangles_without_area_are_counted_not_hit() {
    let mut mesh = floor_and_square(Casting::Both);
    triangle(
        &mut mesh,
        [Vec3::ZERO, Vec3::ONE, Vec3::ONE * 2.0],
        Casting::Both,
    );
    triangle(&mut mesh, [Vec3::ZERO, Vec3::ONE, Vec3::NAN], Casting::Both);
    assert_eq!(Oracle::new(&mesh).ignored(), 2);
    assert_eq!(Oracle::new(&Mesh::default()).ignored(), 0);
}
