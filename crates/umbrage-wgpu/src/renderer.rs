//! Create, prepare, record.

use bytemuck::{Pod, Zeroable};
use thiserror::Error;
use umbrage_core::frame::{FramePlan, LightPath, LightPlan};
use umbrage_core::volume::Volumes;
use umbrage_core::world::World;
use umbrage_core::{Light, View};
use wgpu::{
    BindGroup, BindGroupLayout, Buffer, CompareFunction, DepthBiasState, DepthStencilState, Device,
    Queue, RenderPass, ShaderStages, StencilFaceState, StencilOperation, StencilState,
    TextureFormat,
};

use crate::buffers::{Growing, storage};
use crate::pipelines::Pipelines;

/// What the host's frame looks like.
#[derive(Clone, Debug)]
pub struct RendererOptions<'a> {
    /// Colour targets of the pass given to [`ShadowRenderer::record`].
    pub color_formats: &'a [Option<TextureFormat>],
    /// Its depth-stencil format; must have a stencil.
    pub depth_stencil_format: TextureFormat,
    /// Its sample count.
    pub sample_count: u32,
    /// Whether the device has `DEPTH_CLIP_CONTROL`, and the host's depth pass uses it.
    pub depth_clamp: bool,
    /// What volumes write to the first colour target: nothing, but for debug views.
    pub volume_color: VolumeColor,
}

/// What volumes add to the first colour target, which must then be blendable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeColor {
    /// Nothing.
    #[default]
    None,
    /// One a fragment that passes the depth test: overdraw.
    Fragments,
    /// One a front face and minus one a back face that passes the depth test: on the z-pass path,
    /// with the eye count added, the casters between the surface and the light.
    Layers,
}

/// Why the renderer cannot do what it is asked.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum RenderError {
    /// The depth-stencil format has no stencil.
    #[error("{0:?} has no stencil: create the depth buffer as Depth32FloatStencil8")]
    NoStencil(TextureFormat),
    /// A buffer would pass a device limit.
    #[error(
        "{what} need {needed} bytes; this device binds at most {limit}: \
         request a higher max_storage_buffer_binding_size, or split the world"
    )]
    BufferTooLarge {
        /// Which buffer.
        what: &'static str,
        /// Bytes needed.
        needed: u64,
        /// Bytes the device allows.
        limit: u64,
    },
    /// `prepare` before `upload_world`.
    #[error("no world was uploaded: call upload_world first")]
    NoWorld,
}

/// The uniform behind `struct View` of [`CLIP_WGSL`](crate::CLIP_WGSL).
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ViewUniform {
    eye: [f32; 3],
    scale_x: f32,
    right: [f32; 3],
    scale_y: f32,
    up: [f32; 3],
    near: f32,
    forward: [f32; 3],
    width: f32,
}

impl From<&View> for ViewUniform {
    fn from(view: &View) -> Self {
        Self {
            eye: view.eye.to_array(),
            scale_x: view.scale_x,
            right: view.right.to_array(),
            scale_y: view.scale_y,
            up: view.up.to_array(),
            near: view.near,
            forward: view.forward.to_array(),
            width: view.size[0] as f32,
        }
    }
}

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
    pipelines: Pipelines,
    layout: BindGroupLayout,
    view: Buffer,
    quads: Growing,
    caps: Growing,
    lights: Growing,
    world: Option<WorldBuffers>,
    bind_group: Option<BindGroup>,
    depth_stencil_format: TextureFormat,
}

/// The static geometry, for the host's own passes too.
#[derive(Debug)]
struct WorldBuffers {
    positions: Buffer,
    edges: Buffer,
    triangles: Buffer,
}

impl ShadowRenderer {
    /// Creates pipelines and empty buffers.
    pub fn new(device: &Device, options: &RendererOptions<'_>) -> Result<Self, RenderError> {
        if !options.depth_stencil_format.has_stencil_aspect() {
            return Err(RenderError::NoStencil(options.depth_stencil_format));
        }
        let layout = bind_group_layout(device);
        Ok(Self {
            pipelines: Pipelines::new(device, options, &layout),
            view: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("umbrage view"),
                size: size_of::<ViewUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            quads: Growing::new(device, "umbrage quads"),
            caps: Growing::new(device, "umbrage caps"),
            lights: Growing::new(device, "umbrage lights"),
            world: None,
            bind_group: None,
            layout,
            depth_stencil_format: options.depth_stencil_format,
        })
    }

