//! Draws into the host's pass: light after light its volume, then the host's own light.

use std::ops::Range;

use umbrage_core::frame::{FramePlan, LightPath, LightPlan, PartPlan};
use wgpu::{Buffer, RenderPass, RenderPipeline};

use crate::pipelines::{SHADOW_BIT, VolumePipelines};
use crate::receivers::{LightCalls, within};
use crate::view::ViewShadows;

/// The quads and caps of one light or part.
struct Draws<'a> {
    /// Of its calls, and the instance it is drawn as.
    number: u32,
    quads: &'a Range<u32>,
    caps: [&'a Range<u32>; 2],
}

impl<'a> Draws<'a> {
    fn of_part(part: &'a PartPlan) -> Self {
        Self {
            number: part.number,
            quads: &part.quads,
            caps: [&part.caps, &part.reversed_caps],
        }
    }
}

impl ViewShadows {
    /// Records the volumes of the plan's lights numbered `lights`, calling `draw_light` for each
    /// after its volume, with scissor and stencil reference set. There the host sets a pipeline made
    /// with [`SharedShadows::light_depth_stencil`](crate::SharedShadows::light_depth_stencil) and
    /// its bind groups, and calls [`ViewShadows::draw_light`]. The stencil is zero again after each
    /// light. `pipelines` are those for the pass's colour targets.
    pub fn record(
        &self,
        pass: &mut RenderPass<'_>,
        pipelines: &VolumePipelines,
        plan: &FramePlan,
        lights: Range<usize>,
        mut draw_light: impl FnMut(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let end = lights.end.min(plan.lights.len());
        for number in lights.start.min(end)..end {
            self.record_volume(pass, pipelines, plan, number);
            self.record_light(pass, pipelines, plan, number, &mut draw_light);
        }
    }

    /// The first half of [`ViewShadows::record`] for one light: its volume, counted in the stencil.
    /// The second half, which may come in a later pass that loads the stencil, is
    /// [`ViewShadows::record_light`]; no other light may be recorded between the two.
    pub fn record_volume(
        &self,
        pass: &mut RenderPass<'_>,
        pipelines: &VolumePipelines,
        plan: &FramePlan,
        number: usize,
    ) {
        let Some(light) = self.begin(pass, plan, number) else {
            return;
        };
        if light.parts.is_empty() {
            let counters = &pipelines.whole;
            self.draw_volume(pass, number, light, counters.sides(), counters.caps());
        } else {
            self.draw_parts(pass, pipelines, number, light);
        }
    }

    /// The second half: `draw_light`, as for [`ViewShadows::record`], and what brings the stencil
    /// back to zero.
    pub fn record_light(
        &self,
        pass: &mut RenderPass<'_>,
        pipelines: &VolumePipelines,
        plan: &FramePlan,
        number: usize,
        draw_light: impl FnOnce(&mut RenderPass<'_>, usize, &LightPlan),
    ) {
        let (Some(volumes), Some(world)) = (&self.volumes, self.world_bind_group()) else {
            return;
        };
        let Some(light) = self.begin(pass, plan, number) else {
            return;
        };
        pass.set_stencil_reference(u32::from(light.stencil_reference));
        draw_light(pass, number, light);
        if let Some(calls) = self.calls().filter(|_| light.has_volume()) {
            pass.set_pipeline(&pipelines.clean);
            pass.set_bind_group(0, &volumes.windows[1][0], &[]);
            pass.set_bind_group(1, world, &[]);
            for calls in calls {
                pass.draw_indirect(calls, number as u64 * LightCalls::SIZE + LightCalls::CLEAN);
            }
        }
    }

    /// Sets the scissor of a light; `None` if none of it is drawn.
    fn begin<'a>(
        &self,
        pass: &mut RenderPass<'_>,
        plan: &'a FramePlan,
        number: usize,
    ) -> Option<&'a LightPlan> {
        let light = plan.lights.get(number)?;
        let s = light.scissor;
        if light.is_skipped() || s.is_empty() {
            return None;
        }
        let [x, y] = self.origin;
        pass.set_scissor_rect(x + s.x, y + s.y, s.width, s.height);
        Some(light)
    }

