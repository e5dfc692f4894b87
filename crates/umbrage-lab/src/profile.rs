//! What each light of a frame costs, measured apart from ordinary frames, which stay as they are.
//!
//! Takes what a lab has prepared; gives, light by light, GPU time ([`Meter::round`]), what it draws
//! ([`Counter::count`]) and CPU time ([`Lab::build_times`]). On a GPU that draws tile by tile, software
//! included, a timestamp inside a pass says little; so each light has a pass for its volume and one
//! for its light, timed at their bounds, and the cost of an empty pass is subtracted. Summed up,
//! lights then cost what they cost one after the other; in a frame, some of that overlaps.

mod building;
mod counts;
mod timing;

use umbrage_core::View;
use umbrage_core::frame::FramePlan;
use umbrage_wgpu::VolumeColor;

use crate::gbuffer::texture;
use crate::gpu::{Gpu, GpuError};
use crate::lab::Lab;
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::picture::Lit;
use crate::run::{FROM_DARK, Run, read_calls, read_lit, timed_pass};
use crate::stage::{Stage, StageLight};

pub use counts::{Counter, LightCounts};
pub use timing::GpuCost;

/// Draws the lights of one view one by one.
#[derive(Debug)]
pub struct Meter {
    gpu: Gpu,
    plan: FramePlan,
    run: Run,
    light: LightPass,
    target: wgpu::Texture,
}

impl Lab {
    /// A meter of what `volumes` and `plan` hold, for times and pictures. Finds out which lights
    /// reach visible surface: see [`Lab::path`].
    pub fn meter(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<Meter, GpuError> {
        self.new_meter(stage, lights, view, LightDraw::Shade, VolumeColor::None)
    }

    fn new_meter(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        draw: LightDraw,
        volume_color: VolumeColor,
    ) -> Result<Meter, GpuError> {
        let gpu = self.gpu().clone();
        let mut run = self.run(stage, view, self.method, draw, volume_color)?;
        run.shadows
            .prepare(&gpu.device, &gpu.queue, &self.frame(view))?;
        let mut light = LightPass::new(&gpu, &run.shadows, draw, LitBy::Stencil);
        light.prepare(&run.technique(&gpu, stage, lights, self.frame(view)).1);
        let mut encoder = encoder(&gpu);
        run.record_surface(&gpu, &mut encoder, None);
        gpu.queue.submit([encoder.finish()]);
        self.calls = read_calls(&gpu, &run)?;
        let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(Meter {
            target: texture(&gpu, "one light", view.size, draw.format(), usage),
            plan: self.plan.clone(),
            gpu,
            run,
            light,
        })
    }
}

impl Meter {
    /// Begins a pass in which lights are drawn.
    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        load: wgpu::LoadOp<wgpu::Color>,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let stencil = wgpu::LoadOp::Load;
        timed_pass(
            encoder,
            &self.run.targets,
            &self.target,
            load,
            stencil,
            timestamps,
        )
    }

    fn record_volume(&self, pass: &mut wgpu::RenderPass<'_>, light: usize) {
        self.run.shadows.record_volume(pass, &self.plan, light);
    }

    fn record_light(&self, pass: &mut wgpu::RenderPass<'_>, light: usize) {
        let shadows = &self.run.shadows;
        shadows.record_light(pass, &self.plan, light, |pass, number, _| {
            self.light.draw(pass, shadows, number, None);
        });
    }

    /// The picture with one light alone.
    pub fn picture(&self, light: usize) -> Result<Lit, GpuError> {
        let mut encoder = encoder(&self.gpu);
        let mut pass = self.pass(&mut encoder, FROM_DARK, None);
        self.record_volume(&mut pass, light);
        self.record_light(&mut pass, light);
        drop(pass);
        self.gpu.queue.submit([encoder.finish()]);
        read_lit(&self.gpu, &self.run, &self.target)
    }
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("profile"),
        })
}
