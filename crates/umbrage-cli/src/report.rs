//! The JSON of every verb. Keys are fixed: scripts depend on them; more may be added.
//!
//! Times are milliseconds, medians over `--repeat` frames; a value that could not be measured
//! (GPU time on an adapter without timestamps) is null.

use std::collections::BTreeMap;

use serde::Serialize;
use umbrage_lab::Uploaded;

/// `render`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct RenderReport {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) adapter: String,
    /// Width and height.
    pub(crate) size: [u32; 2],
    pub(crate) frame_ms: f64,
    /// By name of the stage, CPU and GPU.
    pub(crate) stages_ms: BTreeMap<String, f64>,
    /// Of the GPU: volumes, and what the method keeps for itself.
    pub(crate) gpu_bytes: u64,
    /// What a reader of the method's figures must know; empty if nothing.
    pub(crate) note: String,
    pub(crate) totals: RenderTotals,
    pub(crate) lights: Vec<LightReport>,
}

/// Sums over the lights of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct RenderTotals {
    pub(crate) subset_triangles: u64,
    pub(crate) facing_triangles: u64,
    pub(crate) quads: u64,
    pub(crate) cap_triangles: u64,
    /// Of the quads, those drawn.
    pub(crate) quads_drawn: u64,
    /// Quads and cap triangles drawn.
    pub(crate) polygons: u64,
    /// In the last frame.
    pub(crate) uploaded_bytes: u64,
    /// Quads and caps among them.
    pub(crate) uploaded_volume_bytes: u64,
    pub(crate) lights_rebuilt: u64,
    pub(crate) lights_cached: u64,
    pub(crate) lights_skipped: u64,
    /// Of those not skipped, lights drawn in parts: they may have more layers than the stencil holds.
    pub(crate) lights_split: u64,
}

/// How a light was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PathTaken {
    #[default]
    Zpass,
    Zfail,
    Skipped,
}

/// One light of a frame.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct LightReport {
    pub(crate) name: String,
    /// point, spot or directional.
    pub(crate) kind: String,
    /// Metres; null for a light without one.
    pub(crate) range: Option<f32>,
    pub(crate) subset_triangles: u64,
    pub(crate) facing_triangles: u64,
    /// Of its volume.
    pub(crate) quads: u64,
    /// Of these, what the last frame drew.
    pub(crate) quads_drawn: u64,
    pub(crate) cap_triangles: u64,
    /// No point is behind more of its casters; 0 if it was not built.
    pub(crate) layers_bound: u64,
    /// In which its volume is counted: 1, unless that is more than the stencil holds.
    pub(crate) parts: u64,
    pub(crate) path: PathTaken,
    /// Why this path; empty for the default one.
    pub(crate) reason: String,
    pub(crate) cached: bool,
    pub(crate) build_us: f64,
    pub(crate) gpu_us: Option<f64>,
}

impl RenderTotals {
    /// Sums what the lights report; what was uploaded is the frame's own.
    pub(crate) fn of(lights: &[LightReport], uploaded: Uploaded) -> Self {
        let mut totals = Self {
            uploaded_bytes: uploaded.volume_bytes + uploaded.other_bytes,
            uploaded_volume_bytes: uploaded.volume_bytes,
            ..Self::default()
        };
        for light in lights {
            totals.subset_triangles += light.subset_triangles;
            totals.facing_triangles += light.facing_triangles;
            let skipped = light.path == PathTaken::Skipped;
            totals.quads += light.quads;
            totals.quads_drawn += light.quads_drawn;
            totals.cap_triangles += if skipped { 0 } else { light.cap_triangles };
            totals.lights_skipped += u64::from(skipped);
            totals.lights_cached += u64::from(!skipped && light.cached);
            totals.lights_rebuilt += u64::from(!skipped && !light.cached);
            totals.lights_split += u64::from(!skipped && light.parts > 1);
        }
        totals.polygons = totals.quads_drawn + totals.cap_triangles;
        totals
    }
}

