//! A host that draws the masks of a scene in every way the library has.

use std::sync::LazyLock;

use umbrage::wgpu::{self, TextureFormat};
use umbrage::{Host, Light, Lights, Mesh, ShadowView, Shadows, View, World};
use umbrage_core::LightShape;
use umbrage_lab::stage::StageLight;
use umbrage_truth::{Judgement, Mask};

use crate::common::{Site, WALK, judged};
use crate::host_depth::common::{Gpu, Pipeline, pass};

/// With every feature that the adapter has.
pub(crate) static GPU: LazyLock<Gpu> = LazyLock::new(|| open(Shadows::features()));

pub(crate) fn open(features: wgpu::Features) -> Gpu {
    Gpu::open(features).expect("these tests need an adapter")
}

/// Bits of a mask.
pub(crate) const BITS: TextureFormat = TextureFormat::Rgba8Unorm;

/// What a scene is to the library.
pub(crate) struct Given {
    pub(crate) world: World,
    pub(crate) lights: Lights,
}

impl Given {
    /// The first `count` lights of a site.
    pub(crate) fn new(site: &Site, count: usize) -> Self {
        let mesh = &site.stage.mesh;
        let indices = mesh.triangles.as_flattened();
        let positions = bytemuck::cast_slice(&mesh.positions);
        let mesh = Mesh::new(positions, indices).casting(&mesh.casting);
        let world = World::build(&[mesh]).expect("a world");
        let mut lights = Lights::default();
        for light in &site.lights[..count] {
            lights.insert(light_of(light)).expect("a light");
        }
        Self { world, lights }
    }
}

fn light_of(light: &StageLight) -> Light {
    let core = &light.light;
    let at = core.position.to_array();
    match core.shape {
        LightShape::Point => Light::point(at, core.range),
        LightShape::Spot {
            direction,
            cos_outer,
        } => Light::spot(at, direction, cos_outer.acos(), core.range),
        LightShape::Directional { direction } => Light::directional(direction),
    }
}

/// A view across the lower hall of Stormkeep, for the library and for the judge.
pub(crate) fn hall(site: &Site, near_m: f32, size: [u32; 2]) -> (View, umbrage_core::View) {
    let [eye, ahead] = WALK.map(|p| site.stage.local(p.as_dvec3()));
    (
        View::look_at(eye, ahead, 1.2, near_m, size),
        umbrage_core::View::look_at(eye, ahead, 1.2, near_m, size),
    )
}

/// A renderer with its depth pass.
pub(crate) struct Drawing<'g> {
    gpu: &'g Gpu,
    samples: u32,
    pub(crate) shadows: Shadows,
    depth_pipeline: wgpu::RenderPipeline,
    /// Marks a light, and draws it without a mark.
    marking: [wgpu::RenderPipeline; 2],
}

const SHADER: &str = "
    @vertex
    fn depth_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) @invariant vec4f {
        return umbrage_world_corner(index).clip;
    }

    struct Light { @builtin(position) clip: vec4f, @location(0) @interpolate(flat) number: u32 }

    @vertex
    fn mark_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Light {
        return Light(umbrage_light_corner(index, light), light);
    }

    @fragment
    fn mark_fragment(in: Light) -> @location(0) vec4f {
        return unpack4x8unorm(1u << (in.number % 32u));
    }

    @vertex
    fn skip_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Light {
        return Light(umbrage_light_corner(index, light), light);
    }

    @fragment
    fn skip_fragment() -> @location(0) vec4f { return vec4f(0.0); }
";

impl<'g> Drawing<'g> {
    /// `host` and its sample count.
    pub(crate) fn new(gpu: &'g Gpu, host: Host, samples: u32, world: &World) -> Self {
        let host = host.with_samples(samples);
        let shadows = Shadows::new(&gpu.device, world, &host).expect("a renderer");
        let wgsl = shadows.wgsl(0) + SHADER;
        let depth = Pipeline {
            layouts: &[shadows.world_layout()],
            primitive: shadows.depth_primitive(),
            depth_stencil: shadows.depth_stencil(),
            samples,
            target: None,
            ..Pipeline::new("depth", &wgsl, BITS)
        };
        let light = |name| {
            gpu.pipeline(&Pipeline {
                layouts: &[shadows.light_layout()],
                depth_stencil: shadows.light_stencil(),
                samples,
                add: true,
                ..Pipeline::new(name, &wgsl, BITS)
            })
        };
        Self {
            depth_pipeline: gpu.pipeline(&depth),
            marking: ["mark", "skip"].map(light),
            gpu,
            samples,
            shadows,
        }
    }

    pub(crate) fn view(&self) -> ShadowView {
        self.shadows.view(&self.gpu.device).expect("a view")
    }

    /// A target of the renderer's sample count.
    pub(crate) fn target(&self, size: [u32; 2], format: TextureFormat) -> wgpu::Texture {
        let single = self.gpu.target(size, format);
        if self.samples == 1 {
            return single;
        }
        self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: single.size(),
            mip_level_count: 1,
            sample_count: self.samples,
            dimension: single.dimension(),
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    }

