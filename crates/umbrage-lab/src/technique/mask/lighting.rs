//! The steps that apply masks: the light, and what it adds in its shadow.

use umbrage_wgpu::ShadowRenderer;

use super::plan::{MaskPlan, Step};
use crate::gpu::Gpu;
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::technique::Given;

/// A pass for each step, in order.
#[derive(Debug)]
pub(crate) struct Lighting(Vec<LightPass>);

impl Lighting {
    /// Lights are drawn as `draw`, lit by `lit_by`.
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        plan: MaskPlan,
        draw: LightDraw,
        lit_by: LitBy<'_>,
    ) -> Self {
        let steps = plan.light_steps().into_iter();
        let passes = steps.map(|step| match step {
            Step::Ambient => LightPass::new(gpu, shadows, LightDraw::Ambient, LitBy::Everything),
            _ => LightPass::new(gpu, shadows, draw, lit_by),
        });
        Self(passes.collect())
    }

    pub(crate) fn prepare(&mut self, given: &Given<'_>) {
        self.0.iter_mut().for_each(|pass| pass.prepare(given));
    }

    /// Draws one light over the scissor that is set; `masks` is what the shader of `lit_by` reads.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shadows: &ShadowRenderer,
        number: usize,
        masks: Option<&wgpu::BindGroup>,
    ) {
        for step in &self.0 {
            step.draw(pass, shadows, number, masks);
        }
    }
}
