//! The steps that skip work, each of which can be switched off.
//!
//! None of them changes a shadow within a light's range: each is conservative, and tested by
//! comparing masks with and without it. All but one leave masks bit-identical. Leaving out hidden
//! casters changes which sides are drawn, and with it the rasteriser's rounding at pixels that show
//! what lies behind a crack between triangles that meet without a common edge.

use std::fmt;

/// One step that skips work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Cull {
    /// Lights whose range lies outside the view are neither built nor drawn.
    View,
    /// Lights that reach no visible surface are not drawn.
    Receivers,
    /// Quads that cannot meet the hull of the eye and a light's visible receivers are not drawn.
    Quads,
    /// Casters that lie wholly in the shadow of others are left out of a light's volume.
    Hidden,
    /// Quads beyond a light's range are not drawn for an eye within it.
    Range,
    /// Volumes whose light and geometry did not change are not built again.
    Cache,
}

impl Cull {
    /// All steps, in the order in which they save work.
    pub const ALL: [Cull; 6] = [
        Cull::View,
        Cull::Receivers,
        Cull::Quads,
        Cull::Hidden,
        Cull::Range,
        Cull::Cache,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Cull::View => "view",
            Cull::Receivers => "receivers",
            Cull::Quads => "quads",
            Cull::Hidden => "hidden",
            Cull::Range => "range",
            Cull::Cache => "cache",
        }
    }
}

/// A set of steps.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Culls(u8);

impl Culls {
    /// Every step.
    pub const EVERY: Self = Self((1 << Cull::ALL.len()) - 1);
    /// No step: everything is built and drawn.
    pub const NONE: Self = Self(0);

    /// The set with `step` in it.
    #[must_use]
    pub const fn with(self, step: Cull) -> Self {
        Self(self.0 | 1 << step as u8)
    }

    /// The set without `step`.
    #[must_use]
    pub const fn without(self, step: Cull) -> Self {
        Self(self.0 & !(1 << step as u8))
    }

    /// Whether `step` is in the set.
    pub const fn has(self, step: Cull) -> bool {
        self.0 & 1 << step as u8 != 0
    }
}

impl Default for Culls {
    fn default() -> Self {
        Self::EVERY
    }
}

impl fmt::Debug for Culls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = Cull::ALL.into_iter().filter(|&step| self.has(step));
        f.debug_set().entries(steps).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in() {
        for step in Cull::ALL {
            assert!(Culls::EVERY.has(step) && !Culls::NONE.has(step));
            assert!(Culls::NONE.with(step).has(step));
            assert!(!Culls::EVERY.without(step).has(step));
            assert_eq!(Culls::EVERY.without(step).with(step), Culls::EVERY);
        }
    }
}
