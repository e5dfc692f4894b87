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
mod draw;
mod face;
mod pool;
#[cfg(test)]
mod tests;

use std::ops::Range;

use umbrage_core::world::{Reach, Seen};
use umbrage_core::{Cull, Light};
use umbrage_wgpu::ShadowRenderer;

use self::casters::{Casters, casters};
use self::draw::{Bias, CasterPass, Drawing, write_faces};
use self::face::{Face, face_count, faces};
use self::pool::{BUDGET, Map, Pool, bytes};
use super::unseen::Unseen;
use super::{Given, Technique, TechniqueReport};
use crate::binding::{bind, buffer, layout};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// Maps of one size, for all lights.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    texels: u32,
    lit: LightPass,
    casters: CasterPass,
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
        Ok(Self {
            texels,
            lit: LightPass::new(gpu, shadows, draw, lit_by),
            casters: CasterPass::new(gpu, shadows, bias),
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
        let all = changes.fixed || !given.frame.culls.has(Cull::Cache);
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
            if all || kept.light != Some(*light) || moved() {
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
            kept.drawing = Some(
                self.casters
                    .drawing(given.gpu, &kept.casters, &kept.faces)?,
            );
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
        if wanted <= self.pool.budget() {
            self.pool.free_scratch();
        }
        let without = (drawn.iter()).filter(|&&number| self.lights[number].map.is_none());
        let missing: u64 = without.map(|&n| bytes(self.texels, faces(n))).sum();
        let scarce = missing > self.pool.room();
        for (number, kept) in self.lights.iter_mut().enumerate() {
            let other = |map: &mut Map| map.faces.len() != faces(number) as usize;
            let spare = !is_drawn[number] && scarce;
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
}

impl Technique for ShadowMap {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lit.prepare(given);
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
            if let (Some(map), Some(drawing)) = (&kept.map, &kept.drawing) {
                let stale = kept.wanted & !kept.drawn;
                let casters = (drawing, &kept.casters);
                self.casters
                    .record(encoder, given.shadows, casters, map, stale);
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
                readings.push((kept.drawing.as_ref()).map(|drawing| {
                    let casters = (drawing, &kept.casters);
                    self.casters
                        .record(encoder, given.shadows, casters, map, kept.wanted);
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
