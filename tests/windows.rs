//! Worlds, quads and caps that one binding cannot hold are split, and the masks are those of a
//! device that holds them whole, to the last bit; what cannot be split says which limit is in the
//! way.

mod common;

use common::room::crate_of;
use common::{EXACT, Site, lab};
use glam::{DVec3, Vec3};
use umbrage_core::world::Pose;
use umbrage_lab::gpu::{AdapterChoice, Gpu, GpuError};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::Casters;
use umbrage_lab::{Cull, Culls, RenderError, WorldWindows};

const SIZE: [u32; 2] = [200, 120];
const CITY: &str = "gen:city?triangles=6000&lights=40&seed=4&moon=1";

/// A device that binds so many bytes at once.
fn small(binding: u64) -> Lab {
    let gpu = Gpu::open_limited(&AdapterChoice::Auto, |limits| {
        limits.max_storage_buffer_binding_size = binding;
    });
    Lab::new(gpu.expect("limits can be lower than those of the adapter"))
}

fn mask(lab: &mut Lab, site: &Site, method: Method) -> Vec<u32> {
    let view = site.first_camera(SIZE);
    lab.prepare(&site.stage, &site.lights, &view, method);
    let mask = lab.mask(&site.stage, &site.lights, &view);
    mask.expect("the mask can be drawn and read").words
}

#[test]
fn a_split_world_casts_the_same_shadows() {
    let site = Site::open(CITY, Casters::Material);
    let mut small = small(16 << 10);
    let windows = WorldWindows::of(&small.gpu().device, &site.stage.world);
    let windows = windows.expect("few enough windows");
    assert!(windows.storage_buffers() > 10, "{windows:?}");
    let others = [
        Method::Extrude(umbrage_lab::method::Normals::Neighbours),
        Method::ShadowMap { texels: 256 },
        "half".parse().expect("a method"),
        "mask-alpha".parse().expect("a method"),
    ];
    for method in EXACT.into_iter().chain(others) {
        for culls in [Culls::EVERY, Culls::NONE, Culls::NONE.with(Cull::Quads)] {
            small.culls = culls;
            let split = mask(&mut small, &site, method);
            let drawn: Vec<u32> = (0..site.lights.len())
                .map(|i| small.quads_drawn(i))
                .collect();
            let mut whole = lab();
            whole.culls = culls;
            assert_eq!(split, mask(&mut whole, &site, method), "{}", method.name());
            let counted = (0..site.lights.len()).map(|i| whole.quads_drawn(i));
            assert_eq!(drawn, counted.collect::<Vec<u32>>(), "{}", method.name());
            whole.culls = Culls::EVERY;
        }
    }
}

/// One light's quads and caps lie in several windows, and are drawn in as many draws.
#[test]
fn a_light_is_drawn_from_several_windows() {
    let mut site = Site::open("gen:soup?triangles=2500&lights=8", Casters::Both);
    for light in &mut site.lights {
        light.light.range = 1e4;
    }
    let mut small = small(12 << 10);
    for method in EXACT {
        let split = mask(&mut small, &site, method);
        let [quads, caps] = [small.volumes.quads.len(), small.plan.caps.len()];
        assert!(quads > 2048, "{quads} quads in windows of 2048");
        let spans = |r: &std::ops::Range<u32>| r.start / 2048 < r.end.saturating_sub(1) / 2048;
        assert!(small.plan.lights.iter().any(|light| spans(&light.quads)));
        assert!(caps > 2048 || method == Method::Counter, "{caps} caps");
        assert_eq!(split, mask(&mut lab(), &site, method), "{}", method.name());
    }
}

/// What moves is uploaded to the windows it is in, and a world that outgrows its windows gets more.
#[test]
fn objects_come_and_move_across_windows() {
    let mut site = Site::open(CITY, Casters::Material);
    let view = site.first_camera(SIZE);
    let mut small = small(16 << 10);
    small.prepare(&site.stage, &site.lights, &view, Method::Counter);
    let mut kept = small.masking(&site.stage, &view).expect("a renderer");
    let before = WorldWindows::of(&small.gpu().device, &site.stage.world);
    let ahead = view.eye + 6.0 * view.forward.as_dvec3();
    let mut boxes = Vec::new();
    for step in 0..6 {
        let aside = view.right.as_dvec3() * f64::from(step);
        let world = &mut site.stage.world;
        for row in 0..20 {
            let at = Pose::at(ahead + aside + DVec3::new(0.0, f64::from(row) * 0.4, 0.0));
            boxes.push(
                world
                    .insert(&crate_of(Vec3::splat(0.15)), &at)
                    .expect("a box"),
            );
        }
        for (number, id) in (0..).zip(&boxes) {
            let at = ahead + aside * 0.5 - view.right.as_dvec3() * (0.1 * f64::from(number));
            world.pose(*id, &Pose::at(at)).expect("it is there");
        }
        small.prepare(&site.stage, &site.lights, &view, Method::Counter);
        let ours = small.mask_in(&mut kept, &site.stage, &site.lights, &view);
        let ours = ours.expect("the mask can be drawn and read").words;
        let mut whole = lab();
        assert_eq!(
            ours,
            mask(&mut whole, &site, Method::Counter),
            "step {step}"
        );
    }
    let after = WorldWindows::of(&small.gpu().device, &site.stage.world);
    assert_ne!(before, after, "the boxes fit the windows that there were");
}

#[test]
fn what_cannot_be_split_names_the_limit() {
    let site = Site::open(CITY, Casters::Material);
    let mut small = small(4 << 10);
    let view = site.first_camera(SIZE);
    small.prepare(&site.stage, &site.lights, &view, Method::Counter);
    let error = small.mask(&site.stage, &site.lights, &view).unwrap_err();
    assert!(
        matches!(
            error,
            GpuError::Render(RenderError::TooManyWindows { needed, limit, .. }) if needed > limit
        ),
        "{error}"
    );
    let words = error.to_string();
    assert!(
        words.contains("max_storage_buffers_per_shader_stage"),
        "{words}"
    );
}
