//! The shadow mask: a bit for each light and pixel, in a texture that any later pass reads.

use umbrage_wgpu::{SharedShadows, VolumePipelines};
use wgpu::{
    CommandEncoder, Device, RenderPipeline, Texture, TextureFormat, TextureUsages, TextureView,
};

use crate::{Error, ShadowView, Shadows};

const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// Lights a layer.
const LAYER: u32 = 32;

/// Which light reaches which pixel: a `texture_2d_array<f32>` with 32 lights a layer, to be read with
/// [`ShadowMask::WGSL`].
///
/// A bit is 1 where the light's shadow volume says lit, within the rectangle of the screen that its
/// range can touch, at pixels near which there is surface in its range; everywhere else it is 0.
/// Range, cone and facing are the host's: where a light does not reach the surface for one of these
/// reasons, the bit may be either.
#[derive(Debug)]
pub struct ShadowMask {
    size: [u32; 2],
    lights: u32,
    view: TextureView,
    layers: Vec<TextureView>,
}

impl ShadowMask {
    /// `fn umbrage_lit(mask: texture_2d_array<f32>, pixel: vec2i, light: u32) -> bool`, with the pixel
    /// in the target and [`LightId::slot`](crate::LightId::slot) as the light. The mask is a texture of
    /// sample type `Float { filterable: false }` and dimension `D2Array`, and needs no sampler.
    pub const WGSL: &str = include_str!("shaders/lit.wgsl");

    pub(crate) fn new(device: &Device, size: [u32; 2], lights: u32) -> Result<Self, Error> {
        let limits = device.limits();
        let layers = lights.div_ceil(LAYER).max(1);
        let too_large = |limit| {
            Err(Error::MaskTooLarge {
                size,
                lights,
                limit,
            })
        };
        if layers > limits.max_texture_array_layers {
            return too_large("max_texture_array_layers");
        }
        let most = limits.max_texture_dimension_2d;
        if size.iter().any(|&side| side == 0 || side > most) {
            return too_large("max_texture_dimension_2d");
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("umbrage mask"),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        if umbrage_wgpu::captured(scope).is_some() {
            return too_large("memory");
        }
        let layer = |number| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("umbrage mask layer"),
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: number,
                array_layer_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        Ok(Self {
            size,
            lights: layers * LAYER,
            layers: (0..layers).map(layer).collect(),
            view: texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("umbrage mask"),
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..wgpu::TextureViewDescriptor::default()
            }),
        })
    }

    /// To bind.
    pub fn view(&self) -> &TextureView {
        &self.view
    }

    /// Lights that there is room for: numbers below this.
    pub fn lights(&self) -> u32 {
        self.lights
    }
}

/// What draws masks.
#[derive(Debug)]
pub(crate) struct MaskPipelines {
    volumes: VolumePipelines,
    mark: RenderPipeline,
}

impl MaskPipelines {
    pub(crate) fn new(device: &Device, shared: &SharedShadows) -> Self {
        let source = format!(
            "{}\n{}\n{}",
            umbrage_wgpu::CLIP_WGSL,
            umbrage_wgpu::light_wgsl(0),
            include_str!("shaders/mark.wgsl")
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("umbrage mask"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("umbrage mask"),
            bind_group_layouts: &[Some(shared.light_bind_group_layout())],
            immediate_size: 0,
        });
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = wgpu::ColorTargetState {
            format: FORMAT,
            blend: Some(wgpu::BlendState {
                color: add,
                alpha: add,
            }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let mark = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("umbrage mask"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(shared.light_depth_stencil()),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("mark"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self {
            volumes: shared.pipelines_for(device, &[Some(FORMAT)]),
            mark,
        }
    }
}

impl Shadows {
    /// A mask for depth textures of `size`, and for so many lights:
    /// [`Lights::slots`](crate::Lights::slots), or somewhat more to grow into.
    ///
    /// # Errors
    /// If masks were not asked for, or the device has no such textures.
    pub fn mask(&self, device: &Device, size: [u32; 2], lights: u32) -> Result<ShadowMask, Error> {
        match &self.mask {
            Some(_) => ShadowMask::new(device, size, lights),
            None => Err(Error::NoMask),
        }
    }

    /// Records the mask of a view: a render pass for each 32 lights, which the mask has room for,
    /// over the host's finished depth. The stencil must be zero, and is zero again. Bits of lights
    /// that there are none of are zero too.
    ///
    /// # Errors
    /// If depth texture, view or mask do not fit each other or the [`Host`](crate::Host).
    pub fn record_mask(
        &self,
        encoder: &mut CommandEncoder,
        view: &ShadowView,
        depth: &Texture,
        mask: &ShadowMask,
    ) -> Result<(), Error> {
        let pipelines = self.mask.as_ref().ok_or(Error::NoMask)?;
        self.check_view(view)?;
        self.check_depth(view, depth)?;
        let (needed, slots) = ([depth.width(), depth.height()], view.slots());
        if mask.size != needed || mask.lights < slots {
            return Err(Error::Mask {
                found: mask.size,
                lights: mask.lights,
                needed,
                slots,
            });
        }
        let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
        for (layer, target) in mask.layers.iter().enumerate() {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("umbrage mask"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: None,
                    stencil_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Load,
                        store: wgpu::StoreOp::Store,
                    }),
                }),
                ..wgpu::RenderPassDescriptor::default()
            });
            view.set_viewport(&mut pass);
            let first = layer * LAYER as usize;
            let lights = first..first + LAYER as usize;
            view.record(&mut pass, &pipelines.volumes, lights, |pass, light| {
                pass.set_pipeline(&pipelines.mark);
                pass.set_bind_group(0, view.lights(), &[]);
                view.draw_light(pass, light);
            });
        }
        Ok(())
    }
}
