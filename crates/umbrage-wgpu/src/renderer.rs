//! Create, prepare, record.

use umbrage_core::Light;
use umbrage_core::cull::Cull;
use umbrage_core::frame::{Extrusion, FramePlan, LightPath, LightPlan, PartPlan};
use umbrage_core::volume::Version;
use umbrage_core::world::World;
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, BufferUsages, CommandEncoder, CompareFunction,
    DepthBiasState, DepthStencilState, Device, Queue, RenderPass, ShaderStages, StencilFaceState,
    StencilOperation, StencilState, TextureFormat, TextureView,
};

use crate::buffers::Growing;
use crate::host::{Frame, RenderError, RendererOptions, Uploaded, ViewUniform};
use crate::pipelines::{Pipelines, SHADOW_BIT};
use crate::receivers::{Inputs, LightCalls, Receivers, list_window, tile_rows, within};
use crate::split::Split;
use crate::windows::WorldWindows;
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
    quads: Split,
    /// Which quads that buffer holds.
    quads_version: Version,
    caps: Split,
    /// Quads or caps that one window of their lists holds.
    list_window: usize,
    lights: Growing,
    /// How far each is extruded; unused if the renderer was made for infinite volumes.
    distances: Growing,
    extrusion: Extrusion,
    /// Lights, and parts beyond the first of each.
    light_count: u32,
    world: WorldBuffers,
    /// With all quads, and with those that the receivers keep; of each window of quads and caps.
    bind_groups: Option<[Vec<BindGroup>; 2]>,
    receivers: Option<Receivers>,
    found: Found,
    /// Where lights are drawn: `UmbrageSpans` of the shaders.
    spans: Growing,
    light_layout: BindGroupLayout,
    light_bind_group: Option<BindGroup>,
    depth_stencil_format: TextureFormat,
}

/// The quads and caps of one light or part.
struct Draws<'a> {
    /// Of its calls, and the instance it is drawn as.
    number: u32,
    quads: &'a std::ops::Range<u32>,
    caps: [&'a std::ops::Range<u32>; 2],
}

impl<'a> Draws<'a> {
    fn of_part(part: &'a PartPlan) -> Self {
        Self {
            number: part.number,
            quads: &part.quads,
            caps: [&part.caps, &part.reversed_caps],
        }
    }
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
        let world = WorldBuffers::new(device, options.windows)?;
        let list_window = list_window(device);
        let list = |label| Split::open(device, label, 4 * list_window, BufferUsages::empty());
        let growing = |label| Growing::new(device, label, BufferUsages::empty());
        Ok(Self {
            pipelines: Pipelines::new(device, options, [&layout, &world.layout], &world.wgsl(1)),
            view: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("umbrage view"),
                size: size_of::<ViewUniform>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            view_size: [0; 2],
            quads: list("umbrage quads")?,
            quads_version: Version::default(),
            caps: list("umbrage caps")?,
            list_window,
            lights: growing("umbrage lights")?,
            distances: growing("umbrage distances")?,
            extrusion: options.extrusion,
            light_count: 0,
            bind_groups: None,
            layout,
            receivers: Receivers::new(device, options.sample_count, &world)?,
            world,
            found: Found::No,
            spans: growing("umbrage spans")?,
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
        let mut homogeneous: Vec<[[f32; 4]; 2]> =
            frame.lights.iter().map(Light::homogeneous_f32).collect();
        let further: Vec<usize> = frame.plan.further_parts().map(|(light, _)| light).collect();
        homogeneous.extend(
            further
                .iter()
                .map(|&light| frame.lights[light].homogeneous_f32()),
        );
        let view = ViewUniform::from(frame.view);
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        self.view_size = frame.view.size;
        self.light_count = (frame.lights.len().min(frame.plan.lights.len()) + further.len()) as u32;
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
            self.light_bind_group = Some(self.bind_light(device));
        }
        // Over the whole view, until receivers are found.
        queue.write_buffer(&self.spans.buffer, 0, bytemuck::bytes_of(&0u32));
        self.bind_groups = bind_groups.filter(|_| !(volumes.replaced || others.replaced));
        if self.bind_groups.is_none() {
            let kept = self.receivers.as_ref().map(|r| &r.kept_quads);
            let quads = [&self.quads, kept.unwrap_or(&self.quads)];
            let windows = self.quads.buffers().len().max(self.caps.buffers().len());
            let bind = |quads: &Split| -> Vec<BindGroup> {
                let each = (0..windows).map(|number| self.bind(device, quads, number));
                each.collect()
            };
            self.bind_groups = Some(quads.map(bind));
        }
        Ok(Uploaded {
            volume_bytes: volumes.bytes,
            other_bytes: others.bytes + size_of::<ViewUniform>() as u64 + 4,
        })
    }

