//! What is kept of one view from frame to frame.

use std::ops::Range;

use umbrage_core::frame::FramePlan;
use umbrage_wgpu::{ViewShadows, VolumePipelines};
use wgpu::{BindGroup, RenderPass};

use crate::View;

/// One view's plan and buffers: what a host keeps for each camera, mirror or half of a split screen.
#[derive(Debug)]
pub struct ShadowView {
    /// The renderer that it is of.
    pub(crate) of: u64,
    pub(crate) plan: FramePlan,
    pub(crate) gpu: ViewShadows,
    /// As last prepared.
    pub(crate) view: Option<View>,
}

impl ShadowView {
    /// What depth passes bind at the group number of [`Shadows::wgsl`](crate::Shadows::wgsl), in
    /// layout [`Shadows::world_layout`](crate::Shadows::world_layout); `None` before the first
    /// [`Shadows::prepare`](crate::Shadows::prepare), each of which may replace it.
    pub fn world(&self) -> Option<&BindGroup> {
        self.gpu.world_bind_group()
    }

    /// What light draws bind there, in layout [`Shadows::light_layout`](crate::Shadows::light_layout).
    pub fn lights(&self) -> Option<&BindGroup> {
        self.gpu.light_bind_group()
    }

    /// The draw of the light that a callback of [`Shadows::record`](crate::Shadows::record) was called
    /// for: call it once, with pipeline and bind groups set.
    pub fn draw_light(&self, pass: &mut RenderPass<'_>, light: u32) {
        self.gpu.draw_light(pass, light as usize);
    }

    /// Sets the viewport of the [`View`], for the host's passes over a part of a target.
    pub fn set_viewport(&self, pass: &mut RenderPass<'_>) {
        if let Some(view) = &self.view {
            let [x, y] = view.origin.map(|p| p as f32);
            let [width, height] = view.core.size.map(|p| p as f32);
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
        }
    }

    /// Numbers that lights have.
    pub(crate) fn slots(&self) -> u32 {
        self.plan.lights.len() as u32
    }

    pub(crate) fn record(
        &self,
        pass: &mut RenderPass<'_>,
        pipelines: &VolumePipelines,
        lights: Range<usize>,
        mut draw: impl FnMut(&mut RenderPass<'_>, u32),
    ) {
        let draw = |pass: &mut RenderPass<'_>, light, _: &_| draw(pass, light as u32);
        self.gpu.record(pass, pipelines, &self.plan, lights, draw);
    }
}
