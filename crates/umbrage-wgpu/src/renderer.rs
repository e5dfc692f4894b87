//! Create, prepare, record.

use umbrage_core::Light;
use umbrage_core::cull::Cull;
use umbrage_core::frame::{Extrusion, FramePlan, LightPath, LightPlan};
use umbrage_core::volume::Version;
use umbrage_core::world::World;
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, CompareFunction,
    DepthBiasState, DepthStencilState, Device, Queue, RenderPass, ShaderStages, StencilFaceState,
    StencilOperation, StencilState, TextureFormat, TextureView,
};

use crate::buffers::Growing;
use crate::host::{Frame, RenderError, RendererOptions, Uploaded, ViewUniform};
use crate::pipelines::Pipelines;
use crate::receivers::{Inputs, LightCalls, Receivers, tile_rows};
use crate::world::WorldBuffers;

/// The stencil state of a host's light draw: passes where lit, and leaves zero behind.
pub const LIGHT_STENCIL: StencilFaceState = StencilFaceState {
    compare: CompareFunction::Equal,
    fail_op: StencilOperation::Zero,
    depth_fail_op: StencilOperation::Zero,
    pass_op: StencilOperation::Zero,
};

/// Draws volumes into the stencil of a host's pass, light after light.
#[derive(Debug)]
pub struct ShadowRenderer {
    pub(crate) pipelines: Pipelines,
    layout: BindGroupLayout,
    view: Buffer,
    view_size: [u32; 2],
    quads: Growing,
    /// Which quads that buffer holds.
    quads_version: Version,
    caps: Growing,
    lights: Growing,
    /// How far each is extruded; unused if the renderer was made for infinite volumes.
    distances: Growing,
    extrusion: Extrusion,
    light_count: u32,
    world: WorldBuffers,
    /// With all quads, and with those that the receivers keep.
    bind_groups: Option<[BindGroup; 2]>,
    receivers: Option<Receivers>,
    found: Found,
    /// Where lights are drawn: `UmbrageSpans` of the shaders.
    spans: Growing,
    light_layout: BindGroupLayout,
    light_bind_group: Option<BindGroup>,
    depth_stencil_format: TextureFormat,
}

/// How far the receivers of this frame are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found {
    /// Not asked for.
    No,
    /// The plan is uploaded; the depth buffer was not looked at yet.
    Planned,
    /// Draws are indirect.
    Yes,
}

impl ShadowRenderer {
    /// Creates pipelines and empty buffers.
    pub fn new(device: &Device, options: &RendererOptions<'_>) -> Result<Self, RenderError> {
        if !options.depth_stencil_format.has_stencil_aspect() {
            return Err(RenderError::NoStencil(options.depth_stencil_format));
        }
        let layout = bind_group_layout(device);
        let world = WorldBuffers::new(device);
        let growing = |label| Growing::new(device, label, BufferUsages::empty());
        Ok(Self {
            pipelines: Pipelines::new(device, options, [&layout, &world.layout]),
            view: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("umbrage view"),
                size: size_of::<ViewUniform>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            view_size: [0; 2],
            quads: growing("umbrage quads"),
            quads_version: Version::default(),
            caps: growing("umbrage caps"),
            lights: growing("umbrage lights"),
            distances: growing("umbrage distances"),
            extrusion: options.extrusion,
            light_count: 0,
            bind_groups: None,
            layout,
            receivers: Receivers::new(device, options.sample_count, &world.layout),
            world,
            found: Found::No,
            spans: growing("umbrage spans"),
            light_layout: light_layout(device),
            light_bind_group: None,
            depth_stencil_format: options.depth_stencil_format,
        })
    }

    /// Brings positions, edges and triangles on the GPU up to date: everything for a world not
    /// seen yet, later what objects changed. True if [`ShadowRenderer::world_bind_group`] was
    /// replaced.
    pub fn upload_world(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<bool, RenderError> {
        self.world.update(device, queue, world, &self.view)
    }

    /// Uploads what this frame's plan draws and the GPU does not have yet. One call a submission:
    /// what the queue is given here arrives before everything recorded in it, so two views need two
    /// submissions, or two renderers.
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        frame: &Frame<'_>,
    ) -> Result<Uploaded, RenderError> {
        if !self.world.is_filled() {
            return Err(RenderError::NoWorld);
        }
        let homogeneous: Vec<[[f32; 4]; 2]> =
            frame.lights.iter().map(Light::homogeneous_f32).collect();
        let view = ViewUniform::new(frame.view, self.world.vertex_floats());
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        self.view_size = frame.view.size;
        self.light_count = frame.lights.len().min(frame.plan.lights.len()) as u32;
        let quads = &frame.volumes.quads;
        let item = size_of_val(&quads[..])
            .checked_div(quads.len())
            .unwrap_or(0);
        let changed = frame.volumes.quads_since(self.quads_version);
        let changed = changed.map(|r| r.start * item..r.end * item);
        let bytes = bytemuck::cast_slice(quads);
        self.found = Found::No;
        // Made again below unless no buffer is replaced; an error leaves none behind.
        let bind_groups = self.bind_groups.take();
        let mut volumes = self.quads.write_changed(device, queue, bytes, changed)?;
        self.quads_version = frame.volumes.quads_version();
        let caps = bytemuck::cast_slice(&frame.plan.caps);
        volumes += self.caps.write(device, queue, caps)?;
        let points = bytemuck::cast_slice(&homogeneous);
        let mut others = self.lights.write(device, queue, points)?;
        if self.extrusion != Extrusion::Infinite {
            let distances: Vec<f32> = frame.plan.lights.iter().map(shader_distance).collect();
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
            self.light_bind_group = Some(self.bind_light(device));
        }
        // Over the whole view, until receivers are found.
        queue.write_buffer(&self.spans.buffer, 0, bytemuck::bytes_of(&0u32));
        self.bind_groups = bind_groups.filter(|_| !(volumes.replaced || others.replaced));
        if self.bind_groups.is_none() {
            let kept = self.receivers.as_ref().map(|r| &r.kept_quads);
            let quads = [&self.quads, kept.unwrap_or(&self.quads)];
            self.bind_groups = Some(quads.map(|quads| self.bind(device, &quads.buffer)));
        }
        Ok(Uploaded {
            volume_bytes: volumes.bytes,
            other_bytes: others.bytes + size_of::<ViewUniform>() as u64 + 4,
        })
    }

