//! The viewer without its window: takes input, draws a frame into any target.

use std::sync::Arc;
use std::time::Instant;

use umbrage_core::View;
use umbrage_core::frame::LightPath;
use umbrage_lab::gpu::{Gpu, GpuError};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::rendering::Rendering;
use umbrage_lab::stage::{Stage, StageLight};

use crate::camera::{FlyCamera, speed_for};
use crate::check::Check;
use crate::costs::Costs;
use crate::debug_view::DebugView;
use crate::lines::{Lines, ZFAIL, ZPASS, bounds};
use crate::mix::Mix;
use crate::moment::{Moment, follow, followed};
use crate::overlay::{Of, Overlay, heat};
use crate::screen::{Picture, Screen};
use crate::table::Order;
use crate::{Options, Subject};

/// Everything that a window shows, and what it knows between frames.
pub(crate) struct Viewer {
    pub(crate) stage: Arc<Stage>,
    pub(crate) lights: Vec<StageLight>,
    pub(crate) method: Method,
    pub(crate) camera: FlyCamera,
    pub(crate) mix: Mix,
    pub(crate) shown: DebugView,
    /// Whether lines are seen through surfaces.
    pub(crate) through: bool,
    pub(crate) order: Order,
    pub(crate) show_list: bool,
    pub(crate) show_help: bool,
    /// Stops that the picture is made brighter by.
    pub(crate) stops: f32,
    pub(crate) lab: Lab,
    pub(crate) costs: Costs,
    pub(crate) check: Check,
    pub(crate) overlay: Option<Overlay>,
    /// What could not be shown, and why.
    pub(crate) trouble: String,
    gpu: Gpu,
    rendering: Rendering,
    /// Draws counts and masks, so that the volumes of the frames stay as they are.
    aside: Lab,
    screen: Screen,
    ctx: egui::Context,
    /// Nothing until it is measured.
    exposure: Option<f32>,
    lines_of: Option<LinesOf>,
    /// What the last frame drew.
    drawn: Option<Moment>,
    /// Whether time goes on.
    pub(crate) plays: bool,
    followed: Vec<Option<usize>>,
}

/// What the lines were made of.
#[derive(Clone, Debug, PartialEq)]
struct LinesOf {
    shown: DebugView,
    chosen: Option<usize>,
    time_s: f64,
    /// Volume and path of each light drawn.
    lights: Vec<(usize, u64, bool)>,
}

impl Viewer {
    /// For targets of this format, whose size is that of the subject's view.
    pub(crate) fn new(
        gpu: Gpu,
        subject: Subject,
        options: &Options,
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let Subject {
            stage,
            lights,
            view,
        } = subject;
        let [mut lab, mut aside] = [Lab::new(gpu.clone()), Lab::new(gpu.clone())];
        for lab in [&mut lab, &mut aside] {
            lab.culls = options.culls;
            lab.application = options.application;
        }
        let speed = bounds(&stage.world).map_or(1.0, speed_for);
        let rendering = lab.begin(&stage, &view, options.method)?;
        let mut mix = Mix::new(lights.len());
        mix.chosen = options.chosen.filter(|&light| light < lights.len());
        Ok(Self {
            camera: FlyCamera::new(view, speed),
            mix,
            costs: Costs::new(lights.len()),
            followed: followed(&stage, &lights),
            stage: Arc::new(stage),
            lights,
            method: options.method,
            shown: options.shown,
            through: false,
            order: Order::default(),
            show_list: true,
            show_help: false,
            stops: 0.0,
            lab,
            aside,
            check: Check::default(),
            overlay: None,
            trouble: String::new(),
            rendering,
            screen: Screen::new(&gpu, format),
            gpu,
            ctx: egui::Context::default(),
            exposure: None,
            lines_of: None,
            drawn: None,
            plays: false,
        })
    }

    /// What panels are made in.
    pub(crate) fn ctx(&self) -> &egui::Context {
        &self.ctx
    }

