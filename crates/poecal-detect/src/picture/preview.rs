//! Pictures with marks at the detected corners, for inspection.

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};

use crate::detection::DetectedCorner;
use crate::error::{Error, Result};
use crate::gray::Gray;

/// Radius of the ring around a corner, pixels, and its parts.
const RADIUS_PX: f64 = 6.0;
const PARTS: usize = 48;
/// Colours of the first corner, and of the others.
const FIRST: [u8; 3] = [230, 30, 30];
const OTHER: [u8; 3] = [30, 170, 60];

/// A picture as PNG, with a ring around each corner; that of `corner0` is red, the others are green.
///
/// # Errors
/// If it cannot be encoded.
pub fn preview(gray: &Gray, corners: &[DetectedCorner]) -> Result<Vec<u8>> {
    let (width, height) = (gray.width(), gray.height());
    let mut colours: Vec<[u8; 3]> = gray.bytes().into_iter().map(|level| [level; 3]).collect();
    for corner in corners {
        let colour = if corner.id == 0 { FIRST } else { OTHER };
        for part in 0..PARTS {
            let angle = std::f64::consts::TAU * part as f64 / PARTS as f64;
            for radius in [RADIUS_PX, RADIUS_PX + 0.7] {
                let (u, v) = (corner.u_px + radius * angle.cos(), corner.v_px + radius * angle.sin());
                let (u, v) = (u.round(), v.round());
                if u >= 0.0 && v >= 0.0 && u < width as f64 && v < height as f64 {
                    colours[v as usize * width + u as usize] = colour;
                }
            }
        }
    }
    encode_png(gray, ColorType::Rgb, colours.as_flattened())
}

/// A picture as PNG, as a camera saves it: 8 bits of gray.
///
/// # Errors
/// If it cannot be encoded.
pub fn png(gray: &Gray) -> Result<Vec<u8>> {
    encode_png(gray, ColorType::Grayscale, &gray.bytes())
}

/// Samples of 8 bits of a picture of this size as PNG.
fn encode_png(gray: &Gray, colours: ColorType, samples: &[u8]) -> Result<Vec<u8>> {
    let written = || -> std::result::Result<Vec<u8>, EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, gray.width() as u32, gray.height() as u32);
        encoder.set_color(colours);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(samples)?;
        writer.finish()?;
        Ok(bytes)
    };
    written().map_err(|error| Error::new(error.to_string()))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::detection::PointKind;

    #[test]
    fn a_preview_is_a_png_of_the_size_of_the_picture_with_rings() {
        let gray = Gray::from_level(40, 30, 128.0);
        let corners = [
            DetectedCorner { id: 0, kind: PointKind::Corner, u_px: 20.0, v_px: 15.0, sigma_px: 0.1 },
            DetectedCorner { id: 1, kind: PointKind::Corner, u_px: 1.0, v_px: 1.0, sigma_px: 0.1 },
        ];
        let bytes = preview(&gray, &corners).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut colours = vec![[0; 3]; 40 * 30];
        let written = reader.next_frame(colours.as_flattened_mut()).unwrap();
        assert_eq!((written.width, written.height, written.color_type), (40, 30, ColorType::Rgb));
        assert_eq!((colours[15 * 40 + 26], colours[40 + 7]), (FIRST, OTHER));
    }
}
