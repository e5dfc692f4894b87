//! How the host's depth buffer counts.

use wgpu::CompareFunction;

/// Which way depth runs. Both have an infinite far plane; wherever they clip or clamp, it is at the
/// near plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DepthRange {
    /// 1 at the near plane, 0 at infinity: `near / distance`. In floats, depth is as fine far away
    /// as it is near the eye.
    #[default]
    Reversed,
    /// 0 at the near plane, 1 at infinity: `1 - near / distance`, whatever the format in steps of
    /// 2^-24. A surface is known to `distance * distance / near * 2^-24`, so the near plane decides
    /// how exact shadows are; what is farther than 2^24 near planes is background.
    Ordinary,
}

impl DepthRange {
    /// What a nearer surface is to the one that is there: the compare function of depth passes.
    pub fn nearer(self) -> CompareFunction {
        match self {
            DepthRange::Reversed => CompareFunction::Greater,
            DepthRange::Ordinary => CompareFunction::Less,
        }
    }

    /// The opposite: at the same depth, or farther.
    pub(crate) fn not_nearer(self) -> CompareFunction {
        match self {
            DepthRange::Reversed => CompareFunction::LessEqual,
            DepthRange::Ordinary => CompareFunction::GreaterEqual,
        }
    }

    /// The depth of nothing, to clear with.
    pub fn background(self) -> f32 {
        match self {
            DepthRange::Reversed => 0.0,
            DepthRange::Ordinary => 1.0,
        }
    }
}
