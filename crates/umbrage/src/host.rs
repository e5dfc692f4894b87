//! What the host's frame looks like.

use umbrage_wgpu::DepthRange;
use wgpu::{Device, TextureFormat, TextureFormatFeatureFlags, TextureUsages};

use crate::Error;

/// The formats of the host's passes.
///
/// ```
/// use umbrage::Host;
/// use umbrage::wgpu::TextureFormat::{Depth24PlusStencil8, Depth32FloatStencil8, Rgba16Float};
///
/// // Light adds up in an HDR target; depth is reversed, which is best in floats.
/// let deferred = Host::new(Depth32FloatStencil8, &[Some(Rgba16Float)]);
/// // Shadows are read from a mask; near depth is 0.
/// let forward_plus = Host::new(Depth24PlusStencil8, &[]).with_mask().with_ordinary_depth();
/// let smooth = Host::new(Depth32FloatStencil8, &[Some(Rgba16Float)]).with_samples(4);
/// ```
#[derive(Clone, Debug)]
pub struct Host {
    pub(crate) depth_stencil: TextureFormat,
    pub(crate) colors: Vec<Option<TextureFormat>>,
    pub(crate) samples: u32,
    pub(crate) depth: DepthRange,
    pub(crate) mask: bool,
}

impl Host {
    /// Depth of this format, with a stencil; light is drawn into targets of these formats, or only
    /// into masks if there are none. One sample a pixel, reversed depth (1 near, 0 at infinity).
    pub fn new(depth_stencil: TextureFormat, colors: &[Option<TextureFormat>]) -> Self {
        Self {
            depth_stencil,
            colors: colors.to_vec(),
            samples: 1,
            depth: DepthRange::Reversed,
            mask: false,
        }
    }

    /// With so many samples a pixel.
    #[must_use]
    pub fn with_samples(mut self, samples: u32) -> Self {
        self.samples = samples;
        self
    }

    /// With depth 0 at the near plane and 1 at infinity. It resolves `distance^2 / near * 2^-24`, in
    /// any format, and shadows are as exact as that: keep the near plane far away.
    #[must_use]
    pub fn with_ordinary_depth(mut self) -> Self {
        self.depth = DepthRange::Ordinary;
        self
    }

    /// With masks: [`Shadows::record_mask`](crate::Shadows::record_mask).
    #[must_use]
    pub fn with_mask(mut self) -> Self {
        self.mask = true;
        self
    }

    /// Whether this device can do it.
    pub(crate) fn check(&self, device: &Device) -> Result<(), Error> {
        let samples = self.samples;
        if self.mask && samples != 1 {
            return Err(Error::MaskSamples { samples });
        }
        let wrong = |format, what| Err(Error::Format { format, what });
        let format = self.depth_stencil;
        if !(format.has_depth_aspect() && format.has_stencil_aspect()) {
            return wrong(
                format,
                "has not both depth and stencil: use Depth32FloatStencil8 or Depth24PlusStencil8",
            );
        }
        let most = device.limits().max_color_attachments as usize;
        if self.colors.len() > most {
            return Err(Error::Device(format!(
                "{} colour targets are more than max_color_attachments of {most}",
                self.colors.len()
            )));
        }
        for format in self.colors.iter().flatten().copied().chain([format]) {
            if !device.features().contains(format.required_features()) {
                return wrong(
                    format,
                    "needs a feature that the device was not opened with: request \
                     Shadows::features() where the adapter has them, or choose another format",
                );
            }
            let can = format.guaranteed_format_features(device.features());
            if !can
                .allowed_usages
                .contains(TextureUsages::RENDER_ATTACHMENT)
            {
                return wrong(format, "cannot be drawn into: choose another format");
            }
            let flags: TextureFormatFeatureFlags = can.flags;
            if samples == 0 || !flags.sample_count_supported(samples) {
                return wrong(
                    format,
                    "has not that many samples a pixel: 1 and, for most formats, 4 are possible",
                );
            }
        }
        Ok(())
    }
}
