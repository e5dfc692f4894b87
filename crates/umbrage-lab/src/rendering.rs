//! Frames of one view that stay on the GPU: what they leave there, and what each light took.

use umbrage_core::View;
use umbrage_wgpu::VolumeColor;

use crate::gbuffer::{Targets, texture};
use crate::gpu::GpuError;
use crate::lab::{Lab, Method};
use crate::light_pass::LightDraw;
use crate::picture::Lit;
use crate::run::{Run, read_calls, read_lit};
use crate::stage::{Stage, StageLight};
use crate::timer::Timer;

/// Frames of one size and method in the drawing: [`Lab::begin`] makes it, [`Lab::draw`] draws.
#[derive(Debug)]
pub struct Rendering {
    pub(crate) run: Run,
    pub(crate) hdr: wgpu::Texture,
    pub(crate) timer: Option<Timer>,
}

impl Rendering {
    /// Reflected light of the last frame, linear, in half floats; it can be bound.
    pub fn light(&self) -> &wgpu::Texture {
        &self.hdr
    }

    /// Depth and surface of the last frame.
    pub fn surface(&self) -> &Targets {
        &self.run.targets
    }
}

impl Lab {
    /// Makes ready for frames of a view's size that stay on the GPU.
    pub fn begin(
        &mut self,
        stage: &Stage,
        view: &View,
        method: Method,
    ) -> Result<Rendering, GpuError> {
        self.frames.clear();
        self.method = method;
        let draw = LightDraw::Shade;
        let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(Rendering {
            run: self.run(stage, view, method, draw, VolumeColor::None)?,
            hdr: texture(self.gpu(), "light", view.size, draw.format(), usage),
            timer: Timer::new(self.gpu(), 3),
        })
    }

    /// The last frame's picture.
    pub fn lit(&self, rendering: &Rendering) -> Result<Lit, GpuError> {
        let Rendering { run, hdr, .. } = rendering;
        read_lit(self.gpu(), run, hdr)
    }

    /// Finds out what the GPU drew of each light in the last frame: [`Lab::path`] and
    /// [`Lab::quads_drawn`] go by it.
    pub fn read_calls(&mut self, rendering: &Rendering) -> Result<(), GpuError> {
        self.calls = read_calls(self.gpu(), &rendering.run)?;
        Ok(())
    }

    /// Draws one light of the last frame once more, alone, and gives the picture.
    pub fn alone(
        &self,
        rendering: &mut Rendering,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        number: usize,
    ) -> Result<Lit, GpuError> {
        let Rendering { run, hdr, .. } = rendering;
        let gpu = self.gpu();
        let mut encoder = (gpu.device).create_command_encoder(&Default::default());
        let (technique, given) = run.technique(gpu, stage, lights, self.frame(view));
        technique.record(&given, &mut encoder, number..number + 1, hdr)?;
        gpu.queue.submit([encoder.finish()]);
        read_lit(gpu, run, hdr)
    }
}
