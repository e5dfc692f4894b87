//! A trace that Perfetto and `chrome://tracing` open: the profile's figures as a timeline.
//!
//! It is laid out, not recorded: each light's stages follow one another as they were measured apart.
//! On the CPU track all volumes are built, one after the other, as in a first frame; on the GPU track
//! are the parts of the ordinary frame, with volume and light of each light in turn.

use serde_json::{Value, json};

use super::{LightRow, ProfileReport};

const CPU: u32 = 1;
const GPU: u32 = 2;

/// The document: complete events (`ph` X) in microseconds, nested by time.
pub fn trace(report: &ProfileReport) -> Value {
    let name = |tid: u32, name: &str| json!({"ph": "M", "pid": 1, "tid": tid, "name": "thread_name", "args": {"name": name}});
    let mut events = vec![
        json!({"ph": "M", "pid": 1, "name": "process_name", "args": {"name": format!("umbrage profile {}", report.scene)}}),
        name(CPU, "CPU: volumes, light by light"),
        name(GPU, "GPU: frame, light by light"),
    ];
    let built = |light: &LightRow| light.cpu_us.stages().to_vec();
    push(
        &mut events,
        CPU,
        0.0,
        "build volumes",
        &report.lights,
        built,
    );
    let mut at = 0.0;
    for part in &report.frame.parts {
        if part.name == "surface" || part.name == "receivers" {
            events.push(event(GPU, at, part.us, &part.name, json!({})));
            at += part.us;
        }
    }
    let drawn = |light: &LightRow| match light.gpu_us {
        Some(gpu) => vec![("volume", gpu.volume), ("light", gpu.light)],
        None => Vec::new(),
    };
    push(&mut events, GPU, at, "lights", &report.lights, drawn);
    json!({"displayTimeUnit": "ms", "traceEvents": events})
}

/// A parent event named `all`, in it one a light, and in each its stages.
fn push(
    events: &mut Vec<Value>,
    tid: u32,
    begin: f64,
    all: &str,
    lights: &[LightRow],
    stages: impl Fn(&LightRow) -> Vec<(&'static str, f64)>,
) {
    let place = events.len();
    let mut at = begin;
    for light in lights {
        let stages = stages(light);
        let total: f64 = stages.iter().map(|(_, us)| us).sum();
        if total <= 0.0 {
            continue;
        }
        let args = json!({
            "subset_triangles": light.subset_triangles,
            "quads_drawn": light.quads_drawn,
            "volume_fragments": light.volume_fragments,
            "volume_covered": light.volume_covered,
            "shaded_samples": light.shaded_samples,
            "path": light.path,
        });
        events.push(event(tid, at, total, &light.name, args));
        for (stage, us) in stages.into_iter().filter(|(_, us)| *us > 0.0) {
            events.push(event(tid, at, us, stage, json!({})));
            at += us;
        }
    }
    if at > begin {
        events.insert(place, event(tid, begin, at - begin, all, json!({})));
    }
}

fn event(tid: u32, ts: f64, dur: f64, name: &str, args: Value) -> Value {
    json!({"ph": "X", "pid": 1, "tid": tid, "ts": ts, "dur": dur, "name": name, "cat": "umbrage", "args": args})
}
