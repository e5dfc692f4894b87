//! Shadow maps: depth as each light sees it, compared with the surface's.
//!
//! A point light has a cube of six faces, and so has a spot of more than 80 degrees half angle;
//! other spots have one face, directional lights one parallel projection of what the eye sees.
//! A map shows exactly the triangles that cast by the oracle's rule, each face those that can be
//! in it. A face is drawn when the eye may see into it, and kept until the light changes or
//! something in its range moves. Maps together take no more than [`BUDGET`]; lights beyond it share
//! a few scratch maps, which are drawn again every frame.
//!
//! Filter: the sampler's, two by two texels. Bias: slope-scaled when drawn, and by widths of a texel
//! when read; see [`Bias`].

mod casters;
mod face;
mod pool;
#[cfg(test)]
mod tests;
mod unseen;

use std::ops::Range;

use umbrage::{Light, ShadowRenderer};
use umbrage_core::world::{Reach, Seen};
use wgpu::util::DeviceExt as _;

use self::casters::{Casters, casters};
use self::face::{Face, face_count, faces};
use self::pool::{BUDGET, DEPTH, Map, Pool, bytes};
use self::unseen::Unseen;
use super::{Given, Technique, TechniqueReport};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// How far a caster stands back from its own surface, and the surface comes forward.
#[derive(Clone, Copy, Debug)]
struct Bias {
    /// Of the caster, in units of the depth that it gains from one texel to the next.
    slope: f32,
    /// Of the surface, in texels' widths at its distance; for parallel light, of the map's depth.
    texels: f32,
}

impl Bias {
    /// The fewest wrong pixel-lights in all, on three game maps with maps of 256 and 1024 texels.
    const BEST: Self = Self {
        slope: 0.5,
        texels: 4.0,
    };
}

/// Maps of one size, for all lights.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    texels: u32,
    lit: LightPass,
    pipeline: wgpu::RenderPipeline,
    caster_layout: wgpu::BindGroupLayout,
    world_layout: wgpu::BindGroupLayout,
    world: Option<wgpu::BindGroup>,
    map_layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    pool: Pool,
    seen: Seen,
    unseen: Unseen,
    lights: Vec<OneLight>,
    note: String,
}

/// What is kept of one light.
#[derive(Debug, Default)]
struct OneLight {
    /// As it was when `casters` were found; `None` if they are stale.
    light: Option<Light>,
    faces: Vec<Face>,
    casters: Casters,
    drawing: Option<Drawing>,
    map: Option<Map>,
    /// For reading `map`.
    reading: Option<wgpu::BindGroup>,
    /// Faces of `map` that are right, a bit each.
    drawn: u8,
    /// Faces that this view may see.
    wanted: u8,
}

/// What a light's casters are drawn with.
#[derive(Debug)]
struct Drawing {
    faces: wgpu::Buffer,
    binding: wgpu::BindGroup,
}