    fn bind(&self, device: &Device, quads: &Buffer) -> BindGroup {
        let [caps, lights, distances] =
            [&self.caps, &self.lights, &self.distances].map(|growing| &growing.buffer);
        let buffers = [(0, quads), (1, caps), (2, lights), (3, distances)];
        let entries = buffers.map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        });
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage volume"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    fn bind_light(&self, device: &Device) -> BindGroup {
        let entries = [(0, &self.view), (1, &self.spans.buffer)].map(|(binding, buffer)| {
            wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            }
        });
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage light"),
            layout: &self.light_layout,
            entries: &entries,
        })
    }

    /// Finds out from the host's finished depth buffer which lights reach visible surface, and
    /// which of their quads matter for it; [`ShadowRenderer::record`] then draws no more than
    /// that. Record it between the depth pass and the light pass. Does nothing where the device has
    /// no `INDIRECT_FIRST_INSTANCE`, with more than one sample a pixel, or if the frame's culls
    /// want neither.
    ///
    /// `depth` is a depth-only view of the texture, which has `TEXTURE_BINDING` among its usages and
    /// the size of the view that was prepared. What is not in it (glass, fog) counts for nothing: a
    /// light that reaches only such is not drawn.
    pub fn find_receivers(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        depth: &TextureView,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let Some(receivers) = &self.receivers else {
            return;
        };
        if self.found == Found::No || self.light_count == 0 {
            return;
        }
        let Some(world) = &self.world.bind_group else {
            return;
        };
        let inputs = Inputs {
            world,
            quads: &self.quads.buffer,
            spans: &self.spans.buffer,
            depth,
        };
        let (size, lights) = (self.view_size, self.light_count);
        receivers.record(device, encoder, &inputs, size, lights, timestamps);
        self.found = Found::Yes;
    }

    /// Records the volumes of the plan's lights numbered `lights`, calling `draw_light` for each
    /// after its volume, with scissor and stencil reference set. There the host sets a pipeline
    /// made with [`ShadowRenderer::light_depth_stencil`] and its bind groups, and calls
    /// [`ShadowRenderer::draw_light`]. The stencil is zero again after each light.
    pub fn record(
        &self,
        pass: &mut RenderPass<'_>,
        plan: &FramePlan,
        lights: std::ops::Range<usize>,
        mut draw_light: impl FnMut(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let (Some(bind_groups), Some(world)) = (&self.bind_groups, &self.world.bind_group) else {
            return;
        };
        let calls = self.calls();
        let bind_group = &bind_groups[usize::from(calls.is_some())];
        let end = lights.end.min(plan.lights.len());
        let of_range = lights.start.min(end)..end;
        for (number, light) in of_range.clone().zip(&plan.lights[of_range]) {
            if light.is_skipped() || light.scissor.is_empty() {
                continue;
            }
            let s = light.scissor;
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            let p = &self.pipelines;
            let sides = [&p.zpass_sides, &p.zfail_sides];
            let counted = self.draw_volume(
                pass,
                number,
                light,
                sides,
                [&p.zfail_caps, &p.zfail_reversed_caps],
            );
            pass.set_stencil_reference(u32::from(light.stencil_reference));
            draw_light(pass, number, light);
            if let Some(calls) = calls.filter(|_| counted) {
                pass.set_pipeline(&self.pipelines.clean);
                pass.set_bind_group(0, bind_group, &[]);
                pass.set_bind_group(1, world, &[]);
                pass.draw_indirect(calls, number as u64 * LightCalls::SIZE + LightCalls::CLEAN);
            }
        }
    }

    /// Draws a light's quads and caps over the scissor that is set, with `sides` for z-pass and for
    /// z-fail, and `caps` for triangles taken as wound and for those taken reversed; false if it has
    /// none.
    pub(crate) fn draw_volume(
        &self,
        pass: &mut RenderPass<'_>,
        number: usize,
        light: &LightPlan,
        sides: [&wgpu::RenderPipeline; 2],
        caps: [&wgpu::RenderPipeline; 2],
    ) -> bool {
        let (Some(bind_groups), Some(world)) = (&self.bind_groups, &self.world.bind_group) else {
            return false;
        };
        let calls = self.calls();
        let bind_group = &bind_groups[usize::from(calls.is_some())];
        let sides = match light.path {
            LightPath::ZPass { .. } => sides[0],
            _ => sides[1],
        };
        let mut counted = false;
        for (range, pipeline, offset) in [
            (&light.quads, sides, LightCalls::SIDES),
            (&light.caps, caps[0], LightCalls::CAPS),
            (&light.reversed_caps, caps[1], LightCalls::REVERSED_CAPS),
        ] {
            if range.is_empty() {
                continue;
            }
            counted = true;
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind_group, &[]);
            pass.set_bind_group(1, world, &[]);
            match calls {
                Some(calls) => {
                    pass.draw_indirect(calls, number as u64 * LightCalls::SIZE + offset);
                }
                None => {
                    let instance = number as u32..number as u32 + 1;
                    pass.draw(6 * range.start..6 * range.end, instance);
                }
            }
        }
        counted
    }

    /// The draw of light number `light` for the host's own pipeline and bind groups; the instance
    /// index is the light's number, and the vertex shader places its vertices with
    /// `umbrage_light_corner` of [`light_wgsl`](crate::light_wgsl), as a list of counter-clockwise
    /// triangles. Draws nothing if the light reaches no visible surface.
    pub fn draw_light(&self, pass: &mut RenderPass<'_>, light: usize) {
        match self.calls() {
            Some(calls) => {
                pass.draw_indirect(calls, light as u64 * LightCalls::SIZE + LightCalls::LIGHT);
            }
            None => pass.draw(0..3, light as u32..light as u32 + 1),
        }
    }

    /// Layout of what `umbrage_light_corner` reads.
    pub fn light_bind_group_layout(&self) -> &BindGroupLayout {
        &self.light_layout
    }

    /// What `umbrage_light_corner` reads; `None` before [`ShadowRenderer::prepare`], which may
    /// replace it.
    pub fn light_bind_group(&self) -> Option<&BindGroup> {
        self.light_bind_group.as_ref()
    }

    /// The [`LightCalls`] of this frame, one a light, if receivers were found; entries of lights
    /// that the plan skips mean nothing.
    pub fn calls(&self) -> Option<&Buffer> {
        let receivers = self.receivers.as_ref()?;
        (self.found == Found::Yes).then_some(&receivers.calls.buffer)
    }

    /// Depth and stencil state for the host's light draws: passes where the light's volume left
    /// the reference, and zeroes the stencil for the next light either way.
    pub fn light_depth_stencil(&self) -> DepthStencilState {
        DepthStencilState {
            format: self.depth_stencil_format,
            depth_write_enabled: Some(false),
            depth_compare: Some(CompareFunction::Always),
            stencil: StencilState {
                front: LIGHT_STENCIL,
                back: LIGHT_STENCIL,
                read_mask: 0xff,
                write_mask: 0xff,
            },
            bias: DepthBiasState::default(),
        }
    }

    /// Layout of what [`world_wgsl`](crate::world_wgsl) reads, in vertex and compute shaders.
    pub fn world_bind_group_layout(&self) -> &BindGroupLayout {
        &self.world.layout
    }

    /// What [`world_wgsl`](crate::world_wgsl) reads, for the host's depth pass: the world, and the
    /// view of the last [`ShadowRenderer::prepare`]. `None` before
    /// [`ShadowRenderer::upload_world`], which may replace it.
    pub fn world_bind_group(&self) -> Option<&BindGroup> {
        self.world.bind_group.as_ref()
    }

    /// Bytes that positions, edges and triangles take on the GPU.
    pub fn world_bytes(&self) -> u64 {
        self.world.bytes()
    }

    /// The [`ViewUniform`] of the last [`ShadowRenderer::prepare`].
    pub fn view_buffer(&self) -> &Buffer {
        &self.view
    }
}

/// As the volume shader takes it: 0 for infinity, which WGSL does not promise to keep.
fn shader_distance(light: &LightPlan) -> f32 {
    match light.extrusion_m.is_finite() {
        true => light.extrusion_m,
        false => 0.0,
    }
}

/// Quads, caps, lights, distances.
fn bind_group_layout(device: &Device) -> BindGroupLayout {
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    buffers_layout(device, "umbrage volume", ShaderStages::VERTEX, [storage; 4])
}

/// View, spans.
fn light_layout(device: &Device) -> BindGroupLayout {
    let stages = ShaderStages::VERTEX | ShaderStages::COMPUTE;
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let types = [wgpu::BufferBindingType::Uniform, storage];
    buffers_layout(device, "umbrage light", stages, types)
}

fn buffers_layout<const N: usize>(
    device: &Device,
    label: &str,
    visibility: ShaderStages,
    types: [wgpu::BufferBindingType; N],
) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}
