//! The renderer: create, prepare, record.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use umbrage_core::Light as CoreLight;
use umbrage_core::frame::bounds::light_rect;
use umbrage_core::frame::{FramePlan, PathRule, PlanOptions};
use umbrage_core::volume::{VolumeBuilder, Volumes};
use umbrage_wgpu::{CLIP_WGSL, Frame, RendererOptions, SharedShadows, ViewShadows, WorldWindows};
use wgpu::{
    BindGroupLayout, CommandEncoder, DepthStencilState, Device, Features, PrimitiveState, Queue,
    RenderPass, Texture,
};

use crate::mask::MaskPipelines;
use crate::{Error, FrameStats, Host, Lights, ShadowView, View, World};

/// Shadows on the host's device. It opens no device, starts no thread but those of rayon, and draws
/// in the host's own encoder and passes.
#[derive(Debug)]
pub struct Shadows {
    id: u64,
    host: Host,
    pub(crate) shared: SharedShadows,
    pub(crate) mask: Option<MaskPipelines>,
    builder: VolumeBuilder,
    volumes: Volumes,
    path: PathRule,
    /// Depth is drawn with `unclipped_depth`.
    depth_clamp: bool,
}

impl Shadows {
    /// What a device is to be opened with, as far as its adapter has it: without
    /// `DEPTH_CLIP_CONTROL` all volumes are drawn with caps, without `INDIRECT_FIRST_INSTANCE` less is
    /// culled, and `Depth32FloatStencil8` is a feature of its own.
    pub const fn features() -> Features {
        Features::DEPTH_CLIP_CONTROL
            .union(Features::INDIRECT_FIRST_INSTANCE)
            .union(Features::DEPTH32FLOAT_STENCIL8)
    }

    /// Creates pipelines for the host's formats. Objects may come and go; but a world that outgrows
    /// the bindings it needs now, by hundreds of megabytes, needs a new renderer: an error of
    /// [`Shadows::prepare`] says so.
    ///
    /// # Errors
    /// What the device cannot do, with what to do instead.
    pub fn new(device: &Device, world: &World, host: &Host) -> Result<Self, Error> {
        host.check(device)?;
        let depth_clamp = device.features().contains(Features::DEPTH_CLIP_CONTROL);
        let mut options = RendererOptions::new(host.depth_stencil, &host.colors);
        options.sample_count = host.samples;
        options.depth = host.depth;
        options.depth_clamp = depth_clamp;
        options.windows = WorldWindows::of(device, &world.core)?;
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let created = SharedShadows::new(device, &options).map(|shared| {
            let mask = host.mask.then(|| MaskPipelines::new(device, &shared));
            (shared, mask)
        });
        if let Some(error) = umbrage_wgpu::captured(scope) {
            return Err(Error::Device(error.to_string()));
        }
        let (shared, mask) = created?;
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Ok(Self {
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            host: host.clone(),
            shared,
            mask,
            builder: VolumeBuilder::default(),
            volumes: Volumes::default(),
            path: match depth_clamp {
                true => PathRule::ZPassWhereExact,
                false => PathRule::ZFailAlways,
            },
            depth_clamp,
        })
    }

    /// What to keep for a view: one for each that a frame has.
    ///
    /// # Errors
    /// If the device has no memory.
    pub fn view(&self, device: &Device) -> Result<ShadowView, Error> {
        Ok(ShadowView {
            of: self.id,
            plan: FramePlan::default(),
            gpu: ViewShadows::new(device, &self.shared)?,
            view: None,
        })
    }

