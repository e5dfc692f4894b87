//! A picture without a window: a generated street at night, its lamps, their shadows.
//!
//! `cargo run --release --example headless [SCENE] [PICTURE.png]`

use std::error::Error;
use std::path::Path;

use umbrage_core::View;
use umbrage_lab::gpu::{AdapterChoice, Gpu};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::picture::write_png;
use umbrage_lab::stage::{Casters, Stage};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let scene = args.next();
    let scene = scene.unwrap_or("gen:city?triangles=20000&lights=128".into());
    let picture = args.next().unwrap_or("target/headless.png".into());
    run(&scene, Path::new(&picture))
}

/// Draws a scene file or a generated scene, and writes the picture.
pub(crate) fn run(scene: &str, picture: &Path) -> Result<(), Box<dyn Error>> {
    // File or generator -> triangles -> welded world in BVH order.
    let stage = Stage::new(umbrage_scene::open(scene, &())?, Casters::Material, None)?;
    let lights = stage.lights(None);
    let cameras = &stage.scene.cameras;
    let camera = cameras.first().ok_or("the scene has no camera")?;
    let (eye, ahead) = (camera.position, camera.position + camera.forward);
    let size = [960, 540];
    let fovy = camera.fovy_rad as f32;
    let view = View::look_at(stage.local(eye), stage.local(ahead), fovy, 0.05, size);

    // Volumes, plan, draws; the picture comes back to the CPU.
    let mut lab = Lab::new(Gpu::open(&AdapterChoice::Auto)?);
    let lit = lab.render(&stage, &lights, &view, Method::Counter, 1)?;
    write_png(picture, size, &lit.to_rgb8())?;
    let [zpass, zfail, skipped] = lab.lights_by_path();
    println!(
        "{}: {} lights, {zpass} z-pass, {zfail} z-fail, {skipped} skipped",
        picture.display(),
        lights.len()
    );
    Ok(())
}
