//! What was measured, as plain data: the keys of `profile.json`.
//!
//! Keys are fixed, scripts depend on them; more may be added. A figure that was not measured is null.

use serde::Serialize;

use crate::bench::{Machine, Picture};

/// One run of `umbrage profile`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ProfileReport {
    /// The command line that made it.
    pub command: String,
    /// When the run began: RFC 3339, UTC.
    pub when: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the method.
    pub method: String,
    /// Name of the adapter.
    pub adapter: String,
    /// Where it ran.
    pub machine: Machine,
    /// Width and height.
    pub size: [u32; 2],
    /// Of the scene.
    pub triangles: u64,
    /// Rounds that each light was measured in; figures are medians of them.
    pub rounds: u32,
    /// How it was measured, in words.
    pub how: Vec<String>,
    /// The ordinary frame, undisturbed.
    pub frame: Frame,
    /// One a light, in the order of the scene.
    pub lights: Vec<LightRow>,
    /// What would save time, the most first.
    pub advice: Vec<Advice>,
    /// For the page alone.
    #[serde(skip)]
    pub pictures: Pictures,
}

/// What the ordinary frame takes, and where it goes.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Frame {
    /// From its begin to the end of the GPU's work, in milliseconds: the median of the rounds.
    pub frame_ms: f64,
    /// The frame's parts in microseconds: the lights' own GPU times, what is shared, and the
    /// remainder, so that the sum is the frame.
    pub parts: Vec<Share>,
    /// The same of all volumes built anew on one thread.
    pub build_us: f64,
    /// Its parts: the lights' own, and the remainder.
    pub build_parts: Vec<Share>,
}

/// One part of a whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Share {
    /// What it is.
    pub name: String,
    /// Microseconds; below zero for a remainder that the parts before it exceed.
    pub us: f64,
    /// Of the whole, 0 to 1.
    pub share: f64,
}

/// CPU microseconds of one light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CpuCost {
    /// Triangles in its range found.
    pub query: f64,
    /// Which of them cast.
    pub facing: f64,
    /// Casters hidden behind others dropped.
    pub hidden: f64,
    /// Layers bounded.
    pub layers: f64,
    /// Edges counted, quads written.
    pub counters: f64,
    /// Quads ordered and handed over.
    pub emission: f64,
    /// Quads handed to the GPU.
    pub upload: f64,
}

impl CpuCost {
    /// Names and microseconds, in the order of the work.
    pub fn stages(&self) -> [(&'static str, f64); 7] {
        [
            ("query", self.query),
            ("facing", self.facing),
            ("hidden", self.hidden),
            ("layers", self.layers),
            ("counters", self.counters),
            ("emission", self.emission),
            ("upload", self.upload),
        ]
    }

    /// Of all stages.
    pub fn total(&self) -> f64 {
        self.stages().iter().map(|(_, us)| us).sum()
    }
}

/// GPU microseconds of one light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GpuCost {
    /// Its volume.
    pub volume: f64,
    /// Its light draw.
    pub light: f64,
}

impl GpuCost {
    /// Of both.
    pub fn total(&self) -> f64 {
        self.volume + self.light
    }
}

/// One light.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LightRow {
    /// As in the scene.
    pub name: String,
    /// point, spot or directional.
    pub kind: String,
    /// Metres; null for a light without one.
    pub range: Option<f32>,
    /// In the scene; null for a directional light.
    pub position: Option<[f64; 3]>,
    /// Triangles that its query returned.
    pub subset_triangles: u64,
    /// Of these, those that cast.
    pub facing_triangles: u64,
    /// Of its volume.
    pub quads: u64,
    /// Of these, drawn in the view.
    pub quads_drawn: u64,
    /// Cap triangles drawn.
    pub cap_triangles: u64,
    /// zpass, zfail or skipped.
    pub path: String,
    /// Why, in words; empty for the default path.
    pub reason: String,
    /// Whether the ordinary frame kept its volume, rather than building it again.
    pub cached: bool,
    /// What its volume takes when it is built.
    pub cpu_us: CpuCost,
    /// Null on an adapter without timestamps.
    pub gpu_us: Option<GpuCost>,
    /// Fragments of its volume before the surface.
    pub volume_fragments: u64,
    /// All fragments of its volume, those behind the surface too.
    pub volume_covered: u64,
    /// Samples that its light draw covers.
    pub light_fragments: u64,
    /// Of these, samples shaded.
    pub shaded_samples: u64,
    /// Of these, pixels in which its light shows.
    pub lit_pixels: u64,
    /// Pixels in which it would show, had it no shadows, and does not.
    pub shadowed_pixels: u64,
    /// The shortest range in metres with which no pixel gets visibly darker; 0 where it does not show,
    /// and for a directional light.
    pub range_needed_m: f64,
    /// What of the ordinary frame is its own, in microseconds: GPU time, and CPU time unless its
    /// volume was kept. Null where it was drawn on an adapter without timestamps.
    pub frame_us: Option<f64>,
    /// The same as a part of the frame.
    pub frame_share: Option<f64>,
}

/// What kind of thing to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AdviceKind {
    /// Give a light a shorter range.
    ShorterRange,
    /// Let a mesh or material cast no shadows.
    NoCasting,
    /// Let a material cast from its front alone.
    SingleSided,
    /// Switch a light off where it is seen from here.
    SwitchOff,
    /// Let a light have no shadows.
    NoShadows,
    /// Make one light of several.
    Merge,
    /// Move a light away from where the eye is on a side of its volume.
    Move,
}

/// Microseconds saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Saving {
    /// GPU time in each frame; null on an adapter without timestamps.
    pub frame_us: Option<f64>,
    /// CPU time whenever the volumes concerned are built.
    pub build_us: f64,
}

impl Saving {
    /// What counts first: each frame, else each build.
    pub fn weight_us(&self) -> f64 {
        self.frame_us.unwrap_or(self.build_us)
    }
}

/// One thing to do.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// What kind.
    pub kind: AdviceKind,
    /// Names of the lights concerned.
    pub lights: Vec<String>,
    /// Name of the mesh or material concerned; empty for advice about lights.
    pub of: String,
    /// In words.
    pub text: String,
    /// From the figures of this profile.
    pub predicted: Saving,
    /// With the advice applied, if that was asked for.
    pub measured: Option<Saving>,
    /// Measured over predicted, a frame; null without.
    pub frame_ratio: Option<f64>,
    /// Measured over predicted, a build; null without.
    pub build_ratio: Option<f64>,
    /// Pixels of the picture that change to the eye: by more than two steps of 8-bit sRGB.
    pub pixels_changed: u64,
}

/// What only the page shows.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The lit frame.
    pub frame: Option<Picture>,
    /// The scene from above.
    pub plan: Option<Plan>,
    /// The lights that cost most.
    pub lights: Vec<Thumbnail>,
}

/// The scene's edges from above: x to the right, z down.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Grey on nothing.
    pub picture: Picture,
    /// Least x and z shown, in metres of the scene.
    pub least: [f64; 2],
    /// Greatest.
    pub greatest: [f64; 2],
    /// Where the eye is, and a unit vector the way it looks, in x and z.
    pub eye: [[f64; 2]; 2],
}

/// One light in pictures.
#[derive(Clone, Debug)]
pub struct Thumbnail {
    /// Its place in [`ProfileReport::lights`].
    pub light: usize,
    /// Its light alone.
    pub lit: Picture,
    /// Fragments of its volume in false colours.
    pub overdraw: Picture,
}
