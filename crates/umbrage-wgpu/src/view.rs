//! What is kept of one view: the eye, caps, lights, receivers, and bind groups of them and of what
//! all views share.

use umbrage_core::Light;
use umbrage_core::cull::Cull;
use umbrage_core::frame::{Extrusion, LightPlan};
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, Device, Queue, TextureView,
};

use crate::SharedShadows;
use crate::buffers::Growing;
use crate::host::{Frame, RenderError, Uploaded, ViewUniform};
use crate::receivers::{Inputs, Receivers, tile_rows};
use crate::split::Split;

/// One view of what [`SharedShadows`] holds. Views of one submission do not disturb each other.
#[derive(Debug)]
pub struct ViewShadows {
    view: Buffer,
    size: [u32; 2],
    /// Its upper left pixel in its target.
    pub(crate) origin: [u32; 2],
    caps: Split,
    lights: Growing,
    /// How far each is extruded; unused if the renderer was made for infinite volumes.
    distances: Growing,
    /// Lights, and parts beyond the first of each.
    light_count: u32,
    /// With the generation of the world's buffers that it is of.
    world: Option<(u64, BindGroup)>,
    pub(crate) volumes: Option<VolumeBindings>,
    pub(crate) receivers: Option<Receivers>,
    pub(crate) found: Found,
    /// Where lights are drawn: `UmbrageSpans` of the shaders.
    spans: Growing,
    light_bind_group: Option<BindGroup>,
    /// Quads or caps that one window of their lists holds.
    pub(crate) list_window: usize,
}

/// What volumes are drawn from.
#[derive(Debug)]
pub(crate) struct VolumeBindings {
    /// Of the quads' buffers.
    generation: u64,
    /// With all quads, and with those that the receivers keep; of each window of quads and caps.
    pub(crate) windows: [Vec<BindGroup>; 2],
}

/// How far the receivers of this frame are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// Not asked for.
    No,
    /// The plan is uploaded; the depth buffer was not looked at yet.
    Planned,
    /// Draws are indirect.
    Yes,
}

impl ViewShadows {
    /// Creates empty buffers.
    ///
    /// # Errors
    /// If there is no memory.
    pub fn new(device: &Device, shared: &SharedShadows) -> Result<Self, RenderError> {
        let none = BufferUsages::empty();
        let growing = |label| Growing::new(device, label, none);
        let receivers = shared.receivers.as_ref().map(|_| Receivers::new(device));
        Ok(Self {
            view: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("umbrage view"),
                size: size_of::<ViewUniform>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            size: [0; 2],
            origin: [0; 2],
            caps: Split::open(device, "umbrage caps", 4 * shared.list_window, none)?,
            lights: growing("umbrage lights")?,
            distances: growing("umbrage distances")?,
            light_count: 0,
            world: None,
            volumes: None,
            receivers: receivers.transpose()?,
            found: Found::No,
            spans: growing("umbrage spans")?,
            light_bind_group: None,
            list_window: shared.list_window,
        })
    }

    /// Binds the world's buffers if it has not bound those that there are; true if so.
    pub(crate) fn bind_world(&mut self, device: &Device, shared: &SharedShadows) -> bool {
        let generation = shared.world.generation;
        let is_old = self.world.as_ref().is_none_or(|(of, _)| *of != generation);
        if is_old {
            self.world = Some((generation, shared.world.bind(device, &self.view)));
        }
        is_old
    }

    /// Forgets the world's buffers.
    pub(crate) fn unbind_world(&mut self) {
        self.world = None;
    }

