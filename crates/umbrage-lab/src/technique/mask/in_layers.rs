//! `mask-screen`, and every mask at a lower resolution: masks in textures, which the lights read.
//!
//! A batch of lights is placed in the channels of a stack of layers; layer by layer their masks are
//! made and normalised, then the batch's lights are drawn, each multiplied by its mask. At full
//! resolution a light reads the texel of its pixel; else masks are filtered bilinearly, and nothing
//! knows about depth: a mask bleeds over edges of the surface by up to a texel, as the paper's
//! does. Filtering looks past the tiles in which receivers were found, at a background beyond the
//! light's range, where faces count as well: at a lower resolution a mask in floats or eight bits
//! is started and normalised over all of the light's scissor. One from the stencil is lit there.

use std::ops::Range;

use umbrage_wgpu::{ShadowRenderer, Uploaded};

use super::lighting::Lighting;
use super::low::{LowFrame, area, low_size};
use super::pack::{Placed, pack};
use super::painter::Painter;
use super::plan::{MaskPlan, Place};
use super::reading::MaskReading;
use super::slots::Slot;
use crate::application::Application;
use crate::gbuffer::whole;
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::{HDR, LightDraw, LitBy, MASK};
use crate::method::{Counting, MaskBuffer};
use crate::run::{FROM_DARK, light_pass};
use crate::technique::{Given, Technique, TechniqueReport};

/// The most that a stack of layers takes, one layer apart.
const BUDGET_BYTES: u64 = 16 << 20;

/// Layers are plenty beyond this many.
const MOST_LAYERS: u64 = 32;

/// Counts in layers, lights by them.
#[derive(Debug)]
pub(crate) struct InLayers {
    plan: MaskPlan,
    divisor: u32,
    low: Option<LowFrame>,
    painter: Painter,
    lighting: Lighting,
    masks: MaskReading,
    stack: Option<Stack>,
    placed: Vec<Placed>,
}

/// The layers, and this frame's lights in them.
#[derive(Debug)]
struct Stack {
    texture: wgpu::Texture,
    slots: wgpu::BindGroup,
    reading: wgpu::BindGroup,
}

impl InLayers {
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &ShadowRenderer,
        draw: LightDraw,
        of: Counting,
        application: Application,
        divisor: u32,
    ) -> Result<Self, GpuError> {
        let place = match divisor {
            1 => Place::Layers,
            _ => Place::LowLayers,
        };
        let plan = MaskPlan {
            of,
            place,
            application,
        };
        let low = match divisor {
            1 => None,
            _ => Some(LowFrame::new(
                gpu,
                shadows.world_windows(),
                divisor,
                layer_format(of),
            )?),
        };
        let counted_by = low.as_ref().map_or(shadows, |low| &low.shadows);
        let painter = Painter::new(gpu, counted_by, plan, layer_format(of));
        let masks = MaskReading::new(gpu);
        let lit_by = LitBy::Shader {
            wgsl: &MaskReading::wgsl(divisor),
            layout: &masks.layout,
        };
        Ok(Self {
            plan,
            divisor,
            painter,
            lighting: Lighting::new(gpu, shadows, plan, draw, lit_by),
            low,
            masks,
            stack: None,
            placed: Vec::new(),
        })
    }
}

/// Eight bits, or the half floats that masks in alpha are counted in at full resolution.
fn layer_format(of: Counting) -> wgpu::TextureFormat {
    match of {
        Counting::Stencil | Counting::Mask(MaskBuffer::Screen) => MASK,
        Counting::Mask(MaskBuffer::Alpha | MaskBuffer::Max) => HDR,
    }
}

