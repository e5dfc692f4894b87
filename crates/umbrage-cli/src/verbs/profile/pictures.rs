//! What the page shows: the frame, the scene from above, the costliest lights.

use glam::{DVec2, DVec3, dvec2};
use umbrage_lab::heat::false_colours;
use umbrage_lab::lab::Lab;
use umbrage_lab::picture::{rgb_png, rgba_png};
use umbrage_report::bench::Picture;
use umbrage_report::profile::{Pictures, Plan, ProfileReport, Thumbnail};

use super::measure::Base;
use super::rows::costliest;
use crate::error::CliError;
use crate::setting::Setting;

/// Lights in pictures.
const MOST: usize = 6;
/// Pixels a thumbnail, the frame and the plan are wide, at most.
const THUMBNAIL: u32 = 320;
const FRAME: u32 = 640;
const PLAN: f64 = 640.0;

/// All of them.
pub(super) fn pictures(
    lab: &Lab,
    base: &mut Base,
    setting: &Setting,
    report: &ProfileReport,
) -> Result<Pictures, CliError> {
    let size = setting.view.size;
    let mut lights = Vec::new();
    let costly = costliest(&report.lights).into_iter();
    let drawn: Vec<usize> = costly
        .filter(|l| base.drawn.contains(l))
        .take(MOST)
        .collect();
    for light in drawn {
        let (stage, view) = (&setting.stage, &setting.view);
        let lit = lab.alone(&mut base.rendering, stage, &setting.lights, view, light)?;
        let lit = lit.exposed_rgb8(base.exposure);
        let overdraw = false_colours(&base.counter.overdraw(light)?);
        lights.push(Thumbnail {
            light,
            lit: smaller(size, &lit, THUMBNAIL)?,
            overdraw: smaller(size, &overdraw, THUMBNAIL)?,
        });
    }
    let frame = base.lit.exposed_rgb8(base.exposure);
    Ok(Pictures {
        frame: Some(smaller(size, &frame, FRAME)?),
        plan: Some(plan(setting)?),
        lights,
    })
}

fn refused(why: String) -> CliError {
    CliError::BadInput(format!("a picture of the report: {why}"))
}

/// The picture, smaller by the whole factor that brings it to `widest`, each block its mean.
fn smaller(size: [u32; 2], rgb8: &[u8], widest: u32) -> Result<Picture, CliError> {
    let factor = size[0].div_ceil(widest).max(1);
    let [width, height] = size.map(|side| (side / factor).max(1));
    let mut small = Vec::with_capacity((3 * width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let (mut sum, mut count) = (0, 0);
                for row in y * factor..((y + 1) * factor).min(size[1]) {
                    for column in x * factor..((x + 1) * factor).min(size[0]) {
                        let at = 3 * (row as usize * size[0] as usize + column as usize);
                        sum += u32::from(rgb8[at + channel]);
                        count += 1;
                    }
                }
                small.push((sum / count.max(1)) as u8);
            }
        }
    }
    let size = [width, height];
    Ok(Picture {
        size,
        png: rgb_png(size, &small).map_err(refused)?,
    })
}

/// The edges of the world from above, where lights are.
fn plan(setting: &Setting) -> Result<Plan, CliError> {
    let (stage, view) = (&setting.stage, &setting.view);
    let flat = |p: DVec3| dvec2(p.x, p.z);
    let world = &stage.world;
    let places = world.places();
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let all = (0..world.positions.len() as u32).map(|v| flat(places.at(v)));
    let bounds = |(low, high): (DVec2, DVec2), p: DVec2| (low.min(p), high.max(p));
    let (least, greatest) = all.fold(none, bounds);
    let lights = setting.lights.iter().map(|light| &light.light);
    let lights = lights.filter(|light| !light.is_directional() && light.is_usable());
    let near = |light: &umbrage_core::Light| {
        let reach = DVec2::splat(f64::from(light.range).min(1e30));
        [-reach, reach].map(|by| flat(light.position) + by)
    };
    let lit = lights.flat_map(near).fold(none, bounds);
    // A sky far around the lights would make everything else a dot.
    let (low, high) = match lit.0.x <= lit.1.x {
        true => (least.max(lit.0), greatest.min(lit.1)),
        false => (least, greatest),
    };
    let (low, high) = (low.min(flat(view.eye)), high.max(flat(view.eye)));
    let extent = (high - low).max(DVec2::splat(1e-3));
    let margin = 0.02 * extent.max_element();
    let (low, extent) = (low - margin, extent + 2.0 * margin);
    let scale = PLAN / extent.max_element();
    let size = [extent.x, extent.y].map(|side| (side * scale).ceil().max(16.0) as u32);
    let mut density = vec![0u32; size[0] as usize * size[1] as usize];
    for ends in world.edges.vertices.iter() {
        let [a, b] = ends.map(|v| (flat(places.at(v)) - low) * scale);
        draw(&mut density, size, a, b);
    }
    // From above most edges lie on others: the logarithm leaves the few visible.
    let most = f64::from(density.iter().copied().max().unwrap_or(0)).ln_1p();
    let pixel = |&count: &u32| {
        let alpha = 220.0 * (f64::from(count).ln_1p() / most.max(1.0)).powf(0.8);
        [128, 132, 140, alpha as u8]
    };
    let rgba8: Vec<u8> = density.iter().flat_map(pixel).collect();
    let origin = flat(stage.soup.origin);
    let forward = flat(view.forward.as_dvec3()).normalize_or(DVec2::X);
    Ok(Plan {
        picture: Picture {
            size,
            png: rgba_png(size, &rgba8).map_err(refused)?,
        },
        least: (low + origin).to_array(),
        greatest: (low + dvec2(f64::from(size[0]), f64::from(size[1])) / scale + origin).to_array(),
        eye: [(flat(view.eye) + origin).to_array(), forward.to_array()],
    })
}

/// Counts a line in the pixels that it passes.
fn draw(density: &mut [u32], size: [u32; 2], a: DVec2, b: DVec2) {
    let [width, height] = size.map(f64::from);
    let outside = |i: usize, end: f64| (a[i] < 0.0 && b[i] < 0.0) || (a[i] > end && b[i] > end);
    if outside(0, width) || outside(1, height) {
        return;
    }
    let steps = (b - a).abs().max_element().ceil().clamp(1.0, 4096.0);
    for step in 0..=steps as u32 {
        let p = a.lerp(b, f64::from(step) / steps);
        if p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < height {
            density[p.y as usize * size[0] as usize + p.x as usize] += 1;
        }
    }
}
