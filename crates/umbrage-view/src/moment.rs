//! What a frame is of, and lights that move with the scene.

use umbrage_core::View;
use umbrage_lab::stage::{Stage, StageLight};

/// What a frame is of, whatever is shown of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moment {
    pub(crate) view: View,
    /// Numbers of lights left out.
    pub(crate) silent: Vec<usize>,
    /// The stage's time, in seconds.
    pub(crate) time_s: f64,
}

/// For each light the light of the scene that it follows as time goes on: that of its name, if it
/// stands where that one does. Lights brought along stand still.
pub(crate) fn followed(stage: &Stage, lights: &[StageLight]) -> Vec<Option<usize>> {
    let of_scene = stage.lights(None);
    let same = |a: &StageLight, b: &StageLight| {
        a.name == b.name && a.light.position == b.light.position && a.light.shape == b.light.shape
    };
    let of = |light: &StageLight| of_scene.iter().position(|other| same(light, other));
    lights.iter().map(of).collect()
}

/// Puts lights where those that they follow are now.
pub(crate) fn follow(stage: &Stage, followed: &[Option<usize>], lights: &mut [StageLight]) {
    for (light, followed) in lights.iter_mut().zip(followed) {
        if let Some(of) = followed.and_then(|number| stage.scene.lights.get(number)) {
            let now = stage.light(of, None).light;
            (light.light.position, light.light.shape) = (now.position, now.shape);
        }
    }
}
