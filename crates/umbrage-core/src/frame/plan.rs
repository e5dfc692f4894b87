//! What to draw for each light in one view, as plain data.
//!
//! Takes a view, the lights and their volumes; gives a [`FramePlan`]. A light is drawn in two
//! steps: its volume (quads, and caps where needed) counts in the stencil; its light draw passes
//! where the stencil equals the light's reference. The stencil is zero again for the next light.

use std::ops::Range;

use super::bounds::{Rect, light_rect};
use super::extrusion::{Cosines, Drawn, Extrusion, is_beyond_range};
use super::eye_count::{EyeCount, eye_count};
use super::eye_counts::EyeCounts;
use super::parts::{PartPlan, parts, push_caps};
use super::view::View;
use crate::cull::{Cull, Culls};
use crate::light::Light;
use crate::volume::{ChainTriangle, Part, Volumes};
use crate::world::World;

/// How a plan is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// Which stencil path lights take.
    pub path: PathRule,
    /// Where volumes end. A finite one is drawn by z-fail where the eye is outside the light's
    /// range: z-pass has no dark cap, which an eye ray from there may cross.
    pub extrusion: Extrusion,
    /// Which steps skip work.
    pub culls: Culls,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            path: PathRule::ZPassWhereExact,
            extrusion: Extrusion::Infinite,
            culls: Culls::EVERY,
        }
    }
}

/// Which stencil path lights take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathRule {
    /// Z-pass from the eye count; z-fail for lights whose eye count is ambiguous. Needs depth
    /// clamping.
    ZPassWhereExact,
    /// Z-fail with both caps for every light.
    ZFailAlways,
}

/// How one light is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightPath {
    /// Sides crossed in front of the surface are counted, starting from the eye count.
    ZPass {
        /// Casters between light and eye.
        eye_count: u32,
    },
    /// Sides and caps crossed behind the surface are counted.
    ZFail(ZFailReason),
    /// Not drawn.
    Skipped(SkipReason),
}

/// Why a light takes the z-fail path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ZFailReason {
    /// The eye is (almost) on a side of its volume.
    EyeOnSide,
    /// The volume is finite, and the eye outside the light's range.
    EyeBeyondRange,
    /// The plan's options ask for it.
    Asked,
}

/// Why a light cannot matter in this view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SkipReason {
    /// It is no light: [`Light::is_usable`].
    Unusable,
    /// Its range is outside the view.
    OutsideView,
    /// No triangle is within its range.
    NothingInRange,
    /// Nobody wanted its volume built.
    NotBuilt,
    /// Its host left it out of this frame.
    Muted,
    /// No visible surface is within its range: found out on the GPU, from the depth buffer.
    NoVisibleReceiver,
}

impl LightPath {
    /// The word used in reports: `zpass`, `zfail` or `skipped`.
    pub fn name(&self) -> &'static str {
        match self {
            LightPath::ZPass { .. } => "zpass",
            LightPath::ZFail(_) => "zfail",
            LightPath::Skipped(_) => "skipped",
        }
    }

    /// Why, in words; empty for the default path.
    pub fn reason(&self) -> &'static str {
        match self {
            LightPath::ZPass { .. } => "",
            LightPath::ZFail(ZFailReason::EyeOnSide) => "the eye is on a side of its volume",
            LightPath::ZFail(ZFailReason::EyeBeyondRange) => {
                "the volume is finite, and the eye outside the light's range"
            }
            LightPath::ZFail(ZFailReason::Asked) => "asked for",
            LightPath::Skipped(SkipReason::Unusable) => {
                "its position, range, direction or cone is not usable"
            }
            LightPath::Skipped(SkipReason::OutsideView) => "its range is outside the view",
            LightPath::Skipped(SkipReason::NothingInRange) => "no triangle is in its range",
            LightPath::Skipped(SkipReason::NotBuilt) => "its volume was not built",
            LightPath::Skipped(SkipReason::Muted) => "it is muted",
            LightPath::Skipped(SkipReason::NoVisibleReceiver) => {
                "no visible surface is in its range"
            }
        }
    }
}

