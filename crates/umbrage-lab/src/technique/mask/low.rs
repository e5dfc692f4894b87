//! The frame once more at a lower resolution: depth, receivers and volumes, for masks that are
//! counted there.
//!
//! Same eye and frustum, so that what is uploaded differs in the size alone; the last column and
//! row of texels are as wide and high as the others, and cover less where the division leaves a
//! rest. Scissors are a texel wider than a light's own, since filtering looks one texel aside.

use umbrage::frame::bounds::light_rect;
use umbrage::{
    Extrusion, Frame, FramePlan, Rect, RendererOptions, ShadowRenderer, View, VolumeColor,
};

use crate::gbuffer::{DEPTH_STENCIL, Targets, depth_only};
use crate::gpu::{Gpu, GpuError};
use crate::technique::Given;

/// World, volumes and surface for one lower resolution.
#[derive(Debug)]
pub(crate) struct LowFrame {
    divisor: u32,
    pub(crate) shadows: ShadowRenderer,
    pub(crate) plan: FramePlan,
    targets: Option<Targets>,
    /// Whether this frame's surface is still to be drawn.
    pending: bool,
}

impl LowFrame {
    /// For masks of `format`.
    pub(crate) fn new(
        gpu: &Gpu,
        divisor: u32,
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let options = RendererOptions {
            color_formats: &[Some(format)],
            depth_stencil_format: DEPTH_STENCIL,
            sample_count: 1,
            depth_clamp: gpu.depth_clamp,
            extrusion: Extrusion::Infinite,
            volume_color: VolumeColor::None,
        };
        Ok(Self {
            divisor,
            shadows: ShadowRenderer::new(&gpu.device, &options)?,
            plan: FramePlan::default(),
            targets: None,
            pending: true,
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
        if self.targets.as_ref().is_none_or(|t| t.size != size) {
            self.targets = Some(Targets::new(given.gpu, size)?);
        }
        self.shadows
            .upload_world(device, queue, &given.stage.world)?;
        let frame = Frame {
            view: &view,
            plan: &self.plan,
            ..given.frame
        };
        self.shadows.prepare(device, queue, &frame)?;
        self.pending = true;
        Ok(())
    }

    /// Draws the surface and finds the receivers, if this frame's were not yet.
    pub(crate) fn record_surface(&mut self, given: &Given<'_>, encoder: &mut wgpu::CommandEncoder) {
        let Some(targets) = self.targets.as_ref().filter(|_| self.pending) else {
            return;
        };
        given.surface.record(encoder, targets, None);
        let depth = depth_only(&targets.depth);
        self.shadows
            .find_receivers(&given.gpu.device, encoder, &depth, None);
        self.pending = false;
    }

    pub(crate) fn targets(&self) -> Option<&Targets> {
        self.targets.as_ref()
    }

    /// Bytes of surface and world; quads are few.
    pub(crate) fn gpu_bytes(&self) -> u64 {
        // Depth with stencil, albedo, normal, distance.
        const SURFACE: u64 = 8 + 4 + 8 + 4;
        let pixels = self.targets.as_ref().map_or(0, |t| area(t.size));
        let world = self.shadows.world_buffers();
        let world = world.map_or(0, |(positions, triangles)| {
            positions.size() + triangles.size()
        });
        SURFACE * pixels + world
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
