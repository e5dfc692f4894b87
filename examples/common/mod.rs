//! What any wgpu program needs, shadows or not: a device, textures, pipelines, a picture file.
#![allow(dead_code)] // each example uses its own part

use std::error::Error;
use std::io::BufWriter;
use std::path::Path;

use umbrage::wgpu;
use wgpu::{BindGroupLayout, TextureFormat, TextureUsages};

/// Where light adds up.
pub(crate) const HDR: TextureFormat = TextureFormat::Rgba16Float;
/// Depth with a stencil.
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32FloatStencil8;

/// An open device.
pub(crate) struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

impl Gpu {
    /// The best adapter there is, with those of the features that it has.
    pub(crate) fn open(features: wgpu::Features) -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::PRIMARY,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let options = wgpu::RequestAdapterOptions::default();
        let adapter = pollster::block_on(instance.request_adapter(&options))?;
        let descriptor = wgpu::DeviceDescriptor {
            required_features: adapter.features() & features,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
        Ok(Self { device, queue })
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        (self.device).create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// A render target that shaders can read.
    pub(crate) fn target(&self, [width, height]: [u32; 2], format: TextureFormat) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    /// A storage buffer with something in it, and a bind group of it and of textures, for shaders
    /// that read them at bindings 0, 1, ...
    pub(crate) fn bind(&self, items: &[u8], textures: &[&wgpu::TextureView]) -> Bound {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (items.len() as u64).max(16).next_multiple_of(4),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, items);
        let mut types = vec![wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        }];
        types.extend(textures.iter().map(|view| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: match view.texture().depth_or_array_layers() {
                1 => wgpu::TextureViewDimension::D2,
                _ => wgpu::TextureViewDimension::D2Array,
            },
            multisampled: false,
        }));
        let layouts: Vec<_> = (0..)
            .zip(types)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty,
                count: None,
            })
            .collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &layouts,
        };
        let layout = self.device.create_bind_group_layout(&descriptor);
        let views = textures
            .iter()
            .map(|view| wgpu::BindingResource::TextureView(view));
        let entries: Vec<_> = (0..)
            .zip(std::iter::once(buffer.as_entire_binding()).chain(views))
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        Bound { layout, group }
    }

    /// Creates a pipeline.
    pub(crate) fn pipeline(&self, pipeline: &Pipeline<'_>) -> wgpu::RenderPipeline {
        let Pipeline { name, wgsl, .. } = pipeline;
        let device = &self.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl((*wgsl).into()),
        });
        let groups: Vec<_> = pipeline.layouts.iter().copied().map(Some).collect();
        let one = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = pipeline.add.then_some(wgpu::BlendState {
            color: one,
            alpha: one,
        });
        let target = pipeline.target.map(|format| wgpu::ColorTargetState {
            format,
            blend,
            write_mask: wgpu::ColorWrites::ALL,
        });
        let targets = [target];
        let [vertex, fragment] = ["vertex", "fragment"].map(|kind| format!("{name}_{kind}"));
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(
                &device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(name),
                    bind_group_layouts: &groups,
                    immediate_size: 0,
                }),
            ),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(&vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: pipeline.primitive,
            depth_stencil: Some(pipeline.depth_stencil.clone()),
            multisample: wgpu::MultisampleState {
                count: pipeline.samples,
                ..wgpu::MultisampleState::default()
            },
            fragment: pipeline.target.map(|_| wgpu::FragmentState {
                module: &module,
                entry_point: Some(&fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// The colours of a finished `HDR` target, row by row.
    pub(crate) fn read_hdr(
        &self,
        encoder: wgpu::CommandEncoder,
        target: &wgpu::Texture,
    ) -> Vec<[f32; 3]> {
        let texels = self.read(encoder, target, 0);
        let channel = |t: &[u8], i| half(u16::from_le_bytes([t[i], t[i + 1]]));
        let colour = |t: &[u8]| [channel(t, 0), channel(t, 2), channel(t, 4)];
        texels.chunks_exact(8).map(colour).collect()
    }

    /// Submits, and gives the bytes of one layer of a target, row by row.
    pub(crate) fn read(
        &self,
        mut encoder: wgpu::CommandEncoder,
        target: &wgpu::Texture,
        layer: u32,
    ) -> Vec<u8> {
        let texel = target.format().block_copy_size(None).unwrap_or(4);
        let row = target.width() * texel;
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(padded) * u64::from(target.height()),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut source = target.as_image_copy();
        source.origin.z = layer;
        encoder.copy_texture_to_buffer(
            source,
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d {
                depth_or_array_layers: 1,
                ..target.size()
            },
        );
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
        let Ok(mapped) = buffer.get_mapped_range(..) else {
            return Vec::new();
        };
        let rows = mapped.chunks(padded as usize);
        rows.flat_map(|r| r[..row as usize].to_vec()).collect()
    }
}

/// A bind group and its layout.
pub(crate) struct Bound {
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) group: wgpu::BindGroup,
}

/// What a pipeline is made of; its entry points are `NAME_vertex` and `NAME_fragment`.
pub(crate) struct Pipeline<'a> {
    pub(crate) name: &'a str,
    pub(crate) wgsl: &'a str,
    pub(crate) layouts: &'a [&'a BindGroupLayout],
    pub(crate) primitive: wgpu::PrimitiveState,
    pub(crate) depth_stencil: wgpu::DepthStencilState,
    pub(crate) samples: u32,
    /// None if it draws only depth.
    pub(crate) target: Option<TextureFormat>,
    /// Whether colours add up.
    pub(crate) add: bool,
}

