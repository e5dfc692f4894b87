//! What each light takes on the GPU, measured a few lights a frame, in turn.

use umbrage_core::View;
use umbrage_lab::gpu::GpuError;
use umbrage_lab::lab::Lab;
use umbrage_lab::rendering::Rendering;
use umbrage_lab::stage::{Stage, StageLight};

/// Lights measured after one frame.
const A_FRAME: usize = 8;
/// Weight of a new figure beside what was there.
const NEW: f64 = 0.5;

/// Figures of all lights, of the frames so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Costs {
    us: Vec<Option<f64>>,
    /// Whose turn it is.
    next: usize,
    /// Lights looked at since something changed.
    fresh: usize,
}

impl Costs {
    pub(crate) fn new(lights: usize) -> Self {
        Self {
            us: vec![None; lights],
            next: 0,
            fresh: 0,
        }
    }

    /// GPU microseconds of a light; nothing before it was its turn, and without timestamps.
    pub(crate) fn us(&self, light: usize) -> Option<f64> {
        self.us[light]
    }

    /// The frame is another one: figures are to be brought up to date.
    pub(crate) fn stale(&mut self) {
        self.fresh = 0;
    }

    /// Whether each light was looked at since.
    pub(crate) fn are_fresh(&self) -> bool {
        self.fresh >= self.us.len()
    }

    /// Measures the next few lights of those drawn in the last frame.
    pub(crate) fn measure(
        &mut self,
        lab: &Lab,
        rendering: &mut Rendering,
        stage: &Stage,
        lights: &[StageLight],
        view: &View,
    ) -> Result<(), GpuError> {
        if self.are_fresh() || lab.gpu().timestamp_ns.is_none() {
            return Ok(());
        }
        let turn = self.turn(|light| !is_skipped(lab, light));
        let once: Vec<(usize, u32)> = turn.into_iter().map(|light| (light, 1)).collect();
        let costs = lab.time_lights(rendering, stage, lights, view, &once)?;
        for ((light, _), cost) in once.into_iter().zip(costs.into_iter().flatten()) {
            self.put(light, cost.total_us);
        }
        Ok(())
    }

    /// The next lights to measure; those not drawn cost nothing, which needs no measuring.
    fn turn(&mut self, is_drawn: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut turn = Vec::new();
        while turn.len() < A_FRAME && self.fresh < self.us.len() {
            match is_drawn(self.next) {
                true => turn.push(self.next),
                false => self.us[self.next] = Some(0.0),
            }
            self.next = (self.next + 1) % self.us.len();
            self.fresh += 1;
        }
        turn
    }

    fn put(&mut self, light: usize, us: f64) {
        let before = self.us[light].filter(|&before| before > 0.0);
        self.us[light] = Some(before.map_or(us, |before| before + (us - before) * NEW));
    }
}

fn is_skipped(lab: &Lab, light: usize) -> bool {
    matches!(lab.path(light), umbrage_core::frame::LightPath::Skipped(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_light_has_its_turn_once_a_round() {
        let mut costs = Costs::new(30);
        let mut seen = Vec::new();
        while !costs.are_fresh() {
            let turn = costs.turn(|light| light % 3 > 0);
            assert!(turn.len() <= A_FRAME);
            seen.extend(turn);
        }
        let drawn: Vec<usize> = (0..30).filter(|light| light % 3 > 0).collect();
        assert_eq!(seen, drawn);
        assert_eq!((costs.us(3), costs.us(1)), (Some(0.0), None));
        costs.put(1, 8.0);
        costs.put(1, 4.0);
        assert_eq!(costs.us(1), Some(6.0));
        costs.stale();
        assert!(!costs.are_fresh());
        assert!(Costs::new(0).are_fresh());
    }
}
