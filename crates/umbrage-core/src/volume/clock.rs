//! What the stages of one light's build take, for profilers. Ordinary builds have a clock that is
//! nothing, and compiles to nothing.

use std::time::Instant;

/// A stage of a light's build, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BuildStage {
    Query,
    Facing,
    Hidden,
    Layers,
    Counters,
    Emission,
}

/// Told at the end of each stage; one may come several times.
pub(super) trait Clock {
    fn lap(&mut self, stage: BuildStage);
}

impl Clock for () {
    #[inline(always)]
    fn lap(&mut self, _stage: BuildStage) {}
}

/// Microseconds of one light's build on one thread, stage by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildTimes {
    /// Triangles in its range found.
    pub query_us: f64,
    /// Which of them cast.
    pub facing_us: f64,
    /// Hidden casters dropped.
    pub hidden_us: f64,
    /// Layers bounded, and the volume split if they are too many.
    pub layers_us: f64,
    /// Edges counted, and a quad written for each unit.
    pub counters_us: f64,
    /// Quads ordered by range and handed over.
    pub emission_us: f64,
}

impl BuildTimes {
    /// All stages.
    pub fn total_us(&self) -> f64 {
        self.stages().iter().map(|(_, us)| us).sum()
    }

    /// Names and times, in the order of the stages.
    pub fn stages(&self) -> [(&'static str, f64); 6] {
        [
            ("query", self.query_us),
            ("facing", self.facing_us),
            ("hidden", self.hidden_us),
            ("layers", self.layers_us),
            ("counters", self.counters_us),
            ("emission", self.emission_us),
        ]
    }
}

/// A clock that runs.
#[derive(Debug)]
pub(super) struct StageClock {
    last: Instant,
    pub(super) times: BuildTimes,
}

impl StageClock {
    pub(super) fn start() -> Self {
        Self {
            last: Instant::now(),
            times: BuildTimes::default(),
        }
    }
}

impl Clock for StageClock {
    fn lap(&mut self, stage: BuildStage) {
        let now = Instant::now();
        let us = (now - self.last).as_secs_f64() * 1e6;
        self.last = now;
        let times = &mut self.times;
        *match stage {
            BuildStage::Query => &mut times.query_us,
            BuildStage::Facing => &mut times.facing_us,
            BuildStage::Hidden => &mut times.hidden_us,
            BuildStage::Layers => &mut times.layers_us,
            BuildStage::Counters => &mut times.counters_us,
            BuildStage::Emission => &mut times.emission_us,
        } += us;
    }
}
