//! Frames: everything from lights and a view to a lit picture or a mask.

use std::time::Instant;

use umbrage_core::frame::bounds::light_rect;
use umbrage_core::frame::{FramePlan, LightPath, PathRule, PlanOptions, SkipReason};
use umbrage_core::volume::{LayerLimit, VolumeBuilder, Volumes};
use umbrage_core::{Cull, Culls, Light, View};
use umbrage_truth::{Mask, NearClip};
use umbrage_wgpu::{
    Frame, LightCalls, RendererOptions, ShadowRenderer, Uploaded, VolumeColor, WorldWindows,
};

use crate::application::Application;
use crate::gbuffer::{GBufferPass, Targets, texture};
use crate::gpu::{Gpu, GpuError};
use crate::light_pass::LightDraw;
use crate::picture::Lit;
use crate::readback::read_texture;
use crate::rendering::Rendering;
use crate::run::{Run, read_calls};
use crate::spans::{frame_mark, span};
use crate::stage::{Stage, StageLight};
use crate::technique::{Overflow, TechniqueReport, technique};
use crate::timer::{StageTimes, medians, ms_since};

use crate::method::Counting;
pub use crate::method::Method;

/// A device, a stage and what is needed to draw the one on the other.
#[derive(Debug)]
pub struct Lab {
    gpu: Gpu,
    /// Which steps skip work.
    pub culls: Culls,
    /// What masks leave of a light in its shadow.
    pub application: Application,
    /// Layers that the stencil is taken to hold; masks of other kinds have none in parts.
    pub layers: LayerLimit,
    /// Numbers of lights that frames leave out, though their volumes are built and kept.
    pub muted: Vec<usize>,
    /// Numbers of lights whose volumes frames leave out: all that they reach is lit.
    pub unshadowed: Vec<usize>,
    /// Silhouettes and caps of the lights last given.
    pub volumes: Volumes,
    /// How the last frame drew each light.
    pub plan: FramePlan,
    /// What the GPU drew of each light in the last frame; empty if that was not found out.
    pub calls: Vec<LightCalls>,
    /// Bytes written for the last frame.
    pub uploaded: Uploaded,
    /// Times of the last frame, or medians of the last rendering.
    pub times: StageTimes,
    /// Times of each frame of the last rendering; the first warmed up.
    pub frames: Vec<StageTimes>,
    /// What the technique of the last frames holds.
    pub held: TechniqueReport,
    pub(crate) builder: VolumeBuilder,
    pub(crate) lights: Vec<Light>,
    pub(crate) method: Method,
}