    /// Builds what changed, plans each view, and hands the queue what the GPU does not have yet. Call
    /// it once for each submission, with all of its views; volumes are shared by them.
    ///
    /// # Errors
    /// Views that are none or of another renderer; limits and memory of the device.
    pub fn prepare<'v>(
        &mut self,
        device: &Device,
        queue: &Queue,
        world: &World,
        lights: &Lights,
        views: impl IntoIterator<Item = (&'v mut ShadowView, View)>,
    ) -> Result<FrameStats, Error> {
        let views: Vec<(&mut ShadowView, View)> = views.into_iter().collect();
        for (state, view) in &views {
            self.check_view(state)?;
            view.check()?;
        }
        let (world, lights) = (&world.core, &lights.core[..]);
        let mut stats = FrameStats {
            lights: lights.iter().filter(|light| light.is_usable()).count() as u32,
            ..FrameStats::default()
        };
        let start = Instant::now();
        let in_view = |light: &CoreLight| {
            let mut rects = views.iter().map(|(_, view)| light_rect(&view.core, light));
            rects.any(|rect| !rect.is_empty())
        };
        let rebuilt = (self.builder).build(world, lights, in_view, &mut self.volumes);
        stats.rebuilt = rebuilt as u32;
        stats.build_ms = ms_since(start);

        let start = Instant::now();
        self.shared.upload_world(device, queue, world)?;
        stats.uploaded_bytes = (self.shared).upload_volumes(device, queue, &self.volumes)?;
        stats.upload_ms = ms_since(start);
        let mut options = PlanOptions::default();
        options.path = self.path;
        for (state, view) in views {
            let start = Instant::now();
            (state.plan).make(world, lights, &self.volumes, &view.core, &options);
            stats.count(&state.plan);
            stats.plan_ms += ms_since(start);
            let start = Instant::now();
            let frame = Frame::new(&view.core, lights, &self.volumes, &state.plan);
            state.view = Some(view);
            let uploaded = (state.gpu).prepare(device, queue, &self.shared, &frame, view.origin)?;
            stats.uploaded_bytes += uploaded.volume_bytes + uploaded.other_bytes;
            stats.upload_ms += ms_since(start);
        }
        Ok(stats)
    }

    /// Builds all volumes, and leaves out of them all casters that are hidden behind others: what
    /// the next frames would otherwise do bit by bit. For loading screens.
    pub fn settle(&mut self, world: &World, lights: &Lights) {
        (self.builder).settle(&world.core, &lights.core, |_| true, &mut self.volumes);
    }

