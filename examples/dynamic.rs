//! Moving objects and lights, some of which come and go; each frame is checked against the oracle, an
//! exact ray cast that shares no code with the library. Exits with an error if a pixel is wrong.
//!
//! `cargo run --release --example dynamic [FRAMES]`

pub(crate) mod common;

use std::error::Error;

use glam::DVec3;

use common::{DEPTH, Gpu, HDR, Pipeline, Triangles, pass};
use umbrage::wgpu::Features;
use umbrage::{FrameStats, Host, Light, Lights, Mesh, Pose, Shadows, View, World};
use umbrage_core::LightShape;
use umbrage_truth::{JudgeOptions, Judgement, Mask, NearClip, Oracle, judge};

/// What was found in one frame.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) stats: FrameStats,
    /// Pixels and lights that were looked at, and of these the wrong ones.
    pub(crate) samples: u64,
    pub(crate) wrong: u64,
}

/// Draws frames of crates that fall and lamps that circle, with `change` done to each mask before it
/// is checked.
pub(crate) fn run(
    gpu: &Gpu,
    size: [u32; 2],
    frames: u32,
    mut change: impl FnMut(&mut Mask),
) -> Result<Vec<Frame>, Box<dyn Error>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let hall = Triangles::hall(6.0, 4);
    let mut world = World::build(&[Mesh::new(&hall.positions, &hall.indices)])?;
    let mut cube = Triangles::default();
    cube.add_box([-0.4; 3], [0.4; 3]);
    let cube = Mesh::new(&cube.positions, &cube.indices);
    let mut crates = Vec::new();
    let mut lights = Lights::default();
    let mut lamps = Vec::new();
    for i in 0..40 {
        lamps.push(lights.insert(Light::point(circling(i, 0), RANGE))?);
    }
    let mut places: Vec<[f64; 3]> = (0..40).map(|i| circling(i, 0)).collect();

    let host = Host::new(DEPTH, &[]).with_mask();
    let mut shadows = Shadows::new(device, &world, &host)?;
    let mut eye = shadows.view(device)?;
    let mask = shadows.mask(device, size, lights.slots())?;
    let depth = gpu.target(size, DEPTH);
    let wgsl = shadows.wgsl(0) + DEPTH_ONLY;
    let depth_pipeline = gpu.pipeline(&Pipeline {
        layouts: &[shadows.world_layout()],
        primitive: shadows.depth_primitive(),
        depth_stencil: shadows.depth_stencil(),
        target: None,
        ..Pipeline::new("depth", &wgsl, HDR)
    });

    let mut found = Vec::new();
    for frame in 0..frames {
        // A crate comes each frame, all fall, turning; the oldest goes.
        crates.push((frame, world.insert(&cube, &falling(frame, frame))?));
        if crates.len() > 4 {
            world.remove(crates.remove(0).1)?;
        }
        for &(number, object) in &crates {
            world.place(object, &falling(number, frame))?;
        }
        // One lamp in four moves, and one is put out and another lit.
        for (number, id) in (0..).zip(&lamps).step_by(4) {
            places[id.slot() as usize] = circling(number, frame);
            lights.set(*id, Light::point(circling(number, frame), RANGE))?;
        }
        let at = frame as usize % lamps.len();
        lights.remove(lamps[at])?;
        lamps[at] = lights.insert(Light::point(circling(at as u32, frame), RANGE))?;
        places[lamps[at].slot() as usize] = circling(at as u32, frame);

        let angle = f64::from(frame) * 0.3;
        let from = [9.0 * angle.sin(), 4.0, 9.0 * angle.cos()];
        let view = View::look_at(from, TARGET, FOVY, NEAR, size);
        let stats = shadows.prepare(device, queue, &world, &lights, [(&mut eye, view)])?;
        let mut encoder = gpu.encoder();
        let mut drawing = pass(&mut encoder, None, &depth, Some(shadows.depth_clear()));
        drawing.set_pipeline(&depth_pipeline);
        drawing.set_bind_group(0, eye.world(), &[]);
        drawing.draw(world.corners(), 0..1);
        drop(drawing);
        shadows.find_receivers(device, &mut encoder, &mut eye, &depth)?;
        shadows.record_mask(&mut encoder, &eye, &depth, &mask)?;
        gpu.queue.submit([encoder.finish()]);

        let mut bits = Mask::new(size, lights.slots());
        bits.words = (0..lights.slots().div_ceil(32))
            .flat_map(|layer| gpu.read(gpu.encoder(), mask.view().texture(), layer))
            .collect::<Vec<u8>>()
            .chunks_exact(4)
            .map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]))
            .collect();
        change(&mut bits);
        let judgement = truth(gpu, &world, &places, from, &bits);
        found.push(Frame {
            stats,
            samples: judgement.samples,
            wrong: judgement.wrong,
        });
    }
    Ok(found)
}

