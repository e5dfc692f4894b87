//! The frame once more at a lower resolution: depth, receivers and volumes, for masks that are
//! counted there.
//!
//! Same eye and frustum, so that what is uploaded differs in the size alone: where the division
//! leaves a rest, every texel is a little less than `divisor` pixels wide or high, 721/361 for half
//! of 721. Scissors are a texel wider than a light's own, since filtering looks one texel aside.

use umbrage_core::View;
use umbrage_core::frame::bounds::light_rect;
use umbrage_core::frame::{FramePlan, Rect};
use umbrage_wgpu::{RendererOptions, ShadowRenderer, Uploaded, WorldWindows};

use super::low_depth::LowDepth;
use crate::gbuffer::{DEPTH_STENCIL, depth_only, texture};
use crate::gpu::{Gpu, GpuError};
use crate::technique::Given;

/// World, volumes and depth for one lower resolution.
#[derive(Debug)]
pub(crate) struct LowFrame {
    divisor: u32,
    pub(crate) shadows: ShadowRenderer,
    pub(crate) plan: FramePlan,
    /// What the last `prepare` uploaded.
    pub(crate) uploaded: Uploaded,
    surface: LowDepth,
    depth: Option<wgpu::Texture>,
    /// This frame's depth is not drawn yet.
    is_pending: bool,
    /// Bytes of quads, before and after the cull.
    quad_bytes: u64,
}

impl LowFrame {
    /// For masks of `format`.
    pub(crate) fn new(
        gpu: &Gpu,
        windows: WorldWindows,
        divisor: u32,
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let formats = [Some(format)];
        let mut options = RendererOptions::new(DEPTH_STENCIL, &formats);
        options.depth_clamp = gpu.depth_clamp;
        options.windows = windows;
        let shadows = ShadowRenderer::new(&gpu.device, &options)?;
        Ok(Self {
            divisor,
            plan: FramePlan::default(),
            uploaded: Uploaded::default(),
            surface: LowDepth::new(gpu, &shadows),
            shadows,
            depth: None,
            is_pending: false,
            quad_bytes: 0,
        })
    }

    /// Uploads world, volumes and the plan with its own scissors.
    pub(crate) fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        let (device, queue) = (&given.gpu.device, &given.gpu.queue);
        let size = low_size(given.view.size, self.divisor);
        let view = View {
            size,
            ..*given.view
        };
        self.plan.clone_from(given.plan);
        for (light, plan) in given.frame.lights.iter().zip(&mut self.plan.lights) {
            plan.scissor = widened(light_rect(&view, light), size);
        }
        let is_old = |d: &wgpu::Texture| [d.width(), d.height()] != size;
        if self.depth.as_ref().is_none_or(is_old) {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING;
            self.depth = Some(texture(given.gpu, "low depth", size, DEPTH_STENCIL, usage));
        }
        self.shadows
            .upload_world(device, queue, &given.stage.world)?;
        let mut frame = given.frame;
        (frame.view, frame.plan) = (&view, &self.plan);
        self.uploaded = self.shadows.prepare(device, queue, &frame)?;
        self.is_pending = true;
        self.quad_bytes = 2 * size_of_val(&given.frame.volumes.quads[..]) as u64;
        Ok(())
    }

    /// Draws depth and finds the receivers, if this frame's were not yet.
    pub(crate) fn record_surface(&mut self, given: &Given<'_>, encoder: &mut wgpu::CommandEncoder) {
        let Some(depth) = self.depth.as_ref().filter(|_| self.is_pending) else {
            return;
        };
        self.is_pending = false;
        let triangles = given.stage.world.triangles.len() as u32;
        self.surface
            .record(encoder, &self.shadows, triangles, depth);
        self.shadows
            .find_receivers(&given.gpu.device, encoder, &depth_only(depth), None);
    }

    pub(crate) fn depth(&self) -> Option<&wgpu::Texture> {
        self.depth.as_ref()
    }

    /// Bytes of depth, world and quads.
    pub(crate) fn gpu_bytes(&self) -> u64 {
        // With stencil.
        const DEPTH: u64 = 8;
        let size = self.depth.as_ref().map(|d| [d.width(), d.height()]);
        DEPTH * size.map_or(0, area) + self.shadows.world_bytes() + self.quad_bytes
    }
}

/// Sides divided, rounded up.
pub(crate) fn low_size(size: [u32; 2], divisor: u32) -> [u32; 2] {
    size.map(|side| side.div_ceil(divisor).max(1))
}

pub(crate) fn area([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// A texel more on all sides, within the picture.
fn widened(rect: Rect, size: [u32; 2]) -> Rect {
    if rect.is_empty() {
        return rect;
    }
    let (x, y) = (rect.x.saturating_sub(1), rect.y.saturating_sub(1));
    Rect {
        x,
        y,
        width: (rect.x + rect.width + 1).min(size[0]) - x,
        height: (rect.y + rect.height + 1).min(size[1]) - y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_round_up_and_never_vanish() {
        assert_eq!(low_size([1280, 721], 2), [640, 361]);
        assert_eq!(low_size([1, 5], 4), [1, 2]);
        assert_eq!(low_size([7, 3], 1), [7, 3]);
    }

    #[test]
    fn scissors_widen_up_to_the_border() {
        let rect = |x, y, width, height| Rect {
            x,
            y,
            width,
            height,
        };
        assert_eq!(widened(rect(0, 3, 4, 2), [9, 5]), rect(0, 2, 5, 3));
        assert_eq!(widened(rect(2, 2, 3, 3), [9, 9]), rect(1, 1, 5, 5));
        assert!(widened(rect(5, 5, 0, 2), [9, 9]).is_empty());
    }
}
