use egui::{Event, Key, Modifiers, RawInput};
use umbrage_lab::gbuffer::{texture, whole};
use umbrage_lab::gpu::AdapterChoice;
use umbrage_lab::readback::read_texture;
use umbrage_lab::stage::Casters;

use super::*;

const SIZE: [u32; 2] = [320, 200];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A viewer of a small city, and where it draws.
fn viewer() -> (Viewer, wgpu::Texture) {
    let scene = umbrage_scene::open("gen:city?triangles=1500&lights=6&seed=2", &()).unwrap();
    of(scene)
}

fn of(scene: umbrage_scene::Scene) -> (Viewer, wgpu::Texture) {
    let stage = Stage::new(scene, Casters::Material, None).unwrap();
    let camera = stage.scene.cameras[0].clone();
    let [eye, ahead] = [camera.position, camera.position + camera.forward].map(|p| stage.local(p));
    let subject = Subject {
        lights: stage.lights(None),
        view: View::look_at(eye, ahead, camera.fovy_rad as f32, 0.05, SIZE),
        stage,
    };
    let gpu = match Gpu::open(&AdapterChoice::Auto) {
        Ok(gpu) => gpu,
        Err(error) => panic!("these tests need an adapter: {error}"),
    };
    let target = texture(&gpu, "target", SIZE, FORMAT, wgpu::TextureUsages::COPY_SRC);
    let mut viewer = Viewer::new(gpu, subject, &Options::default(), FORMAT).unwrap();
    viewer.show_list = false;
    (viewer, target)
}

/// Draws a frame while keys are down; gives its pixels.
fn frame(viewer: &mut Viewer, target: &wgpu::Texture, keys: &[Key]) -> Vec<[u8; 3]> {
    let screen = egui::vec2(SIZE[0] as f32, SIZE[1] as f32);
    let press = |pressed| {
        move |&key| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    };
    let input = |events| RawInput {
        screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, screen)),
        events,
        focused: true,
        ..RawInput::default()
    };
    let down = input(keys.iter().map(press(true)).collect());
    viewer.frame(down, &whole(target)).unwrap();
    if !keys.is_empty() {
        let up = input(keys.iter().map(press(false)).collect());
        viewer.frame(up, &whole(target)).unwrap();
    }
    let pixels = read_texture(viewer.gpu(), target).unwrap();
    pixels.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect()
}

/// The picture that `umbrage render` would write of what the viewer sees.
fn rendered(viewer: &Viewer) -> Vec<[u8; 3]> {
    let mut lab = Lab::new(viewer.gpu().clone());
    lab.muted = viewer.mix.silent();
    let (stage, lights, view) = (&viewer.stage, &viewer.lights, &viewer.camera.view);
    let lit = lab.render(stage, lights, view, viewer.method, 1).unwrap();
    assert_eq!(Some(lit.exposure()), viewer.exposure);
    lit.to_rgb8()
        .chunks_exact(3)
        .map(|p| [p[0], p[1], p[2]])
        .collect()
}

/// Pixels that differ by more than a step of any channel.
fn differing(a: &[[u8; 3]], b: &[[u8; 3]]) -> usize {
    assert_eq!(a.len(), b.len());
    let far = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    a.iter().zip(b).filter(|pair| far(*pair)).count()
}

#[test]
fn the_screen_shows_what_render_writes() {
    let (mut viewer, target) = viewer();
    let shown = frame(&mut viewer, &target, &[]);
    assert_eq!(differing(&shown, &rendered(&viewer)), 0);
    // The control: half a stop more light.
    viewer.stops = 0.5;
    let brighter = frame(&mut viewer, &target, &[]);
    let differing = differing(&brighter, &shown);
    assert!(differing > 300, "{differing} pixels");
}

#[test]
fn solo_and_mute_change_the_picture_and_rebuild_no_volume() {
    let (mut viewer, target) = viewer();
    let all = frame(&mut viewer, &target, &[]);
    let stamps = |viewer: &Viewer| -> Vec<u64> {
        viewer
            .lab
            .volumes
            .lights
            .iter()
            .map(|light| light.stamp)
            .collect()
    };
    let built = stamps(&viewer);
    let bright =
        |pixels: &[[u8; 3]]| -> u64 { pixels.as_flattened().iter().map(|&c| u64::from(c)).sum() };
    // Down chooses the first of the list, the costliest; Space plays it alone.
    frame(&mut viewer, &target, &[Key::ArrowDown]);
    let chosen = viewer.mix.chosen.expect("a light is chosen");
    let alone = frame(&mut viewer, &target, &[Key::Space]);
    let [_, _, skipped] = viewer.lab.lights_by_path();
    assert_eq!(skipped, viewer.lights.len() - 1);
    let without = frame(&mut viewer, &target, &[Key::Space, Key::M]);
    assert!(viewer.mix.is_muted(chosen));
    assert!(bright(&alone) < bright(&all) && bright(&without) < bright(&all));
    let again = frame(&mut viewer, &target, &[Key::C]);
    assert_eq!(differing(&again, &all), 0);
    assert_eq!(stamps(&viewer), built);
}