impl Lab {
    /// A lab on `gpu`.
    pub fn new(gpu: Gpu) -> Self {
        Self {
            gpu,
            culls: Culls::EVERY,
            application: Application::default(),
            layers: LayerLimit::STENCIL,
            muted: Vec::new(),
            unshadowed: Vec::new(),
            volumes: Volumes::default(),
            plan: FramePlan::default(),
            calls: Vec::new(),
            uploaded: Uploaded::default(),
            times: StageTimes::default(),
            frames: Vec::new(),
            held: TechniqueReport::default(),
            builder: VolumeBuilder::default(),
            lights: Vec::new(),
            method: Method::default(),
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Drops all that was built, scratch memory included: the next frame starts from nothing.
    pub fn forget(&mut self) {
        self.volumes = Volumes::default();
        self.plan = FramePlan::default();
        self.builder = VolumeBuilder::default();
    }

    /// Brings volumes and plan up to date for a view. [`Lab::mask`] draws what stands in `volumes` and
    /// `plan` then; a test may change them in between.
    pub fn prepare(&mut self, stage: &Stage, lights: &[StageLight], view: &View, method: Method) {
        let start = Instant::now();
        let building = span("volumes");
        self.calls.clear();
        self.lights = lights.iter().map(|l| l.light).collect();
        self.method = method;
        let Some(recipe) = method.recipe() else {
            self.volumes = Volumes::empty(self.lights.len());
            self.plan.unshadowed(&self.lights, view);
            self.mute();
            self.times.volumes = ms_since(start);
            self.times.plan = 0.0;
            return;
        };
        let culls = self.culls;
        let in_view = |light: &Light| !culls.has(Cull::View) || !light_rect(view, light).is_empty();
        self.builder.culls = culls;
        self.builder.construction = recipe.construction;
        self.builder.layers = match method.counting() {
            Counting::Stencil => self.layers,
            // In parts there would be more faces, and fewer layers that a mask can represent.
            Counting::Mask(_) => LayerLimit::NONE,
        };
        self.builder
            .settle(&stage.world, &self.lights, in_view, &mut self.volumes);
        self.times.volumes = ms_since(start);
        building.end();
        let _span = span("plan");
        let start = Instant::now();
        let mut options = PlanOptions::default();
        options.culls = culls;
        options.extrusion = recipe.extrusion;
        options.path = match self.gpu.depth_clamp {
            true => recipe.path,
            false => PathRule::ZFailAlways,
        };
        self.plan
            .make(&stage.world, &self.lights, &self.volumes, view, &options);
        self.mute();
        for &light in &self.unshadowed {
            self.plan.leave_unshadowed(light);
        }
        self.times.plan = ms_since(start);
    }

    fn mute(&mut self) {
        for &light in &self.muted {
            self.plan.lights[light].path = LightPath::Skipped(SkipReason::Muted);
        }
    }

    pub(crate) fn run(
        &self,
        stage: &Stage,
        view: &View,
        method: Method,
        draw: LightDraw,
        volume_color: VolumeColor,
    ) -> Result<Run, GpuError> {
        self.gpu.check_alive()?;
        if !stage.world.residuals.is_empty() && !method.takes_residuals() {
            return Err(GpuError::NeedsF32 {
                method: method.name().into_owned(),
            });
        }
        let targets = Targets::new(&self.gpu, view.size)?;
        let formats = [Some(draw.format())];
        let mut options = RendererOptions::new(crate::gbuffer::DEPTH_STENCIL, &formats);
        options.depth_clamp = self.gpu.depth_clamp;
        options.extrusion = self.method.recipe().unwrap_or_default().extrusion;
        options.volume_color = volume_color;
        options.windows = WorldWindows::of(&self.gpu.device, &stage.world)?;
        let mut shadows = ShadowRenderer::new(&self.gpu.device, &options)?;
        shadows.upload_world(&self.gpu.device, &self.gpu.queue, &stage.world)?;
        let surface = GBufferPass::new(&self.gpu, stage, &shadows)?;
        // What a mask leaves in the shadow is for pictures; whether a pixel is lit does not hang
        // on it.
        let application = match draw {
            LightDraw::Shade => self.application,
            _ => Application::Black,
        };
        let technique = technique(method, application, &self.gpu, &shadows, draw)?;
        Ok(Run {
            targets,
            shadows,
            surface,
            technique,
            method,
            draw,
            built: stage.world.topology(),
        })
    }

    /// Renders `repeat` frames after one to warm up, in which volumes are built that are not there
    /// yet, and gives the last picture; `times` are medians.
    pub fn render(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
        repeat: usize,
    ) -> Result<Lit, GpuError> {
        self.render_while(stage, lights, view, method, |frames| frames.len() <= repeat)
    }

    /// As [`Lab::render`], with frames as long as `more`, asked after each, says that those so far
    /// are not enough.
    pub fn render_while(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
        mut more: impl FnMut(&[StageTimes]) -> bool,
    ) -> Result<Lit, GpuError> {
        let mut rendering = self.begin(stage, view, method)?;
        loop {
            self.draw(&mut rendering, stage, lights, view, Instant::now())?;
            if !more(&self.frames) {
                break;
            }
        }
        self.finish(&rendering)
    }

    /// As [`Lab::render`], on a stage that moves: `move_on`, asked before each frame and within its
    /// time, moves it and says whether that frame is to be drawn.
    pub fn render_moving<E: From<GpuError>>(
        &mut self,
        stage: &mut Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
        mut move_on: impl FnMut(&mut Stage, &[StageTimes]) -> Result<bool, E>,
    ) -> Result<Lit, E> {
        let mut rendering = self.begin(stage, view, method)?;
        loop {
            let start = Instant::now();
            if !move_on(stage, &self.frames)? {
                break;
            }
            self.draw(&mut rendering, stage, lights, view, start)?;
        }
        Ok(self.finish(&rendering)?)
    }

    /// Draws a frame that began at `start`, and adds its times to `frames`. The view has the size
    /// that `rendering` was begun with.
    pub fn draw(
        &mut self,
        rendering: &mut Rendering,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        start: Instant,
    ) -> Result<(), GpuError> {
        let Rendering { run, hdr, timer } = rendering;
        self.prepare(stage, lights, view, run.method);
        let upload = Instant::now();
        {
            let _span = span("upload");
            self.upload(run, stage, lights, view)?;
        }
        self.times.upload = ms_since(upload);
        let recording = span("record");
        let record = Instant::now();
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("frame"),
        };
        let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
        run.record_surface(&self.gpu, &mut encoder, timer.as_ref());
        if let Some(timer) = timer {
            timer.mark(&mut encoder, 4);
        }
        let (technique, given) = run.technique(&self.gpu, stage, lights, self.frame(view));
        technique.record(&given, &mut encoder, 0..lights.len(), hdr)?;
        if let Some(timer) = timer {
            timer.mark(&mut encoder, 5);
            timer.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.times.record = ms_since(record);
        recording.end();
        let waiting = span("wait for the GPU");
        let done = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
        done.map_err(|e| self.gpu.lost_or(GpuError::Readback(e.to_string())))?;
        self.gpu.check_alive()?;
        self.times.frame = ms_since(start);
        waiting.end();
        frame_mark();
        if let Some(timer) = timer {
            let spans = timer.read(&self.gpu)?;
            self.times.gpu_surface = spans[0];
            self.times.gpu_receivers = spans[1];
            self.times.gpu_lights = spans[2];
        }
        self.frames.push(self.times);
        Ok(())
    }

    /// Hands the GPU what changed since it was last handed something.
    fn upload(
        &mut self,
        run: &mut Run,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<(), GpuError> {
        self.gpu.check_alive()?;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        if WorldWindows::of(device, &stage.world)? != run.shadows.world_windows() {
            *run = self.run(stage, view, run.method, run.draw, VolumeColor::None)?;
        }
        let replaced = run.shadows.upload_world(device, queue, &stage.world)?;
        if run.rebuilt(stage) || replaced {
            run.surface.renew(&self.gpu, stage, &run.shadows)?;
        }
        run.surface.update(&self.gpu, stage);
        let mut frame = self.frame(view);
        if let Method::LowResolution { .. } = run.method {
            // Its quads are drawn by a renderer of the technique's own.
            frame.culls = frame.culls.without(Cull::Quads);
        }
        let mut uploaded = run.shadows.prepare(device, queue, &frame)?;
        let (technique, given) = run.technique(&self.gpu, stage, lights, self.frame(view));
        technique.prepare(&given)?;
        if let Some((_, own)) = technique.own_renderer() {
            uploaded.volume_bytes += own.volume_bytes;
            uploaded.other_bytes += own.other_bytes;
        }
        self.uploaded = uploaded;
        Ok(())
    }

    /// The last picture; `times` become medians over the frames after the first.
    fn finish(&mut self, rendering: &Rendering) -> Result<Lit, GpuError> {
        let run = &rendering.run;
        let timed = usize::from(self.frames.len() > 1);
        self.times = medians(&self.frames[timed.min(self.frames.len())..]);
        if let Some(first) = self.frames.first() {
            self.times.volumes_first = first.volumes;
            self.times.frame_first = first.frame;
        }
        self.held = run.technique.report();
        self.read_calls(rendering)?;
        self.lit(rendering)
    }

    /// Renders the shadow mask of what `volumes` and `plan` hold: the same volume draws and the
    /// same stencil test as a lit frame, with light draws that write a bit.
    pub fn mask(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<Mask, GpuError> {
        let mut run = self.masking(stage, view)?;
        self.mask_in(&mut run, stage, lights, view)
    }

    /// What [`Lab::mask_in`] draws with, for several masks of one method and one size.
    pub fn masking(&self, stage: &Stage, view: &View) -> Result<Run, GpuError> {
        self.run(stage, view, self.method, LightDraw::Mark, VolumeColor::None)
    }

    /// The pixel-lights, among those that the lights reach, whose layers the method's mask cannot
    /// represent, in what `volumes` and `plan` hold: a bit for each light, as in a mask. `None` if
    /// the method has no such limit, or its mask another resolution.
    pub fn unrepresentable(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<Option<Mask>, GpuError> {
        let Some(layers) = self.method.layers() else {
            return Ok(None);
        };
        let mut run = self.masking(stage, view)?;
        run.technique = Box::new(Overflow::new(&self.gpu, &run.shadows, layers));
        self.mask_in(&mut run, stage, lights, view).map(Some)
    }

    /// As [`Lab::mask`], with buffers that keep what they hold from mask to mask.
    pub fn mask_in(
        &mut self,
        run: &mut Run,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<Mask, GpuError> {
        if run.method != self.method {
            *run = self.masking(stage, view)?;
        }
        self.upload(run, stage, lights, view)?;
        let usage = wgpu::TextureUsages::COPY_SRC;
        let layer = texture(
            &self.gpu,
            "mask",
            view.size,
            LightDraw::Mark.format(),
            usage,
        );
        let mut words = Vec::new();
        for first in (0..lights.len()).step_by(32) {
            let mut encoder =
                self.gpu
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                        label: Some("mask"),
                    });
            if first == 0 {
                run.record_surface(&self.gpu, &mut encoder, None);
            }
            let (technique, given) = run.technique(&self.gpu, stage, lights, self.frame(view));
            let batch = first..lights.len().min(first + 32);
            technique.record(&given, &mut encoder, batch, &layer)?;
            self.gpu.queue.submit([encoder.finish()]);
            let bytes = read_texture(&self.gpu, &layer)?;
            words.extend(
                bytes
                    .chunks_exact(4)
                    .map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])),
            );
        }
        self.calls = read_calls(&self.gpu, run)?;
        self.held = run.technique.report();
        Ok(Mask {
            size: view.size,
            lights: lights.len() as u32,
            words,
        })
    }

    /// What the renderer is to draw.
    pub(crate) fn frame<'a>(&'a self, view: &'a View) -> Frame<'a> {
        let mut frame = Frame::new(view, &self.lights, &self.volumes, &self.plan);
        frame.culls = self.culls;
        frame
    }

    /// GPU memory of the last frame: volumes, and what the technique holds.
    pub fn gpu_bytes(&self) -> u64 {
        let indices = self.volumes.quads.len() + self.plan.caps.len();
        4 * indices as u64 + self.held.gpu_bytes
    }

    /// What happens to surfaces before the near plane on this device.
    pub fn near_clip(&self) -> NearClip {
        self.gpu.near_clip()
    }

    /// How a light was drawn in the last frame: as planned, or not at all because it reaches no
    /// visible surface.
    pub fn path(&self, light: usize) -> LightPath {
        let planned = self.plan.lights[light].path;
        let unseen = self
            .calls
            .get(light)
            .is_some_and(|c| c.light.instance_count == 0);
        match planned {
            LightPath::Skipped(_) => planned,
            _ if unseen => LightPath::Skipped(SkipReason::NoVisibleReceiver),
            _ => planned,
        }
    }

    /// Quads of a light that the last frame drew.
    pub fn quads_drawn(&self, light: usize) -> u32 {
        match (self.path(light), self.calls.get(light)) {
            (LightPath::Skipped(_), _) => 0,
            (_, Some(calls)) => {
                let parts = self.plan.lights[light].parts.iter().skip(1);
                let further = parts.filter_map(|part| self.calls.get(part.number as usize));
                let calls = std::iter::once(calls).chain(further);
                calls.map(|calls| calls.sides.vertex_count / 6).sum()
            }
            (_, None) => self.plan.lights[light].quads.len() as u32,
        }
    }

    /// Lights drawn by each path: z-pass, z-fail, skipped.
    pub fn lights_by_path(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for light in 0..self.plan.lights.len() {
            counts[match self.path(light) {
                LightPath::ZPass { .. } => 0,
                LightPath::ZFail(_) => 1,
                LightPath::Skipped(_) => 2,
            }] += 1;
        }
        counts
    }
}
