//! Where a method differs from the oracle, as a picture.
//!
//! Takes, for each pixel, the brightness of the lit picture and how many lights are wrong and
//! ambiguous there; gives palette indices in order of severity: dimmed grey, then yellow
//! (ambiguous), then reds, brighter with every doubling of wrong lights. Invariant: when the
//! picture is made smaller, the worst pixel of a block stays, so no error is averaged away.

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};
use thiserror::Error;

/// Shades of the dimmed picture.
const GREYS: u8 = 24;
const AMBIGUOUS: u8 = GREYS;
/// Reds: 1, 2 to 3, 4 to 7, 8 to 15, 16 and more wrong lights.
const REDS: u8 = 5;
/// Of the brightest shade; what is wrong must outshine what is lit.
const BRIGHTEST_GREY: u32 = 120;

/// A difference picture: method against oracle.
#[derive(Clone, PartialEq, Eq)]
pub struct Difference {
    size: [u32; 2],
    pixels: Vec<u8>,
}

impl std::fmt::Debug for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [width, height] = self.size;
        write!(f, "Difference({width}x{height})")
    }
}

/// A picture as a page has it: a PNG file, small enough to lie in it.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width and height.
    pub size: [u32; 2],
    /// The file.
    pub png: Vec<u8>,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [width, height] = self.size;
        write!(f, "Picture({width}x{height})")
    }
}

/// Wider pictures are made smaller.
const WIDEST: u32 = 480;

/// Why there is no picture.
#[derive(Debug, Error)]
pub enum DifferenceError {
    /// One of the slices has another length than the picture has pixels.
    #[error("{what}: {given} values for {wanted} pixels; give one a pixel, row by row")]
    Length {
        /// Which slice.
        what: &'static str,
        /// Its length.
        given: usize,
        /// Pixels of the picture.
        wanted: usize,
    },
    /// The encoder refused, as it does for a picture without pixels.
    #[error("difference picture: {0}")]
    Encoding(#[from] EncodingError),
}

impl Difference {
    /// `grey` is the brightness of the lit picture, 0 to 1 (what is outside, or not a number, is
    /// clamped); `wrong` and `ambiguous` count lights. All row by row from the top.
    ///
    /// # Errors
    /// A slice of another length than `size` asks for.
    pub fn new(
        size: [u32; 2],
        grey: &[f32],
        wrong: &[u32],
        ambiguous: &[u32],
    ) -> Result<Self, DifferenceError> {
        let wanted = size[0] as usize * size[1] as usize;
        for (what, given) in [
            ("grey", grey.len()),
            ("wrong", wrong.len()),
            ("ambiguous", ambiguous.len()),
        ] {
            if given != wanted {
                return Err(DifferenceError::Length {
                    what,
                    given,
                    wanted,
                });
            }
        }
        let pixels = grey
            .iter()
            .zip(wrong.iter().zip(ambiguous))
            .map(|(&grey, (&wrong, &ambiguous))| match (wrong, ambiguous) {
                (1.., _) => AMBIGUOUS + 1 + (wrong.ilog2() as u8).min(REDS - 1),
                (0, 1..) => AMBIGUOUS,
                // A cast from f32 saturates, and NaN becomes 0.
                (0, 0) => ((grey * f32::from(GREYS)) as u8).min(GREYS - 1),
            })
            .collect();
        Ok(Self { size, pixels })
    }

    /// Made smaller where it is too wide for the page, and encoded.
    ///
    /// # Errors
    /// A picture without pixels.
    pub fn picture(&self) -> Result<Picture, DifferenceError> {
        let small = self.at_most(WIDEST);
        let png = small.png()?;
        Ok(Picture {
            size: small.size,
            png,
        })
    }

    /// As it is, or smaller by the whole factor that brings it to `max_width` or below.
    fn at_most(&self, max_width: u32) -> Self {
        let factor = self.size[0].div_ceil(max_width.max(1)).max(1);
        let size = self.size.map(|side| side.div_ceil(factor));
        let mut pixels = vec![0; size[0] as usize * size[1] as usize];
        for (place, &pixel) in self.pixels.iter().enumerate() {
            let [x, y] = [place as u32 % self.size[0], place as u32 / self.size[0]];
            let block = &mut pixels[(y / factor * size[0] + x / factor) as usize];
            *block = pixel.max(*block);
        }
        Self { size, pixels }
    }

    /// As an indexed PNG file.
    fn png(&self) -> Result<Vec<u8>, DifferenceError> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_palette(palette());
        encoder.set_compression(Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(file)
    }
}

fn palette() -> Vec<u8> {
    let greys = (0..GREYS).flat_map(|shade| {
        let grey = (u32::from(shade) * BRIGHTEST_GREY / u32::from(GREYS - 1)) as u8;
        [grey; 3]
    });
    let marks: [[u8; 3]; 1 + REDS as usize] = [
        [240, 210, 60],
        [190, 20, 30],
        [225, 30, 35],
        [255, 60, 50],
        [255, 110, 95],
        [255, 170, 155],
    ];
    greys.chain(marks.into_iter().flatten()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(file: &[u8]) -> (png::OutputInfo, Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        (info, pixels)
    }

    #[test]
    fn wrong_is_red_ambiguous_yellow_and_the_rest_grey() {
        let grey = [0.0, 1.0, f32::NAN, 0.5];
        let picture = Difference::new([2, 2], &grey, &[0, 0, 3, 0], &[0, 0, 9, 1]).unwrap();
        let (info, pixels) = decoded(&picture.png().unwrap());
        assert_eq!([info.width, info.height], [2, 2]);
        let rgb: Vec<[u8; 3]> = pixels.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(rgb[0], [0; 3]);
        assert_eq!(rgb[1], [BRIGHTEST_GREY as u8; 3]);
        assert!(rgb[2][0] > 200 && rgb[2][1] < 60, "red: {:?}", rgb[2]);
        assert!(rgb[3][0] > 200 && rgb[3][1] > 180 && rgb[3][2] < 90);
    }

    #[test]
    fn a_single_wrong_pixel_survives_any_reduction() {
        let mut wrong = vec![0; 100 * 60];
        wrong[37 * 100 + 81] = 1;
        let picture = Difference::new([100, 60], &[1.0; 6000], &wrong, &[1; 6000]).unwrap();
        for width in [100, 50, 33, 7, 1, 0] {
            let small = picture.at_most(width);
            assert!(small.size[0] <= width.max(1));
            let reds = small.pixels.iter().filter(|&&p| p > AMBIGUOUS).count();
            assert_eq!(reds, 1, "at width {width}");
        }
    }

    #[test]
    fn a_picture_is_narrow_enough_for_the_page() {
        let picture = Difference::new([1000, 2], &[1.0; 2000], &[0; 2000], &[0; 2000])
            .and_then(|difference| difference.picture())
            .unwrap();
        assert_eq!(picture.size, [334, 1]);
        assert_eq!(decoded(&picture.png).0.width, 334);
    }

    #[test]
    fn a_slice_of_another_length_is_named() {
        let error = Difference::new([2, 1], &[0.0; 2], &[0; 3], &[0; 2]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "wrong: 3 values for 2 pixels; give one a pixel, row by row"
        );
        assert!(
            Difference::new([0, 0], &[], &[], &[])
                .unwrap()
                .picture()
                .is_err()
        );
    }
}