#[test]
fn keys_choose_views_and_fly() {
    let (mut viewer, target) = viewer();
    let lit = frame(&mut viewer, &target, &[]);
    let volumes = frame(&mut viewer, &target, &[Key::Num2]);
    assert_eq!(viewer.shown, DebugView::Volumes);
    assert!(differing(&volumes, &lit) > 100);
    let before = viewer.camera.view;
    frame(&mut viewer, &target, &[Key::W, Key::Num1]);
    let step = (viewer.camera.view.eye - before.eye).as_vec3();
    assert!(step.dot(before.forward) > 0.0 && viewer.shown == DebugView::Lit);
}

#[test]
fn counts_come_once_the_camera_rests_and_go_as_it_moves() {
    let (mut viewer, target) = viewer();
    frame(&mut viewer, &target, &[Key::Num4]);
    frame(&mut viewer, &target, &[]);
    let note = &viewer.overlay.as_ref().expect("layers were counted").note;
    assert!(note.starts_with("layers a pixel: mean"), "{note}");
    viewer.camera.turn(100.0, 0.0);
    frame(&mut viewer, &target, &[]);
    assert!(viewer.overlay.is_none() && viewer.is_unfinished());
    while viewer.is_unfinished() {
        frame(&mut viewer, &target, &[]);
    }
    assert!(viewer.overlay.is_some());
    let costs = (0..viewer.lights.len()).filter_map(|light| viewer.costs.us(light));
    assert_eq!(costs.count() > 0, viewer.gpu().timestamp_ns.is_some());
}

#[test]
fn a_check_finds_nothing_wrong_with_the_counter_and_much_without_shadows() {
    for method in [Method::Counter, Method::None] {
        let (mut viewer, target) = viewer();
        viewer.method = method;
        frame(&mut viewer, &target, &[]);
        // Of silent lights the oracle is not asked.
        viewer.mix.toggle_mute(0);
        frame(&mut viewer, &target, &[Key::O]);
        while viewer.check.progress().is_some() {
            frame(&mut viewer, &target, &[]);
        }
        let found = viewer.check.found(&viewer.of().moment);
        let found = found.expect("it was judged");
        assert!(found.samples > 1000);
        assert_eq!(
            found.wrong == 0,
            method == Method::Counter,
            "{}",
            found.wrong
        );
    }
}

/// A man who walks before a wall, a lamp in his hand, and a lamp that hangs.
fn walker() -> umbrage_scene::Scene {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/actors/cesium_man.glb"
    );
    let mut scene = umbrage_scene::open(file, &()).unwrap();
    let rig = scene.rig.as_ref().expect("he has bones");
    let hand = rig.moving().iter().rposition(|&moves| moves).unwrap();
    let lamp = umbrage_scene::Light {
        name: "carried".into(),
        intensity: 30.0,
        range: Some(20.0),
        node: Some(hand as u32),
        ..umbrage_scene::Light::default()
    };
    scene.lights.push(umbrage_scene::Light {
        name: "hangs".into(),
        position: glam::DVec3::new(1.0, 2.5, 2.0),
        node: None,
        ..lamp.clone()
    });
    scene.lights.push(lamp);
    let eye = glam::DVec3::new(2.0, 1.5, 3.0);
    let camera = umbrage_scene::Camera::look_at("door", eye, glam::DVec3::Y * 0.8, 1.0);
    scene.cameras = vec![camera];
    scene
}

#[test]
fn time_goes_on_and_lights_that_are_carried_with_it() {
    let (mut viewer, target) = of(walker());
    let first = frame(&mut viewer, &target, &[]);
    let before = viewer.lights.clone();
    frame(&mut viewer, &target, &[Key::T]);
    assert!(viewer.plays && viewer.stage.time_s > 0.0);
    viewer.set_time(0.4);
    frame(&mut viewer, &target, &[Key::T]);
    assert!(!viewer.plays);
    viewer.expose();
    let later = frame(&mut viewer, &target, &[]);
    assert!(differing(&later, &first) > 100);
    assert_eq!(differing(&later, &rendered(&viewer)), 0);
    let moved = |i: usize| viewer.lights[i].light.position != before[i].light.position;
    assert_eq!([moved(0), moved(1)], [false, true]);
    // The oracle sees him where he is, at two times one after the other.
    for time_s in [0.4, 0.9] {
        viewer.set_time(time_s);
        frame(&mut viewer, &target, &[Key::O]);
        while viewer.check.progress().is_some() {
            frame(&mut viewer, &target, &[]);
        }
        let found = viewer
            .check
            .found(&viewer.of().moment)
            .expect("it was judged");
        assert!(found.samples > 1000, "{}", found.samples);
        assert_eq!(found.wrong, 0, "at {time_s} s");
    }
    viewer.set_time(0.5);
    assert!(viewer.check.found(&viewer.of().moment).is_none());
}
