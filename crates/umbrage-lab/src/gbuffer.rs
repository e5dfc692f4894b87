//! The lab's depth pass: depth, and the surface that lights are shaded on.

mod attributes;

use std::borrow::Cow;

use umbrage_wgpu::{CLIP_WGSL, ShadowRenderer};
use wgpu::util::DeviceExt as _;
use wgpu::{ShaderStages, Texture, TextureFormat, TextureUsages, TextureView};

use self::attributes::{Part, pack, parts};
use crate::binding::{self, STORAGE, bind, buffer, layout};
use crate::gpu::{Gpu, GpuError};
use crate::stage::Stage;

/// Depth with the stencil that volumes count in.
pub const DEPTH_STENCIL: TextureFormat = TextureFormat::Depth32FloatStencil8;

const ALBEDO: TextureFormat = TextureFormat::Rgba8UnormSrgb;
const NORMAL: TextureFormat = TextureFormat::Rgba16Float;
const DISTANCE: TextureFormat = TextureFormat::R32Float;

/// Render targets of one size.
#[derive(Debug)]
pub struct Targets {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Depth and stencil.
    pub depth: Texture,
    /// Base colour; alpha is roughness.
    pub albedo: Texture,
    /// World-space unit normal.
    pub normal: Texture,
    /// Distance along the viewing direction; 0 where there is no surface.
    pub distance: Texture,
}

impl Targets {
    /// Creates them, or says which limit is in the way.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let [width, height] = size;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(GpuError::SizeTooLarge {
                width,
                height,
                limit,
            });
        }
        let read = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        Ok(Self {
            size,
            depth: texture(
                gpu,
                "depth",
                size,
                DEPTH_STENCIL,
                TextureUsages::TEXTURE_BINDING,
            ),
            albedo: texture(gpu, "albedo", size, ALBEDO, read),
            normal: texture(gpu, "normal", size, NORMAL, read),
            distance: texture(gpu, "distance", size, DISTANCE, read),
        })
    }
}

/// A 2D render target.
pub fn texture(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    format: TextureFormat,
    usage: TextureUsages,
) -> Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

/// The default view of a texture.
pub fn whole(texture: &Texture) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The view of a depth texture that shaders can read.
pub fn depth_only(texture: &Texture) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        aspect: wgpu::TextureAspect::DepthOnly,
        ..wgpu::TextureViewDescriptor::default()
    })
}

/// Draws the stage's triangles, both sides, whatever casts.
#[derive(Debug)]
pub struct GBufferPass {
    pipeline: wgpu::RenderPipeline,
    parts: Vec<Part>,
    /// The stage's time that normals are of.
    time_s: f64,
}

impl GBufferPass {
    /// Uploads what shading needs; positions are the shadow renderer's.
    pub fn new(gpu: &Gpu, stage: &Stage, shadows: &ShadowRenderer) -> Result<Self, GpuError> {
        Self::with_pipeline(gpu, None, stage, shadows)
    }

    /// The same for other triangles, or for a world whose buffers were replaced; `shadows` is the
    /// renderer that it was made for.
    pub fn renew(
        &mut self,
        gpu: &Gpu,
        stage: &Stage,
        shadows: &ShadowRenderer,
    ) -> Result<(), GpuError> {
        *self = Self::with_pipeline(gpu, Some(self.pipeline.clone()), stage, shadows)?;
        Ok(())
    }

    fn with_pipeline(
        gpu: &Gpu,
        kept: Option<wgpu::RenderPipeline>,
        stage: &Stage,
        shadows: &ShadowRenderer,
    ) -> Result<Self, GpuError> {
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let attributes = layout(gpu, "gbuffer", stages, [buffer(STORAGE); 4]);
        let texture = binding::texture(
            wgpu::TextureSampleType::Float { filterable: true },
            wgpu::TextureViewDimension::D2,
        );
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let images = layout(
            gpu,
            "base colour",
            ShaderStages::FRAGMENT,
            [texture, sampler],
        );
        let world_layout = shadows.world_bind_group_layout();
        let layouts = [&attributes, &images, world_layout];
        let pipeline = kept.unwrap_or_else(|| pipeline(gpu, shadows, layouts));
        let images_of = &stage.scene.images;
        let parts = parts(gpu, stage, &attributes, |image| {
            image_bind_group(gpu, &images, image.map(|i| &images_of[i as usize]))
        })?;
        Ok(Self {
            parts,
            time_s: stage.time_s,
            pipeline,
        })
    }

    /// Brings the normals of actors in step with the stage's time. Positions are the shadow
    /// renderer's.
    pub fn update(&mut self, gpu: &Gpu, stage: &Stage) {
        if self.time_s == stage.time_s || stage.soup.normals.is_empty() {
            return;
        }
        self.time_s = stage.time_s;
        for (actor, range) in (stage.actors.iter()).filter_map(|a| Some((a, stage.share(a)?))) {
            let sources = stage.world.source[range.clone()].iter();
            let normals = sources
                .flat_map(|t| stage.soup.normals[(actor.triangles.start + t) as usize].map(pack));
            let normals: Vec<u32> = normals.collect();
            for part in &self.parts {
                part.write_normals(gpu, range.start as u32, &normals);
            }
        }
    }

    /// Clears and fills the targets.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadows: &ShadowRenderer,
        targets: &Targets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let views = [&targets.albedo, &targets.normal, &targets.distance].map(whole);
        let attachments = views.each_ref().map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("gbuffer"),
            color_attachments: &attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &whole(&targets.depth),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Store,
                }),
            }),
            timestamp_writes: timestamps,
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(2, shadows.world_bind_group(), &[]);
        for part in &self.parts {
            part.draw(&mut pass);
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    shadows: &ShadowRenderer,
    layouts: [&wgpu::BindGroupLayout; 3],
) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let source = format!(
        "{CLIP_WGSL}\n{}\n{}",
        shadows.world_wgsl(2),
        include_str!("shaders/gbuffer.wgsl")
    );
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("gbuffer"),
        source: wgpu::ShaderSource::Wgsl(Cow::Owned(source)),
    });
    let targets = [ALBEDO, NORMAL, DISTANCE].map(|format| Some(format.into()));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("gbuffer"),
        layout: Some(
            &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("gbuffer"),
                bind_group_layouts: &layouts.map(Some),
                immediate_size: 0,
            }),
        ),
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
            format: DEPTH_STENCIL,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn image_bind_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    image: Option<&umbrage_scene::Image>,
) -> wgpu::BindGroup {
    let white = ([1, 1], vec![255u8; 4]);
    let ([width, height], rgba8) = image.map_or((white.0, &white.1), |i| (i.size, &i.rgba8));
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("base colour"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Rgba8UnormSrgb,
            usage: TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        rgba8,
    );
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("base colour"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    });
    let resources = [
        wgpu::BindingResource::TextureView(&whole(&texture)),
        wgpu::BindingResource::Sampler(&sampler),
    ];
    bind(gpu, "base colour", layout, resources)
}
