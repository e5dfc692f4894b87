//! The window: events to input, frames to the screen.

use std::sync::Arc;

use egui_winit::State;
use umbrage_lab::gpu::Gpu;
use umbrage_lab::picture::write_png;
use umbrage_lab::readback::read_texture;
use wgpu::CurrentSurfaceTexture as Current;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use crate::screen::FORMATS;
use crate::viewer::Viewer;
use crate::{DebugView, Options, Screenshot, Seen, Subject, ViewError};

/// Opens a window on a subject; returns when it is closed, or its screenshot is taken. Call it on the
/// main thread, once in a process.
pub fn open(subject: Subject, options: Options) -> Result<Seen, ViewError> {
    check_libraries()?;
    let event_loop = EventLoop::new().map_err(|error| ViewError::NoWindow(error.to_string()))?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let mut app = App {
        subject: Some(subject),
        options,
        shown: None,
        seen: Seen::default(),
        error: None,
    };
    let ran = event_loop.run_app(&mut app);
    match app.error {
        Some(error) => Err(error),
        None => ran.map_err(|error| ViewError::NoWindow(error.to_string())),
    }?;
    Ok(app.seen)
}

struct App {
    /// Until the window is there.
    subject: Option<Subject>,
    options: Options,
    shown: Option<Shown>,
    seen: Seen,
    error: Option<ViewError>,
}

/// A window with what it shows.
struct Shown {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    input: State,
    viewer: Viewer,
}

impl Shown {
    fn new(
        event_loop: &ActiveEventLoop,
        subject: Subject,
        options: &Options,
    ) -> Result<Self, ViewError> {
        let [width, height] = subject.view.size;
        let attributes = Window::default_attributes()
            .with_title(format!("{} - Umbrage", subject.stage.scene.name))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = event_loop.create_window(attributes);
        let window = Arc::new(window.map_err(|error| ViewError::NoWindow(error.to_string()))?);
        let display = Box::new(event_loop.owned_display_handle());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::PRIMARY,
            ..wgpu::InstanceDescriptor::new_with_display_handle(display)
        });
        let surface = surface(&instance, &window)?;
        let (gpu, capabilities) = Gpu::open_for(&instance, &surface, &options.adapter)?;
        let format = FORMATS
            .into_iter()
            .find(|f| capabilities.formats.contains(f));
        let config = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: format
                .ok_or_else(|| ViewError::Surface(format!("it takes none of {FORMATS:?}")))?,
            color_space: wgpu::SurfaceColorSpace::Auto,
            width,
            height,
            present_mode: wgpu::PresentMode::AutoVsync,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: Vec::new(),
        };
        let viewer = Viewer::new(gpu, subject, options, config.format)?;
        let side = viewer.gpu().device.limits().max_texture_dimension_2d as usize;
        let scale = Some(window.scale_factor() as f32);
        let (ctx, id) = (viewer.ctx().clone(), egui::ViewportId::ROOT);
        let input = State::new(ctx, id, &window, scale, window.theme(), Some(side));
        let mut shown = Self {
            window,
            instance,
            surface,
            config,
            input,
            viewer,
        };
        shown.fit()?;
        if options.shown == DebugView::Wrong && options.screenshot.is_some() {
            shown.viewer.start_check()?;
        }
        Ok(shown)
    }

    /// Fits surface and viewer to the window; false if nothing of it can be seen.
    fn fit(&mut self) -> Result<bool, ViewError> {
        let PhysicalSize { width, height } = self.window.inner_size();
        if width == 0 || height == 0 {
            return Ok(false);
        }
        self.viewer.resize([width, height])?;
        (self.config.width, self.config.height) = (width, height);
        self.surface
            .configure(&self.viewer.gpu().device, &self.config);
        Ok(true)
    }

    /// A texture of the surface; nothing where this frame is to be left out.
    fn acquire(&mut self) -> Result<Option<wgpu::SurfaceTexture>, ViewError> {
        // Once more after it was brought up to date.
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                Current::Success(texture) | Current::Suboptimal(texture) => {
                    return Ok(Some(texture));
                }
                Current::Timeout | Current::Occluded => return Ok(None),
                Current::Outdated => {}
                Current::Lost => self.surface = surface(&self.instance, &self.window)?,
                Current::Validation => return Err(ViewError::Surface("it is not valid".into())),
            }
            if !self.fit()? {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// Draws a frame; true if another should follow at once.
    fn frame(&mut self) -> Result<bool, ViewError> {
        let Some(texture) = self.acquire()? else {
            return Ok(false);
        };
        let view = texture
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let again = self.draw(&view)?;
        self.window.pre_present_notify();
        self.viewer.gpu().queue.present(texture);
        Ok(again)
    }

    fn draw(&mut self, target: &wgpu::TextureView) -> Result<bool, ViewError> {
        let input = self.input.take_egui_input(&self.window);
        let output = self.viewer.frame(input, target)?;
        (self.input).handle_platform_output(&self.window, output.platform_output);
        let soon = |v: &egui::ViewportOutput| v.repaint_delay.is_zero();
        Ok(output.viewport_output.values().any(soon) || self.viewer.is_unfinished())
    }

    /// Draws the same into a texture, and writes it.
    fn write(&mut self, screenshot: &Screenshot) -> Result<(), ViewError> {
        let size = [self.config.width, self.config.height];
        let (format, usage) = (self.config.format, wgpu::TextureUsages::COPY_SRC);
        let gpu = self.viewer.gpu().clone();
        let texture = umbrage_lab::gbuffer::texture(&gpu, "screenshot", size, format, usage);
        self.draw(&umbrage_lab::gbuffer::whole(&texture))?;
        let is_bgr = format == wgpu::TextureFormat::Bgra8Unorm;
        let pixels = read_texture(&gpu, &texture)?;
        let rgb = pixels.chunks_exact(4).flat_map(|p| match is_bgr {
            true => [p[2], p[1], p[0]],
            false => [p[0], p[1], p[2]],
        });
        write_png(&screenshot.file, size, &rgb.collect::<Vec<u8>>())?;
        Ok(())
    }
}