impl ShadowMap {
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        texels: u32,
    ) -> Result<Self, GpuError> {
        Self::with_budget(gpu, shadows, draw, texels, BUDGET)
    }

    fn with_budget(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        texels: u32,
        budget: u64,
    ) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if texels > limit {
            return Err(GpuError::SizeTooLarge {
                width: texels,
                height: texels,
                limit,
            });
        }
        let bias = Bias::BEST;
        let map_layout = map_layout(gpu);
        let wgsl = format!(
            "const BIAS: f32 = {};\n{}\n{}",
            2.0 * bias.texels / texels as f32,
            include_str!("../shaders/shadow_face.wgsl"),
            include_str!("../shaders/shadow_map.wgsl")
        );
        let lit_by = LitBy::Shader {
            wgsl: &wgsl,
            layout: &map_layout,
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let world_layout = buffers_layout(gpu, "shadow map world", [storage, storage]);
        let caster_layout = buffers_layout(gpu, "shadow map casters", [uniform, storage]);
        Ok(Self {
            texels,
            lit: LightPass::new(gpu, shadows, draw, lit_by),
            pipeline: pipeline(gpu, &[&world_layout, &caster_layout], bias),
            caster_layout,
            world_layout,
            world: None,
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("shadow map"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::GreaterEqual),
                ..wgpu::SamplerDescriptor::default()
            }),
            map_layout,
            pool: Pool::new(texels, budget),
            seen: Seen::default(),
            unseen: Unseen::default(),
            lights: Vec::new(),
            note: String::new(),
        })
    }

    /// The lights that need maps.
    fn drawn(&self, given: &Given<'_>) -> Vec<usize> {
        let drawn = given.plan.drawn().map(|(number, _)| number);
        drawn.filter(|&number| !self.unseen.has(number)).collect()
    }

    /// Marks as stale what is not of these lights in this world.
    fn forget_changes(&mut self, given: &Given<'_>) {
        let changes = self.seen.update(&given.stage.world);
        for gone in self
            .lights
            .drain(given.lights.len().min(self.lights.len())..)
        {
            gone.map.into_iter().for_each(|map| self.pool.give(map));
        }
        self.lights
            .resize_with(given.lights.len(), OneLight::default);
        for (kept, light) in self.lights.iter_mut().zip(given.lights) {
            let light = &light.light;
            let reach = Reach::new(light);
            let moved = || changes.boxes.iter().any(|at| reach.touches_box(*at));
            if changes.fixed || kept.light != Some(*light) || moved() {
                kept.light = None;
                kept.drawn = 0;
            }
        }
    }

    /// Finds the casters of the lights that are drawn and stale, and where their maps look.
    fn find_casters(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        let world = &given.stage.world;
        let mut bounds = world.bvh.nodes.first().map(|root| [root.min, root.max]);
        for [min, max] in world.objects.iter().map(|object| object.bounds) {
            bounds = bounds.map(|[low, high]| [low.min(min), high.max(max)]);
        }
        let mut stale = Vec::new();
        for number in self.drawn(given) {
            let (light, kept) = (&given.lights[number].light, &mut self.lights[number]);
            if kept.light.is_none() || light.is_directional() {
                let looks = faces(light, self.texels, given.view, bounds.unwrap_or_default());
                if looks != kept.faces {
                    kept.drawn = 0;
                    if let Some(drawing) = &kept.drawing {
                        write_faces(given.gpu, &drawing.faces, &looks);
                    }
                    kept.faces = looks;
                }
            }
            if kept.light.is_none() {
                stale.push(number);
            }
            kept.wanted = 0;
            for (bit, face) in kept.faces.iter().enumerate() {
                kept.wanted |= u8::from(face.is_seen(given.view, light.range)) << bit;
            }
        }
        let jobs: Vec<(&Light, &[Face])> = (stale.iter())
            .map(|&n| (&given.lights[n].light, &self.lights[n].faces[..]))
            .collect();
        for (number, found) in stale.iter().zip(casters(world, &jobs)) {
            let kept = &mut self.lights[*number];
            kept.casters = found;
            kept.light = Some(given.lights[*number].light);
            kept.drawing = Some(drawing(given.gpu, &self.caster_layout, kept)?);
            // It reads the faces' buffer, which is new.
            kept.reading = None;
        }
        Ok(())
    }

    /// Gives maps to the lights that are drawn, as far as the budget goes; those that others have
    /// and do not need are taken from them.
    fn assign(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        let gpu = given.gpu;
        let drawn = self.drawn(given);
        let faces = |number: usize| face_count(&given.lights[number].light);
        let wanted = drawn.iter().map(|&n| bytes(self.texels, faces(n))).sum();
        let mut is_drawn = vec![false; self.lights.len()];
        drawn.iter().for_each(|&number| is_drawn[number] = true);
        for (number, kept) in self.lights.iter_mut().enumerate() {
            let other = |map: &mut Map| map.faces.len() != faces(number) as usize;
            let spare = !is_drawn[number] && wanted > self.pool.budget();
            if let Some(map) = kept.map.take_if(|map| spare || other(map)) {
                self.pool.give(map);
                (kept.reading, kept.drawn) = (None, 0);
            }
        }
        self.pool.make_scratch(gpu, wanted)?;
        let mut cached = 0;
        for &number in &drawn {
            let kept = &mut self.lights[number];
            if kept.map.is_none() {
                kept.map = self.pool.take(gpu, faces(number));
            }
            if let (Some(map), None, Some(drawing)) = (&kept.map, &kept.reading, &kept.drawing) {
                kept.reading = Some(read_map(gpu, &self.map_layout, &self.sampler, drawing, map));
            }
            cached += usize::from(kept.map.is_some());
        }
        if self.pool.scratch.is_empty() && cached < drawn.len() {
            self.pool.make_scratch(gpu, u64::MAX)?;
        }
        self.note = format!("{cached} of {} maps cached", drawn.len());
        Ok(())
    }

    /// Draws the faces `wanted` of a light's map.
    fn draw_map(&self, encoder: &mut wgpu::CommandEncoder, kept: &OneLight, map: &Map, wanted: u8) {
        let Some(drawing) = &kept.drawing else {
            return;
        };
        let all = (0..).zip(kept.casters.faces.iter().zip(&map.faces));
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
            pass.set_bind_group(0, self.world.as_ref(), &[]);
            pass.set_bind_group(1, &drawing.binding, &[]);
            pass.draw(3 * casters.start..3 * casters.end, face..face + 1);
        }
    }
}

