//! Nothing between the lights of a frame: each light's volume in the stencil, then the light where
//! the count came out as zero; or, without volumes, the light wherever it reaches: the floor.

use std::ops::Range;

use umbrage_wgpu::ShadowRenderer;

use super::{Given, Part, Technique};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass, stencil_pass};

/// All of the plan's volumes, if it has any, and lights in one pass.
#[derive(Debug)]
pub(crate) struct OnePass(LightPass);

impl OnePass {
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        lit_by: LitBy<'_>,
    ) -> Self {
        Self(LightPass::new(gpu, shadows, draw, lit_by))
    }
}

impl Technique for OnePass {
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

    fn record_again(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
        (part, times): (Part, u32),
    ) -> Result<u32, GpuError> {
        let clean = wgpu::LoadOp::Clear(0);
        let mut pass = stencil_pass(encoder, given.targets, target, FROM_DARK, clean);
        for _ in 0..times {
            match part {
                Part::Whole => self.0.record(&mut pass, given, lights.clone(), None),
                Part::Volumes => {
                    for light in lights.clone() {
                        given.shadows.record_volume(&mut pass, given.plan, light);
                    }
                }
            }
        }
        Ok(times)
    }
}
