//! A light's casters into the faces of its map.

use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer};

use super::casters::Casters;
use super::face::Face;
use super::pool::{DEPTH, Map};
use crate::binding::{STORAGE, bind, buffer, layout};
use crate::gpu::{Gpu, GpuError};

/// How far a caster stands back from its own surface, and the surface comes forward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bias {
    /// Of the caster, in units of the depth that it gains from one texel to the next.
    pub(super) slope: f32,
    /// Of the surface, in texels' widths at its distance; for parallel light, of the map's depth.
    pub(super) texels: f32,
}

impl Bias {
    /// The fewest wrong pixel-lights in all, on three game maps with maps of 256 and 1024 texels.
    pub(super) const BEST: Self = Self {
        slope: 0.5,
        texels: 4.0,
    };
}

/// Draws maps.
#[derive(Debug)]
pub(super) struct CasterPass {
    pipeline: wgpu::RenderPipeline,
    map_layout: wgpu::BindGroupLayout,
}

/// What a light's casters are drawn with.
#[derive(Debug)]
pub(super) struct Drawing {
    pub(super) faces: wgpu::Buffer,
    binding: wgpu::BindGroup,
}

impl CasterPass {
    pub(super) fn new(gpu: &Gpu, shadows: &ShadowRenderer, bias: Bias) -> Self {
        let uniform = wgpu::BufferBindingType::Uniform;
        let types = [uniform, STORAGE].map(buffer);
        let stage = wgpu::ShaderStages::VERTEX;
        let map_layout = layout(gpu, "shadow map casters", stage, types);
        Self {
            pipeline: pipeline(gpu, shadows, &map_layout, bias),
            map_layout,
        }
    }

    /// Uploads what a light's map is drawn with.
    pub(super) fn drawing(
        &self,
        gpu: &Gpu,
        casters: &Casters,
        looks: &[Face],
    ) -> Result<Drawing, GpuError> {
        let triangles = match casters.triangles.is_empty() {
            true => &[0],
            false => &casters.triangles[..],
        };
        gpu.check_storage("casters of a light", size_of_val(triangles))?;
        let faces = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow map faces"),
            size: MAP_BYTES,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        write_faces(gpu, &faces, looks);
        let list = gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("shadow map casters"),
            contents: bytemuck::cast_slice(triangles),
            usage: wgpu::BufferUsages::STORAGE,
        });
        Ok(Drawing {
            binding: bind(
                gpu,
                "shadow map casters",
                &self.map_layout,
                [faces.as_entire_binding(), list.as_entire_binding()],
            ),
            faces,
        })
    }

    /// Draws the faces `wanted` of a map, a bit each.
    pub(super) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadows: &ShadowRenderer,
        (drawing, casters): (&Drawing, &Casters),
        map: &Map,
        wanted: u8,
    ) {
        let all = (0..).zip(casters.faces.iter().zip(&map.faces));
        for (face, (casters, view)) in all.filter(|(face, _)| wanted >> face & 1 == 1) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow map"),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..wgpu::RenderPassDescriptor::default()
            });
            if casters.is_empty() {
                continue;
            }
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &drawing.binding, &[]);
            pass.set_bind_group(1, shadows.world_bind_group(), &[]);
            pass.draw(3 * casters.start..3 * casters.end, face..face + 1);
        }
    }
}

/// Where `count` stands in `struct ShadowMap` of the shaders, little-endian, and its size.
const COUNT_AT: usize = 6 * size_of::<Face>();
const MAP_BYTES: u64 = COUNT_AT as u64 + 16;

pub(super) fn write_faces(gpu: &Gpu, buffer: &wgpu::Buffer, faces: &[Face]) {
    let mut map = [0; MAP_BYTES as usize];
    let bytes: &[u8] = bytemuck::cast_slice(faces);
    map[..bytes.len()].copy_from_slice(bytes);
    map[COUNT_AT] = faces.len() as u8;
    gpu.queue.write_buffer(buffer, 0, &map);
}

/// Casters, both sides: which of them cast was decided before.
fn pipeline(
    gpu: &Gpu,
    shadows: &ShadowRenderer,
    map_layout: &wgpu::BindGroupLayout,
    bias: Bias,
) -> wgpu::RenderPipeline {
    let layouts = [map_layout, shadows.world_bind_group_layout()];
    let source = [
        CLIP_WGSL,
        &shadows.world_wgsl(1),
        include_str!("../../shaders/shadow_face.wgsl"),
        include_str!("../../shaders/shadow_caster.wgsl"),
    ]
    .concat();
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("shadow map"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("shadow map"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("shadow map"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            unclipped_depth: gpu.depth_clamp,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState {
                slope_scale: -bias.slope,
                ..wgpu::DepthBiasState::default()
            },
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}
