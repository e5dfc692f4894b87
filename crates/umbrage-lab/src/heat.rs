//! Heat maps: what is drawn or counted at each pixel, in false colours.

use half::f16;
use umbrage_core::frame::{FramePlan, LightPath};
use umbrage_core::{Cull, Culls, View};
use umbrage_wgpu::VolumeColor;

use crate::gbuffer::texture;
use crate::gpu::GpuError;
use crate::lab::{Lab, Method};
use crate::light_pass::{HDR, LightDraw};
use crate::readback::read_texture;
use crate::stage::{Stage, StageLight};

/// What a heat map counts at each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heat {
    /// Volume fragments in front of the surface (z-pass) of all lights.
    Overdraw,
    /// Lights whose range reaches the surface.
    Lights,
    /// Volumes that enclose the surface: casters between it and each light, summed.
    Layers,
    /// Volume fragments and light fragments.
    Cost,
}

impl Lab {
    /// Draws a view's volumes and lights as counts, one f32 a pixel. Fragments are those that a frame
    /// with the lab's culls has; layers are counted with every caster there.
    pub fn heat(
        &mut self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        method: Method,
        heat: Heat,
    ) -> Result<Vec<f32>, GpuError> {
        if heat != Heat::Lights && method != Method::None && method.recipe().is_none() {
            return Err(GpuError::NoVolumes {
                method: method.name().into_owned(),
            });
        }
        let culls = self.culls;
        if heat == Heat::Layers {
            self.culls = Culls::NONE.with(Cull::View);
        }
        self.prepare(stage, lights, view, method);
        let counts = self.prepared_heat(stage, lights, view, heat);
        self.culls = culls;
        counts
    }

    fn prepared_heat(
        &self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        heat: Heat,
    ) -> Result<Vec<f32>, GpuError> {
        let (volume_color, draw) = match heat {
            Heat::Overdraw => (VolumeColor::Fragments, LightDraw::Nothing),
            Heat::Lights => (VolumeColor::None, LightDraw::Reach),
            Heat::Layers => (VolumeColor::Layers, LightDraw::Nothing),
            Heat::Cost => (VolumeColor::Fragments, LightDraw::One),
        };
        let mut counts = self.counts(stage, lights, view, volume_color, draw)?;
        if heat == Heat::Layers {
            add_eye_counts(&self.plan, &mut counts, view.size[0] as usize);
        }
        Ok(counts)
    }

    fn counts(
        &self,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        volume_color: VolumeColor,
        draw: LightDraw,
    ) -> Result<Vec<f32>, GpuError> {
        let gpu = self.gpu();
        // Light fragments count wherever they are drawn, shadowed or not.
        let technique = match draw {
            LightDraw::Reach | LightDraw::One => Method::None,
            _ => Method::Counter,
        };
        let mut run = self.run(stage, view, technique, draw, volume_color)?;
        run.shadows
            .prepare(&gpu.device, &gpu.queue, &self.frame(view))?;
        let (technique, given) = run.technique(gpu, stage, lights, self.frame(view));
        technique.prepare(&given)?;
        let sums = texture(gpu, "counts", view.size, HDR, wgpu::TextureUsages::COPY_SRC);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("counts"),
            });
        run.record_surface(gpu, &mut encoder, None);
        let (technique, given) = run.technique(gpu, stage, lights, self.frame(view));
        technique.record(&given, &mut encoder, 0..lights.len(), &sums)?;
        gpu.queue.submit([encoder.finish()]);
        let first = |t: &[u8]| f16::from_le_bytes([t[0], t[1]]).to_f32();
        Ok(read_texture(gpu, &sums)?
            .chunks_exact(8)
            .map(first)
            .collect())
    }
}

/// Sides crossed plus the eye count are the layers at the surface.
fn add_eye_counts(plan: &FramePlan, total: &mut [f32], width: usize) {
    for (_, light) in plan.drawn() {
        let LightPath::ZPass { eye_count } = light.path else {
            continue;
        };
        let s = light.scissor;
        for y in s.y..s.y + s.height {
            let row = y as usize * width + s.x as usize;
            total[row..row + s.width as usize]
                .iter_mut()
                .for_each(|t| *t += eye_count as f32);
        }
    }
}

/// Black, blue, green, yellow, red, white; the scale ends at the 99.9th percentile.
pub fn false_colours(counts: &[f32]) -> Vec<u8> {
    const STOPS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.02],
        [0.1, 0.15, 0.7],
        [0.05, 0.65, 0.45],
        [0.95, 0.85, 0.2],
        [0.9, 0.2, 0.1],
        [1.0, 1.0, 1.0],
    ];
    let mut sorted = counts.to_vec();
    sorted.sort_by(f32::total_cmp);
    let top = sorted.get(sorted.len().saturating_sub(1 + sorted.len() / 1000));
    let top = top.copied().unwrap_or(1.0).max(1.0);
    counts
        .iter()
        .flat_map(|&count| {
            let at = (count / top).clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
            let low = (at as usize).min(STOPS.len() - 2);
            let [a, b] = [STOPS[low], STOPS[low + 1]].map(glam::Vec3::from);
            (a.lerp(b, at - low as f32) * 255.0)
                .to_array()
                .map(|c| c as u8)
        })
        .collect()
}