impl Technique for ShadowMap {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lit.prepare(given);
        let buffers = given.shadows.world_buffers();
        let (positions, triangles) = buffers.ok_or(umbrage::RenderError::NoWorld)?;
        self.world = Some(bind_buffers(
            given.gpu,
            &self.world_layout,
            [positions, triangles],
        ));
        self.unseen.update(given)?;
        self.forget_changes(given);
        self.find_casters(given)?;
        self.assign(given)
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        if lights.start == 0 {
            self.unseen.record(given, encoder);
        }
        let mut drawn = self.drawn(given);
        drawn.retain(|number| lights.contains(number));
        let (cached, others): (Vec<usize>, Vec<usize>) = drawn
            .into_iter()
            .partition(|&number| self.lights[number].map.is_some());
        for &number in &cached {
            let kept = &self.lights[number];
            if let Some(map) = &kept.map {
                self.draw_map(encoder, kept, map, kept.wanted & !kept.drawn);
            }
            let kept = &mut self.lights[number];
            kept.drawn |= kept.wanted;
        }
        let mut pass = light_pass(encoder, given.targets, target, FROM_DARK);
        given
            .shadows
            .record(&mut pass, given.plan, lights, |pass, number, _| {
                let reading = self.lights[number].reading.as_ref();
                if reading.is_some() {
                    self.lit.draw(pass, given.shadows, number, reading);
                }
            });
        drop(pass);
        for some in others.chunks(self.pool.scratch.len().max(1)) {
            let mut readings = Vec::new();
            for (&number, map) in some.iter().zip(&self.pool.scratch) {
                let kept = &self.lights[number];
                self.draw_map(encoder, kept, map, kept.wanted);
                readings.push((kept.drawing.as_ref()).map(|drawing| {
                    read_map(given.gpu, &self.map_layout, &self.sampler, drawing, map)
                }));
            }
            let mut pass = light_pass(encoder, given.targets, target, wgpu::LoadOp::Load);
            let range = some[0]..some[some.len() - 1] + 1;
            given
                .shadows
                .record(&mut pass, given.plan, range, |pass, number, _| {
                    let at = some.iter().position(|&n| n == number);
                    let reading = at.and_then(|at| readings[at].as_ref());
                    if reading.is_some() {
                        self.lit.draw(pass, given.shadows, number, reading);
                    }
                });
        }
        Ok(())
    }

    fn report(&self) -> TechniqueReport {
        let lists = self.lights.iter().map(|kept| kept.casters.triangles.len());
        TechniqueReport {
            gpu_bytes: self.pool.held() + 4 * lists.sum::<usize>() as u64,
            note: self.note.clone(),
        }
    }
}

/// Uploads what a light's map is drawn with.
fn drawing(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    kept: &OneLight,
) -> Result<Drawing, GpuError> {
    let triangles = match kept.casters.triangles.is_empty() {
        true => &[0],
        false => &kept.casters.triangles[..],
    };
    let needed = size_of_val(triangles) as u64;
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    if needed > limit {
        let what = "casters of a light";
        return Err(umbrage::RenderError::BufferTooLarge {
            what,
            needed,
            limit,
        }
        .into());
    }
    let faces = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("shadow map faces"),
        size: MAP_BYTES,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    write_faces(gpu, &faces, &kept.faces);
    let list = gpu
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("shadow map casters"),
            contents: bytemuck::cast_slice(triangles),
            usage: wgpu::BufferUsages::STORAGE,
        });
    Ok(Drawing {
        binding: bind_buffers(gpu, layout, [&faces, &list]),
        faces,
    })
}

/// Where `count` stands in `struct ShadowMap` of the shaders, little-endian, and its size.
const COUNT_AT: usize = 6 * size_of::<Face>();
const MAP_BYTES: u64 = COUNT_AT as u64 + 16;

fn write_faces(gpu: &Gpu, buffer: &wgpu::Buffer, faces: &[Face]) {
    let mut map = [0; MAP_BYTES as usize];
    let bytes: &[u8] = bytemuck::cast_slice(faces);
    map[..bytes.len()].copy_from_slice(bytes);
    map[COUNT_AT] = faces.len() as u8;
    gpu.queue.write_buffer(buffer, 0, &map);
}

fn read_map(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    sampler: &wgpu::Sampler,
    drawing: &Drawing,
    map: &Map,
) -> wgpu::BindGroup {
    let resources = [
        drawing.faces.as_entire_binding(),
        wgpu::BindingResource::TextureView(&map.all),
        wgpu::BindingResource::Sampler(sampler),
    ];
    bind(gpu, "shadow map", layout, resources)
}

fn bind_buffers(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    buffers: [&wgpu::Buffer; 2],
) -> wgpu::BindGroup {
    let resources = buffers.map(wgpu::Buffer::as_entire_binding);
    bind(gpu, "shadow map casters", layout, resources)
}

fn bind<const N: usize>(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

fn layout<const N: usize>(
    gpu: &Gpu,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: [wgpu::BindingType; N],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn buffers_layout(
    gpu: &Gpu,
    label: &str,
    types: [wgpu::BufferBindingType; 2],
) -> wgpu::BindGroupLayout {
    layout(gpu, label, wgpu::ShaderStages::VERTEX, types.map(buffer))
}

/// What a light's map is read with.
fn map_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let types = [
        buffer(wgpu::BufferBindingType::Uniform),
        wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
    ];
    layout(gpu, "shadow map", wgpu::ShaderStages::FRAGMENT, types)
}

/// Casters, both sides: which of them cast was decided before.
fn pipeline(gpu: &Gpu, layouts: &[&wgpu::BindGroupLayout; 2], bias: Bias) -> wgpu::RenderPipeline {
    let source = concat!(
        include_str!("../shaders/shadow_face.wgsl"),
        include_str!("../shaders/shadow_caster.wgsl")
    );
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
