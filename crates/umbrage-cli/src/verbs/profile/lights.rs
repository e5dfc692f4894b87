//! Which lights there are to take apart.

use umbrage_core::frame::LightPath;
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::method::Counting;

/// Whether a method draws each light's volume and then the light, in the stencil.
pub(super) fn is_drawn_light_by_light(method: Method) -> bool {
    let is_low = matches!(method, Method::LowResolution { .. });
    method.recipe().is_some() && !is_low && matches!(method.counting(), Counting::Stencil)
}

/// Lights that the view draws.
pub(super) fn drawn(lab: &Lab) -> Vec<usize> {
    let all = 0..lab.plan.lights.len();
    all.filter(|&light| !matches!(lab.path(light), LightPath::Skipped(_)))
        .collect()
}

/// Lights whose volume was built.
pub(super) fn built(lab: &Lab) -> Vec<usize> {
    let volumes = lab.volumes.lights.iter().enumerate();
    let built = volumes.filter(|(_, volume)| volume.stamp != 0);
    built.map(|(light, _)| light).collect()
}