const RANGE: f32 = 2.5;
const FOVY: f32 = 1.0;
const NEAR: f32 = 0.05;
const TARGET: [f64; 3] = [0.0, 0.5, 0.0];

const DEPTH_ONLY: &str = "
    @vertex
    fn depth_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) @invariant vec4f {
        return umbrage_world_corner(index).clip;
    }";

/// Where a lamp is.
fn circling(number: u32, frame: u32) -> [f64; 3] {
    let angle = f64::from(number) * 1.7 + f64::from(frame) * 0.11;
    let radius = 1.0 + f64::from(number % 9) * 0.6;
    [
        radius * angle.sin(),
        0.7 + f64::from(number % 5) * 0.5,
        radius * angle.cos(),
    ]
}

/// Where a crate is that came with frame `number`.
fn falling(number: u32, frame: u32) -> Pose {
    let (place, age) = (f64::from(number) * 2.4, f64::from(frame - number));
    let half_angle = 0.2 * age;
    let turn = [
        0.6 * half_angle.sin(),
        0.8 * half_angle.sin(),
        0.0,
        half_angle.cos(),
    ];
    Pose::new(
        [3.0 * place.sin(), 3.0 - 0.5 * age, 3.0 * place.cos()],
        turn,
    )
}

/// What an exact ray cast says of the mask.
fn truth(gpu: &Gpu, world: &World, lamps: &[[f64; 3]], eye: [f64; 3], mask: &Mask) -> Judgement {
    let (positions, triangles, casting) = world.snapshot();
    let mut mesh = umbrage_core::Mesh {
        triangles,
        casting,
        ..umbrage_core::Mesh::default()
    };
    mesh.stand(positions.into_iter().map(DVec3::from));
    let light = |&at: &[f64; 3]| umbrage_core::Light {
        position: at.into(),
        range: RANGE,
        shape: LightShape::Point,
    };
    let lights: Vec<_> = lamps.iter().map(light).collect();
    let view = umbrage_core::View::look_at(eye, TARGET, FOVY, NEAR, mask.size);
    let clamps = gpu.device.features().contains(Features::DEPTH_CLIP_CONTROL);
    let options = JudgeOptions::default().with_near(match clamps {
        true => NearClip::Clamped,
        false => NearClip::Clipped,
    });
    judge(
        &Oracle::new(&mesh),
        &view,
        &lights,
        mask,
        &options,
        &|_, _| (),
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let frames = std::env::args().nth(1).map_or(Ok(12), |n| n.parse())?;
    let found = run(&Gpu::open(Shadows::features())?, [320, 180], frames, |_| ())?;
    for (number, frame) in found.iter().enumerate() {
        let FrameStats {
            rebuilt,
            quads,
            build_ms,
            ..
        } = frame.stats;
        let Frame { samples, wrong, .. } = frame;
        println!(
            "frame {number}: {rebuilt} lights built in {build_ms:.1} ms, {quads} quads; \
             {wrong} of {samples} wrong"
        );
    }
    match found.iter().map(|frame| frame.wrong).sum() {
        0u64 => Ok(()),
        wrong => Err(format!("{wrong} pixels and lights are wrong").into()),
    }
}