    fn draw_depth(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        given: &Given,
        depth: &wgpu::Texture,
        eyes: &mut [ShadowView],
    ) {
        let mut drawing = pass(encoder, None, depth, Some(self.shadows.depth_clear()));
        drawing.set_pipeline(&self.depth_pipeline);
        for eye in eyes.iter() {
            eye.set_viewport(&mut drawing);
            drawing.set_bind_group(0, eye.world(), &[]);
            drawing.draw(given.world.corners(), 0..1);
        }
        drop(drawing);
        for eye in eyes {
            let found = self
                .shadows
                .find_receivers(&self.gpu.device, encoder, eye, depth);
            found.expect("a depth texture that fits");
        }
    }

    /// Masks of views that share one target, each of the whole target, in one submission.
    pub(crate) fn masks(
        &mut self,
        given: &Given,
        views: &[View],
        eyes: &mut [ShadowView],
        target: [u32; 2],
    ) -> Vec<Mask> {
        self.prepare(given, views, eyes);
        let depth = self.target(target, self.shadows.depth_stencil().format);
        let mut encoder = self.gpu.encoder();
        self.draw_depth(&mut encoder, given, &depth, eyes);
        let slots = given.lights.slots();
        let record = |eye: &ShadowView| {
            let mask = self.shadows.mask(&self.gpu.device, target, slots);
            let mask = mask.expect("a mask");
            let recorded = (self.shadows).record_mask(&mut encoder, eye, &depth, &mask);
            recorded.expect("a mask that fits");
            mask
        };
        let masks: Vec<_> = eyes.iter().map(record).collect();
        self.gpu.queue.submit([encoder.finish()]);
        let read = |mask: &umbrage::ShadowMask| {
            let layers = 0..slots.div_ceil(32);
            let read = |layer| {
                self.gpu
                    .read(self.gpu.encoder(), mask.view().texture(), layer)
            };
            mask_of(target, slots, layers.flat_map(read).collect())
        };
        masks.iter().map(read).collect()
    }

    fn prepare(&mut self, given: &Given, views: &[View], eyes: &mut [ShadowView]) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        // Leaving out hidden casters later would change how cracks between triangles are rounded.
        self.shadows.settle(&given.world, &given.lights);
        let views = eyes.iter_mut().zip(views.iter().copied());
        let stats = self
            .shadows
            .prepare(device, queue, &given.world, &given.lights, views);
        stats.expect("views that can be prepared");
    }

    /// The mask of one view by callbacks; lights for which `skip` is true are not marked. With several
    /// samples a bit is what most of them say, if it is the lowest of its channel and the only one.
    pub(crate) fn by_callback(
        &mut self,
        given: &Given,
        view: View,
        target: [u32; 2],
        skip: impl Fn(u32) -> bool,
    ) -> Mask {
        let mut eyes = [self.view()];
        self.prepare(given, &[view], &mut eyes);
        let depth = self.target(target, self.shadows.depth_stencil().format);
        let bits = self.target(target, BITS);
        let resolved = self.gpu.target(target, BITS);
        let mut encoder = self.gpu.encoder();
        self.draw_depth(&mut encoder, given, &depth, &mut eyes);
        let eye = &eyes[0];
        let slots = given.lights.slots();
        let mut bytes = Vec::new();
        for layer in 0..slots.div_ceil(32) {
            let mut drawing = pass(&mut encoder, Some(&bits), &depth, None);
            eye.set_viewport(&mut drawing);
            let recorded = self.shadows.record(&mut drawing, eye, |pass, light| {
                let is_marked = light / 32 == layer && !skip(light);
                pass.set_pipeline(&self.marking[usize::from(!is_marked)]);
                pass.set_bind_group(0, eye.lights(), &[]);
                eye.draw_light(pass, light);
            });
            recorded.expect("a view of this renderer");
            drop(drawing);
            let read = match self.samples {
                1 => &bits,
                _ => {
                    resolve(&mut encoder, &bits, &resolved);
                    &resolved
                }
            };
            let next = self.gpu.encoder();
            let done = std::mem::replace(&mut encoder, next);
            bytes.extend(self.gpu.read(done, read, 0));
        }
        mask_of(target, slots, bytes)
    }
}

fn resolve(encoder: &mut wgpu::CommandEncoder, from: &wgpu::Texture, to: &wgpu::Texture) {
    let [from, to] = [from, to].map(|texture| texture.create_view(&Default::default()));
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &from,
            depth_slice: None,
            resolve_target: Some(&to),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
}

fn mask_of(size: [u32; 2], lights: u32, bytes: Vec<u8>) -> Mask {
    let words = bytes.chunks_exact(4);
    let words = words.map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]));
    Mask {
        size,
        lights,
        words: words.collect(),
    }
}

/// A part of a mask.
pub(crate) fn cropped(mask: &Mask, origin: [u32; 2], size: [u32; 2]) -> Mask {
    let mut part = Mask::new(size, mask.lights);
    for light in 0..mask.lights {
        for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
            let lit = mask.get(origin[0] + x, origin[1] + y, light);
            part.set(x, y, light, lit);
        }
    }
    part
}

/// Bits that differ.
pub(crate) fn differences(a: &Mask, b: &Mask) -> u32 {
    assert_eq!((a.size, a.lights), (b.size, b.lights));
    let words = a.words.iter().zip(&b.words);
    words.map(|(a, b)| (a ^ b).count_ones()).sum()
}

/// What the oracle says of a mask of the first lights of a site.
pub(crate) fn truth(site: &Site, view: &umbrage_core::View, mask: &Mask) -> Judgement {
    let lights = &site.lights[..mask.lights as usize];
    judged(site, lights, view, mask, &[])
}
