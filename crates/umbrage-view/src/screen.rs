//! What a frame puts on the screen: the picture, lines over it, the panels on top.

use umbrage_core::View;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::rendering::Rendering;

use crate::lines::LinePass;
use crate::tone::TonePass;

/// Formats that screens are drawn in: what is written is encoded already.
pub(crate) const FORMATS: [wgpu::TextureFormat; 2] = [
    wgpu::TextureFormat::Bgra8Unorm,
    wgpu::TextureFormat::Rgba8Unorm,
];

/// The passes, for targets of one format.
pub(crate) struct Screen {
    tone: TonePass,
    pub(crate) lines: LinePass,
    panels: egui_wgpu::Renderer,
}

/// The picture under the panels.
pub(crate) struct Picture<'a> {
    pub(crate) rendering: &'a Rendering,
    pub(crate) exposure: f32,
    pub(crate) view: &'a View,
    /// Whether there are lines, and then whether surfaces do not hide them.
    pub(crate) lines: Option<bool>,
}

impl Screen {
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let options = egui_wgpu::RendererOptions::default();
        Self {
            tone: TonePass::new(gpu, format),
            lines: LinePass::new(gpu, format),
            panels: egui_wgpu::Renderer::new(&gpu.device, format, options),
        }
    }

    /// Draws all of it; `target` has the size of the picture's view.
    pub(crate) fn paint(
        &mut self,
        gpu: &Gpu,
        picture: &Picture<'_>,
        ctx: &egui::Context,
        output: &mut egui::FullOutput,
        target: &wgpu::TextureView,
    ) {
        let label = Some("screen");
        let mut encoder =
            (gpu.device).create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let (rendering, view) = (picture.rendering, picture.view);
        self.tone
            .record(gpu, &mut encoder, rendering, picture.exposure, target);
        if let Some(through) = picture.lines {
            let depth = &rendering.surface().depth;
            self.lines
                .record(gpu, &mut encoder, target, depth, view, through);
        }
        let size = egui_wgpu::ScreenDescriptor {
            size_in_pixels: view.size,
            pixels_per_point: output.pixels_per_point,
        };
        let shapes = std::mem::take(&mut output.shapes);
        let jobs = ctx.tessellate(shapes, output.pixels_per_point);
        let mut textures = std::mem::take(&mut output.textures_delta);
        for (id, delta) in
            (textures.set.iter()).flat_map(|(id, of)| of.iter().map(move |d| (id, d)))
        {
            (self.panels).update_texture(&gpu.device, &gpu.queue, *id, delta);
        }
        let callbacks =
            (self.panels).update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &size);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        self.panels
            .render(&mut pass.forget_lifetime(), &jobs, &size);
        gpu.queue
            .submit(callbacks.into_iter().chain([encoder.finish()]));
        for id in &textures.free {
            self.panels.free_texture(id);
        }
        // Done with; debug builds of egui panic where it is dropped before.
        textures.clear();
    }
}
