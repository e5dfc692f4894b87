//! Lights that reached no visible surface in the last frame, for as long as nothing changes.
//!
//! The receivers of a frame are found on the GPU, too late to leave out what is drawn directly in that
//! very frame. So they are read back with the next, and count if view, lights and world are the same:
//! other methods then spare exactly the lights that volumes spare, and no shadow is ever late.

use umbrage_core::{Light, View};
use umbrage_wgpu::LightCalls;

use crate::gpu::{Gpu, GpuError};
use crate::readback::{read_items, record_copy};
use crate::technique::Given;

/// What a frame was drawn from.
#[derive(Clone, Debug, PartialEq)]
struct Frame {
    view: View,
    lights: Vec<Light>,
    world: u64,
}

impl Frame {
    fn of(given: &Given<'_>) -> Self {
        Self {
            view: *given.view,
            lights: given.lights.iter().map(|l| l.light).collect(),
            world: given.stage.world.stamp,
        }
    }
}

/// What the last frame found.
#[derive(Debug, Default)]
pub(super) struct Unseen {
    /// Of the last record, which was submitted.
    calls: Option<(Frame, wgpu::Buffer)>,
    known: Option<(Frame, Vec<bool>)>,
}

impl Unseen {
    /// Brings it up to date with the last frame.
    pub(super) fn update(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        let now = Frame::of(given);
        if let Some((frame, calls)) = self.calls.take()
            && frame == now
        {
            self.known = Some((frame, read(given.gpu, &calls)?));
        }
        self.known.take_if(|(frame, _)| *frame != now);
        Ok(())
    }

    /// Whether the light can be left out.
    pub(super) fn has(&self, light: usize) -> bool {
        let known = self.known.as_ref();
        known.is_some_and(|(_, unseen)| unseen.get(light).copied().unwrap_or(false))
    }

    /// Records that what this frame finds is kept.
    pub(super) fn record(&mut self, given: &Given<'_>, encoder: &mut wgpu::CommandEncoder) {
        if self.known.is_some() {
            return;
        }
        let Some(calls) = given.shadows.calls().and_then(|mut calls| calls.next()) else {
            return;
        };
        let readable = record_copy(given.gpu, encoder, calls);
        self.calls = Some((Frame::of(given), readable));
    }
}

fn read(gpu: &Gpu, calls: &wgpu::Buffer) -> Result<Vec<bool>, GpuError> {
    let calls: Vec<LightCalls> = read_items(gpu, calls)?;
    Ok(calls.iter().map(|c| c.light.instance_count == 0).collect())
}
