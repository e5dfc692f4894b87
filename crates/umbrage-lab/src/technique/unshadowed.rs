//! No shadows: the floor.

use std::ops::Range;

use umbrage::ShadowRenderer;

use super::{Given, Technique};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// Every light wherever it reaches.
#[derive(Debug)]
pub(crate) struct Unshadowed(LightPass);

impl Unshadowed {
    pub(crate) fn new(gpu: &Gpu, shadows: &ShadowRenderer, draw: LightDraw) -> Self {
        Self(LightPass::new(gpu, shadows, draw, LitBy::Everything))
    }
}

impl Technique for Unshadowed {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.0.prepare(given);
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        let mut pass = light_pass(encoder, given.targets, target, FROM_DARK);
        self.0.record(&mut pass, given, lights, None);
        Ok(())
    }
}