    /// Uploads what this frame's plan draws and the GPU does not have yet, after
    /// [`SharedShadows::upload_world`] and [`SharedShadows::upload_volumes`]. One call a view and
    /// submission: what the queue is given here arrives before everything recorded in it.
    ///
    /// `origin` is the view's upper left pixel in its target: the host's passes have a viewport
    /// there, of the view's size.
    ///
    /// # Errors
    /// If no world was uploaded, or the device's limits or its memory do not suffice.
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        shared: &SharedShadows,
        frame: &Frame<'_>,
        origin: [u32; 2],
    ) -> Result<Uploaded, RenderError> {
        if !shared.world.is_filled() {
            return Err(RenderError::NoWorld);
        }
        self.bind_world(device, shared);
        let mut homogeneous: Vec<[[f32; 4]; 2]> =
            frame.lights.iter().map(Light::homogeneous_f32).collect();
        let further: Vec<usize> = frame.plan.further_parts().map(|(light, _)| light).collect();
        homogeneous.extend(
            further
                .iter()
                .map(|&light| frame.lights[light].homogeneous_f32()),
        );
        let view = ViewUniform::new(frame.view, origin, shared.depth());
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        self.size = frame.view.size;
        self.origin = origin;
        self.light_count = (frame.lights.len().min(frame.plan.lights.len()) + further.len()) as u32;
        self.found = Found::No;
        // Made again below unless no buffer is replaced; an error leaves none behind.
        let volumes = self.volumes.take();
        let caps = bytemuck::cast_slice(&frame.plan.caps);
        let caps = self.caps.write(device, queue, caps)?;
        let points = bytemuck::cast_slice(&homogeneous);
        let mut others = self.lights.write(device, queue, points)?;
        if shared.shader().extrusion != Extrusion::Infinite {
            let lights = &frame.plan.lights;
            let further = further.iter().map(|&light| &lights[light]);
            let distances: Vec<f32> = lights.iter().chain(further).map(shader_distance).collect();
            let distances = bytemuck::cast_slice(&distances);
            others += self.distances.write(device, queue, distances)?;
        }
        let asked = frame.culls.has(Cull::Receivers) || frame.culls.has(Cull::Quads);
        if let Some(receivers) = self.receivers.as_mut().filter(|_| asked) {
            others += receivers.prepare(device, queue, frame)?;
            self.found = Found::Planned;
        }
        let spans = 4 + 4 * u64::from(tile_rows(frame.view)) * u64::from(self.light_count);
        if self.spans.reserve(device, spans)? || self.light_bind_group.is_none() {
            let buffers = [&self.view, &self.spans.buffer];
            let bound = bind(device, "umbrage light", &shared.light_layout, buffers);
            self.light_bind_group = Some(bound);
        }
        // Over the whole view, until receivers are found.
        queue.write_buffer(&self.spans.buffer, 0, bytemuck::bytes_of(&0u32));
        let generation = shared.quads_generation;
        let is_current = |volumes: &VolumeBindings| {
            volumes.generation == generation && !(caps.replaced || others.replaced)
        };
        let volumes = volumes.filter(is_current);
        self.volumes = Some(volumes.unwrap_or_else(|| self.bind_volumes(device, shared)));
        Ok(Uploaded {
            volume_bytes: caps.bytes,
            other_bytes: others.bytes + size_of::<ViewUniform>() as u64 + 4,
        })
    }

    fn bind_volumes(&self, device: &Device, shared: &SharedShadows) -> VolumeBindings {
        let kept = self.receivers.as_ref().map(|r| &r.kept_quads);
        let quads = [&shared.quads, kept.unwrap_or(&shared.quads)];
        let windows = shared.quads.buffers().len().max(self.caps.buffers().len());
        let window = |quads: &Split, number| {
            let [lights, distances] = [&self.lights, &self.distances].map(|list| &list.buffer);
            let buffers = [
                quads.buffer(number),
                self.caps.buffer(number),
                lights,
                distances,
            ];
            bind(device, "umbrage volume", &shared.layout, buffers)
        };
        VolumeBindings {
            generation: shared.quads_generation,
            windows: quads.map(|quads| (0..windows).map(|number| window(quads, number)).collect()),
        }
    }

    /// Finds out from the host's finished depth buffer which lights reach visible surface, and
    /// which of their quads matter for it; [`ViewShadows::record`] then draws no more than
    /// that. Record it between the depth pass and the light pass. Does nothing where the device has
    /// no `INDIRECT_FIRST_INSTANCE`, with more than one sample a pixel, or if the frame's culls
    /// want neither.
    ///
    /// `depth` is a depth-only view of the texture, which has `TEXTURE_BINDING` among its usages and
    /// contains the view that was prepared. What is not in it (glass, fog) counts for nothing: a
    /// light that reaches only such is not drawn.
    pub fn find_receivers(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        shared: &SharedShadows,
        depth: &TextureView,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let (Some(receivers), Some(pipelines)) = (&self.receivers, &shared.receivers) else {
            return;
        };
        if self.found == Found::No || self.light_count == 0 {
            return;
        }
        let Some((_, world)) = &self.world else {
            return;
        };
        let inputs = Inputs {
            pipelines,
            world,
            quads: &shared.quads,
            spans: &self.spans.buffer,
            depth,
        };
        let (size, lights) = (self.size, self.light_count);
        receivers.record(device, encoder, &inputs, size, lights, timestamps);
        self.found = Found::Yes;
    }

    /// What `umbrage_light_corner` reads; `None` before [`ViewShadows::prepare`], which may
    /// replace it.
    pub fn light_bind_group(&self) -> Option<&BindGroup> {
        self.light_bind_group.as_ref()
    }

    /// What [`SharedShadows::world_wgsl`] reads, for the host's depth pass: the world, and the
    /// view of the last [`ViewShadows::prepare`], which may replace it; `None` before.
    pub fn world_bind_group(&self) -> Option<&BindGroup> {
        self.world.as_ref().map(|(_, bind_group)| bind_group)
    }

    /// `struct View` of [`CLIP_WGSL`](crate::CLIP_WGSL), as of the last [`ViewShadows::prepare`].
    pub fn view_buffer(&self) -> &Buffer {
        &self.view
    }

    /// The [`LightCalls`](crate::LightCalls) of this frame, one a light and then one a further part,
    /// if receivers were found; entries of lights that the plan skips mean nothing. Where quads or
    /// caps are more than one binding holds, there is a buffer for each window of them: sides and
    /// caps are those in the window, all else is the same in each.
    pub fn calls(&self) -> Option<impl Iterator<Item = &Buffer>> {
        let receivers = self.receivers.as_ref()?;
        (self.found == Found::Yes).then(|| receivers.calls())
    }
}

/// As the volume shader takes it: 0 for infinity, which WGSL does not promise to keep.
fn shader_distance(light: &LightPlan) -> f32 {
    match light.extrusion_m.is_finite() {
        true => light.extrusion_m,
        false => 0.0,
    }
}

/// Buffers, from binding 0 on.
fn bind<const N: usize>(
    device: &Device,
    label: &str,
    layout: &BindGroupLayout,
    buffers: [&Buffer; N],
) -> BindGroup {
    let mut binding = 0..;
    let entries = buffers.map(|buffer| wgpu::BindGroupEntry {
        binding: binding.next().unwrap_or_default(),
        resource: buffer.as_entire_binding(),
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}