/// `view`, once the window is closed.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct ViewReport {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) adapter: String,
    /// Width and height of the last frame.
    pub(crate) size: [u32; 2],
    pub(crate) frames: u64,
    /// The last frame, panels apart.
    pub(crate) frame_ms: f64,
}

/// `inspect`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct InspectReport {
    pub(crate) scene: String,
    /// As the scene has them, degenerate ones included.
    pub(crate) triangles: u64,
    pub(crate) vertices: u64,
    pub(crate) welded_vertices: u64,
    pub(crate) unique_edges: u64,
    pub(crate) edges_by_triangles: EdgesByTriangles,
    pub(crate) opposite_wound_pairs: u64,
    pub(crate) degenerate_triangles: u64,
    pub(crate) duplicate_triangles: u64,
    pub(crate) bytes_per_triangle: f64,
    /// `bytes_per_triangle` by array of the world.
    pub(crate) memory: BTreeMap<&'static str, f64>,
    /// What edges that point to their faces take, with the `sides` that they need too, where
    /// `sides` and `clusters` stand here, a triangle.
    pub(crate) face_pointer_bytes_per_triangle: f64,
    /// That the scene brings itself.
    pub(crate) lights: u64,
    /// What loading skipped or repaired, and how often.
    pub(crate) oddities: Vec<String>,
    /// A sentence for each of the first of these.
    pub(crate) oddity_notes: Vec<String>,
    /// A `--world` file mapped, fingerprint and checksums included; null where it was built.
    pub(crate) open_ms: Option<f64>,
    /// Of a mapped world, `load` apart: when it was saved.
    pub(crate) build_ms: BuildMs,
}

/// Edges by the number of triangles on them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct EdgesByTriangles {
    #[serde(rename = "1")]
    pub(crate) one: u64,
    #[serde(rename = "2")]
    pub(crate) two: u64,
    #[serde(rename = "3")]
    pub(crate) three: u64,
    #[serde(rename = "4+")]
    pub(crate) more: u64,
}

/// Stages of a world's build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct BuildMs {
    /// File read, decoded and flattened.
    pub(crate) load: f64,
    pub(crate) weld: f64,
    pub(crate) edges: f64,
    pub(crate) bvh: f64,
    pub(crate) order: f64,
    /// All of it, `load` included.
    pub(crate) total: f64,
}

/// `check`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct CheckReport {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) adapter: String,
    pub(crate) size: [u32; 2],
    /// With a surface in them.
    pub(crate) pixels: u64,
    pub(crate) lights: u64,
    /// Pixel-lights in the light's range and facing it.
    pub(crate) samples: u64,
    pub(crate) wrong: u64,
    pub(crate) ambiguous: u64,
    /// Pixel-lights whose layers the method's mask cannot represent, of those in the light's range,
    /// facing it or not; no other can be wrong. Null for methods without such a limit, and at lower
    /// resolutions.
    pub(crate) unrepresentable: Option<u64>,
    /// Of `wrong`, those not among them: the method fails by one. Null as `unrepresentable` is.
    pub(crate) wrong_representable: Option<u64>,
    pub(crate) tolerance_px: f64,
    pub(crate) tolerance_depth: f64,
    /// Whether every light's volume is closed, counted in integers.
    pub(crate) closed: bool,
    pub(crate) worst: Vec<WorstPixel>,
    pub(crate) lights_by_path: LightsByPath,
    /// Of those not skipped, lights drawn in parts.
    pub(crate) lights_split: u64,
    /// Of every light.
    pub(crate) layers: Vec<LightLayers>,
    /// What a reader of the method's figures must know; empty if nothing.
    pub(crate) note: String,
}

/// A wrong pixel-light.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct WorstPixel {
    pub(crate) x: u32,
    pub(crate) y: u32,
    /// Name of the light.
    pub(crate) light: String,
}

/// A light's layers; see [`LightReport`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct LightLayers {
    pub(crate) name: String,
    pub(crate) layers_bound: u64,
    pub(crate) parts: u64,
}