/// One light of a plan.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LightPlan {
    /// How it is drawn.
    pub path: LightPath,
    /// Stencil value of a lit pixel after the volume is drawn.
    pub stencil_reference: u8,
    /// Pixels its range can touch.
    pub scissor: Rect,
    /// Its silhouette quads, in [`Volumes::quads`].
    pub quads: Range<u32>,
    /// Its cap triangles that are taken as wound, in [`FramePlan::caps`]; empty on the z-pass
    /// path.
    pub caps: Range<u32>,
    /// Its cap triangles that are taken with reversed winding, in [`FramePlan::caps`].
    pub reversed_caps: Range<u32>,
    /// Distance from the light to which its volume is extruded, in metres; infinite unless
    /// [`PlanOptions::extrusion`] asks for less.
    pub extrusion_m: f32,
    /// Two or more if it is drawn in parts, which then share quads and caps among them; else empty.
    pub parts: Vec<PartPlan>,
}

/// One view's plan for all lights.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct FramePlan {
    /// One entry a light, skipped ones included.
    pub lights: Vec<LightPlan>,
    /// The chains of the lights that need caps.
    pub caps: Vec<ChainTriangle>,
    counts: EyeCounts,
    cosines: Cosines,
}

impl LightPlan {
    /// Whether it is not drawn.
    pub fn is_skipped(&self) -> bool {
        matches!(self.path, LightPath::Skipped(_))
    }

    /// Whether anything of a volume is drawn for it.
    pub fn has_volume(&self) -> bool {
        let lists = [&self.quads, &self.caps, &self.reversed_caps];
        !self.parts.is_empty() || lists.into_iter().any(|list| !list.is_empty())
    }
}

impl FramePlan {
    /// Plans `view`, replacing what was there. `volumes` must be those of `lights`. Eye counts are
    /// kept from the last plan where neither eye nor volume changed.
    pub fn make(
        &mut self,
        world: &World,
        lights: &[Light],
        volumes: &Volumes,
        view: &View,
        options: &PlanOptions,
    ) {
        self.lights.clear();
        self.caps.clear();
        self.counts.look_from(view.eye, lights.len());
        self.cosines.fit(lights.len());
        // The number of the next part that is not a light's first.
        let mut extra = lights.len() as u32;
        for (number, (light, volume)) in lights.iter().zip(&volumes.lights).enumerate() {
            let scissor = light_rect(view, light);
            let mut distance = |drawn| {
                let extrusion = options.extrusion;
                self.cosines
                    .distance(extrusion, world, light, volumes, number, drawn)
            };
            let is_finite = options.extrusion != Extrusion::Infinite;
            let is_beyond = is_finite && is_beyond_range(light, view.eye);
            let path = if !light.is_usable() {
                LightPath::Skipped(SkipReason::Unusable)
            } else if scissor.is_empty() && options.culls.has(Cull::View) {
                LightPath::Skipped(SkipReason::OutsideView)
            } else if volume.stamp == 0 {
                LightPath::Skipped(SkipReason::NotBuilt)
            } else if volume.subset_triangles == 0 {
                LightPath::Skipped(SkipReason::NothingInRange)
            } else if options.path == PathRule::ZFailAlways {
                LightPath::ZFail(ZFailReason::Asked)
            } else if is_beyond && distance(Drawn::Whole).is_finite() {
                LightPath::ZFail(ZFailReason::EyeBeyondRange)
            } else {
                let count = |part: &Part| {
                    let (chain, quads) = (volumes.chain_of_part(part), volumes.quads_of_part(part));
                    eye_count(world, light, chain, quads, view.eye)
                };
                match self.counts.of(number, volume, count) {
                    EyeCount::Exact(eye_count) => LightPath::ZPass { eye_count },
                    EyeCount::Ambiguous => LightPath::ZFail(ZFailReason::EyeOnSide),
                }
            };
            let starts = match path {
                LightPath::ZPass { .. } => self.counts.of_parts(number),
                _ => &[],
            };
            let mut parts = parts(number, &volume.parts, starts, &mut extra);
            let [caps, reversed_caps] = match path {
                LightPath::ZFail(_) => push_caps(number, volumes, &mut parts, &mut self.caps),
                _ => [0, 0].map(|_| self.caps.len() as u32..self.caps.len() as u32),
            };
            let mut quads = volume.quads.clone();
            // Behind a surface, where z-fail counts, the ray leaves the range.
            if matches!(path, LightPath::ZPass { .. }) && options.culls.has(Cull::Range) {
                let all = quads.len() as u32;
                quads.end = quads.start + volume.in_range.for_eye(light, view.eye, all);
            }
            let extrusion_m = match path {
                LightPath::ZFail(_) => distance(Drawn::Whole),
                LightPath::ZPass { .. } if !is_beyond => distance(Drawn::Sides(quads.len() as u32)),
                _ => f32::INFINITY,
            };
            self.lights.push(LightPlan {
                extrusion_m,
                stencil_reference: match (parts.last(), path) {
                    (Some(last), _) => last.reference,
                    // Lit where eye count + sides crossed is 0; stencil arithmetic is modulo 256.
                    (None, LightPath::ZPass { eye_count }) => (eye_count as u8).wrapping_neg(),
                    _ => 0,
                },
                parts,
                path,
                scissor,
                quads,
                caps,
                reversed_caps,
            });
        }
    }

