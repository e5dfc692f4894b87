//! Pictures that are made once the camera rests: counts in false colours, and marks on wrong pixels.

use egui::{ColorImage, TextureHandle, TextureOptions};
use umbrage_lab::gpu::GpuError;
use umbrage_lab::heat::{Heat, false_colours};
use umbrage_lab::lab::{Lab, Method};
use umbrage_lab::stage::{Stage, StageLight};

use crate::check::{Checked, marks};
use crate::debug_view::DebugView;
use crate::moment::Moment;

/// What a picture was made of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Of {
    pub(crate) shown: DebugView,
    pub(crate) moment: Moment,
}

/// A picture over the whole window.
pub(crate) struct Overlay {
    of: Of,
    pub(crate) texture: TextureHandle,
    /// A sentence about it.
    pub(crate) note: String,
}

/// Which heat map a debug view is.
pub(crate) fn heat(shown: DebugView) -> Option<Heat> {
    match shown {
        DebugView::Layers => Some(Heat::Layers),
        DebugView::Lights => Some(Heat::Lights),
        _ => None,
    }
}

impl Overlay {
    /// Whether it shows this.
    pub(crate) fn is_of(&self, of: &Of) -> bool {
        self.of == *of
    }

    /// Counts at each pixel, drawn and read back.
    pub(crate) fn counted(
        ctx: &egui::Context,
        of: Of,
        heat: Heat,
        lab: &mut Lab,
        stage: &Stage,
        lights: &[StageLight],
        method: Method,
    ) -> Result<Self, GpuError> {
        let counts = lab.heat(stage, lights, &of.moment.view, method, heat)?;
        let size = of.moment.view.size.map(|side| side as usize);
        let image = ColorImage::from_rgb(size, &false_colours(&counts));
        Ok(Self {
            texture: ctx.load_texture("heat map", image, TextureOptions::NEAREST),
            note: summary(&counts, of.shown.name()),
            of,
        })
    }

    /// Marks where a check found errors.
    pub(crate) fn marked(ctx: &egui::Context, of: Of, found: &Checked) -> Self {
        let size = found.map.size.map(|side| side as usize);
        let image = ColorImage::from_rgba_unmultiplied(size, &marks(&found.map));
        let Checked {
            samples,
            wrong,
            ambiguous,
            ..
        } = found;
        Self {
            texture: ctx.load_texture("wrong pixels", image, TextureOptions::NEAREST),
            note: format!("{wrong} wrong, {ambiguous} ambiguous of {samples} pixel-lights"),
            of,
        }
    }
}

/// Mean and most of counts.
fn summary(counts: &[f32], what: &str) -> String {
    let sum = counts
        .iter()
        .fold(0.0, |sum, &count| sum + f64::from(count));
    let most = counts.iter().copied().fold(0.0, f32::max);
    let mean = sum / counts.len().max(1) as f64;
    format!("{what} a pixel: mean {mean:.2}, most {most:.0}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_all_pixels() {
        let note = summary(&[0.0, 1.0, 2.0, 7.0], "layers");
        assert_eq!(note, "layers a pixel: mean 2.50, most 7");
        assert_eq!(summary(&[], "lights"), "lights a pixel: mean 0.00, most 0");
    }
}
