//! The seam between the lab's frame and the methods: one trait, one file a method in `technique/`.
//!
//! The lab makes ready what all methods share: the surface (depth, normal, base colour, distance),
//! the view, and which pixels each light reaches. A technique then finds the shadows of a range of
//! lights and draws these lights into the target, be it light that adds up or bits of a mask.

mod extrude;
mod mask;
mod one_pass;
mod oracle;
mod ray_trace;
mod shadow_map;
mod unseen;

use std::fmt::Debug;
use std::ops::Range;

use umbrage_core::View;
use umbrage_core::frame::FramePlan;
use umbrage_wgpu::{Frame, ShadowRenderer, Uploaded};

use crate::application::Application;
use crate::gbuffer::Targets;
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LitBy};
use crate::method::{Counting, MaskBuffer, Method};
use crate::stage::{Stage, StageLight};

use extrude::Extrude;
pub(crate) use mask::Overflow;
use mask::{InFrame, InLayers};
use one_pass::OnePass;
use oracle::OracleMask;
use ray_trace::RayTrace;
use shadow_map::ShadowMap;

/// What a technique is given to draw a frame with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) stage: &'a Stage,
    pub(crate) lights: &'a [StageLight],
    pub(crate) view: &'a View,
    /// Where each light is drawn, and its volume if the method has volumes.
    pub(crate) plan: &'a FramePlan,
    /// What the plan was made of, for who makes it ready once more at another size.
    pub(crate) frame: Frame<'a>,
    /// The surface, drawn earlier in the same encoder.
    pub(crate) targets: &'a Targets,
    /// World, view and volumes on the GPU; records lights in their scissors.
    pub(crate) shadows: &'a ShadowRenderer,
}

/// What a technique has to say about itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TechniqueReport {
    /// GPU memory of its own, in bytes: maps, masks, trees; not world and volumes.
    pub gpu_bytes: u64,
    /// What a reader of its figures must know; empty if nothing.
    pub note: String,
}

/// What of lights is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Their volumes.
    Volumes,
    /// Volumes, if there are any, and light.
    Whole,
}

/// A way of finding shadows, and of lighting by them.
pub(crate) trait Technique: Debug {
    /// Brings what it keeps from frame to frame up to date. Once a frame, before the first
    /// `record`.
    fn prepare(&mut self, _given: &Given<'_>) -> Result<(), GpuError> {
        Ok(())
    }

    /// Records the lights numbered `lights` into `target`, cleared first, whose format is that of
    /// the [`LightDraw`] that the technique was made for.
    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError>;

    /// Records a part of the lights into `target` for its time alone, `times` over in one pass if it
    /// can; says how often it did: no time if it does not draw volume by volume. The stencil may hold
    /// volumes before that, and does so after volumes alone.
    fn record_again(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
        (part, _times): (Part, u32),
    ) -> Result<u32, GpuError> {
        match part {
            Part::Volumes => Ok(0),
            Part::Whole => self.record(given, encoder, lights, target).map(|()| 1),
        }
    }

    /// The shadow renderer of its own that draws the quads, if it has one, and what `prepare`
    /// uploaded with it last.
    fn own_renderer(&self) -> Option<(&ShadowRenderer, Uploaded)> {
        None
    }

    /// What it holds.
    fn report(&self) -> TechniqueReport {
        TechniqueReport::default()
    }
}

/// The technique behind a method, for lights drawn as `draw`, of which masks leave what
/// `application` says in their shadows.
pub(crate) fn technique(
    method: Method,
    application: Application,
    gpu: &Gpu,
    shadows: &ShadowRenderer,
    draw: LightDraw,
) -> Result<Box<dyn Technique>, GpuError> {
    method.check(application)?;
    Ok(match method {
        Method::Counter
        | Method::CounterZFail
        | Method::CounterFinite(_)
        | Method::Brute
        | Method::Crow => Box::new(OnePass::new(gpu, shadows, draw, LitBy::Stencil)),
        Method::Mask(buffer @ (MaskBuffer::Alpha | MaskBuffer::Max)) => {
            Box::new(InFrame::new(gpu, shadows, draw, buffer, application))
        }
        Method::Mask(buffer) => {
            let of = Counting::Mask(buffer);
            Box::new(InLayers::new(gpu, shadows, draw, of, application, 1)?)
        }
        Method::LowResolution { of, divisor } => {
            let pixels = divisor.pixels();
            Box::new(InLayers::new(gpu, shadows, draw, of, application, pixels)?)
        }
        Method::Extrude(normals) => Box::new(Extrude::new(gpu, shadows, draw, normals)),
        Method::ShadowMap { texels } => Box::new(ShadowMap::new(gpu, shadows, draw, texels)?),
        Method::Oracle => Box::new(OracleMask::new(gpu, shadows, draw)),
        Method::RayTrace => Box::new(RayTrace::new(gpu, shadows, draw)),
        Method::None => Box::new(OnePass::new(gpu, shadows, draw, LitBy::Everything)),
    })
}
