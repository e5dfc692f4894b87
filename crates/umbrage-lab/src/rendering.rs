//! Frames of one view that stay on the GPU: what they leave there, and what each light took.

use umbrage_core::View;
use umbrage_core::frame::LightPath;
use umbrage_wgpu::VolumeColor;

use crate::gbuffer::{Targets, texture};
use crate::gpu::GpuError;
use crate::lab::{Lab, Method};
use crate::light_pass::{HDR, LightDraw};
use crate::picture::Lit;
use crate::run::{Run, read_calls, read_lit};
use crate::stage::{Stage, StageLight};
use crate::timer::{Timer, median};

/// Frames of one size and method in the drawing: [`Lab::begin`] makes it, [`Lab::draw`] draws.
#[derive(Debug)]
pub struct Rendering {
    pub(crate) run: Run,
    pub(crate) hdr: wgpu::Texture,
    pub(crate) timer: Option<Timer>,
}

impl Rendering {
    /// Reflected light of the last frame, linear, in [`HDR`]; it can be bound.
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
            timer: Timer::new(self.gpu()),
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

    /// GPU microseconds of each of `numbers`, lights of the last frame: volume and light drawn once
    /// more, alone, in a pass of its own, less what such a pass takes without a light. Nothing on
    /// adapters without timestamps.
    pub fn time_lights(
        &self,
        rendering: &mut Rendering,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        numbers: &[usize],
    ) -> Result<Vec<f64>, GpuError> {
        let Rendering { run, timer, .. } = rendering;
        let Some(timer) = timer else {
            return Ok(Vec::new());
        };
        let gpu = self.gpu();
        let scratch = texture(
            gpu,
            "one light",
            view.size,
            HDR,
            wgpu::TextureUsages::empty(),
        );
        let drawn: Vec<usize> = (numbers.iter().copied())
            .filter(|&n| !matches!(self.path(n), LightPath::Skipped(_)))
            .collect();
        let (mut empty, mut alone) = (Vec::new(), Vec::new());
        for &number in &drawn {
            let mut encoder = (gpu.device).create_command_encoder(&Default::default());
            let (technique, given) = run.technique(gpu, stage, lights, self.frame(view));
            timer.mark(&mut encoder, 0);
            technique.record(&given, &mut encoder, number..number, &scratch)?;
            timer.mark(&mut encoder, 1);
            timer.mark(&mut encoder, 2);
            technique.record(&given, &mut encoder, number..number + 1, &scratch)?;
            timer.mark(&mut encoder, 3);
            timer.mark(&mut encoder, 4);
            timer.mark(&mut encoder, 5);
            timer.resolve(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let [without, with, _] = timer.read(gpu)?;
            empty.push(without);
            alone.push(with);
        }
        let empty = median(&mut empty).unwrap_or_default();
        let of = |number| drawn.iter().position(|&drawn| drawn == number);
        Ok((numbers.iter())
            .map(|&number| of(number).map_or(0.0, |i| (alone[i] - empty).max(0.0) * 1e3))
            .collect())
    }
}