    /// The device.
    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Fits everything to targets of another size, no side zero.
    pub(crate) fn resize(&mut self, size: [u32; 2]) -> Result<(), GpuError> {
        if size != self.camera.view.size {
            self.camera.resize(size);
            let view = self.camera.view;
            self.rendering = self.lab.begin(&self.stage, &view, self.method)?;
        }
        Ok(())
    }

    /// Measures the exposure anew with the next frame.
    pub(crate) fn expose(&mut self) {
        self.exposure = None;
    }

    /// Compares the view with the oracle, and shows the outcome when it is there.
    pub(crate) fn start_check(&mut self) -> Result<(), GpuError> {
        self.shown = DebugView::Wrong;
        self.plays = false;
        self.aside.muted = self.mix.silent();
        let (view, method) = (self.camera.view, self.method);
        let (stage, lights) = (&self.stage, &self.lights);
        (self.check).start(&mut self.aside, stage, lights, &view, method)
    }

    /// Whether anything of the scene moves with time.
    pub(crate) fn can_play(&self) -> bool {
        let rig = self.stage.scene.rig.as_ref();
        rig.is_some_and(|rig| rig.moving().contains(&true))
    }

    /// Moves what moves to where it is at a time in seconds; it stands while the oracle looks.
    pub(crate) fn set_time(&mut self, time_s: f64) {
        let Some(stage) = Arc::get_mut(&mut self.stage) else {
            return;
        };
        let before = stage.time_s;
        if let Err(error) = stage.set_time(time_s) {
            self.trouble = error.to_string();
            self.plays = false;
            // Where everything stood well it does again.
            let _ = stage.set_time(before);
        }
        follow(stage, &self.followed, &mut self.lights);
    }

    /// Takes input, draws a frame into `target`, and gives what the window is to do.
    pub(crate) fn frame(
        &mut self,
        input: egui::RawInput,
        target: &wgpu::TextureView,
    ) -> Result<egui::FullOutput, GpuError> {
        let ctx = self.ctx.clone();
        let mut asked = Ok(());
        let mut output = ctx.run_ui(input, |ui| asked = crate::panel::show(self, ui));
        if let Err(error) = asked.and_then(|()| self.draw()) {
            // Never drawn; debug builds of egui panic where it is dropped before.
            output.textures_delta.clear();
            return Err(error);
        }
        let picture = Picture {
            rendering: &self.rendering,
            exposure: self.exposure.unwrap_or(1.0) * self.stops.exp2(),
            view: &self.camera.view,
            lines: self.lines_of.as_ref().map(|_| self.through),
        };
        self.screen
            .paint(&self.gpu, &picture, &ctx, &mut output, target);
        Ok(output)
    }

    /// Whether the next frame would show something else, whatever the user does.
    pub(crate) fn is_unfinished(&self) -> bool {
        let measuring = self.lab.gpu().timestamp_ns.is_some() && !self.costs.are_fresh();
        let counting = heat(self.shown).is_some() && self.trouble.is_empty();
        let counted = self.overlay.as_ref().is_some_and(|o| o.is_of(&self.of()));
        measuring || self.check.progress().is_some() || counting && !counted
    }

    /// The frame in the lab, and what the debug view adds.
    fn draw(&mut self) -> Result<(), GpuError> {
        let stage = Arc::clone(&self.stage);
        let lights = std::mem::take(&mut self.lights);
        let drawn = self.draw_stage(&stage, &lights);
        self.lights = lights;
        drawn
    }