    /// Uploads positions, edges and triangles; once a world.
    pub fn upload_world(&mut self, device: &Device, world: &World) -> Result<(), RenderError> {
        let buffer = |label, bytes| storage(device, label, bytes);
        self.world = Some(WorldBuffers {
            positions: buffer("umbrage positions", bytemuck::cast_slice(&world.positions))?,
            edges: buffer("umbrage edges", bytemuck::cast_slice(&world.edges.vertices))?,
            triangles: buffer("umbrage triangles", bytemuck::cast_slice(&world.triangles))?,
        });
        self.bind_group = None;
        Ok(())
    }

    /// Uploads what this frame's plan draws; gives the bytes written.
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        view: &View,
        lights: &[Light],
        volumes: &Volumes,
        plan: &FramePlan,
    ) -> Result<u64, RenderError> {
        let world = self.world.as_ref().ok_or(RenderError::NoWorld)?;
        let homogeneous: Vec<[f32; 4]> = lights.iter().map(Light::homogeneous).collect();
        let view = ViewUniform::from(view);
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        let quads: &[u8] = bytemuck::cast_slice(&volumes.quads);
        let caps: &[u8] = bytemuck::cast_slice(&plan.caps);
        let points: &[u8] = bytemuck::cast_slice(&homogeneous);
        let replaced = [
            self.quads.write(device, queue, quads)?,
            self.caps.write(device, queue, caps)?,
            self.lights.write(device, queue, points)?,
        ];
        if replaced.contains(&true) || self.bind_group.is_none() {
            let buffers = [
                &self.view,
                &world.positions,
                &world.edges,
                &world.triangles,
                &self.quads.buffer,
                &self.caps.buffer,
                &self.lights.buffer,
            ];
            let entries: Vec<_> = (0..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            self.bind_group = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("umbrage volume"),
                layout: &self.layout,
                entries: &entries,
            }));
        }
        Ok((quads.len() + caps.len() + points.len() + size_of::<ViewUniform>()) as u64)
    }

    /// Records the volumes of the plan's lights numbered `lights`, calling `draw_light` for each
    /// after its volume, with scissor and stencil reference set. `draw_light` must draw over the
    /// whole scissor with [`ShadowRenderer::light_depth_stencil`]: that is what leaves the stencil
    /// clean for the next light.
    pub fn record(
        &self,
        pass: &mut RenderPass<'_>,
        plan: &FramePlan,
        lights: std::ops::Range<usize>,
        mut draw_light: impl FnMut(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let Some(bind_group) = &self.bind_group else {
            return;
        };
        for (number, light) in plan.drawn().filter(|(i, _)| lights.contains(i)) {
            let s = light.scissor;
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            let instance = number as u32..number as u32 + 1;
            let zpass = matches!(light.path, LightPath::ZPass { .. });
            let sides = if zpass {
                &self.pipelines.zpass_sides
            } else {
                &self.pipelines.zfail_sides
            };
            for (range, pipeline) in [
                (&light.quads, sides),
                (&light.caps, &self.pipelines.zfail_caps),
                (&light.reversed_caps, &self.pipelines.zfail_reversed_caps),
            ] {
                if !range.is_empty() {
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, bind_group, &[]);
                    pass.draw(6 * range.start..6 * range.end, instance.clone());
                }
            }
            pass.set_stencil_reference(u32::from(light.stencil_reference));
            draw_light(pass, number, light);
        }
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

    /// The uploaded positions (tightly packed f32 triples) and triangles (u32 triples), for the
    /// host's depth pass; `None` before [`ShadowRenderer::upload_world`].
    pub fn world_buffers(&self) -> Option<(&Buffer, &Buffer)> {
        self.world.as_ref().map(|w| (&w.positions, &w.triangles))
    }

    /// The [`ViewUniform`] of the last [`ShadowRenderer::prepare`].
    pub fn view_buffer(&self) -> &Buffer {
        &self.view
    }
}

fn bind_group_layout(device: &Device) -> BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let mut entries = vec![entry(0, wgpu::BufferBindingType::Uniform)];
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    entries.extend((1..7).map(|binding| entry(binding, storage)));
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage volume"),
        entries: &entries,
    })
}