    /// Counts a light's parts in the stencil, one after the other.
    fn draw_parts(
        &self,
        pass: &mut RenderPass<'_>,
        pipelines: &VolumePipelines,
        number: usize,
        light: &LightPlan,
    ) {
        let counters = &pipelines.part;
        for (i, part) in light.parts.iter().enumerate() {
            let draws = Draws::of_part(part);
            self.draw(pass, &draws, light.path, counters.sides(), counters.caps());
            if i + 1 == light.parts.len() {
                break;
            }
            pass.set_pipeline(&pipelines.join);
            pass.set_stencil_reference(SHADOW_BIT | u32::from(part.reference));
            match self.calls() {
                // Whoever joins twice changes nothing the second time.
                Some(calls) => {
                    let at = number as u64 * LightCalls::SIZE + LightCalls::CLEAN;
                    calls.for_each(|calls| pass.draw_indirect(calls, at));
                }
                None => pass.draw(0..3, 0..1),
            }
        }
    }

    /// Draws a light's quads and caps over the scissor that is set, those of all its parts alike,
    /// with `sides` for z-pass and for z-fail, and all of `caps` for triangles taken as wound and for
    /// those taken reversed; false if it has none.
    pub(crate) fn draw_volume(
        &self,
        pass: &mut RenderPass<'_>,
        number: usize,
        light: &LightPlan,
        sides: [&RenderPipeline; 2],
        caps: [&[RenderPipeline]; 2],
    ) -> bool {
        if light.parts.is_empty() {
            let draws = Draws {
                number: number as u32,
                quads: &light.quads,
                caps: [&light.caps, &light.reversed_caps],
            };
            return self.draw(pass, &draws, light.path, sides, caps);
        }
        let mut counted = false;
        for part in &light.parts {
            counted |= self.draw(pass, &Draws::of_part(part), light.path, sides, caps);
        }
        counted
    }

    fn draw(
        &self,
        pass: &mut RenderPass<'_>,
        draws: &Draws<'_>,
        path: LightPath,
        sides: [&RenderPipeline; 2],
        caps: [&[RenderPipeline]; 2],
    ) -> bool {
        let (Some(volumes), Some(world)) = (&self.volumes, self.world_bind_group()) else {
            return false;
        };
        let calls: Option<Vec<&Buffer>> = self.calls().map(Iterator::collect);
        let bind_groups = &volumes.windows[usize::from(calls.is_some())];
        let sides = match path {
            LightPath::ZPass { .. } => sides[0],
            _ => sides[1],
        };
        let mut counted = false;
        // Whatever is drawn next has its bind groups set.
        pass.set_bind_group(0, &bind_groups[0], &[]);
        pass.set_bind_group(1, world, &[]);
        for (range, pipelines, offset) in [
            (draws.quads, std::slice::from_ref(sides), LightCalls::SIDES),
            (draws.caps[0], caps[0], LightCalls::CAPS),
            (draws.caps[1], caps[1], LightCalls::REVERSED_CAPS),
        ] {
            if range.is_empty() {
                continue;
            }
            counted = true;
            let first = range.start as usize / self.list_window;
            let last = (range.end as usize - 1) / self.list_window;
            for pipeline in pipelines {
                pass.set_pipeline(pipeline);
                for (window, bind_group) in (first..=last).zip(&bind_groups[first..]) {
                    pass.set_bind_group(0, bind_group, &[]);
                    match &calls {
                        Some(calls) => {
                            let at = u64::from(draws.number) * LightCalls::SIZE + offset;
                            pass.draw_indirect(calls[window], at);
                        }
                        None => {
                            let range = within(range, window, self.list_window);
                            let instance = draws.number..draws.number + 1;
                            pass.draw(6 * range.start..6 * range.end, instance);
                        }
                    }
                }
            }
        }
        counted
    }

    /// The draw of light number `light` for the host's own pipeline and bind groups; the instance
    /// index is the light's number, and the vertex shader places its vertices with
    /// `umbrage_light_corner` of [`light_wgsl`](crate::light_wgsl), as a list of counter-clockwise
    /// triangles. Draws nothing if the light reaches no visible surface.
    pub fn draw_light(&self, pass: &mut RenderPass<'_>, light: usize) {
        match self.calls().and_then(|mut calls| calls.next()) {
            Some(calls) => {
                pass.draw_indirect(calls, light as u64 * LightCalls::SIZE + LightCalls::LIGHT);
            }
            None => pass.draw(0..3, light as u32..light as u32 + 1),
        }
    }
}
