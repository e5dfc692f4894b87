//! A window on a scene: fly with W A S D, choose a light in the list, press H for all keys.
//!
//! `cargo run --release --example viewer [SCENE] [SCREENSHOT.png]`

use std::error::Error;

use umbrage_core::View;
use umbrage_lab::stage::{Casters, Stage};
use umbrage_view::{Options, Screenshot, Subject, open};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let scene = args
        .next()
        .unwrap_or("gen:city?triangles=20000&lights=128".into());
    let stage = Stage::new(umbrage_scene::open(&scene, &())?, Casters::Material, None)?;
    let cameras = &stage.scene.cameras;
    let camera = cameras.first().ok_or("the scene has no camera")?;
    let (eye, ahead) = (camera.position, camera.position + camera.forward);
    let fovy = camera.fovy_rad as f32;
    let (eye, ahead) = (stage.local(eye), stage.local(ahead));
    let subject = Subject {
        lights: stage.lights(None),
        view: View::look_at(eye, ahead, fovy, 0.05, [1280, 720]),
        stage,
    };
    let mut options = Options::default();
    options.screenshot = args.next().map(|file| Screenshot {
        file: file.into(),
        frames: 3,
    });
    let seen = open(subject, options)?;
    println!("{} frames on {}", seen.frames, seen.adapter);
    Ok(())
}
