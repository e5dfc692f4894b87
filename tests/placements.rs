//! Lights and eyes in the places where shadow volumes are known to break: nothing may be wrong in
//! any of them. Eyes exactly on a side of a volume must take the z-fail path; eyes a little off it
//! may take either.

mod common;

use common::{EXACT, Found, Site, assert_exact, by_profile, check, plain, point, room, staged};
use glam::{DVec3, Vec3};
use umbrage_core::frame::{LightPath, ZFailReason};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_core::{Light, LightShape, View};
use umbrage_lab::lab::Method;
use umbrage_lab::stage::Casters;

const SIZE: [u32; 2] = if cfg!(debug_assertions) {
    [96, 72]
} else {
    [160, 120]
};

fn room_site(casters: Casters) -> Site {
    let mut site = Site::new(room::scene(), casters);
    site.lights = room::lights();
    site
}

fn soup_site() -> Site {
    Site::open("gen:soup?triangles=500&lights=6&seed=4", Casters::Material)
}

fn city_site() -> Site {
    Site::open(
        "gen:city?triangles=4000&lights=16&seed=5",
        Casters::Material,
    )
}

/// One light in one view by both methods; gives what the default method found.
fn assert_placed(what: &str, site: &Site, light: Light, view: &View) -> Found {
    let lights = staged([light]);
    let [counter, zfail] = EXACT.map(|method| check(site, &lights, view, method));
    let where_from = format!("{what}: light {light:?}, view {view:?}");
    assert_exact(&format!("counter, {where_from}"), &counter);
    assert_exact(&format!("counter-zfail, {where_from}"), &zfail);
    counter
}

fn is_on_side(found: &Found) -> bool {
    found.plan.lights[0].path == LightPath::ZFail(ZFailReason::EyeOnSide)
}

/// An eye looks along its volume's side and away from it.
fn views_from(site: &Site, eye: Vec3, light: Vec3) -> [View; 2] {
    let away = (eye - light).normalize_or(Vec3::X);
    let across = away.any_orthonormal_vector();
    [
        site.look(eye, eye + away + 0.3 * across, SIZE),
        site.look(eye, eye - away + 0.2 * across, SIZE),
    ]
}

/// Silhouette quads of one light as edges in world space.
fn silhouette(site: &Site, light: &Light) -> Vec<[Vec3; 2]> {
    let mut volumes = Volumes::default();
    VolumeBuilder::default().build(&site.stage.world, &[*light], |_| true, &mut volumes);
    let world = &site.stage.world;
    let ends =
        |q: &umbrage_core::volume::Quad| q.ends(&world.edges).map(|v| world.positions[v as usize]);
    volumes.quads.iter().map(ends).collect()
}

/// Evenly spread picks, so that every run is the same.
fn some<T: Copy>(list: &[T], count: usize) -> Vec<T> {
    let step = (list.len() / count).max(1);
    list.iter().copied().step_by(step).take(count).collect()
}

/// Room coordinates and this light lie on a lattice of 1/16 m, so the eye is in the side's plane
/// to the last bit.
#[test]
fn eye_exactly_on_a_side() {
    let site = room_site(Casters::Material);
    let light = point(Vec3::new(0.5, 4.5, 1.0), 30.0);
    let edges = silhouette(&site, &light);
    assert!(edges.len() > 20);
    for [a, b] in some(&edges, by_profile(10, 5)) {
        let middle = (a + b) * 0.5;
        for k in [0.5, 2.0] {
            let eye = middle + k * (middle - light.position.as_vec3());
            for view in views_from(&site, eye, light.position.as_vec3()) {
                let found = assert_placed("on a side", &site, light, &view);
                assert!(
                    is_on_side(&found),
                    "{eye} is on the side of {a} {b}: {:?}",
                    found.plan
                );
            }
        }
    }
}

/// From one ulp to a thousandth of the distance, to both sides of a side.
#[test]
fn eye_next_to_a_side() {
    for (name, site) in [("room", room_site(Casters::Both)), ("soup", soup_site())] {
        let light = point(site.lights[0].light.position, 30.0);
        let (mut on_side, mut off_side) = (0, 0);
        for [a, b] in some(&silhouette(&site, &light), by_profile(4, 2)) {
            let middle = (a + b) * 0.5;
            let on = middle + 0.75 * (middle - light.position.as_vec3());
            let normal = (b - a)
                .cross(middle - light.position.as_vec3())
                .normalize_or_zero();
            for share in [0.0, 1e-6, 1e-4, 1e-3] {
                for sign in [-1.0, 1.0] {
                    let mut eye = on + sign * share * on.distance(middle) * normal;
                    if share == 0.0 {
                        eye = on.map(|x| {
                            if sign > 0.0 {
                                x.next_up()
                            } else {
                                x.next_down()
                            }
                        });
                    }
                    let [view, _] = views_from(&site, eye, light.position.as_vec3());
                    let found = assert_placed(&format!("{name}, {share} off"), &site, light, &view);
                    if share < 1e-5 {
                        assert!(is_on_side(&found), "{name}: {eye} is {share} off a side");
                        on_side += 1;
                    } else {
                        off_side += usize::from(!is_on_side(&found));
                    }
                }
            }
        }
        assert!(
            on_side > 0 && off_side > 0,
            "{name}: {on_side} on, {off_side} off"
        );
    }
}