impl<'a> Pipeline<'a> {
    pub(crate) fn new(name: &'a str, wgsl: &'a str, target: TextureFormat) -> Self {
        Self {
            name,
            wgsl,
            layouts: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: wgpu::DepthStencilState::stencil(DEPTH, wgpu::StencilState::default()),
            samples: 1,
            target: Some(target),
            add: false,
        }
    }
}

/// A pass with one colour target, cleared to black, and depth and stencil cleared as `clear` says, or
/// kept, depth read only.
pub(crate) fn pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    target: Option<&wgpu::Texture>,
    depth: &wgpu::Texture,
    clear: Option<f32>,
) -> wgpu::RenderPass<'e> {
    let whole = wgpu::TextureViewDescriptor::default();
    let target = target.map(|texture| texture.create_view(&whole));
    let color = target.as_ref().map(|view| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations::default(),
    });
    let colors: Vec<_> = color.map(Some).into_iter().collect();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &colors,
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth.create_view(&whole),
            depth_ops: clear.map(|depth| wgpu::Operations {
                load: wgpu::LoadOp::Clear(depth),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: Some(wgpu::Operations {
                load: match clear {
                    Some(_) => wgpu::LoadOp::Clear(0),
                    None => wgpu::LoadOp::Load,
                },
                store: wgpu::StoreOp::Store,
            }),
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Half float to float; halves below 2^-14 become 0.
fn half(bits: u16) -> f32 {
    let (sign, rest) = (u32::from(bits >> 15) << 31, u32::from(bits & 0x7fff));
    match rest >> 10 {
        0 => 0.0,
        _ => f32::from_bits(sign | ((rest << 13) + (112 << 23))),
    }
}

/// Writes linear light as a PNG, brightness mapped as x / (1 + x).
pub(crate) fn write_png(
    path: &Path,
    size: [u32; 2],
    light: &[[f32; 3]],
) -> Result<(), Box<dyn Error>> {
    let byte = |x: f32| ((x / (1.0 + x)).powf(1.0 / 2.2) * 255.0 + 0.5) as u8;
    let bytes: Vec<u8> = light.iter().flat_map(|c| c.map(byte)).collect();
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let part = path.with_extension("part");
    let mut encoder = png::Encoder::new(
        BufWriter::new(std::fs::File::create(&part)?),
        size[0],
        size[1],
    );
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    std::fs::rename(&part, path)?;
    Ok(())
}

/// Positions and indices, as a loader gives them.
#[derive(Default)]
pub(crate) struct Triangles {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<u32>,
}

impl Triangles {
    /// A box, its front outside.
    pub(crate) fn add_box(&mut self, low: [f32; 3], high: [f32; 3]) {
        let first = self.positions.len() as u32;
        for corner in 0..8 {
            let side = |axis| {
                if corner >> axis & 1 == 1 {
                    high[axis]
                } else {
                    low[axis]
                }
            };
            self.positions.push([side(0), side(1), side(2)]);
        }
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        for [a, b, c, d] in faces {
            let corners = [a, b, c, a, c, d];
            self.indices
                .extend(corners.map(|corner: u32| first + corner));
        }
    }

    /// A floor of `half` metres to each side, with pillars on it in rows.
    pub(crate) fn hall(half: f32, pillars: u32) -> Self {
        let mut hall = Self::default();
        hall.add_box([-half, -1.0, -half], [half, 0.0, half]);
        let step = 2.0 * half / pillars as f32;
        for (row, column) in (0..pillars).flat_map(|r| (0..pillars).map(move |c| (r, c))) {
            let at = |i: u32| -half + (i as f32 + 0.5) * step;
            let height = 1.0 + ((row * 7 + column * 3) % 5) as f32 * 0.4;
            let (x, z) = (at(column), at(row));
            hall.add_box([x - 0.2, 0.0, z - 0.2], [x + 0.2, height, z + 0.2]);
        }
        hall
    }
}
