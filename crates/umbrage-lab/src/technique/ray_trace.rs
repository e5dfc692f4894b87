//! Ray tracing: one any-hit ray for each pixel and light that reaches it, in a compute shader over
//! the world's own BVH.
//!
//! For batches of lights: rays leave a bit a light in a layer of 32, then the light pass reads
//! them. Tiles of 8x8 pixels ask only the lights that reach visible surface in them, as the
//! receivers found. Nothing but the tree is kept from frame to frame.
//!
//! What it promises: verdicts in f32. A caster counts if its rounded edges enclose the ray and
//! light and surface lie on two sides of its plane, the surface by more than rounding. So shadows
//! that begin within some 2^-21 of the distances from eye and light are lost, which the oracle calls
//! ambiguous.

mod primary;
mod tree;

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use umbrage_core::LightShape;
use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer, light_wgsl};
use wgpu::{BindGroupLayout, BufferUsages, ShaderStages, TextureFormat, TextureUsages};

use self::primary::Primary;
use self::tree::Tree;
use super::{Given, Technique, TechniqueReport};
use crate::binding::{STORAGE, bind, buffer, layout, texture};
use crate::gbuffer::whole;
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// Layers of 32 lights that are traced before they are lit.
const LAYERS: u32 = 8;
/// Lights of a batch.
const BATCH: usize = 32 * LAYERS as usize;
/// Pixels a tile is wide and high.
const TILE: u32 = 8;
/// Rounding of a surface's height over a caster's plane, in units of 2^-23: of the distances from
/// eye and light, and of the distance to the caster's nearest corner times how thin the caster is.
/// Of the first, 1 is too little on worlds with coplanar triangles, 2 to 4 are right.
const TOUCH: [f32; 2] = [3.0, 2.0];

const BITS: TextureFormat = TextureFormat::R32Uint;

/// `struct Light` of the shader.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct RayLight {
    position: [f32; 3],
    range: f32,
    direction: [f32; 3],
    cos_outer: f32,
    residual: [f32; 3],
    kind: u32,
    rows: [u32; 2],
    unused: [u32; 2],
}

/// Rays for all lights.
#[derive(Debug)]
pub(crate) struct RayTrace {
    lit: LightPass,
    primary: Primary,
    pipeline: wgpu::ComputePipeline,
    layout: BindGroupLayout,
    bits_layout: BindGroupLayout,
    tree: Option<Tree>,
    frame: Option<Frame>,
}

/// What depends on size and lights.
#[derive(Debug)]
struct Frame {
    size: [u32; 2],
    ids: wgpu::Texture,
    bits: wgpu::TextureView,
    /// To read `bits` with.
    reading: wgpu::BindGroup,
    lights: wgpu::Buffer,
}

impl RayTrace {
    pub(crate) fn new(gpu: &Gpu, shadows: &ShadowRenderer, draw: LightDraw) -> Self {
        let uint = wgpu::TextureSampleType::Uint;
        let bits_layout = layout(
            gpu,
            "bits of rays",
            ShaderStages::FRAGMENT,
            [texture(uint, wgpu::TextureViewDimension::D2Array)],
        );
        let layers = format!("const LAYERS: u32 = {LAYERS};\n");
        let wgsl = layers.clone() + include_str!("../shaders/ray_mask.wgsl");
        let lit_by = LitBy::Shader {
            wgsl: &wgsl,
            layout: &bits_layout,
        };
        let uniform = buffer(wgpu::BufferBindingType::Uniform);
        let storage = buffer(STORAGE);
        let bits = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: BITS,
            view_dimension: wgpu::TextureViewDimension::D2Array,
        };
        let ids = texture(uint, wgpu::TextureViewDimension::D2);
        let types = [uniform, storage, storage, storage, uniform, ids, bits];
        let layout = layout(gpu, "rays", ShaderStages::COMPUTE, types);
        Self {
            lit: LightPass::new(gpu, shadows, draw, lit_by),
            primary: Primary::new(gpu, shadows),
            pipeline: pipeline(gpu, &layers, &[&layout, shadows.light_bind_group_layout()]),
            layout,
            bits_layout,
            tree: None,
            frame: None,
        }
    }

    /// Rays of a batch of lights, which begins at a multiple of 32.
    fn trace(
        &self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: &Range<usize>,
    ) -> Option<()> {
        let (tree, frame) = (self.tree.as_ref()?, self.frame.as_ref()?);
        let batch = [lights.start as u32, lights.end as u32, 0, 0];
        let batch = given
            .gpu
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("batch of rays"),
                contents: bytemuck::cast_slice(&batch),
                usage: BufferUsages::UNIFORM,
            });
        let ids = whole(&frame.ids);
        let resources = [
            given.shadows.view_buffer().as_entire_binding(),
            tree.nodes.as_entire_binding(),
            tree.corners.as_entire_binding(),
            frame.lights.as_entire_binding(),
            batch.as_entire_binding(),
            wgpu::BindingResource::TextureView(&ids),
            wgpu::BindingResource::TextureView(&frame.bits),
        ];
        let bind_group = bind(given.gpu, "rays", &self.layout, resources);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("rays"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.set_bind_group(1, given.shadows.light_bind_group(), &[]);
        let [width, height] = frame.size.map(|side| side.div_ceil(TILE));
        pass.dispatch_workgroups(width, height, 1);
        Some(())
    }
}

