//! Decoding of base colour images: PNG and JPEG to eight bits a channel.
//!
//! Takes encoded bytes; gives an [`Image`] without a name. Invariant: nothing is allocated for
//! pixels that the encoded bytes cannot hold; no image has more than [`MAX_PIXELS_OF_ONE`], and all
//! of one scene together have no more than that unless they have the bytes for it, and never more
//! than [`MAX_PIXELS`].

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::{Image, Scene};

/// Most pixels that the images of one scene may have together: 1 GiB.
const MAX_PIXELS: u64 = 1 << 28;

/// Most pixels of one image: 8192 by 8192, 256 MiB, which any GPU takes as a texture.
const MAX_PIXELS_OF_ONE: u64 = 1 << 26;

/// Beyond it, most pixels of a scene for each byte of its images: photographs have about ten.
const PIXELS_FOR_A_BYTE: u64 = 64;

/// Most pixels that a byte of an encoded image can stand for. Deflate repeats at most 258 bytes in
/// two bits, 1032 to one, and a row may have eight pixels a byte; a JPEG block of 64 pixels takes
/// at least a bit of its first scan.
const MAX_PIXELS_PER_BYTE: u64 = 1032 * 8;

/// Why an image is left out.
pub(crate) enum ImageError {
    /// Its bytes are not there.
    Missing(String),
    /// They are there, but are no PNG or JPEG that can be decoded.
    Unreadable(String),
}

/// Decodes the images of one scene and counts their pixels.
#[derive(Default)]
pub(crate) struct Decoder {
    pixels: u64,
    bytes: u64,
}

impl Decoder {
    /// Decodes one image, told apart by its first bytes.
    pub(crate) fn decode(&mut self, bytes: &[u8]) -> Result<Image, ImageError> {
        self.bytes += bytes.len() as u64;
        let result = match bytes {
            [0x89, b'P', b'N', b'G', ..] => self.png(bytes),
            [0xFF, 0xD8, ..] => self.jpeg(bytes),
            _ => Err("neither PNG nor JPEG".to_owned()),
        };
        result.map_err(ImageError::Unreadable)
    }

    /// Grants an image of this size, or refuses.
    fn grant(&mut self, size: [u32; 2], bytes: usize) -> Result<(), String> {
        let [width, height] = size;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > bytes as u64 * MAX_PIXELS_PER_BYTE {
            return Err(format!(
                "{width} x {height} pixels cannot be in {bytes} bytes"
            ));
        }
        if pixels > MAX_PIXELS_OF_ONE {
            return Err(format!(
                "{width} x {height} pixels are more than the {MAX_PIXELS_OF_ONE} of an image"
            ));
        }
        let earned = self.bytes.saturating_mul(PIXELS_FOR_A_BYTE);
        let most = earned.clamp(MAX_PIXELS_OF_ONE, MAX_PIXELS);
        if self.pixels + pixels > most {
            return Err(format!(
                "with {width} x {height} pixels more the images of the scene exceed {most}"
            ));
        }
        self.pixels += pixels;
        Ok(())
    }

    fn png(&mut self, bytes: &[u8]) -> Result<Image, String> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
        let size = [reader.info().width, reader.info().height];
        self.grant(size, bytes.len())?;
        let length = reader.output_buffer_size().ok_or("too large")?;
        let mut pixels = vec![0; length];
        let frame = reader.next_frame(&mut pixels).map_err(|e| e.to_string())?;
        pixels.truncate(frame.buffer_size());
        let channels = match frame.color_type {
            png::ColorType::Grayscale => 1,
            png::ColorType::GrayscaleAlpha => 2,
            png::ColorType::Rgb | png::ColorType::Indexed => 3,
            png::ColorType::Rgba => 4,
        };
        Ok(Image {
            name: String::new(),
            size,
            rgba8: expand(pixels, channels),
        })
    }

    fn jpeg(&mut self, bytes: &[u8]) -> Result<Image, String> {
        let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGBA);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
        decoder.decode_headers().map_err(|e| e.to_string())?;
        let (width, height) = decoder.dimensions().ok_or("no dimensions")?;
        let size = [width as u32, height as u32];
        self.grant(size, bytes.len())?;
        let rgba8 = decoder.decode().map_err(|e| e.to_string())?;
        if rgba8.len() != width * height * 4 {
            return Err("not eight bits in four channels once decoded".to_owned());
        }
        Ok(Image {
            name: String::new(),
            size,
            rgba8,
        })
    }
}

/// Pixels of one to four channels as red, green, blue, alpha.
fn expand(pixels: Vec<u8>, channels: usize) -> Vec<u8> {
    if channels == 4 {
        return pixels;
    }
    let rgba = |p: &[u8]| match *p {
        [l] => [l, l, l, 255],
        [l, a] => [l, l, l, a],
        [r, g, b] => [r, g, b, 255],
        _ => [0; 4],
    };
    pixels.chunks_exact(channels).flat_map(rgba).collect()
}

/// Appends a decoded image, or counts why there is none.
pub(crate) fn keep(
    scene: &mut Scene,
    name: String,
    result: Result<Image, ImageError>,
) -> Option<u32> {
    let what = match result {
        Ok(image) => {
            scene.images.push(Image { name, ..image });
            return Some(scene.images.len() as u32 - 1);
        }
        Err(ImageError::Missing(what)) => {
            scene.report.missing_images += 1;
            what
        }
        Err(ImageError::Unreadable(what)) => {
            scene.report.unreadable_images += 1;
            what
        }
    };
    scene
        .report
        .note(|| format!("image {name} left out: {what}"));
    None
}
