//! From figures to the report's rows and words.

use umbrage_core::volume::BuildTimes;
use umbrage_lab::profile::GpuCost as Gpu;
use umbrage_report::profile::{Advice, CpuCost, Frame, GpuCost, LightRow, Saving, Share};

use super::measure::{Base, Figures};
use crate::setting::Setting;

/// How it was measured.
pub(super) fn how(base: &Base) -> Vec<String> {
    let mut how = vec![
        "Ordinary frames were timed with nothing in them that the profile needs, in turn with all \
         else."
            .to_owned(),
        "CPU figures: each light built from nothing on one thread, with a clock between the stages. \
         A light whose volume is kept pays none of it in a frame."
            .to_owned(),
    ];
    how.push(match base.has_gpu_times {
        true => "GPU figures: each light drawn in a pass of its own, several times over, and its \
                 volume in another, timed from outside: what the further times take counts. One by one \
                 lights do not overlap as they do in the frame: the difference says how much."
            .to_owned(),
        false => "This adapter has no timestamps, so there are no GPU figures.".to_owned(),
    });
    how.push(
        "Every figure is the median of the rounds, each of which has them all. \
         Fragments and pixels are counted exactly. A light shows on a pixel that it makes brighter \
         by a step of 8-bit sRGB or more."
            .to_owned(),
    );
    how
}

/// What of the frame is a light's own, in microseconds.
fn own_us(figures: &Figures) -> Option<f64> {
    let build = match figures.cached {
        true => 0.0,
        false => figures.build.total_us() + figures.upload_us,
    };
    Some(figures.gpu?.total_us + build)
}

/// The frame and its parts.
pub(super) fn frame(base: &Base) -> Frame {
    let times = &base.frame;
    let frame_us = times.frame * 1e3;
    let built_us = |figures: &Figures| figures.build.total_us() + figures.upload_us;
    let mut parts = Vec::new();
    if base.has_gpu_times {
        let gpu = base.lights.iter().filter_map(|figures| figures.gpu);
        let lights: f64 = gpu.map(|gpu| gpu.total_us).sum();
        parts.push(("lights, one by one", lights));
        parts.push((
            "lights in one pass, difference",
            times.gpu_lights * 1e3 - lights,
        ));
        parts.push(("surface", times.gpu_surface * 1e3));
        parts.push(("receivers", times.gpu_receivers * 1e3));
    }
    parts.push(("volumes brought up to date", times.volumes * 1e3));
    parts.push(("plan", times.plan * 1e3));
    parts.push(("upload", times.upload * 1e3));
    parts.push(("commands recorded", times.record * 1e3));
    let built: f64 = base.lights.iter().map(built_us).sum();
    Frame {
        frame_ms: times.frame,
        parts: with_remainder(frame_us, parts),
        build_us: base.build_all_us,
        build_parts: with_remainder(base.build_all_us, vec![("lights, one by one", built)]),
    }
}

/// Parts as shares of a whole, the last of them what the others leave.
fn with_remainder(whole: f64, mut parts: Vec<(&str, f64)>) -> Vec<Share> {
    let sum: f64 = parts.iter().map(|(_, us)| us).sum();
    parts.push(("remainder", whole - sum));
    let share = |(name, us): (&str, f64)| Share {
        name: name.to_owned(),
        us,
        share: us / whole.max(f64::MIN_POSITIVE),
    };
    parts.into_iter().map(share).collect()
}

/// One row a light.
pub(super) fn lights(base: &Base, setting: &Setting) -> Vec<LightRow> {
    let origin = setting.stage.soup.origin;
    let rows = setting.lights.iter().zip(&base.lights);
    rows.map(|(light, figures)| {
        let work = &figures.work;
        let counts = &work.counts;
        let is_sun = light.light.is_directional();
        let own = own_us(figures);
        LightRow {
            name: light.name.clone(),
            kind: light.kind().to_owned(),
            range: (!is_sun).then_some(light.light.range),
            position: (!is_sun).then_some((light.light.position + origin).to_array()),
            subset_triangles: u64::from(work.subset),
            facing_triangles: u64::from(work.facing),
            quads: u64::from(work.quads),
            quads_drawn: u64::from(work.quads_drawn),
            cap_triangles: u64::from(work.cap_triangles),
            path: figures.path.name().to_owned(),
            reason: figures.path.reason().to_owned(),
            cached: figures.cached,
            cpu_us: cpu(&figures.build, figures.upload_us),
            gpu_us: figures.gpu.map(gpu),
            volume_fragments: counts.volume_fragments,
            volume_covered: counts.volume_covered,
            light_fragments: counts.light_fragments,
            shaded_samples: counts.shaded_samples,
            lit_pixels: counts.lit_pixels,
            shadowed_pixels: counts.lit_unshadowed.saturating_sub(counts.lit_pixels),
            range_needed_m: counts.range_needed_m,
            frame_us: own,
            frame_share: own.map(|us| us / (base.frame.frame * 1e3)),
        }
    })
    .collect()
}

fn cpu(build: &BuildTimes, upload_us: f64) -> CpuCost {
    CpuCost {
        query: build.query_us,
        facing: build.facing_us,
        hidden: build.hidden_us,
        layers: build.layers_us,
        counters: build.counters_us,
        emission: build.emission_us,
        upload: upload_us,
    }
}

fn gpu(gpu: Gpu) -> GpuCost {
    GpuCost {
        volume: gpu.volume_us,
        light: gpu.light_us(),
    }
}

/// Places of the lights, the costliest first.
pub(super) fn costliest(lights: &[LightRow]) -> Vec<usize> {
    let cost = |light: &usize| {
        let row = &lights[*light];
        row.frame_us.unwrap_or(row.cpu_us.total())
    };
    let mut places: Vec<usize> = (0..lights.len()).collect();
    places.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
    places.retain(|light| cost(light) > 0.0);
    places
}

/// The advice with its savings.
pub(super) fn in_words(advice: &Advice) -> String {
    let of = |saving: &Saving| match saving.frame_us {
        Some(frame) => format!("{frame:.0} us a frame, {:.0} us a build", saving.build_us),
        None => format!("{:.0} us a build", saving.build_us),
    };
    let measured = match &advice.measured {
        Some(measured) => format!("; measured {}", of(measured)),
        None => String::new(),
    };
    format!("{} Saves {}{measured}.", advice.text, of(&advice.predicted))
}