    /// For the quads and caps in window `number` of their lists.
    fn bind(&self, device: &Device, quads: &Split, number: usize) -> BindGroup {
        let [lights, distances] = [&self.lights, &self.distances].map(|growing| &growing.buffer);
        let (quads, caps) = (quads.buffer(number), self.caps.buffer(number));
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
            quads: &self.quads,
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
        let end = lights.end.min(plan.lights.len());
        let of_range = lights.start.min(end)..end;
        for (number, light) in of_range.clone().zip(&plan.lights[of_range]) {
            if light.is_skipped() || light.scissor.is_empty() {
                continue;
            }
            let s = light.scissor;
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            let counted = match light.parts.is_empty() {
                true => {
                    let counters = &self.pipelines.whole;
                    self.draw_volume(pass, number, light, counters.sides(), counters.caps())
                }
                false => {
                    self.draw_parts(pass, number, light);
                    true
                }
            };
            pass.set_stencil_reference(u32::from(light.stencil_reference));
            draw_light(pass, number, light);
            if let Some(calls) = self.calls().filter(|_| counted) {
                pass.set_pipeline(&self.pipelines.clean);
                pass.set_bind_group(0, &bind_groups[1][0], &[]);
                pass.set_bind_group(1, world, &[]);
                for calls in calls {
                    pass.draw_indirect(calls, number as u64 * LightCalls::SIZE + LightCalls::CLEAN);
                }
            }
        }
    }

    /// Counts a light's parts in the stencil, one after the other.
    fn draw_parts(&self, pass: &mut RenderPass<'_>, number: usize, light: &LightPlan) {
        let counters = &self.pipelines.part;
        for (i, part) in light.parts.iter().enumerate() {
            let draws = Draws::of_part(part);
            self.draw(pass, &draws, light.path, counters.sides(), counters.caps());
            if i + 1 == light.parts.len() {
                break;
            }
            pass.set_pipeline(&self.pipelines.join);
            pass.set_stencil_reference(SHADOW_BIT | u32::from(part.reference));
            match self.calls() {
                // Whoever joins twice changes nothing the second time.
                Some(calls) => {
                    let at = number as u64 * LightCalls::SIZE + LightCalls::CLEAN;
                    calls.for_each(|calls| pass.draw_indirect(calls, at));
                }
                None => pass.draw(0..3, 0..1),
            }
        }
    }

    /// Draws a light's quads and caps over the scissor that is set, those of all its parts alike,
    /// with `sides` for z-pass and for z-fail, and all of `caps` for triangles taken as wound and for
    /// those taken reversed; false if it has none.
    pub(crate) fn draw_volume(
        &self,
        pass: &mut RenderPass<'_>,
        number: usize,
        light: &LightPlan,
        sides: [&wgpu::RenderPipeline; 2],
        caps: [&[wgpu::RenderPipeline]; 2],
    ) -> bool {
        if light.parts.is_empty() {
            let draws = Draws {
                number: number as u32,
                quads: &light.quads,
                caps: [&light.caps, &light.reversed_caps],
            };
            return self.draw(pass, &draws, light.path, sides, caps);
        }
        let mut counted = false;
        for part in &light.parts {
            counted |= self.draw(pass, &Draws::of_part(part), light.path, sides, caps);
        }
        counted
    }

