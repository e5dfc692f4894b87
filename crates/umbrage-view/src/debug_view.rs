//! The debug views: what each shows, and its key.

use std::str::FromStr;

use thiserror::Error;

/// What the window shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DebugView {
    /// The picture.
    #[default]
    Lit,
    /// Edges of shadow volumes.
    Volumes,
    /// The edges whose counter is not zero.
    Silhouettes,
    /// Volumes that enclose the surface, counted.
    Layers,
    /// Lights that reach the surface, counted.
    Lights,
    /// Rectangles that lights are drawn in.
    Scissors,
    /// Boxes of the BVH in the chosen light's reach.
    Boxes,
    /// The chosen light's subset.
    Subset,
    /// Where the shadows are not those of the oracle.
    Wrong,
}

/// A name that no debug view has.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "no debug view is called {0:?}: there are lit, volumes, silhouettes, layers, lights, scissors, boxes, subset and wrong"
)]
pub struct NoSuchView(String);

impl DebugView {
    /// In the order of their keys, 1 to 9.
    pub const ALL: [DebugView; 9] = [
        DebugView::Lit,
        DebugView::Volumes,
        DebugView::Silhouettes,
        DebugView::Layers,
        DebugView::Lights,
        DebugView::Scissors,
        DebugView::Boxes,
        DebugView::Subset,
        DebugView::Wrong,
    ];

    /// One word, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            DebugView::Lit => "lit",
            DebugView::Volumes => "volumes",
            DebugView::Silhouettes => "silhouettes",
            DebugView::Layers => "layers",
            DebugView::Lights => "lights",
            DebugView::Scissors => "scissors",
            DebugView::Boxes => "boxes",
            DebugView::Subset => "subset",
            DebugView::Wrong => "wrong",
        }
    }

    /// What it shows, in a line.
    pub fn meaning(self) -> &'static str {
        match self {
            DebugView::Lit => "the lit picture",
            DebugView::Volumes => "shadow volumes, to the light's range: z-pass green, z-fail red",
            DebugView::Silhouettes => {
                "silhouette edges: counter 1 white, 2 yellow, 3 orange, more red"
            }
            DebugView::Layers => "layers of volumes at each pixel",
            DebugView::Lights => "lights that reach each pixel",
            DebugView::Scissors => "scissors of the lights",
            DebugView::Boxes => "BVH nodes of up to 64 triangles in reach of the chosen light",
            DebugView::Subset => "subset of the chosen light: casters orange, others blue",
            DebugView::Wrong => "pixels against the oracle: wrong red, ambiguous yellow",
        }
    }

    /// Whether it is about one light, and shows nothing before one is chosen.
    pub fn needs_light(self) -> bool {
        matches!(self, DebugView::Boxes | DebugView::Subset)
    }
}

impl FromStr for DebugView {
    type Err = NoSuchView;

    fn from_str(name: &str) -> Result<Self, NoSuchView> {
        let found = Self::ALL.into_iter().find(|view| view.name() == name);
        found.ok_or_else(|| NoSuchView(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_and_others_are_refused_with_the_list() {
        for view in DebugView::ALL {
            assert_eq!(view.name().parse(), Ok(view));
        }
        let error = "shadows".parse::<DebugView>().unwrap_err().to_string();
        assert!(
            DebugView::ALL
                .iter()
                .all(|view| error.contains(view.name())),
            "{error}"
        );
    }
}
