//! Receivers: which lights reach visible surface, and which quads can matter for it, found on the
//! GPU from the host's depth buffer.
//!
//! Takes a plan's lights and quads; gives the arguments of indirect draws and, light by light, the
//! quads that are left. Needs indirect draws that may begin with any instance, and one sample a
//! pixel; without them every light of the plan is drawn whole.

use std::borrow::Cow;
use std::mem::offset_of;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use umbrage_core::cull::{Cull, Culls};
use umbrage_core::frame::{LightPath, LightPlan, PartPlan};
use umbrage_core::{Light, LightShape, View};
use wgpu::{
    BindGroup, BindGroupLayout, BindingType, Buffer, BufferBindingType, BufferUsages,
    ComputePipeline, Device, Queue, ShaderStages, TextureView,
};

use crate::buffers::{Growing, Written, binding_limit};
use crate::split::Split;
use crate::windows::shift_of;
use crate::world::WorldBuffers;
use crate::{CLIP_WGSL, Frame, RenderError};

/// The indirect calls of one light, as the shader writes them.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct LightCalls {
    /// Silhouette quads, six vertices each.
    pub sides: Call,
    /// Caps of triangles taken as wound.
    pub caps: Call,
    /// Caps of triangles taken with reversed winding.
    pub reversed_caps: Call,
    /// The host's light draw: six vertices a row of tiles.
    pub light: Call,
    /// The draw that zeroes the stencil: three vertices, if there is a volume. Of a light in parts
    /// also the draw between them.
    pub clean: Call,
}

/// Arguments of an indirect draw.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Call {
    /// Vertices drawn.
    pub vertex_count: u32,
    /// 1, or 0 for a light that reaches no visible surface.
    pub instance_count: u32,
    /// First vertex.
    pub first_vertex: u32,
    /// The light's number.
    pub first_instance: u32,
}

impl LightCalls {
    pub(crate) const SIDES: u64 = offset_of!(Self, sides) as u64;
    pub(crate) const CAPS: u64 = offset_of!(Self, caps) as u64;
    pub(crate) const REVERSED_CAPS: u64 = offset_of!(Self, reversed_caps) as u64;
    pub(crate) const LIGHT: u64 = offset_of!(Self, light) as u64;
    pub(crate) const CLEAN: u64 = offset_of!(Self, clean) as u64;
    pub(crate) const SIZE: u64 = size_of::<Self>() as u64;
}

/// `struct LightPlan` of the shader.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct PlanUniform {
    homogeneous: [f32; 4],
    residual: [f32; 4],
    axis: [f32; 3],
    cos_outer: f32,
    tiles: [u32; 4],
    quads: [u32; 2],
    caps: [u32; 2],
    reversed_caps: [u32; 2],
    range: f32,
    path: u32,
}

/// A range beyond anything, whose square is finite.
const FARTHEST: f32 = 1e18;

/// Pixels a tile is wide and high; known to the shaders.
const TILE: u32 = 8;

/// Rows of tiles in a view.
pub(crate) fn tile_rows(view: &View) -> u32 {
    view.size[1].div_ceil(TILE)
}

/// What finds receivers, in whatever view.
#[derive(Debug)]
pub(crate) struct ReceiverPipelines {
    surface: ComputePipeline,
    light: ComputePipeline,
    layout: BindGroupLayout,
}

/// The receivers of one view.
#[derive(Debug)]
pub(crate) struct Receivers {
    tiles: Growing,
    pub(crate) kept_quads: Split,
    /// A window of quads and caps each.
    windows: Vec<Window>,
}

/// What the shader is told and says of the quads and caps in one window of their lists.
#[derive(Debug)]
struct Window {
    plan: Growing,
    calls: Growing,
}

/// What the shader reads and does not own.
pub(crate) struct Inputs<'a> {
    pub(crate) pipelines: &'a ReceiverPipelines,
    pub(crate) world: &'a BindGroup,
    pub(crate) quads: &'a Split,
    pub(crate) spans: &'a Buffer,
    pub(crate) depth: &'a TextureView,
}

