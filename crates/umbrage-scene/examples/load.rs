//! Loads each scene named on the command line and prints what is in it, or why there is nothing.
//!
//! `cargo run -p umbrage-scene --example load -- town.glb gen:field?n=64`

use std::time::Instant;

fn main() {
    for spec in std::env::args().skip(1) {
        let start = Instant::now();
        let scene = umbrage_scene::open(&spec, &());
        let soup = scene.and_then(|scene| Ok((scene.soup()?, scene)));
        let ms = start.elapsed().as_secs_f64() * 1e3;
        match soup {
            Ok((soup, scene)) => println!(
                "ok\t{spec}\t{} triangles\t{} instances\t{} lights\t{} cameras\t{ms:.0} ms\t{:?}",
                soup.triangles.len(),
                scene.instances.len(),
                scene.lights.len(),
                scene.cameras.len(),
                scene.report.oddities(),
            ),
            Err(error) => println!("err\t{spec}\t{error}"),
        }
    }
}
