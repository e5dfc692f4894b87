//! The shadows of one view against the oracle's, judged beside the window's own work.
//!
//! Takes the mask of a view; gives counts, and a picture of where it errs. Silent lights are left out
//! of the mask, and so of what the oracle is asked.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, OnceLock};
use std::thread;

use umbrage_core::frame::LightPath;
use umbrage_core::{Light, LightShape, View};
use umbrage_lab::gpu::GpuError;
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::{Stage, StageLight};
use umbrage_truth::{ErrorMap, Oracle, Verdicts};

use crate::moment::Moment;

/// What came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Checked {
    /// Pixel-lights that the lights reach.
    pub(crate) samples: u64,
    pub(crate) wrong: u64,
    pub(crate) ambiguous: u64,
    pub(crate) map: ErrorMap,
}

/// A check under way.
#[derive(Debug)]
struct Running {
    done: Arc<AtomicU64>,
    pixels: u64,
    result: Receiver<Checked>,
}

/// The last check, and the oracle that the next one asks again.
#[derive(Debug, Default)]
pub(crate) struct Check {
    oracle: Arc<OnceLock<Oracle>>,
    /// The stage's time that it knows.
    time_s: f64,
    running: Option<Running>,
    /// What it judged.
    of: Option<Moment>,
    found: Option<Checked>,
}

impl Check {
    /// Draws the mask of a view without its silent lights, and starts judging it.
    pub(crate) fn start(
        &mut self,
        lab: &mut Lab,
        stage: &Arc<Stage>,
        lights: &[StageLight],
        view: &View,
        method: Method,
    ) -> Result<(), GpuError> {
        if self.time_s != stage.time_s {
            (self.time_s, self.oracle) = (stage.time_s, Arc::default());
        }
        let silent = lab.muted.clone();
        lab.prepare(stage, lights, view, method);
        let mask = lab.mask(stage, lights, view)?;
        let skipped: Vec<bool> = (0..lights.len())
            .map(|light| matches!(lab.path(light), LightPath::Skipped(_)))
            .collect();
        let mut asked: Vec<Light> = lights.iter().map(|light| light.light).collect();
        for &light in &silent {
            asked[light] = NONE;
        }
        let (done, near) = (Arc::new(AtomicU64::new(0)), lab.near_clip());
        let (send, result) = channel();
        let (stage, oracle) = (Arc::clone(stage), Arc::clone(&self.oracle));
        let (progress, judged) = (Arc::clone(&done), *view);
        thread::spawn(move || {
            let oracle = oracle.get_or_init(|| Oracle::new(&stage.mesh));
            let mut verdicts = Verdicts::new(oracle, &judged, &asked, near, &|done, _| {
                progress.store(done, Ordering::Relaxed);
            });
            let found = verdicts.judge(oracle, &mask, &skipped);
            // Nobody waits for it if the window was closed, or a later check started.
            let _ = send.send(Checked {
                samples: found.samples,
                wrong: found.wrong,
                ambiguous: found.ambiguous,
                map: verdicts.error_map(&mask, &skipped),
            });
        });
        self.found = None;
        self.of = Some(Moment {
            view: *view,
            silent,
            time_s: self.time_s,
        });
        self.running = Some(Running {
            done,
            pixels: u64::from(view.size[0]) * u64::from(view.size[1]),
            result,
        });
        Ok(())
    }

    /// Takes over the result if it is there; true once.
    pub(crate) fn poll(&mut self) -> bool {
        let Some(running) = &self.running else {
            return false;
        };
        match running.result.try_recv() {
            Ok(found) => self.found = Some(found),
            Err(TryRecvError::Empty) => return false,
            Err(TryRecvError::Disconnected) => {}
        }
        self.running = None;
        true
    }

    /// Share of the pixels that the oracle has looked at, while it looks.
    pub(crate) fn progress(&self) -> Option<f32> {
        let running = self.running.as_ref()?;
        Some(running.done.load(Ordering::Relaxed) as f32 / running.pixels.max(1) as f32)
    }

    /// What was found, if this is what was judged.
    pub(crate) fn found(&self, moment: &Moment) -> Option<&Checked> {
        let same = self.of.as_ref() == Some(moment);
        self.found.as_ref().filter(|_| same)
    }
}

/// A light that reaches nothing.
const NONE: Light = Light {
    position: glam::DVec3::ZERO,
    range: 0.0,
    shape: LightShape::Point,
};

/// Red where a pixel is wrong for a light, yellow where it is ambiguous, else nothing: rows of RGBA.
/// Each mark is a pixel wider all round, to be found.
pub(crate) fn marks(map: &ErrorMap) -> Vec<u8> {
    let [width, height] = map.size.map(|side| side as usize);
    let mut rgba = vec![0; 4 * width * height];
    for (counts, color) in [
        (&map.ambiguous, [255, 220, 0, 255]),
        (&map.wrong, [255, 0, 0, 255]),
    ] {
        for (at, _) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (x, y) = (at % width, at / width);
            for y in y.saturating_sub(1)..(y + 2).min(height) {
                for x in x.saturating_sub(1)..(x + 2).min(width) {
                    rgba[4 * (y * width + x)..][..4].copy_from_slice(&color);
                }
            }
        }
    }
    rgba
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_is_marked_over_ambiguous_and_nothing_else_is() {
        let mut map = ErrorMap {
            size: [8, 4],
            wrong: vec![0; 32],
            ambiguous: vec![0; 32],
        };
        assert!(marks(&map).iter().all(|&byte| byte == 0));
        map.wrong[0] = 1;
        map.ambiguous[2] = 3;
        let rgba = marks(&map);
        let at = |x: usize, y: usize| &rgba[4 * (y * 8 + x)..][..4];
        assert_eq!(at(1, 1), [255, 0, 0, 255]);
        assert_eq!(at(3, 1), [255, 220, 0, 255]);
        assert_eq!(at(4, 0), [0; 4]);
        assert_eq!(at(0, 2), [0; 4]);
    }
}