impl ReceiverPipelines {
    /// `None` where the device lacks what it takes.
    pub(crate) fn new(device: &Device, sample_count: u32, world: &WorldBuffers) -> Option<Self> {
        let features = device.features();
        if sample_count != 1 || !features.contains(wgpu::Features::INDIRECT_FIRST_INSTANCE) {
            return None;
        }
        let layout = bind_group_layout(device);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage receivers"),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(format!(
                "{CLIP_WGSL}\n{}\n{}",
                world.wgsl(1),
                include_str!("shaders/receivers.wgsl")
            ))),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage receivers"),
            bind_group_layouts: &[Some(&layout), Some(&world.layout)],
            immediate_size: 0,
        });
        let pipeline = |entry| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("umbrage receivers"),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        Some(Self {
            surface: pipeline("surface"),
            light: pipeline("light"),
            layout,
        })
    }
}

impl Receivers {
    pub(crate) fn new(device: &Device) -> Result<Self, RenderError> {
        let bytes = list_window(device) * 4;
        let none = BufferUsages::empty();
        Ok(Self {
            tiles: Growing::new(device, "umbrage tiles", none)?,
            kept_quads: Split::open(device, "umbrage kept quads", bytes, none)?,
            windows: Vec::new(),
        })
    }

    /// Of each window, the calls of each light.
    pub(crate) fn calls(&self) -> impl Iterator<Item = &Buffer> {
        self.windows.iter().map(|window| &window.calls.buffer)
    }

    /// Makes room, uploads the plan; the buffers' names change where `replaced` says so.
    pub(crate) fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        frame: &Frame<'_>,
    ) -> Result<Written, RenderError> {
        let quads = size_of_val(&frame.volumes.quads[..]);
        let mut written = self.kept_quads.reserve(device, quads)?;
        let [columns, rows] = frame.view.size.map(|side| u64::from(side.div_ceil(TILE)));
        written.replaced |= self.tiles.reserve(device, columns * rows * 32)?;
        let items = list_window(device);
        let longest = frame.volumes.quads.len().max(frame.plan.caps.len());
        let count = longest.div_ceil(items).max(1);
        self.windows.truncate(count);
        for number in 0..count {
            if number == self.windows.len() {
                let usage = BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
                self.windows.push(Window {
                    plan: Growing::new(device, "umbrage plan", BufferUsages::empty())?,
                    calls: Growing::new(device, "umbrage calls", usage)?,
                });
            }
            let lights = frame.lights.iter().zip(&frame.plan.lights);
            let within = |range: &Range<u32>| within(range, number, items);
            let mut uniforms: Vec<PlanUniform> = lights
                .map(|(light, plan)| {
                    PlanUniform::new(light, plan, plan.parts.first(), frame.culls, within)
                })
                .collect();
            uniforms.extend(frame.plan.further_parts().map(|(number, part)| {
                let (light, plan) = (&frame.lights[number], &frame.plan.lights[number]);
                PlanUniform::new(light, plan, Some(part), frame.culls, within)
            }));
            if uniforms.is_empty() {
                uniforms.push(PlanUniform::default());
            }
            let Window { plan, calls } = &mut self.windows[number];
            written += plan.write(device, queue, bytemuck::cast_slice(&uniforms))?;
            let bytes = uniforms.len() as u64 * LightCalls::SIZE;
            written.replaced |= calls.reserve(device, bytes)?;
        }
        Ok(written)
    }

    pub(crate) fn record(
        &self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        size: [u32; 2],
        lights: u32,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let mut bind_groups = (0..self.windows.len())
            .map(|number| self.bind(device, inputs, number, lights))
            .peekable();
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("umbrage receivers"),
            timestamp_writes,
        });
        pass.set_bind_group(1, inputs.world, &[]);
        pass.set_pipeline(&inputs.pipelines.surface);
        pass.set_bind_group(0, bind_groups.peek(), &[]);
        let [columns, rows] = size.map(|side| side.div_ceil(TILE * 8));
        pass.dispatch_workgroups(columns, rows, 1);
        pass.set_pipeline(&inputs.pipelines.light);
        let columns = lights.min(1 << 15);
        for bind_group in bind_groups {
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(columns, lights.div_ceil(columns.max(1)), 1);
        }
    }

    /// For the quads in window `number`.
    fn bind(&self, device: &Device, inputs: &Inputs<'_>, number: usize, lights: u32) -> BindGroup {
        let Window { plan, calls } = &self.windows[number];
        let plan = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &plan.buffer,
            offset: 0,
            size: wgpu::BufferSize::new(u64::from(lights) * size_of::<PlanUniform>() as u64),
        });
        let resources = [
            inputs.quads.buffer(number).as_entire_binding(),
            plan,
            self.tiles.buffer.as_entire_binding(),
            self.kept_quads.buffer(number).as_entire_binding(),
            calls.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(inputs.depth),
            inputs.spans.as_entire_binding(),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("umbrage receivers"),
            layout: &inputs.pipelines.layout,
            entries: &entries,
        })
    }
}

