//! Light to picture: exposure, tone mapping, PNG.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use glam::Vec3;
use thiserror::Error;
use umbrage_scene::write::whole;

/// A lit frame on the CPU.
#[derive(Clone, Debug)]
pub struct Lit {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear reflected light.
    pub light: Vec<Vec3>,
    /// sRGB base colour.
    pub albedo: Vec<[u8; 3]>,
    /// Distance of the surface along the viewing direction; 0 where there is none.
    pub distance: Vec<f32>,
}

/// A picture could not be written.
#[derive(Debug, Error)]
#[error("{path}: {message}; is the folder there and writable?", path = path.display())]
pub struct PictureError {
    path: PathBuf,
    message: String,
}

/// Share of the exposed base colour that is seen where no light falls.
const AMBIENT: f32 = 0.035;

impl Lit {
    /// Scale that brings the lit pixels' geometric mean luminance to a middle grey, but no more
    /// than a few of them to white. Deterministic.
    pub fn exposure(&self) -> f32 {
        let mut lit: Vec<f32> = self.light.iter().map(|&c| luminance(c)).collect();
        lit.retain(|&y| y > 1e-9);
        if lit.is_empty() {
            return 1.0;
        }
        lit.sort_by(f32::total_cmp);
        let mean_ln = lit.iter().map(|&y| f64::from(y.ln())).sum::<f64>() / lit.len() as f64;
        let bright = lit[(lit.len() - 1) * 95 / 100];
        (0.2 / mean_ln.exp() as f32).min(1.4 / bright)
    }

    /// 8-bit sRGB with the scene's own exposure.
    pub fn to_rgb8(&self) -> Vec<u8> {
        self.exposed_rgb8(self.exposure())
    }

    /// 8-bit sRGB with the exposure of another picture, to be compared with that.
    pub fn exposed_rgb8(&self, exposure: f32) -> Vec<u8> {
        self.light
            .iter()
            .zip(&self.albedo)
            .zip(&self.distance)
            .flat_map(|((light, albedo), distance)| {
                let base = Vec3::from(albedo.map(|c| (f32::from(c) / 255.0).powf(2.2)));
                let sky = Vec3::new(0.004, 0.006, 0.011);
                let color = if *distance > 0.0 {
                    *light * exposure + base * AMBIENT
                } else {
                    sky
                };
                filmic(color)
                    .to_array()
                    .map(|c| (srgb(c) * 255.0 + 0.5) as u8)
            })
            .collect()
    }
}

fn luminance(c: Vec3) -> f32 {
    c.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Narkowicz's fit of the ACES film curve (2015) on the luminance; colours brighter than the
/// screen fade towards white instead of shifting in hue.
fn filmic(color: Vec3) -> Vec3 {
    let y = luminance(color).max(1e-6);
    let x = y * 0.8;
    let mapped = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    let scaled = color * (mapped / y);
    let over = scaled.max_element() - 1.0;
    if over > 0.0 {
        let fade = over / (scaled.max_element() - mapped).max(1e-6);
        return scaled
            .lerp(Vec3::splat(mapped), fade)
            .clamp(Vec3::ZERO, Vec3::ONE);
    }
    scaled
}

fn srgb(c: f32) -> f32 {
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}

/// Writes 8-bit RGB rows as PNG, whole or not at all.
pub fn write_png(path: &Path, [width, height]: [u32; 2], rgb8: &[u8]) -> Result<(), PictureError> {
    let fail = |message: String| PictureError {
        path: path.into(),
        message,
    };
    let bytes = png_file([width, height], png::ColorType::Rgb, rgb8).map_err(fail)?;
    whole(path, |file| file.write_all(&bytes)).map_err(|e| fail(e.to_string()))
}

/// 8-bit rows of four channels, the last of them alpha, as the bytes of a PNG file.
///
/// # Errors
/// What the encoder says: of a picture without pixels, or of too few bytes.
pub fn rgba_png(size: [u32; 2], rgba8: &[u8]) -> Result<Vec<u8>, String> {
    png_file(size, png::ColorType::Rgba, rgba8)
}

/// 8-bit RGB rows as the bytes of a PNG file.
///
/// # Errors
/// As [`rgba_png`].
pub fn rgb_png(size: [u32; 2], rgb8: &[u8]) -> Result<Vec<u8>, String> {
    png_file(size, png::ColorType::Rgb, rgb8)
}

fn png_file(
    [width, height]: [u32; 2],
    color: png::ColorType,
    pixels: &[u8],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(pixels))
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}