/// Behind closed boxes, behind the sail, inside a box, behind the outer walls, under the ground.
#[test]
fn eye_deep_in_shadow() {
    let site = room_site(Casters::Material);
    let light = point(Vec3::new(0.5, 4.5, 1.0), 30.0);
    let box_middle = (room::BOX[0] + room::BOX[1]) * 0.5;
    let eyes = [
        Vec3::new(-4.5, 0.25, -2.25),
        box_middle,
        (room::SAIL[0] + room::SAIL[1] + room::SAIL[2]) / 3.0 + Vec3::new(0.3, -0.8, 0.2),
        Vec3::new(0.0, -2.0, 0.0),
        Vec3::new(20.0, 9.0, -3.0),
    ];
    let mut in_shadow = 0;
    for eye in eyes {
        for view in views_from(&site, eye, light.position.as_vec3()) {
            let found = assert_placed("deep in shadow", &site, light, &view);
            let count = found.plan.lights[0].path;
            in_shadow += usize::from(matches!(count, LightPath::ZPass { eye_count: 1.. }));
        }
    }
    assert!(in_shadow >= 4, "{in_shadow} eyes stood in shadow");
    for (name, site) in [("soup", soup_site()), ("city", city_site())] {
        for seed in 100..by_profile(112, 104) {
            let view = site.seeded_view(seed, SIZE);
            for method in EXACT {
                let found = check(&site, &site.lights, &view, method);
                assert_exact(&format!("{name}, seed {seed}, {}", method.name()), &found);
            }
        }
    }
}

/// In a caster's plane beside it, on its face, on its edge, on its corner.
#[test]
fn eye_on_a_caster() {
    let site = room_site(Casters::Both);
    let light = point(Vec3::new(0.5, 4.5, 1.0), 30.0);
    let [a, b, c] = room::SAIL;
    let floor = Vec3::new(2.0, 0.0, 0.5);
    for eye in [
        a + 2.0 * (b - a) - (c - a),
        (a + b) * 0.5,
        a,
        (a + b + c) / 3.0,
        floor,
    ] {
        for view in views_from(&site, eye, light.position.as_vec3()) {
            assert_placed("on a caster", &site, light, &view);
        }
    }
    // On a lattice point of the floor the eye is on a caster for certain.
    let found = assert_placed(
        "on the floor",
        &site,
        light,
        &views_from(&site, floor, a)[0],
    );
    assert!(
        is_on_side(&found),
        "an eye on a caster is ambiguous: {:?}",
        found.plan
    );
}

/// At the light itself nothing shadowed is seen. (Between that and some hundredths of a pixel of
/// parallax, sides are narrower than the rasteriser's grid, and their depth is rounding alone.)
#[test]
fn eye_at_the_light() {
    for (name, site) in [("room", room_site(Casters::Both)), ("soup", soup_site())] {
        let at = site.lights[0].light.position;
        let light = point(at, 30.0);
        for offset in [0.0, 1e-2, 0.25] {
            let eye = at + DVec3::new(offset, -offset, 0.5 * offset);
            for target in [Vec3::X, Vec3::new(-0.4, -0.7, 0.3)] {
                let view = site.look(eye, eye + target.as_dvec3(), SIZE);
                assert_placed(
                    &format!("{name}, eye {offset} from the light"),
                    &site,
                    light,
                    &view,
                );
            }
        }
    }
}