    /// Leaves a light's volume out: every pixel that it reaches is lit.
    pub fn leave_unshadowed(&mut self, light: usize) {
        let plan = &mut self.lights[light];
        if plan.is_skipped() {
            return;
        }
        plan.path = LightPath::ZPass { eye_count: 0 };
        plan.stencil_reference = 0;
        for range in [&mut plan.quads, &mut plan.caps, &mut plan.reversed_caps] {
            range.end = range.start;
        }
        let further = std::mem::take(&mut plan.parts).len().saturating_sub(1) as u32;
        // Numbers of parts follow the order of their lights.
        for later in &mut self.lights[light + 1..] {
            for part in later.parts.iter_mut().skip(1) {
                part.number -= further;
            }
        }
    }

    /// Parts that are not the first of their light, with the light's number, in the order of their
    /// own numbers, which follow those of all lights.
    pub fn further_parts(&self) -> impl Iterator<Item = (usize, &PartPlan)> {
        let lights = self.lights.iter().enumerate();
        lights.flat_map(|(number, light)| light.parts.iter().skip(1).map(move |p| (number, p)))
    }

    /// Plans lights without shadows: no volumes, every pixel lit.
    pub fn unshadowed(&mut self, lights: &[Light], view: &View) {
        self.lights.clear();
        self.caps.clear();
        self.lights.extend(lights.iter().map(|light| {
            let scissor = light_rect(view, light);
            LightPlan {
                path: match (light.is_usable(), scissor.is_empty()) {
                    (false, _) => LightPath::Skipped(SkipReason::Unusable),
                    (_, true) => LightPath::Skipped(SkipReason::OutsideView),
                    (_, false) => LightPath::ZPass { eye_count: 0 },
                },
                stencil_reference: 0,
                scissor,
                quads: 0..0,
                caps: 0..0,
                reversed_caps: 0..0,
                extrusion_m: f32::INFINITY,
                parts: Vec::new(),
            }
        }));
    }

    /// Cap triangles drawn for a light: light and dark caps.
    pub fn cap_triangles(&self, light: usize) -> usize {
        let light = &self.lights[light];
        2 * (light.caps.len() + light.reversed_caps.len())
    }

    /// The lights that are drawn, with their numbers.
    pub fn drawn(&self) -> impl Iterator<Item = (usize, &LightPlan)> {
        self.lights
            .iter()
            .enumerate()
            .filter(|(_, light)| !light.is_skipped())
    }
}