    fn draw_stage(&mut self, stage: &Stage, lights: &[StageLight]) -> Result<(), GpuError> {
        let view = &{ self.camera.view };
        let now = self.of().moment;
        self.lab.muted.clone_from(&now.silent);
        self.lab.frames.clear();
        let rendering = &mut self.rendering;
        (self.lab).draw(rendering, stage, lights, view, Instant::now())?;
        self.lab.read_calls(rendering)?;
        if self.exposure.is_none() {
            self.exposure = Some(self.lab.lit(rendering)?.exposure());
        }
        let rests = self.drawn.as_ref() == Some(&now);
        if !rests {
            self.costs.stale();
            self.trouble.clear();
        }
        self.drawn = Some(now);
        (self.costs).measure(&self.lab, rendering, stage, lights, view)?;
        self.make_lines(stage, lights, view);
        self.check.poll();
        self.make_overlay(stage, lights, rests)
    }

    fn of(&self) -> Of {
        Of {
            shown: self.shown,
            moment: Moment {
                view: self.camera.view,
                silent: self.mix.silent(),
                time_s: self.stage.time_s,
            },
        }
    }

    /// Brings the picture over the window in step with what it is of, once the camera rests.
    fn make_overlay(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        rests: bool,
    ) -> Result<(), GpuError> {
        let of = self.of();
        if self
            .overlay
            .as_ref()
            .is_some_and(|overlay| overlay.is_of(&of))
        {
            return Ok(());
        }
        self.overlay = None;
        if let Some(heat) = heat(self.shown).filter(|_| rests && self.trouble.is_empty()) {
            self.aside.muted.clone_from(&of.moment.silent);
            let (ctx, aside) = (&self.ctx, &mut self.aside);
            match Overlay::counted(ctx, of, heat, aside, stage, lights, self.method) {
                Ok(overlay) => self.overlay = Some(overlay),
                Err(error @ GpuError::NoVolumes { .. }) => self.trouble = error.to_string(),
                Err(error) => return Err(error),
            }
        } else if self.shown == DebugView::Wrong
            && let Some(found) = self.check.found(&of.moment)
        {
            self.overlay = Some(Overlay::marked(&self.ctx, of, found));
        }
        Ok(())
    }

    /// Brings the lines in step with the debug view, the chosen light and the lights drawn.
    fn make_lines(&mut self, stage: &Stage, lights: &[StageLight], view: &View) {
        let (shown, chosen) = (self.shown, self.mix.chosen);
        let has_lines = match shown {
            DebugView::Volumes | DebugView::Silhouettes => true,
            DebugView::Boxes | DebugView::Subset => chosen.is_some(),
            _ => false,
        };
        if !has_lines {
            self.lines_of = None;
            return;
        }
        let shines = |&light: &usize| {
            chosen.is_none_or(|chosen| chosen == light)
                && !matches!(self.lab.path(light), LightPath::Skipped(_))
        };
        let stamp = |light: usize| {
            let zfail = matches!(self.lab.path(light), LightPath::ZFail(_));
            (light, self.lab.volumes.lights[light].stamp, zfail)
        };
        let of = LinesOf {
            shown,
            chosen,
            time_s: stage.time_s,
            lights: (0..lights.len()).filter(shines).map(stamp).collect(),
        };
        if self.lines_of.as_ref() == Some(&of) {
            return;
        }
        let (world, volumes) = (&stage.world, &self.lab.volumes);
        let mut lines = Lines::new(view.eye);
        for &(number, _, zfail) in &of.lights {
            let (light, quads) = (&lights[number].light, volumes.quads_of(number));
            match shown {
                DebugView::Volumes => {
                    lines.volume(world, light, quads, if zfail { ZFAIL } else { ZPASS });
                }
                DebugView::Silhouettes => lines.silhouettes(world, quads),
                _ => {}
            }
        }
        match (shown, chosen) {
            (DebugView::Boxes, Some(number)) => lines.boxes(world, &lights[number].light),
            (DebugView::Subset, Some(number)) => {
                lines.subset(world, &lights[number].light, volumes, number);
            }
            _ => {}
        }
        self.screen.lines.set(&self.gpu, &lines);
        self.lines_of = Some(of);
    }
}

#[cfg(test)]
mod tests;