    fn draw(
        &self,
        pass: &mut RenderPass<'_>,
        draws: &Draws<'_>,
        path: LightPath,
        sides: [&wgpu::RenderPipeline; 2],
        caps: [&[wgpu::RenderPipeline]; 2],
    ) -> bool {
        let (Some(bind_groups), Some(world)) = (&self.bind_groups, &self.world.bind_group) else {
            return false;
        };
        let calls: Option<Vec<&Buffer>> = self.calls().map(Iterator::collect);
        let bind_groups = &bind_groups[usize::from(calls.is_some())];
        let sides = match path {
            LightPath::ZPass { .. } => sides[0],
            _ => sides[1],
        };
        let mut counted = false;
        // Whatever is drawn next has its bind groups set.
        pass.set_bind_group(0, &bind_groups[0], &[]);
        pass.set_bind_group(1, world, &[]);
        for (range, pipelines, offset) in [
            (draws.quads, std::slice::from_ref(sides), LightCalls::SIDES),
            (draws.caps[0], caps[0], LightCalls::CAPS),
            (draws.caps[1], caps[1], LightCalls::REVERSED_CAPS),
        ] {
            if range.is_empty() {
                continue;
            }
            counted = true;
            let first = range.start as usize / self.list_window;
            let last = (range.end as usize - 1) / self.list_window;
            for pipeline in pipelines {
                pass.set_pipeline(pipeline);
                for (window, bind_group) in (first..=last).zip(&bind_groups[first..]) {
                    pass.set_bind_group(0, bind_group, &[]);
                    match &calls {
                        Some(calls) => {
                            let at = u64::from(draws.number) * LightCalls::SIZE + offset;
                            pass.draw_indirect(calls[window], at);
                        }
                        None => {
                            let range = within(range, window, self.list_window);
                            let instance = draws.number..draws.number + 1;
                            pass.draw(6 * range.start..6 * range.end, instance);
                        }
                    }
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
        match self.calls().and_then(|mut calls| calls.next()) {
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

    /// The [`LightCalls`] of this frame, one a light and then one a further part, if receivers were
    /// found; entries of lights that the plan skips mean nothing. Where quads or caps are more than
    /// one binding holds, there is a buffer for each window of them: sides and caps are those in the window, all else is the
    /// same in each.
    pub fn calls(&self) -> Option<impl Iterator<Item = &Buffer>> {
        let receivers = self.receivers.as_ref()?;
        (self.found == Found::Yes).then(|| receivers.calls())
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

    /// WGSL through which shaders read the world: `umbrage_position(vertex)`, `umbrage_edge(edge)`,
    /// `umbrage_corner(corner)`, `umbrage_from_eye(vertex)` and more. Goes with
    /// [`CLIP_WGSL`](crate::CLIP_WGSL), has the view as `umbrage_world_view`, and reads
    /// [`ShadowRenderer::world_bind_group`] at bind group number `group`.
    pub fn world_wgsl(&self, group: u32) -> String {
        self.world.wgsl(group)
    }

    /// In how many windows the world is.
    pub fn world_windows(&self) -> WorldWindows {
        self.world.windows
    }

    /// Layout of what [`ShadowRenderer::world_wgsl`] reads, in vertex and compute shaders.
    pub fn world_bind_group_layout(&self) -> &BindGroupLayout {
        &self.world.layout
    }

    /// What [`ShadowRenderer::world_wgsl`] reads, for the host's depth pass: the world, and the
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
    let types = [(storage, ShaderStages::VERTEX); 4];
    buffers_layout(device, "umbrage volume", types)
}

/// View, spans.
fn light_layout(device: &Device) -> BindGroupLayout {
    let stages = ShaderStages::VERTEX | ShaderStages::COMPUTE;
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    let types = [wgpu::BufferBindingType::Uniform, storage];
    buffers_layout(device, "umbrage light", types.map(|ty| (ty, stages)))
}

/// Of buffers, each with the stages that read it, from binding 0 on.
pub(crate) fn buffers_layout(
    device: &Device,
    label: &str,
    types: impl IntoIterator<Item = (wgpu::BufferBindingType, ShaderStages)>,
) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, (ty, visibility))| wgpu::BindGroupLayoutEntry {
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
