//! A small deferred renderer of one's own, with shadows: all of the embedding is in `run`.
//!
//! `cargo run --release --example host_depth [PICTURE.png]`

pub(crate) mod common;

use std::error::Error;
use std::path::Path;

use common::{DEPTH, Gpu, HDR, Pipeline, Triangles, pass};
use umbrage::wgpu::{TextureFormat, TextureViewDescriptor};
use umbrage::{Host, Light, Lights, Mesh, Shadows, View, World};

/// Normal, and distance ahead of the eye.
const SURFACE: TextureFormat = TextureFormat::Rgba32Float;

/// Draws a hall of pillars in the light of lamps; gives the light of each pixel.
pub(crate) fn run(gpu: &Gpu, size: [u32; 2]) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
    // Once: triangles, lights and what they look like, the renderer for your formats.
    let hall = Triangles::hall(10.0, 8);
    let world = World::build(&[Mesh::new(&hall.positions, &hall.indices)])?;
    let mut lights = Lights::default();
    let mut looks: Vec<[f32; 8]> = Vec::new();
    for i in 0..12 {
        let (x, z) = ((i % 4) as f32 * 5.0 - 7.5, (i / 4) as f32 * 5.0 - 5.0);
        let id = lights.insert(Light::point([x.into(), 1.3, z.into()], 6.0))?;
        looks.resize(lights.slots() as usize, [0.0; 8]);
        let blue = (i % 3) as f32;
        looks[id.slot() as usize] = [x, 1.3, z, 6.0, 2.0 - 0.6 * blue, 1.2, 0.6 + 0.6 * blue, 0.0];
    }
    let host = Host::new(DEPTH, &[Some(HDR)]);
    let mut shadows = Shadows::new(&gpu.device, &world, &host)?;
    let mut eye = shadows.view(&gpu.device)?;

    // Your targets and pipelines. Clip positions and stencil states are the library's.
    let [depth, surface, lit] = [DEPTH, SURFACE, HDR].map(|format| gpu.target(size, format));
    let surface_view = surface.create_view(&TextureViewDescriptor::default());
    let shading = gpu.bind(bytemuck::cast_slice(&looks), &[&surface_view]);
    let wgsl = shadows.wgsl(0) + include_str!("host_depth.wgsl");
    let surface_pipeline = gpu.pipeline(&Pipeline {
        layouts: &[shadows.world_layout()],
        primitive: shadows.depth_primitive(),
        depth_stencil: shadows.depth_stencil(),
        ..Pipeline::new("surface", &wgsl, SURFACE)
    });
    let light_pipeline = gpu.pipeline(&Pipeline {
        layouts: &[shadows.light_layout(), &shading.layout],
        depth_stencil: shadows.light_stencil(),
        add: true,
        ..Pipeline::new("light", &wgsl, HDR)
    });

    // Each frame: what changed, your surface, what of it lights reach, and light after light.
    let view = View::look_at([-11.0, 8.0, 12.0], [0.0, 0.0, 0.0], 0.9, 0.05, size);
    shadows.prepare(&gpu.device, &gpu.queue, &world, &lights, [(&mut eye, view)])?;
    let mut encoder = gpu.encoder();
    let mut drawing = pass(
        &mut encoder,
        Some(&surface),
        &depth,
        Some(shadows.depth_clear()),
    );
    drawing.set_pipeline(&surface_pipeline);
    drawing.set_bind_group(0, eye.world(), &[]);
    drawing.draw(world.corners(), 0..1);
    drop(drawing);
    shadows.find_receivers(&gpu.device, &mut encoder, &mut eye, &depth)?;
    let mut drawing = pass(&mut encoder, Some(&lit), &depth, None);
    shadows.record(&mut drawing, &eye, |pass, light| {
        pass.set_pipeline(&light_pipeline);
        pass.set_bind_group(0, eye.lights(), &[]);
        pass.set_bind_group(1, &shading.group, &[]);
        eye.draw_light(pass, light);
    })?;
    drop(drawing);
    Ok(gpu.read_hdr(encoder, &lit))
}

fn main() -> Result<(), Box<dyn Error>> {
    let picture = std::env::args().nth(1);
    let picture = picture.unwrap_or("target/host_depth.png".into());
    let size = [960, 540];
    let light = run(&Gpu::open(Shadows::features())?, size)?;
    common::write_png(Path::new(&picture), size, &light)?;
    println!("{picture}");
    Ok(())
}
