//! The scene from above, with lights as discs: the larger and redder, the costlier.

use super::{cost, heat, most};
use crate::figure::figure;
use crate::grouped;
use crate::page::{data_uri, escape};
use crate::profile::{LightRow, Plan, ProfileReport};

/// Radius of the costliest light's disc, in pixels of the picture.
const LARGEST: f64 = 11.0;
const SMALLEST: f64 = 2.5;

/// Drawing and legend.
pub(super) fn plan_figure(report: &ProfileReport, plan: &Plan) -> String {
    let [width, height] = plan.picture.size.map(f64::from);
    let place = |[x, z]: [f64; 2]| {
        let part = |at: f64, i: usize| {
            (at - plan.least[i]) / (plan.greatest[i] - plan.least[i]).max(f64::MIN_POSITIVE)
        };
        [part(x, 0) * width, part(z, 1) * height]
    };
    let mut svg = format!(
        "<svg class=\"plot plan\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"Plan\">\
         <image href=\"{}\" width=\"{width}\" height=\"{height}\"/>\
         <rect class=\"frame\" width=\"{width}\" height=\"{height}\"/>",
        data_uri("image/png", &plan.picture.png)
    );
    let most = most(report);
    let mut lights: Vec<&LightRow> = report.lights.iter().collect();
    // The costliest on top.
    lights.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    for light in lights {
        let Some([x, _, z]) = light.position else {
            continue;
        };
        let [x, y] = place([x, z]);
        let radius = SMALLEST + (LARGEST - SMALLEST) * (cost(light) / most).max(0.0).sqrt();
        svg += &format!(
            "<g class=\"spot lamp\" tabindex=\"0\" data-method=\"{name}\"><title>{title}</title>\
             <circle class=\"hit\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>\
             <circle class=\"mark h{}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/></g>",
            radius + 2.0,
            heat(light, most),
            name = escape(&light.name),
            title = escape(&title(light)),
        );
    }
    let [eye, forward] = plan.eye;
    let [x, y] = place(eye);
    let [fx, fy] = forward;
    svg += &format!(
        "<path class=\"eye\" d=\"M{:.1} {:.1}L{x:.1} {y:.1}L{:.1} {:.1}\"><title>The eye</title></path></svg>",
        x + 22.0 * (fx - 0.5 * fy),
        y + 22.0 * (fy + 0.5 * fx),
        x + 22.0 * (fx + 0.5 * fy),
        y + 22.0 * (fy - 0.5 * fx),
    );
    format!(
        "<figure>{svg}<figcaption>From above, X to the right and Z down: lights, larger and redder the \
         more they cost, each step of colour half as much. The angle is what the eye sees.\
         </figcaption></figure>"
    )
}

/// What a disc or a bar tells when pointed at.
pub(super) fn title(light: &LightRow) -> String {
    let gpu = match light.gpu_us {
        Some(gpu) => format!(
            "GPU {} \u{b5}s: volume {}, light {}",
            figure(gpu.total()),
            figure(gpu.volume),
            figure(gpu.light)
        ),
        None => "GPU not measured".to_owned(),
    };
    format!(
        "{}\n{gpu}\nbuilt in {} \u{b5}s\n{} quads drawn, {} lit pixels",
        light.name,
        figure(light.cpu_us.total()),
        grouped(light.quads_drawn),
        grouped(light.lit_pixels)
    )
}
