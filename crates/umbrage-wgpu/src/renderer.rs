//! Create, prepare, record: for hosts with one view a submission.

use umbrage_core::frame::{FramePlan, LightPlan};
use umbrage_core::world::World;
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, CommandEncoder, DepthStencilState, Device, Queue,
    RenderPass, TextureView,
};

use crate::host::{Frame, RenderError, RendererOptions, Uploaded};
use crate::shared::SharedShadows;
use crate::view::ViewShadows;
use crate::windows::WorldWindows;

/// Draws volumes into the stencil of a host's pass, light after light: a [`SharedShadows`] and the
/// one [`ViewShadows`] on it.
#[derive(Debug)]
pub struct ShadowRenderer {
    shared: SharedShadows,
    view: ViewShadows,
}

impl ShadowRenderer {
    /// Creates pipelines and empty buffers.
    ///
    /// # Errors
    /// As [`SharedShadows::new`].
    pub fn new(device: &Device, options: &RendererOptions<'_>) -> Result<Self, RenderError> {
        let shared = SharedShadows::new(device, options)?;
        let view = ViewShadows::new(device, &shared)?;
        Ok(Self { shared, view })
    }

    pub(crate) fn shared(&self) -> &SharedShadows {
        &self.shared
    }

    pub(crate) fn view(&self) -> &ViewShadows {
        &self.view
    }

    /// As [`SharedShadows::upload_world`]. True if [`ShadowRenderer::world_bind_group`] was
    /// replaced.
    ///
    /// # Errors
    /// If the world is not one that the options allow for, or there is no memory.
    pub fn upload_world(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<bool, RenderError> {
        let uploaded = self.shared.upload_world(device, queue, world);
        uploaded.inspect_err(|_| self.view.unbind_world())?;
        Ok(self.view.bind_world(device, &self.shared))
    }

    /// Uploads what this frame's plan draws and the GPU does not have yet. One call a submission.
    ///
    /// # Errors
    /// As [`ViewShadows::prepare`].
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        frame: &Frame<'_>,
    ) -> Result<Uploaded, RenderError> {
        let Self { shared, view } = self;
        let quads = shared.upload_volumes(device, queue, frame.volumes)?;
        let mut uploaded = view.prepare(device, queue, shared, frame, [0; 2])?;
        uploaded.volume_bytes += quads;
        Ok(uploaded)
    }

    /// As [`ViewShadows::find_receivers`].
    pub fn find_receivers(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        depth: &TextureView,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let Self { shared, view } = self;
        view.find_receivers(device, encoder, shared, depth, timestamps);
    }

    /// As [`ViewShadows::record`].
    pub fn record(
        &self,
        pass: &mut RenderPass<'_>,
        plan: &FramePlan,
        lights: std::ops::Range<usize>,
        draw_light: impl FnMut(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let pipelines = self.shared.pipelines();
        self.view.record(pass, pipelines, plan, lights, draw_light);
    }

    /// As [`ViewShadows::record_volume`].
    pub fn record_volume(&self, pass: &mut RenderPass<'_>, plan: &FramePlan, number: usize) {
        self.view
            .record_volume(pass, self.shared.pipelines(), plan, number);
    }

    /// As [`ViewShadows::record_light`].
    pub fn record_light(
        &self,
        pass: &mut RenderPass<'_>,
        plan: &FramePlan,
        number: usize,
        draw_light: impl FnOnce(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let pipelines = self.shared.pipelines();
        self.view
            .record_light(pass, pipelines, plan, number, draw_light);
    }

    /// As [`ViewShadows::draw_light`].
    pub fn draw_light(&self, pass: &mut RenderPass<'_>, light: usize) {
        self.view.draw_light(pass, light);
    }

    /// As [`SharedShadows::light_bind_group_layout`].
    pub fn light_bind_group_layout(&self) -> &BindGroupLayout {
        self.shared.light_bind_group_layout()
    }

    /// As [`ViewShadows::light_bind_group`].
    pub fn light_bind_group(&self) -> Option<&BindGroup> {
        self.view.light_bind_group()
    }

    /// As [`ViewShadows::calls`].
    pub fn calls(&self) -> Option<impl Iterator<Item = &Buffer>> {
        self.view.calls()
    }

    /// As [`SharedShadows::light_depth_stencil`].
    pub fn light_depth_stencil(&self) -> DepthStencilState {
        self.shared.light_depth_stencil()
    }

    /// As [`SharedShadows::world_wgsl`].
    pub fn world_wgsl(&self, group: u32) -> String {
        self.shared.world_wgsl(group)
    }

    /// As [`SharedShadows::world_windows`].
    pub fn world_windows(&self) -> WorldWindows {
        self.shared.world_windows()
    }

    /// As [`SharedShadows::world_bind_group_layout`].
    pub fn world_bind_group_layout(&self) -> &BindGroupLayout {
        self.shared.world_bind_group_layout()
    }

    /// What [`ShadowRenderer::world_wgsl`] reads, for the host's depth pass: the world, and the
    /// view of the last [`ShadowRenderer::prepare`]. `None` before
    /// [`ShadowRenderer::upload_world`], which may replace it.
    pub fn world_bind_group(&self) -> Option<&BindGroup> {
        self.view.world_bind_group()
    }

    /// As [`SharedShadows::world_bytes`].
    pub fn world_bytes(&self) -> u64 {
        self.shared.world_bytes()
    }

    /// As [`ViewShadows::view_buffer`].
    pub fn view_buffer(&self) -> &Buffer {
        self.view.view_buffer()
    }
}