/// Lights by how they were drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct LightsByPath {
    pub(crate) zpass: u64,
    pub(crate) zfail: u64,
    pub(crate) skipped: u64,
}

/// `volumes`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct VolumesReport {
    pub(crate) scene: String,
    pub(crate) lights: u64,
    /// portable, avx2 or avx512.
    pub(crate) instructions: String,
    /// Of `parallel_ms_total`; the methods are timed on one.
    pub(crate) threads: u64,
    /// Candidates of all lights.
    pub(crate) subset_triangles: u64,
    /// The library's own build of all lights on all threads.
    pub(crate) parallel_ms_total: f64,
    /// The same on one.
    pub(crate) serial_ms_total: f64,
    pub(crate) methods: Vec<VolumesMethod>,
    pub(crate) lights_detail: Vec<VolumesLight>,
}

/// One light, by every method.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct VolumesLight {
    pub(crate) name: String,
    /// point, spot or directional.
    pub(crate) kind: String,
    pub(crate) subset_triangles: u64,
    /// Casters by name of the method.
    pub(crate) facing_triangles: BTreeMap<String, u64>,
    /// By name of the method.
    pub(crate) quads: BTreeMap<String, u64>,
    /// Microseconds for query, facing and quads, by name of the method.
    pub(crate) build_us: BTreeMap<String, f64>,
}

/// One method over all lights: query, facing and quads.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct VolumesMethod {
    pub(crate) name: String,
    pub(crate) ms_total: f64,
    pub(crate) ns_per_triangle: f64,
    pub(crate) quads: u64,
    /// Mean over all lights.
    pub(crate) quads_per_light: f64,
    /// Mean over point and spot lights; 0 if there are none.
    pub(crate) quads_per_local_light: f64,
    /// Light and dark caps, if drawn.
    pub(crate) cap_triangles: u64,
    /// Quads and cap triangles.
    pub(crate) polygons: u64,
    pub(crate) adjacency_bytes_per_triangle: f64,
}

/// `stress`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct StressReport {
    pub(crate) cases: u64,
    /// Of these, drawn.
    pub(crate) rendered: u64,
    /// Counts at points and pixel-lights.
    pub(crate) samples: u64,
    pub(crate) wrong: u64,
    pub(crate) ambiguous: u64,
    /// Whether every volume is closed, counted in integers.
    pub(crate) closed: bool,
    /// Volumes that are not.
    pub(crate) not_closed: u64,
    /// Points for which no ray could be counted; no samples.
    pub(crate) uncounted: u64,
    pub(crate) point_samples: u64,
    pub(crate) pixel_samples: u64,
    pub(crate) seed: u64,
    /// Of a point, as a share of its distance from the light.
    pub(crate) tolerance: f64,
    /// Of pixel-lights, as for check.
    pub(crate) tolerance_px: f64,
    pub(crate) tolerance_depth: f64,
    /// Of the pictures.
    pub(crate) size: [u32; 2],
    /// Null where nothing was to be drawn.
    pub(crate) adapter: Option<String>,
    /// Whether --time ran out.
    pub(crate) ended_early: bool,
    pub(crate) families: Vec<StressFamily>,
    /// Lights left out of masks, by placement.
    pub(crate) not_drawn: Vec<StressNotDrawn>,
    pub(crate) failures: Vec<StressFailure>,
}

/// Counts of one family.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct StressFamily {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) cases: u64,
    pub(crate) rendered: u64,
    pub(crate) samples: u64,
    pub(crate) wrong: u64,
    pub(crate) ambiguous: u64,
    pub(crate) closed: bool,
    pub(crate) not_closed: u64,
}

/// A placement that masks cannot show.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct StressNotDrawn {
    pub(crate) name: &'static str,
    pub(crate) reason: &'static str,
    /// Left out of a mask.
    pub(crate) lights: u64,
}