    /// Finds out from the finished depth which lights reach visible surface, and which part of their
    /// volumes matters for it: a compute pass, between the depth pass and the lights. Not calling it
    /// changes no shadow, but draws more. It does nothing with several samples a pixel, or without
    /// `INDIRECT_FIRST_INSTANCE`.
    ///
    /// What is not in the depth (glass, fog) does not count: a light that reaches only such is not
    /// drawn.
    ///
    /// # Errors
    /// If depth texture and view do not fit each other or the [`Host`].
    pub fn find_receivers(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        view: &mut ShadowView,
        depth: &Texture,
    ) -> Result<(), Error> {
        self.check_view(view)?;
        self.check_depth(view, depth)?;
        if self.host.samples != 1 {
            return Ok(());
        }
        if !depth.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
            return Err(Error::Depth {
                what: "cannot be read: create it with TEXTURE_BINDING among its usages",
            });
        }
        let depth = depth.create_view(&wgpu::TextureViewDescriptor {
            aspect: wgpu::TextureAspect::DepthOnly,
            ..wgpu::TextureViewDescriptor::default()
        });
        (view.gpu).find_receivers(device, encoder, &self.shared, &depth, None);
        Ok(())
    }

    /// Records all lights of a view into the host's pass, calling `draw` after each one's volume with
    /// the light's number ([`LightId::slot`](crate::LightId::slot)). Scissor and stencil stand ready
    /// then: set a pipeline that has [`Shadows::light_stencil`], its bind groups, and call
    /// [`ShadowView::draw_light`] once. Fragments pass where the light is not in shadow.
    ///
    /// The pass has the formats of the [`Host`], the finished depth, read only or not, and a stencil
    /// of zeros, which it leaves behind. Scissor, stencil reference, pipeline and bind groups 0 and 1
    /// are others afterwards.
    ///
    /// # Errors
    /// If the view is of another renderer.
    pub fn record(
        &self,
        pass: &mut RenderPass<'_>,
        view: &ShadowView,
        draw: impl FnMut(&mut RenderPass<'_>, u32),
    ) -> Result<(), Error> {
        self.check_view(view)?;
        let all = 0..view.plan.lights.len();
        view.record(pass, self.shared.pipelines(), all, draw);
        Ok(())
    }

    /// WGSL for the host's shaders, with all bindings in bind group `group`.
    ///
    /// Depth passes bind [`ShadowView::world`] there, and have `umbrage_world_corner(corner)`, which
    /// gives an `UmbrageCorner { clip, place, normal }`: a clip position that must go to a
    /// `@builtin(position) @invariant`, the place relative to the eye, and the triangle's normal, of
    /// any length. `umbrage_corner(corner)` is the vertex at a corner.
    ///
    /// Light draws bind [`ShadowView::lights`] there, and have `umbrage_light_corner(index, light)`,
    /// which gives clip positions for vertex index and instance index.
    ///
    /// Both have the view at binding 0, as `umbrage_world_view` and as `umbrage_view`: with
    /// `umbrage_ray(view, pixel)` (from the eye through a pixel of the target, as far as one metre
    /// ahead), `umbrage_nearness(view, depth)` (`near / distance` ahead), and
    /// `umbrage_minus_eye(view, place, residual)` (from the eye to an f64 place as two f32).
    pub fn wgsl(&self, group: u32) -> String {
        let [world, light] = [
            self.shared.world_wgsl(group),
            umbrage_wgpu::light_wgsl(group),
        ];
        format!("{CLIP_WGSL}\n{world}\n{light}")
    }

    /// Of what depth passes bind: [`ShadowView::world`].
    pub fn world_layout(&self) -> &BindGroupLayout {
        self.shared.world_bind_group_layout()
    }

    /// Of what light draws bind: [`ShadowView::lights`].
    pub fn light_layout(&self) -> &BindGroupLayout {
        self.shared.light_bind_group_layout()
    }

    /// Primitive state of the host's depth pass: both sides of triangles, with depth clamping where
    /// the device has it.
    pub fn depth_primitive(&self) -> PrimitiveState {
        PrimitiveState {
            unclipped_depth: self.depth_clamp,
            ..PrimitiveState::default()
        }
    }

    /// Depth state of the host's depth pass; clear depth with [`Shadows::depth_clear`] and the stencil
    /// with 0.
    pub fn depth_stencil(&self) -> DepthStencilState {
        DepthStencilState {
            format: self.host.depth_stencil,
            depth_write_enabled: Some(true),
            depth_compare: Some(self.host.depth.nearer()),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }
    }

    /// Depth where there is nothing.
    pub fn depth_clear(&self) -> f32 {
        self.host.depth.background()
    }

    /// Depth and stencil state of the host's light draws.
    pub fn light_stencil(&self) -> DepthStencilState {
        self.shared.light_depth_stencil()
    }

    pub(crate) fn check_view(&self, view: &ShadowView) -> Result<(), Error> {
        match view.of == self.id {
            true => Ok(()),
            false => Err(Error::ForeignView),
        }
    }

    /// Whether a depth texture is as the host said, and contains the view.
    pub(crate) fn check_depth(&self, view: &ShadowView, depth: &Texture) -> Result<(), Error> {
        let wrong = |what| Err(Error::Depth { what });
        if depth.format() != self.host.depth_stencil {
            return wrong("has another format than the renderer was made for");
        }
        if depth.sample_count() != self.host.samples {
            return wrong("has another sample count than the renderer was made for");
        }
        if depth.depth_or_array_layers() != 1 || depth.mip_level_count() != 1 {
            return wrong("has layers or mip levels: hand over one of a single layer and level");
        }
        let Some(view) = &view.view else {
            return Ok(());
        };
        let fits = |i: usize, side: u32| {
            let end = view.origin[i].checked_add(view.core.size[i]);
            end.is_some_and(|end| end <= side)
        };
        match fits(0, depth.width()) && fits(1, depth.height()) {
            true => Ok(()),
            false => wrong("is smaller than the view: make it larger, or the view smaller"),
        }
    }
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