impl Technique for InLayers {
    fn prepare(&mut self, given: &Given<'_>) -> Result<(), GpuError> {
        self.lighting.prepare(given);
        if let Some(low) = &mut self.low {
            low.prepare(given)?;
        }
        let plan = self.low.as_ref().map_or(given.plan, |low| &low.plan);
        let rects = plan.drawn().map(|(number, light)| (number, light.scissor));
        let size = low_size(given.view.size, self.divisor);
        let format = layer_format(self.plan.of);
        let bytes = area(size) * u64::from(format.block_copy_size(None).unwrap_or(4));
        let layers = (BUDGET_BYTES / bytes).clamp(1, MOST_LAYERS) as u32;
        self.placed = pack(rects.filter(|(_, rect)| !rect.is_empty()), layers);

        let device = &given.gpu.device;
        let used = self.placed.iter().map(|p| p.layer + 1).max().unwrap_or(1);
        let texture = match self.stack.take().map(|stack| stack.texture) {
            Some(t) if t.depth_or_array_layers() >= used && [t.width(), t.height()] == size => t,
            _ => device.create_texture(&wgpu::TextureDescriptor {
                label: Some("masks"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: used,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            }),
        };
        let slots = Slot::all(given.plan, self.plan, self.placed.iter().copied());
        let slots = Slot::upload(given.gpu, &slots);
        self.stack = Some(Stack {
            slots: self.painter.bind(given.gpu, &slots),
            reading: self.masks.bind(given.gpu, &texture, &slots),
            texture,
        });
        Ok(())
    }

    fn record(
        &mut self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        lights: Range<usize>,
        target: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        if let Some(low) = &mut self.low {
            low.record_surface(given, encoder);
        }
        let mut load = FROM_DARK;
        let first = self.placed.partition_point(|p| p.number < lights.start);
        let end = self.placed.partition_point(|p| p.number < lights.end);
        for batch in self.placed[first..end].chunk_by(|a, b| a.batch == b.batch) {
            self.record_masks(given, encoder, batch);
            let mut pass = light_pass(encoder, given.targets, target, load);
            self.record_lights(given, &mut pass, batch);
            load = wgpu::LoadOp::Load;
        }
        if first == end {
            drop(light_pass(encoder, given.targets, target, load));
        }
        Ok(())
    }

    fn own_renderer(&self) -> Option<(&ShadowRenderer, Uploaded)> {
        let low = self.low.as_ref();
        low.map(|low| (&low.shadows, low.uploaded))
    }

    fn report(&self) -> TechniqueReport {
        let texture = self.stack.as_ref().map(|stack| &stack.texture);
        let layers = texture.map_or(0, |t| {
            let texel = u64::from(t.format().block_copy_size(None).unwrap_or(4));
            area([t.width(), t.height()]) * u64::from(t.depth_or_array_layers()) * texel
        });
        let low = self.low.as_ref().map_or(0, LowFrame::gpu_bytes);
        let batches = self.placed.last().map_or(0, |p| p.batch + 1);
        TechniqueReport {
            gpu_bytes: layers + low,
            note: match batches {
                0 | 1 => String::new(),
                _ => format!("masks of all lights in {batches} batches"),
            },
        }
    }
}

impl InLayers {
    /// Makes and normalises the masks of one batch.
    fn record_masks(
        &self,
        given: &Given<'_>,
        encoder: &mut wgpu::CommandEncoder,
        batch: &[Placed],
    ) {
        let Some(stack) = &self.stack else { return };
        let full = &given.targets.depth;
        let (shadows, plan, depth) = match &self.low {
            None => (given.shadows, given.plan, full),
            Some(low) => (&low.shadows, &low.plan, low.depth().unwrap_or(full)),
        };
        let mut batch = batch.to_vec();
        batch.sort_by_key(|p| p.layer);
        for layer in batch.chunk_by(|a, b| a.layer == b.layer) {
            let mut pass = mask_pass(encoder, &stack.texture, layer[0].layer, depth);
            for placed in layer {
                let (number, channel) = (placed.number, placed.channel);
                let light = &plan.lights[number];
                if self.plan.of == Counting::Stencil {
                    shadows.record(
                        &mut pass,
                        plan,
                        number..number + 1,
                        |pass, number, light| {
                            self.painter
                                .paint(pass, shadows, &stack.slots, number, light, channel);
                        },
                    );
                } else {
                    let s = light.scissor;
                    pass.set_scissor_rect(s.x, s.y, s.width, s.height);
                    self.painter
                        .paint(&mut pass, shadows, &stack.slots, number, light, channel);
                }
            }
        }
    }

    /// Draws the lights of one batch.
    fn record_lights(&self, given: &Given<'_>, pass: &mut wgpu::RenderPass<'_>, batch: &[Placed]) {
        let reading = self.stack.as_ref().map(|stack| &stack.reading);
        for placed in batch {
            let s = given.plan.lights[placed.number].scissor;
            if s.is_empty() {
                continue;
            }
            pass.set_scissor_rect(s.x, s.y, s.width, s.height);
            self.lighting
                .draw(pass, given.shadows, placed.number, reading);
        }
    }
}

/// A pass into one layer, lit throughout, over the depth that volumes count against.
fn mask_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    masks: &wgpu::Texture,
    layer: u32,
    depth: &wgpu::Texture,
) -> wgpu::RenderPass<'e> {
    let view = masks.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("masks"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &whole(depth),
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            }),
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}