impl Technique for RayTrace {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lit.prepare(given);
        let world = &given.stage.world;
        let mut tree = match self.tree.take() {
            Some(tree) => tree,
            None => Tree::new(given.gpu, world)?,
        };
        tree.update(given.gpu, world)?;
        let lights = ray_lights(given);
        self.tree = Some(tree);
        match &self.frame {
            Some(frame)
                if frame.size == given.targets.size
                    && frame.lights.size() == size_of_val(&lights[..]) as u64 =>
            {
                let bytes = bytemuck::cast_slice(&lights);
                given.gpu.queue.write_buffer(&frame.lights, 0, bytes);
            }
            _ => self.frame = Some(Frame::new(given, &lights, &self.bits_layout)),
        }
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        if let (0, Some(frame)) = (lights.start, &self.frame) {
            self.primary.record(given, encoder, &frame.ids);
        }
        drop(light_pass(encoder, given.targets, target, FROM_DARK));
        let mut first = lights.start;
        while first < lights.end {
            let end = lights.end.min((first / BATCH + 1) * BATCH);
            let batch = first..end;
            self.trace(given, encoder, &batch);
            let mut pass = light_pass(encoder, given.targets, target, wgpu::LoadOp::Load);
            let reading = self.frame.as_ref().map(|frame| &frame.reading);
            self.lit.record(&mut pass, given, batch, reading);
            first = end;
        }
        Ok(())
    }

    fn report(&self) -> TechniqueReport {
        let tree = self.tree.as_ref().map_or(0, Tree::bytes);
        let frame = self.frame.as_ref().map_or(0, |frame| {
            let [width, height] = frame.size.map(u64::from);
            4 * width * height * u64::from(LAYERS + 1) + frame.lights.size()
        });
        TechniqueReport {
            gpu_bytes: tree + frame,
            note: String::new(),
        }
    }
}

impl Frame {
    fn new(given: &Given<'_>, lights: &[RayLight], layout: &BindGroupLayout) -> Self {
        let (gpu, size) = (given.gpu, given.targets.size);
        let bits = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bits of rays"),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: LAYERS,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: BITS,
            usage: TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let bits = whole(&bits);
        Self {
            size,
            ids: Primary::target(gpu, size),
            reading: bind(
                gpu,
                "bits of rays",
                layout,
                [wgpu::BindingResource::TextureView(&bits)],
            ),
            bits,
            lights: gpu.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("lights of rays"),
                contents: bytemuck::cast_slice(lights),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            }),
        }
    }
}

/// Lights with the rows of tiles that they are drawn in; never empty.
fn ray_lights(given: &Given<'_>) -> Vec<RayLight> {
    let mut lights = vec![RayLight::default(); given.lights.len().max(1)];
    for (number, plan) in given.plan.drawn() {
        let light = &given.lights[number].light;
        let (kind, direction, cos_outer) = match light.shape {
            LightShape::Point => (0, glam::Vec3::ZERO, -1.0),
            LightShape::Spot {
                direction,
                cos_outer,
            } => (1, direction, cos_outer),
            LightShape::Directional { direction } => (2, direction, -1.0),
        };
        let scissor = plan.scissor;
        let [position, residual] = light.position_f32();
        lights[number] = RayLight {
            position: position.to_array(),
            residual: residual.to_array(),
            range: light.range,
            direction: direction.to_array(),
            cos_outer,
            kind,
            rows: [
                scissor.y / TILE,
                (scissor.y + scissor.height).div_ceil(TILE),
            ],
            unused: [0; 2],
        };
    }
    lights
}

fn pipeline(gpu: &Gpu, layers: &str, layouts: &[&BindGroupLayout; 2]) -> wgpu::ComputePipeline {
    let source = [
        layers,
        &format!("const TOUCH = vec2f({}, {});\n", TOUCH[0], TOUCH[1]),
        CLIP_WGSL,
        &light_wgsl(1),
        include_str!("../shaders/ray_trace.wgsl"),
    ]
    .concat();
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("rays"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("rays"),
        bind_group_layouts: &layouts.map(Some),
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("rays"),
        layout: Some(&layout),
        module: &module,
        entry_point: Some("trace"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}