/// Inside closed meshes; exactly on corners, edges and faces; one ulp off faces and corners.
///
/// What f32 clip positions cannot show is not here. A light off an edge, but nearer to it than some
/// ten-thousandths of its length, sees the edge's ends in opposite directions, and rounding turns
/// the side about the edge. A light as near above a face covers half of all directions with the
/// face's dark cap, and rounding bends its rim: the z-fail path is asked from a thousandth on.
#[test]
fn lights_in_geometry() {
    let [a, b, c] = room::SAIL;
    let [low, high] = room::BOX;
    let (leaf, top) = ((a + b + 2.0 * c) * 0.25, low.midpoint(high).with_y(high.y));
    let normal = (b - a).cross(c - a).normalize();
    let corners = [a, low, high, room::LOW];
    let elsewhere = [
        low.midpoint(high),
        (a + b) * 0.5,
        top.with_x(high.x),
        3.0 * b - a - c,
        Vec3::new(2.0, 0.0, 0.5),
    ];
    let near = [
        leaf + 1e-3 * normal,
        leaf - 1e-3 * normal,
        top + 1e-3 * Vec3::Y,
    ];
    let exact = [leaf, top]
        .into_iter()
        .chain(corners)
        .chain(elsewhere)
        .chain(near);
    let beside = [leaf, top].into_iter().chain(corners);
    let ulps_off = beside.flat_map(|p| [p.map(f32::next_up), p.map(f32::next_down)]);
    for casters in [Casters::Material, Casters::Both] {
        let site = room_site(casters);
        let view = site.look(Vec3::new(5.5, 3.5, 5.0), Vec3::new(-1.0, 1.0, 0.0), SIZE);
        for position in exact.clone() {
            assert_placed(&format!("{casters:?}"), &site, point(position, 12.0), &view);
        }
        for position in ulps_off.clone() {
            let lights = staged([point(position, 12.0)]);
            let found = check(&site, &lights, &view, Method::Counter);
            assert_exact(&format!("{casters:?}, light at {position}"), &found);
        }
    }
    let site = soup_site();
    let view = site.first_camera(SIZE);
    for t in 0..by_profile(16, 6) {
        let [a, b, c] = site.stage.mesh.corners(t * 29).map(DVec3::as_vec3);
        assert_placed(&format!("on corner of {t}"), &site, point(a, 9.0), &view);
        // As near to the plane as rounding allows: on either side of it, or in it.
        for position in [(a + b + c) / 3.0, a + 2.5 * (b - a) + (c - a)] {
            let lights = staged([point(position, 9.0)]);
            let found = check(&site, &lights, &view, Method::Counter);
            assert_exact(&format!("on plane of {t}, light at {position}"), &found);
        }
    }
}

/// At a hundredth and a thousandth of a metre from edges of metres, on all sides of them.
#[test]
fn lights_next_to_edges() {
    let site = room_site(Casters::Both);
    let [a, b, _] = room::SAIL;
    let [low, high] = room::BOX;
    let mut random = common::Random(7);
    for on in [
        (a + b) * 0.5,
        low.midpoint(high).with_y(high.y).with_x(low.x),
    ] {
        for distance in [1e-2, 1e-3] {
            for _ in 0..by_profile(8, 4) {
                let off = random.point(Vec3::NEG_ONE, Vec3::ONE).normalize() * distance;
                for eye in [Vec3::new(5.5, 3.5, 5.0), Vec3::new(-6.0, 3.0, 4.0)] {
                    let view = site.look(eye, Vec3::new(0.0, 1.0, 0.0), SIZE);
                    let what = format!("{distance} from an edge");
                    assert_placed(&what, &site, point(on + off, 12.0), &view);
                }
            }
        }
    }
}

/// Sides and casters between eye and near plane. Surfaces there are seen all the same, clamped to
/// one depth: among those the judge is not asked.
#[test]
fn near_plane_through_volumes() {
    for (name, site) in [
        ("room", room_site(Casters::Material)),
        ("soup", soup_site()),
        ("city", city_site()),
    ] {
        let lights = &site.lights;
        for seed in 0..by_profile(8, 4) {
            for near in [0.5, 2.0, 5.0] {
                let view = View {
                    near,
                    ..site.seeded_view(seed, SIZE)
                };
                for method in EXACT {
                    let found = check(&site, lights, &view, method);
                    let near_clip = common::lab().near_clip();
                    let truth = site.oracle.shadow_mask(&view, &plain(lights), near_clip);
                    let mut beyond = found.mask.clone();
                    beyond.trust_before_near(&site.oracle, &view, near_clip, &truth);
                    let judgement = common::judged(&site, lights, &view, &beyond, &found.skipped);
                    let what = format!("{name}, seed {seed}, near {near}, {}", method.name());
                    assert_exact(&what, &Found { judgement, ..found });
                }
            }
        }
    }
}