/// Whether the libraries are there without which winit panics.
fn check_libraries() -> Result<(), ViewError> {
    #[cfg(target_os = "linux")]
    {
        let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_wayland = is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET");
        let is_x11 = is_set("DISPLAY") && !is_wayland;
        if is_x11 && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
            let why = "libxkbcommon-x11 is missing (Debian, Ubuntu: libxkbcommon-x11-0)";
            return Err(ViewError::NoWindow(why.to_owned()));
        }
        if (is_x11 || is_wayland) && xkbcommon_dl::xkbcommon_option().is_none() {
            let why = "libxkbcommon is missing (Debian, Ubuntu: libxkbcommon0)";
            return Err(ViewError::NoWindow(why.to_owned()));
        }
    }
    Ok(())
}

fn surface(
    instance: &wgpu::Instance,
    window: &Arc<Window>,
) -> Result<wgpu::Surface<'static>, ViewError> {
    let surface = instance.create_surface(Arc::clone(window));
    surface.map_err(|error| ViewError::Surface(error.to_string()))
}

impl App {
    /// Ends the event loop with an error.
    fn fail(&mut self, event_loop: &ActiveEventLoop, error: ViewError) {
        self.error = Some(error);
        event_loop.exit();
    }

    fn redraw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ViewError> {
        let Some(shown) = &mut self.shown else {
            return Ok(());
        };
        let again = shown.frame()?;
        let viewer = &shown.viewer;
        self.seen.frames += 1;
        self.seen.frame_ms = viewer.lab.times.frame;
        self.seen.size = viewer.camera.view.size;
        self.seen.adapter.clone_from(&viewer.gpu().adapter);
        let screenshot = self.options.screenshot.as_ref();
        if let Some(screenshot) = screenshot {
            let is_due = self.seen.frames >= u64::from(screenshot.frames);
            if is_due && !viewer.is_unfinished() {
                shown.write(screenshot)?;
                event_loop.exit();
                return Ok(());
            }
        }
        if again || screenshot.is_some() {
            shown.window.request_redraw();
        }
        Ok(())
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(subject) = self.subject.take() else {
            return;
        };
        match Shown::new(event_loop, subject, &self.options) {
            Ok(shown) => {
                shown.window.request_redraw();
                self.shown = Some(shown);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else {
            return;
        };
        let response = shown.input.on_window_event(&shown.window, &event);
        let done = match event {
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::Resized(_) => shown.fit().map(|_| shown.window.request_redraw()),
            WindowEvent::RedrawRequested => self.redraw(event_loop),
            _ => {
                if response.repaint {
                    shown.window.request_redraw();
                }
                Ok(())
            }
        };
        if let Err(error) = done {
            self.fail(event_loop, error);
        }
    }
}
