//! Volumes in the stencil: each light's volume, then the light where the count came out as zero.

use std::ops::Range;

use umbrage::ShadowRenderer;

use super::{Given, Technique};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// All of the plan's volumes and lights in one pass.
#[derive(Debug)]
pub(crate) struct Stencil(LightPass);

impl Stencil {
    pub(crate) fn new(gpu: &Gpu, shadows: &ShadowRenderer, draw: LightDraw) -> Self {
        Self(LightPass::new(gpu, shadows, draw, LitBy::Stencil))
    }
}

impl Technique for Stencil {
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
