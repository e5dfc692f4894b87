//! What all views share: pipelines, the world, and every light's silhouette quads.

use umbrage_core::volume::{Version, Volumes};
use umbrage_core::world::World;
use wgpu::{
    BindGroupLayout, BufferUsages, CompareFunction, DepthBiasState, DepthStencilState, Device,
    Queue, ShaderStages, StencilFaceState, StencilOperation, StencilState, TextureFormat,
};

use crate::WorldWindows;
use crate::host::{RenderError, RendererOptions};
use crate::pipelines::{VolumePipelines, VolumeShader};
use crate::receivers::{ReceiverPipelines, list_window};
use crate::split::Split;
use crate::world::WorldBuffers;
use crate::{DepthRange, VolumeColor};

/// The stencil state of a host's light draw: passes where lit, and leaves zero behind.
pub const LIGHT_STENCIL: StencilFaceState = StencilFaceState {
    compare: CompareFunction::Equal,
    fail_op: StencilOperation::Zero,
    depth_fail_op: StencilOperation::Zero,
    pass_op: StencilOperation::Zero,
};

/// What the views of a host share; see [`ViewShadows`](crate::ViewShadows).
#[derive(Debug)]
pub struct SharedShadows {
    shader: VolumeShader,
    pub(crate) pipelines: VolumePipelines,
    pub(crate) layout: BindGroupLayout,
    pub(crate) light_layout: BindGroupLayout,
    pub(crate) world: WorldBuffers,
    pub(crate) quads: Split,
    /// Which quads that holds.
    quads_version: Version,
    /// Bind groups of another generation are of buffers that were replaced.
    pub(crate) quads_generation: u64,
    /// Quads or caps that one window of their lists holds.
    pub(crate) list_window: usize,
    pub(crate) receivers: Option<ReceiverPipelines>,
}

impl SharedShadows {
    /// Creates pipelines and empty buffers.
    ///
    /// # Errors
    /// If the format has no stencil, or there is no memory.
    pub fn new(device: &Device, options: &RendererOptions<'_>) -> Result<Self, RenderError> {
        if !options.depth_stencil_format.has_stencil_aspect() {
            return Err(RenderError::NoStencil(options.depth_stencil_format));
        }
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        // Quads, caps, lights, distances.
        let types = [(storage, ShaderStages::VERTEX); 4];
        let layout = buffers_layout(device, "umbrage volume", types);
        // View, spans.
        let types = [wgpu::BufferBindingType::Uniform, storage];
        let stages = ShaderStages::VERTEX_FRAGMENT | ShaderStages::COMPUTE;
        let light_layout = buffers_layout(device, "umbrage light", types.map(|ty| (ty, stages)));
        let world = WorldBuffers::new(device, options.windows)?;
        let shader = VolumeShader::new(device, options, [&layout, &world.layout], &world.wgsl(1));
        let (formats, color) = (options.color_formats, options.volume_color);
        let list_window = list_window(device);
        let none = BufferUsages::empty();
        Ok(Self {
            pipelines: VolumePipelines::new(device, &shader, formats, color),
            shader,
            layout,
            light_layout,
            quads: Split::open(device, "umbrage quads", 4 * list_window, none)?,
            quads_version: Version::default(),
            quads_generation: 0,
            list_window,
            receivers: ReceiverPipelines::new(device, options.sample_count, &world),
            world,
        })
    }

    /// Brings positions, edges and triangles on the GPU up to date: everything for a world not
    /// seen yet, later what objects changed.
    ///
    /// # Errors
    /// If the world is not one that the options allow for, or there is no memory.
    pub fn upload_world(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
    ) -> Result<(), RenderError> {
        self.world.update(device, queue, world)
    }

    /// Brings the quads on the GPU up to date, and gives the bytes handed to the queue.
    ///
    /// # Errors
    /// If the device's limits or its memory do not suffice.
    pub fn upload_volumes(
        &mut self,
        device: &Device,
        queue: &Queue,
        volumes: &Volumes,
    ) -> Result<u64, RenderError> {
        let item = size_of_val(&volumes.quads[..])
            .checked_div(volumes.quads.len())
            .unwrap_or(0);
        let changed = volumes.quads_since(self.quads_version);
        let changed = changed.map(|r| r.start * item..r.end * item);
        let bytes = bytemuck::cast_slice(&volumes.quads);
        let written = self.quads.write_changed(device, queue, bytes, changed);
        if written.as_ref().map_or(true, |written| written.replaced) {
            self.quads_generation += 1;
        }
        self.quads_version = match written {
            Ok(_) => volumes.quads_version(),
            Err(_) => Version::default(),
        };
        written.map(|written| written.bytes)
    }

    /// What draws volumes in passes with the options' colour targets.
    pub fn pipelines(&self) -> &VolumePipelines {
        &self.pipelines
    }

    /// What draws volumes in passes with other colour targets, and all else alike.
    pub fn pipelines_for(
        &self,
        device: &Device,
        color_formats: &[Option<TextureFormat>],
    ) -> VolumePipelines {
        VolumePipelines::new(device, &self.shader, color_formats, VolumeColor::None)
    }

    pub(crate) fn shader(&self) -> &VolumeShader {
        &self.shader
    }

    /// Which way the host's depth runs.
    pub fn depth(&self) -> DepthRange {
        self.shader.depth
    }

    /// Depth and stencil state for the host's light draws: passes where the light's volume left
    /// the reference, and zeroes the stencil for the next light either way.
    pub fn light_depth_stencil(&self) -> DepthStencilState {
        DepthStencilState {
            format: self.shader.depth_stencil_format,
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

    /// Layout of what `umbrage_light_corner` reads; the view in fragment shaders too.
    pub fn light_bind_group_layout(&self) -> &BindGroupLayout {
        &self.light_layout
    }

    /// WGSL through which shaders read the world: `umbrage_world_corner(corner)`,
    /// `umbrage_place(vertex)`, `umbrage_edge(edge)`, `umbrage_corner(corner)`,
    /// `umbrage_from_eye(vertex)` and more. Goes with
    /// [`CLIP_WGSL`](crate::CLIP_WGSL), has the view as `umbrage_world_view`, and reads
    /// [`ViewShadows::world_bind_group`](crate::ViewShadows::world_bind_group) at bind group number
    /// `group`.
    pub fn world_wgsl(&self, group: u32) -> String {
        self.world.wgsl(group)
    }

    /// In how many windows the world is.
    pub fn world_windows(&self) -> WorldWindows {
        self.world.windows
    }

    /// Layout of what [`SharedShadows::world_wgsl`] reads, in vertex and compute shaders; the view in
    /// fragment shaders too.
    pub fn world_bind_group_layout(&self) -> &BindGroupLayout {
        &self.world.layout
    }

    /// Bytes that positions, edges and triangles take on the GPU.
    pub fn world_bytes(&self) -> u64 {
        self.world.bytes()
    }
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
