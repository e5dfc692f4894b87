//! GPU time of each light, drawn alone.

use std::ops::Range;

use umbrage_core::View;

use crate::gbuffer::texture;
use crate::gpu::GpuError;
use crate::lab::Lab;
use crate::light_pass::HDR;
use crate::rendering::Rendering;
use crate::stage::{Stage, StageLight};
use crate::technique::Part;
use crate::timer::Timer;

/// GPU time of one light, in microseconds, without that of a pass as such.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GpuCost {
    /// Its volume, counted in the stencil; zero for methods that do not draw volume by volume.
    pub volume_us: f64,
    /// All that is drawn for it.
    pub total_us: f64,
}

impl GpuCost {
    /// All but the volume: its light draw, the stencil cleaned.
    pub fn light_us(&self) -> f64 {
        (self.total_us - self.volume_us).max(0.0)
    }
}

/// Lights an encoder.
const CHUNK: usize = 64;
/// Empty passes before them.
const EMPTY: usize = 8;

impl Lab {
    /// GPU time of each of `numbers`, lights of the last frame, which [`Lab::draw`] drew: each is
    /// drawn alone in a pass of its own, once, and in another as often as is said beside its number,
    /// one after the other; its volume likewise, where the method draws volume by volume. What the
    /// further times took counts, so a pass as such costs nothing, and the more times, the less a
    /// disturbance matters. Of lights drawn once, and of methods that can but do so, what an empty
    /// pass takes is subtracted. Nothing on adapters without timestamps. Lights that the frame skipped
    /// have next to no cost, which need not be asked for.
    pub fn time_lights(
        &self,
        rendering: &mut Rendering,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
        numbers: &[(usize, u32)],
    ) -> Result<Option<Vec<GpuCost>>, GpuError> {
        let gpu = self.gpu();
        let none = wgpu::TextureUsages::empty();
        let scratch = texture(gpu, "one light", view.size, HDR, none);
        let mut costs = Vec::with_capacity(numbers.len());
        for numbers in numbers.chunks(CHUNK) {
            // A query that is never written is waited for without end.
            let spans = numbers
                .iter()
                .map(|(_, times)| if *times > 1 { 4 } else { 2 });
            let Some(timer) = Timer::new(gpu, EMPTY as u32 + spans.sum::<u32>()) else {
                return Ok(None);
            };
            let (technique, given) =
                (rendering.run).technique(gpu, stage, lights, self.frame(view));
            let mut encoder = super::encoder(gpu);
            let mut spans = 0..;
            // How often it was drawn, and in which span.
            let mut pass = |lights: Range<usize>, part, times| -> Result<(u32, usize), GpuError> {
                let span: u32 = spans.next().unwrap_or_default();
                timer.mark(&mut encoder, 2 * span);
                let again = (part, times);
                let drawn =
                    technique.record_again(&given, &mut encoder, lights, &scratch, again)?;
                timer.mark(&mut encoder, 2 * span + 1);
                Ok((drawn, span as usize))
            };
            for _ in 0..EMPTY {
                pass(0..0, Part::Whole, 1)?;
            }
            let mut drawn = Vec::with_capacity(numbers.len());
            for &(number, times) in numbers {
                let mut both = |part| -> Result<_, GpuError> {
                    let once = pass(number..number + 1, part, 1)?;
                    let often = match times {
                        0 | 1 => once,
                        _ => pass(number..number + 1, part, times)?,
                    };
                    Ok([once, often])
                };
                // Volumes leave the stencil as it happens to be.
                drawn.push([both(Part::Volumes)?, both(Part::Whole)?]);
            }
            timer.resolve(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            let us: Vec<f64> = timer.read(gpu)?.iter().map(|ms| ms * 1e3).collect();
            let empty = us[..EMPTY].iter().copied().fold(f64::INFINITY, f64::min);
            let took = |passes: [(u32, usize); 2]| {
                let [few, many] = passes.map(|(times, span)| (times, us[span]));
                once(few, many, empty)
            };
            costs.extend(drawn.into_iter().map(|[volume, whole]| GpuCost {
                volume_us: took(volume),
                total_us: took(whole),
            }));
        }
        Ok(Some(costs))
    }
}

/// What drawing once takes, from how long two passes took, or an empty one, in each of which it was
/// drawn so many times.
fn once(few: (u32, f64), many: (u32, f64), empty: f64) -> f64 {
    let us = match (few, many) {
        ((0, _), _) => 0.0,
        ((few, few_us), (many, many_us)) if many > few => {
            (many_us - few_us) / f64::from(many - few)
        }
        ((few, few_us), (_, many_us)) => (few_us.min(many_us) - empty) / f64::from(few),
    };
    us.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::once;

    #[test]
    fn a_pass_as_such_costs_nothing() {
        // A pass takes 7, a light 3.
        assert_eq!(once((1, 10.0), (5, 22.0), 6.0), 3.0);
        // What can be drawn once only has the empty pass to be compared with.
        assert_eq!(once((1, 10.0), (1, 11.0), 7.0), 3.0);
        assert_eq!(once((1, 5.0), (1, 6.0), 7.0), 0.0);
        // No volume.
        assert_eq!(once((0, 1.0), (0, 1.0), 0.0), 0.0);
    }
}
