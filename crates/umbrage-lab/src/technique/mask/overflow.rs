//! Not a method, but what is to be known about some: the pixel-lights whose layers a mask cannot
//! represent, as bits of a mask. Drawn by `check`, never in a timed frame.
//!
//! A mask counts up before it counts down, from the eye count n by one a raising face, and the
//! values run out where n and the faces that raise exceed its layers. They are counted in the
//! stencil, with the very draws that the mask has.

use std::ops::Range;

use umbrage_core::frame::LightPath;
use umbrage_wgpu::{CountStep, FaceOptions, ShadowRenderer, VolumeFaces};
use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy, MASK};
use crate::run::{FROM_DARK, stencil_pass};
use crate::technique::{Given, Technique};

/// Marks pixel-lights with more than `layers` on the way to their count.
#[derive(Debug)]
pub(crate) struct Overflow {
    layers: u32,
    raise: VolumeFaces,
    mark: LightPass,
}

impl Overflow {
    pub(crate) fn new(gpu: &Gpu, shadows: &ShadowRenderer, layers: u32) -> Self {
        let keep = StencilFaceState {
            compare: CompareFunction::Always,
            fail_op: StencilOperation::Keep,
            depth_fail_op: StencilOperation::Keep,
            pass_op: StencilOperation::IncrementClamp,
        };
        let target = wgpu::ColorTargetState {
            format: MASK,
            blend: None,
            write_mask: wgpu::ColorWrites::empty(),
        };
        let options = FaceOptions {
            step: CountStep::Raise,
            targets: &[Some(target)],
            stencil: keep,
        };
        let enough = StencilFaceState {
            compare: CompareFunction::LessEqual,
            pass_op: StencilOperation::Keep,
            ..keep
        };
        Self {
            layers,
            raise: shadows.faces(&gpu.device, &options),
            mark: LightPass::new(gpu, shadows, LightDraw::Mark, LitBy::StencilTest(enough)),
        }
    }
}

impl Technique for Overflow {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.mark.prepare(given);
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        // Cleared, also if nothing is drawn.
        drop(counting_pass(encoder, given, target, FROM_DARK));
        let drawn = given.plan.drawn().filter(|(i, _)| lights.contains(i));
        for (number, light) in drawn.filter(|(_, light)| !light.scissor.is_empty()) {
            let mut pass = counting_pass(encoder, given, target, wgpu::LoadOp::Load);
            let s = light.scissor;
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            given
                .shadows
                .record_faces(&mut pass, &self.raise, number, light);
            let eye_count = match light.path {
                LightPath::ZPass { eye_count } => eye_count,
                _ => 0,
            };
            // At least this many raising faces are too many.
            pass.set_stencil_reference((self.layers + 1).saturating_sub(eye_count));
            self.mark.draw(&mut pass, given.shadows, number, None);
        }
        Ok(())
    }
}

/// A pass that starts to count from zero.
fn counting_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    given: &Given<'_>,
    target: &wgpu::Texture,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPass<'e> {
    stencil_pass(encoder, given.targets, target, load, wgpu::LoadOp::Clear(0))
}
