//! The oracle's own verdicts, drawn: what all other methods are judged by, as a picture.
//!
//! Takes the stage's triangles, lights and view; rays are cast on the CPU in f64, once for as long as
//! none of the three changes, and uploaded as a bit a pixel and light. Pixel-lights that are no
//! samples (facing away) stay dark, as they are.

use std::ops::Range;

use umbrage_core::{Light, View};
use umbrage_truth::{NearClip, Oracle, Verdicts};
use umbrage_wgpu::ShadowRenderer;
use wgpu::{BindGroupLayout, ShaderStages, TextureUsages};

use super::{Given, Technique, TechniqueReport};
use crate::binding::{bind, layout, texture};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{LightDraw, LightPass, LitBy};
use crate::run::{FROM_DARK, light_pass};

/// Lights by bits that came from the CPU.
#[derive(Debug)]
pub(crate) struct OracleMask {
    lit: LightPass,
    layout: BindGroupLayout,
    near: NearClip,
    kept: Option<Kept>,
}

#[derive(Debug)]
struct Kept {
    view: View,
    lights: Vec<Light>,
    stamp: u64,
    bytes: u64,
    reading: wgpu::BindGroup,
}

impl OracleMask {
    pub(crate) fn new(gpu: &Gpu, shadows: &ShadowRenderer, draw: LightDraw) -> Self {
        let uint = wgpu::TextureSampleType::Uint;
        let layout = layout(
            gpu,
            "oracle",
            ShaderStages::FRAGMENT,
            [texture(uint, wgpu::TextureViewDimension::D2Array)],
        );
        // All layers at once: no light shares one with another batch.
        let wgsl = format!(
            "const LAYERS: u32 = {}u;\n{}",
            u32::MAX,
            include_str!("../shaders/ray_mask.wgsl")
        );
        let lit_by = LitBy::Shader {
            wgsl: &wgsl,
            layout: &layout,
        };
        Self {
            lit: LightPass::new(gpu, shadows, draw, lit_by),
            layout,
            near: gpu.near_clip(),
            kept: None,
        }
    }

    fn cast(&self, given: &Given<'_>, lights: Vec<Light>) -> Result<Kept, GpuError> {
        let (view, world) = (*given.frame.view, &given.stage.world);
        let layers = lights.len().div_ceil(32).max(1) as u32;
        let limit = given.gpu.device.limits().max_texture_array_layers;
        if layers > limit {
            return Err(GpuError::TooManyLights {
                lights: lights.len(),
                limit: 32 * limit as usize,
            });
        }
        let oracle = Oracle::new(&given.stage.mesh);
        let mask = Verdicts::new(&oracle, &view, &lights, self.near, &|_, _| ()).mask();
        let size = wgpu::Extent3d {
            width: view.size[0],
            height: view.size[1],
            depth_or_array_layers: layers,
        };
        let bits = given.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("oracle"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        if !mask.words.is_empty() {
            let rows = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * size.width),
                rows_per_image: Some(size.height),
            };
            let words = bytemuck::cast_slice(&mask.words);
            given
                .gpu
                .queue
                .write_texture(bits.as_image_copy(), words, rows, size);
        }
        let all = bits.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        let resources = [wgpu::BindingResource::TextureView(&all)];
        Ok(Kept {
            view,
            lights,
            stamp: world.stamp,
            bytes: 4 * mask.words.len() as u64,
            reading: bind(given.gpu, "oracle", &self.layout, resources),
        })
    }
}

impl Technique for OracleMask {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lit.prepare(given);
        let lights: Vec<Light> = given.lights.iter().map(|l| l.light).collect();
        let is_kept = self.kept.as_ref().is_some_and(|kept| {
            kept.view == *given.frame.view
                && kept.lights == lights
                && kept.stamp == given.stage.world.stamp
        });
        if !is_kept {
            self.kept = Some(self.cast(given, lights)?);
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
        let mut pass = light_pass(encoder, given.targets, target, FROM_DARK);
        let reading = self.kept.as_ref().map(|kept| &kept.reading);
        self.lit.record(&mut pass, given, lights, reading);
        Ok(())
    }

    fn report(&self) -> TechniqueReport {
        TechniqueReport {
            gpu_bytes: self.kept.as_ref().map_or(0, |kept| kept.bytes),
            note: "found on the CPU, in the first frame".to_owned(),
        }
    }
}
