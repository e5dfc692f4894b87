//! Forward+: a depth pass, the shadow mask of all lights, and one shading pass that reads it.
//!
//! `cargo run --release --example mask_texture [PICTURE.png]`

pub(crate) mod common;

use std::error::Error;
use std::path::Path;

use common::{DEPTH, Gpu, HDR, Pipeline, Triangles, pass};
use umbrage::wgpu::{CompareFunction, DepthStencilState};
use umbrage::{Host, Light, Lights, Mesh, ShadowMask, Shadows, View, World};

/// Draws a hall in the light of 300 lamps; gives the light of each pixel.
pub(crate) fn run(gpu: &Gpu, size: [u32; 2]) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
    let hall = Triangles::hall(10.0, 8);
    let world = World::build(&[Mesh::new(&hall.positions, &hall.indices)])?;
    let mut lights = Lights::default();
    let mut looks: Vec<[f32; 8]> = Vec::new();
    for i in 0..300 {
        let (x, z) = ((i % 20) as f32 - 9.6, (i / 20) as f32 * 1.3 - 9.1);
        // One above them all, and small ones near the floor.
        let (y, range) = match i {
            0 => (5.0, 40.0),
            _ => (0.3 + (i % 7) as f32 * 0.1, 1.4),
        };
        let id = lights.insert(Light::point([x.into(), y.into(), z.into()], range))?;
        looks.resize(lights.slots() as usize, [0.0; 8]);
        let blue = 0.3 + (i % 3) as f32 * 0.6;
        looks[id.slot() as usize] = [x, y, z, range, 1.6, 0.9, blue, 0.0];
    }
    // Light is drawn nowhere else: no colour targets. Depth is 0 near and 1 far.
    let host = Host::new(DEPTH, &[]).with_mask().with_ordinary_depth();
    let mut shadows = Shadows::new(&gpu.device, &world, &host)?;
    let mut eye = shadows.view(&gpu.device)?;
    let mask = shadows.mask(&gpu.device, size, lights.slots())?;

    let [depth, lit] = [DEPTH, HDR].map(|format| gpu.target(size, format));
    let shading = gpu.bind(bytemuck::cast_slice(&looks), &[mask.view()]);
    let wgsl = shadows.wgsl(0) + ShadowMask::WGSL + include_str!("mask_texture.wgsl");
    let depth_pipeline = gpu.pipeline(&Pipeline {
        layouts: &[shadows.world_layout()],
        primitive: shadows.depth_primitive(),
        depth_stencil: shadows.depth_stencil(),
        target: None,
        ..Pipeline::new("shade", &wgsl, HDR)
    });
    let shade_pipeline = gpu.pipeline(&Pipeline {
        layouts: &[shadows.world_layout(), &shading.layout],
        primitive: shadows.depth_primitive(),
        depth_stencil: DepthStencilState {
            depth_write_enabled: Some(false),
            depth_compare: Some(CompareFunction::Equal),
            ..shadows.depth_stencil()
        },
        ..Pipeline::new("shade", &wgsl, HDR)
    });

    let view = View::look_at([-11.0, 8.0, 12.0], [0.0, 0.0, 0.0], 0.9, 0.2, size);
    shadows.prepare(&gpu.device, &gpu.queue, &world, &lights, [(&mut eye, view)])?;
    let mut encoder = gpu.encoder();
    let clear = Some(shadows.depth_clear());
    for (pipeline, target, clear) in [
        (&depth_pipeline, None, clear),
        (&shade_pipeline, Some(&lit), None),
    ] {
        let mut drawing = pass(&mut encoder, target, &depth, clear);
        drawing.set_pipeline(pipeline);
        drawing.set_bind_group(0, eye.world(), &[]);
        drawing.set_bind_group(1, &shading.group, &[]);
        drawing.draw(world.corners(), 0..1);
        drop(drawing);
        if clear.is_some() {
            shadows.find_receivers(&gpu.device, &mut encoder, &mut eye, &depth)?;
            shadows.record_mask(&mut encoder, &eye, &depth, &mask)?;
        }
    }
    Ok(gpu.read_hdr(encoder, &lit))
}

fn main() -> Result<(), Box<dyn Error>> {
    let picture = std::env::args().nth(1);
    let picture = picture.unwrap_or("target/mask_texture.png".into());
    let size = [960, 540];
    let light = run(&Gpu::open(Shadows::features())?, size)?;
    common::write_png(Path::new(&picture), size, &light)?;
    println!("{picture}");
    Ok(())
}