/// Quads or caps that a window of their list holds.
pub(crate) fn list_window(device: &Device) -> usize {
    1 << shift_of(binding_limit(&device.limits()).0, 4)
}

/// What of a range of quads or caps lies in window `number`, counted from the window's start.
pub(crate) fn within(range: &Range<u32>, number: usize, items: usize) -> Range<u32> {
    let from = |at: u32| (at as usize).clamp(number * items, (number + 1) * items);
    let counted = |at| (from(at) - number * items) as u32;
    counted(range.start)..counted(range.end)
}

impl PlanUniform {
    /// Of a light, or of a part of it; `within` cuts ranges to a window.
    fn new(
        light: &Light,
        plan: &LightPlan,
        part: Option<&PartPlan>,
        culls: Culls,
        within: impl Fn(&Range<u32>) -> Range<u32>,
    ) -> Self {
        let s = plan.scissor;
        let [quads, caps, reversed_caps] = match part {
            Some(part) => [&part.quads, &part.caps, &part.reversed_caps],
            None => [&plan.quads, &plan.caps, &plan.reversed_caps],
        };
        let ends = |range| {
            let Range { start, end } = within(range);
            [start, end]
        };
        let path = match plan.path {
            LightPath::Skipped(_) => 0,
            LightPath::ZPass { .. } => 1,
            LightPath::ZFail(_) => 2,
        };
        let unasked = |step, bit| if culls.has(step) { 0 } else { bit };
        let (axis, cos_outer) = match light.shape {
            LightShape::Spot {
                direction,
                cos_outer,
            } => (direction.to_array(), cos_outer),
            _ => ([0.0; 3], -1.0),
        };
        let [homogeneous, residual] = light.homogeneous_f32();
        Self {
            homogeneous,
            residual,
            axis,
            cos_outer,
            tiles: [
                s.x / TILE,
                s.y / TILE,
                (s.x + s.width).div_ceil(TILE),
                (s.y + s.height).div_ceil(TILE),
            ],
            quads: ends(quads),
            caps: ends(caps),
            reversed_caps: ends(reversed_caps),
            range: light.range.min(FARTHEST),
            path: path
                | unasked(Cull::Receivers, 4)
                | unasked(Cull::Quads, 8)
                | if part.is_some() { 16 } else { 0 },
        }
    }
}

fn bind_group_layout(device: &Device) -> BindGroupLayout {
    let buffer = |ty| BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let storage = |read_only| buffer(BufferBindingType::Storage { read_only });
    let mut types = vec![storage(true); 2];
    types.extend([storage(false); 3]);
    types.push(BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    });
    types.push(storage(false));
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage receivers"),
        entries: &entries,
    })
}
