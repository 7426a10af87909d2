//! Pictures with the corners that were found in them, to look at.

use std::io::Cursor;

use image::{GrayImage, ImageFormat, Rgb, RgbImage};

use crate::error::{Error, Result};
use crate::found::Corner;
use crate::gray::Gray;

/// Radius of the ring around a corner, pixels, and its parts.
const RADIUS_PX: f64 = 6.0;
const PARTS: usize = 48;
/// Colours of the first corner, and of the others.
const FIRST: Rgb<u8> = Rgb([230, 30, 30]);
const OTHER: Rgb<u8> = Rgb([30, 170, 60]);

/// A picture as PNG, with a ring around each corner; that of `corner0` is red, the others are green.
///
/// # Errors
/// If it cannot be encoded.
pub fn preview(gray: &Gray, corners: &[Corner]) -> Result<Vec<u8>> {
    let (width, height) = (gray.width() as u32, gray.height() as u32);
    let colours = gray.bytes().into_iter().flat_map(|level| [level; 3]).collect();
    let mut image = RgbImage::from_raw(width, height, colours)
        .ok_or_else(|| Error::new("found a picture of another size than its levels"))?;
    for corner in corners {
        let colour = if corner.id == 0 { FIRST } else { OTHER };
        for part in 0..PARTS {
            let angle = std::f64::consts::TAU * part as f64 / PARTS as f64;
            for radius in [RADIUS_PX, RADIUS_PX + 0.7] {
                let (u, v) = (corner.u_px + radius * angle.cos(), corner.v_px + radius * angle.sin());
                let (u, v) = (u.round(), v.round());
                if u >= 0.0 && v >= 0.0 && u < f64::from(width) && v < f64::from(height) {
                    image.put_pixel(u as u32, v as u32, colour);
                }
            }
        }
    }
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| Error::new(error.to_string()))?;
    Ok(bytes.into_inner())
}

/// A picture as PNG, as a camera saves it: 8 bits of gray.
///
/// # Errors
/// If it cannot be encoded.
pub fn png(gray: &Gray) -> Result<Vec<u8>> {
    let (width, height) = (gray.width() as u32, gray.height() as u32);
    let image = GrayImage::from_raw(width, height, gray.bytes())
        .ok_or_else(|| Error::new("found a picture of another size than its levels"))?;
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| Error::new(error.to_string()))?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::found::Kind;

    #[test]
    fn a_preview_is_a_png_of_the_size_of_the_picture_with_rings() {
        let gray = Gray::filled(40, 30, 128.0);
        let corners = [
            Corner { id: 0, kind: Kind::Corner, u_px: 20.0, v_px: 15.0, sigma_px: 0.1 },
            Corner { id: 1, kind: Kind::Corner, u_px: 1.0, v_px: 1.0, sigma_px: 0.1 },
        ];
        let bytes = preview(&gray, &corners).unwrap();
        let image = image::load_from_memory(&bytes).unwrap().to_rgb8();
        assert_eq!(image.dimensions(), (40, 30));
        assert_eq!((image.get_pixel(26, 15), image.get_pixel(7, 1)), (&FIRST, &OTHER));
    }
}