/// A case that failed.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct StressFailure {
    /// Its name.
    pub(crate) case: String,
    pub(crate) fault: String,
    /// The command line that tries it again.
    pub(crate) again: String,
    /// Of the smaller case; null where none was written.
    pub(crate) file: Option<String>,
    /// Of the smaller case.
    pub(crate) triangles: Option<u64>,
    /// The command line that shows the failure of the file; null where its masks are right.
    pub(crate) check: Option<String>,
}

/// `gen`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct GenReport {
    pub(crate) scene: String,
    pub(crate) file: String,
    pub(crate) bytes: u64,
    pub(crate) triangles: u64,
    pub(crate) lights: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(value: &impl Serialize) -> Vec<String> {
        let value = serde_json::to_value(value).unwrap();
        value.as_object().unwrap().keys().cloned().collect()
    }

    /// Every key that DESIGN.md fixes is there, under its very name.
    #[test]
    fn fixed_keys_are_there() {
        let has = |given: Vec<String>, fixed: &str| {
            for key in fixed.split(' ') {
                assert!(given.iter().any(|k| k == key), "{key} missing in {given:?}");
            }
        };
        has(
            keys(&RenderReport::default()),
            "scene method adapter size frame_ms stages_ms totals lights",
        );
        has(
            keys(&RenderTotals::default()),
            "subset_triangles facing_triangles quads cap_triangles polygons uploaded_bytes \
             lights_rebuilt lights_cached lights_skipped lights_split",
        );
        has(
            keys(&LightReport::default()),
            "name kind range subset_triangles facing_triangles quads cap_triangles path reason \
             cached build_us gpu_us layers_bound parts",
        );
        has(
            keys(&InspectReport::default()),
            "triangles vertices welded_vertices unique_edges edges_by_triangles \
             opposite_wound_pairs degenerate_triangles duplicate_triangles bytes_per_triangle \
             memory face_pointer_bytes_per_triangle lights open_ms build_ms",
        );
        has(keys(&EdgesByTriangles::default()), "1 2 3 4+");
        has(keys(&BuildMs::default()), "load weld edges bvh order total");
        has(
            keys(&CheckReport::default()),
            "scene method adapter size pixels lights samples wrong ambiguous tolerance_px \
             tolerance_depth closed worst lights_by_path lights_split layers",
        );
        has(
            keys(&VolumesReport::default()),
            "scene lights threads subset_triangles methods",
        );
        has(
            keys(&VolumesLight::default()),
            "name kind subset_triangles facing_triangles quads build_us",
        );
        has(
            keys(&VolumesMethod::default()),
            "name ms_total ns_per_triangle quads cap_triangles polygons \
             adjacency_bytes_per_triangle",
        );
        has(keys(&LightLayers::default()), "name layers_bound parts");
        has(
            keys(&StressReport::default()),
            "cases rendered samples wrong ambiguous closed families",
        );
        has(
            keys(&StressFamily::default()),
            "name cases rendered samples wrong ambiguous closed",
        );
        has(keys(&WorstPixel::default()), "x y light");
        has(keys(&LightsByPath::default()), "zpass zfail skipped");
    }

    #[test]
    fn totals_count_each_light_once() {
        let light = |path, cached| LightReport {
            path,
            cached,
            quads: 3,
            quads_drawn: if path == PathTaken::Skipped { 0 } else { 2 },
            cap_triangles: 2,
            ..LightReport::default()
        };
        let mut uploaded = Uploaded::default();
        (uploaded.volume_bytes, uploaded.other_bytes) = (10, 30);
        let lights = [
            light(PathTaken::Zpass, true),
            light(PathTaken::Zfail, false),
            light(PathTaken::Skipped, true),
        ];
        let totals = RenderTotals::of(&lights, uploaded);
        assert_eq!(
            (
                totals.lights_rebuilt,
                totals.lights_cached,
                totals.lights_skipped
            ),
            (1, 1, 1)
        );
        assert_eq!(
            (totals.quads, totals.polygons, totals.uploaded_bytes),
            (9, 8, 40)
        );
        assert_eq!(serde_json::to_value(PathTaken::Zpass).unwrap(), "zpass");
    }
}
