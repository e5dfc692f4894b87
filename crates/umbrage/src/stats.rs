//! What a frame cost.

use umbrage_core::frame::{FramePlan, LightPath};

/// What one [`Shadows::prepare`](crate::Shadows::prepare) did. Counts over views are sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FrameStats {
    /// Lights in the set.
    pub lights: u32,
    /// Lights whose volumes were built in this frame, because they changed or something near them
    /// did.
    pub rebuilt: u32,
    /// Drawn without caps, over all views: the fast path.
    pub zpass: u32,
    /// Drawn with caps: where the eye is on a side of the volume, and without depth clamping.
    pub zfail: u32,
    /// Not drawn: out of view, or with nothing in range.
    pub skipped: u32,
    /// Silhouette quads of the lights that are drawn, before the GPU culls some.
    pub quads: u64,
    /// Cap triangles of the lights that are drawn.
    pub cap_triangles: u64,
    /// Bytes handed to the queue, world apart.
    pub uploaded_bytes: u64,
    /// Building volumes, in milliseconds.
    pub build_ms: f64,
    /// Planning views, in milliseconds.
    pub plan_ms: f64,
    /// Handing over, in milliseconds.
    pub upload_ms: f64,
}

impl FrameStats {
    /// Counts one view's lights; free slots are none.
    pub(crate) fn count(&mut self, plan: &FramePlan) {
        use umbrage_core::frame::SkipReason::Unusable;
        for light in &plan.lights {
            match light.path {
                LightPath::ZPass { .. } => self.zpass += 1,
                LightPath::ZFail(_) => self.zfail += 1,
                LightPath::Skipped(Unusable) => {}
                LightPath::Skipped(_) => self.skipped += 1,
            }
            if !light.is_skipped() {
                self.quads += light.quads.len() as u64;
                self.cap_triangles += 2 * (light.caps.len() + light.reversed_caps.len()) as u64;
            }
        }
    }
}