#[test]
fn vertical_views() {
    for (name, site) in [
        ("room", room_site(Casters::Material)),
        ("city", city_site()),
    ] {
        let middle = site.lights[1].light.position;
        for (rise, ahead) in [(2.0, Vec3::NEG_Y), (-1.0, Vec3::Y)] {
            let eye = middle.as_vec3() + Vec3::new(0.75, rise, 0.5);
            for ahead in [
                ahead,
                ahead + Vec3::new(1e-3, 0.0, 0.0),
                ahead + Vec3::new(0.0, 0.0, 0.1),
            ] {
                let view = site.look(eye, eye + ahead, SIZE);
                for method in EXACT {
                    let found = check(&site, &site.lights, &view, method);
                    assert_exact(&format!("{name}, {ahead}, {}", method.name()), &found);
                }
            }
        }
    }
}

/// Cones from a needle to more than a half space; suns along axes, in planes and askew.
#[test]
fn spots_and_suns() {
    let site = room_site(Casters::Both);
    let eye = Vec3::new(5.5, 3.5, 5.0);
    let view = site.look(eye, Vec3::new(-1.0, 1.0, 0.0), SIZE);
    let position = Vec3::new(1.0, 4.5, 3.0);
    for cos_outer in [0.999, 0.7, 0.0, -0.7] {
        for direction in [Vec3::NEG_Y, Vec3::new(-0.6, -0.64, -0.48)] {
            let shape = LightShape::Spot {
                direction,
                cos_outer,
            };
            assert_placed(
                "spot",
                &site,
                Light {
                    position: position.into(),
                    range: 15.0,
                    shape,
                },
                &view,
            );
        }
    }
    let soup = soup_site();
    let soup_view = soup.first_camera(SIZE);
    let directions = [
        Vec3::NEG_Y,
        Vec3::X,
        Vec3::new(0.0, -0.6, 0.8),
        Vec3::new(0.48, -0.8, 0.36),
    ];
    for direction in directions {
        let shape = LightShape::Directional { direction };
        let light = Light {
            position: DVec3::ZERO,
            range: f32::INFINITY,
            shape,
        };
        assert_placed("sun", &soup, light, &soup_view);
        // A roof lets no sun in: with front faces casting the room's walls do not.
        let front = room_site(Casters::Front);
        assert_placed("sun in the room", &front, light, &view);
        // An eye on a side of the sail's shadow.
        let on = (room::SAIL[0] + room::SAIL[1]) * 0.5 + 2.0 * direction;
        assert_placed(
            "eye on a sun's side",
            &front,
            light,
            &front.look(on, eye, SIZE),
        );
    }
}

/// Ranges that touch a few triangles or none; eyes far outside.
#[test]
fn small_ranges_and_far_eyes() {
    for (name, site) in [
        ("room", room_site(Casters::Material)),
        ("soup", soup_site()),
    ] {
        let middle = room::SAIL[2];
        for range in [1e-3, 0.1, 0.5, 1.5] {
            let light = point(middle + Vec3::new(0.0, 0.05, 0.0), range);
            for distance in [1.0, 40.0, 4000.0] {
                let eye = middle + distance * Vec3::new(0.5, 0.6, 0.62);
                let view = View::look_at(eye, middle, 2.0 * range / distance, site.near(), SIZE);
                assert_placed(&format!("{name}, {distance} away"), &site, light, &view);
            }
        }
        let everything = point(middle, f32::INFINITY);
        let eye = middle + Vec3::new(300.0, 250.0, -200.0);
        let view = View::look_at(eye, middle, 0.05, site.near(), SIZE);
        assert_placed(&format!("{name}, no range"), &site, everything, &view);
    }
}

/// A light whose range nothing touches, or that the view does not meet, is skipped for that reason.
#[test]
fn lights_without_effect_are_skipped() {
    use umbrage_core::frame::SkipReason;
    let site = room_site(Casters::Material);
    let view = site.look(Vec3::new(5.5, 3.5, 5.0), Vec3::ZERO, SIZE);
    let lights = staged([
        point(Vec3::new(0.0, 3.5, 0.0), 0.25),
        point(Vec3::new(7.5, 4.5, 5.75), 0.5),
        point(Vec3::new(0.0, 3.5, 0.0), 4.0),
    ]);
    let found = check(&site, &lights, &view, Method::Counter);
    assert_exact("skipped", &found);
    let paths: Vec<LightPath> = found.plan.lights.iter().map(|l| l.path).collect();
    assert_eq!(paths[0], LightPath::Skipped(SkipReason::NothingInRange));
    assert_eq!(paths[1], LightPath::Skipped(SkipReason::OutsideView));
    assert!(matches!(paths[2], LightPath::ZPass { .. }), "{paths:?}");
}
