//! Pixels of PNG and JPEG files.

use std::fmt::Display;
use std::io::Cursor;

use png::{BitDepth, DecodingError, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::error::Result;
use crate::exif;
use crate::gray::Gray;

/// Most bytes that the PNG reader uses beside the picture: its rows, and texts and profiles in the file.
const BESIDE: usize = 64 << 20;
/// Most pixels for each byte of a file. Deflate expands one byte to at most 1032, of 8 pixels each. JPEG needs a bit for a block of 8 × 8 pixels, or
/// of 32 × 32 if its components have other sizes. A header that states more is wrong, and is refused.
const PIXELS_PER_BYTE: usize = 8 * 1032;

/// Message about a picture that does not fit.
const TOO_LARGE: &str = "Memory limit exceeded";

/// Unsupported formats, by their bytes at an offset.
const OTHERS: [(usize, &[u8], &str); 20] = [
    (0, b"GIF89a", "Gif"),
    (0, b"GIF87a", "Gif"),
    (8, b"WEBP", "WebP"),
    (0, b"MM\0*", "Tiff"),
    (0, b"II*\0", "Tiff"),
    (0, b"DDS ", "Dds"),
    (0, b"BM", "Bmp"),
    (0, &[0, 0, 1, 0], "Ico"),
    (0, b"#?RADIANCE", "Hdr"),
    (4, b"ftypavif", "Avif"),
    (0, &[0x76, 0x2f, 0x31, 0x01], "OpenExr"),
    (0, b"qoif", "Qoi"),
    (0, b"P1", "Pnm"),
    (0, b"P2", "Pnm"),
    (0, b"P3", "Pnm"),
    (0, b"P4", "Pnm"),
    (0, b"P5", "Pnm"),
    (0, b"P6", "Pnm"),
    (0, b"P7", "Pnm"),
    (0, b"farbfeld", "Farbfeld"),
];

/// The pixels of a file, row by row.
pub(crate) struct DecodedPicture {
    width: usize,
    height: usize,
    /// Samples of a pixel: gray, or red, green and blue, and opacity.
    channels: usize,
    /// True if a sample is two bytes, the high one first.
    is_deep: bool,
    samples: Vec<u8>,
    /// The orientation of EXIF, 1 to 8.
    pub(crate) orientation: u8,
}

impl DecodedPicture {
    /// Decodes a file of at most `most` pixels; the error describes its fault.
    pub(crate) fn from_bytes(bytes: &[u8], most: u64) -> std::result::Result<Self, DecodeFailure> {
        if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
            return of_png(bytes, most);
        }
        if bytes.starts_with(&[0xff, 0xd8, 0xff]) {
            return of_jpeg(bytes, most);
        }
        let is_it = |(at, magic, _): &&(usize, &[u8], &str)| {
            bytes.get(*at..).is_some_and(|rest| rest.starts_with(magic)) && (*at != 8 || bytes.starts_with(b"RIFF"))
        };
        Err(DecodeFailure::Broken(OTHERS.iter().find(is_it).map_or_else(
            || "The image format could not be determined".to_owned(),
            |(_, _, name)| format!("The image format {name} is not supported"),
        )))
    }

    /// Levels from 0 to 255, colours by the weights of OpenCV (ITU-R BT.601).
    pub(crate) fn gray(&self) -> Result<Gray> {
        let (width, height, channels) = (self.width, self.height, self.channels);
        if channels == 1 && !self.is_deep {
            return Gray::from_bytes(width, height, &self.samples);
        }
        let weigh = |[red, green, blue]: [f32; 3]| 0.299 * red + 0.587 * green + 0.114 * blue;
        // Offsets of the samples in a pixel: gray serves as all three colours.
        let places = if channels < 3 { [0, 0, 0] } else { [0, 1, 2] };
        let levels = if self.is_deep {
            let sample = |pixel: &[u8], at: usize| f32::from(u16::from_be_bytes([pixel[2 * at], pixel[2 * at + 1]]));
            let pixels = self.samples.chunks_exact(2 * channels);
            pixels.map(|pixel| weigh(places.map(|at| sample(pixel, at))) * (255.0 / 65535.0)).collect()
        } else {
            // A pixel of OpenCV is an integer.
            let pixels = self.samples.chunks_exact(channels);
            pixels.map(|pixel| weigh(places.map(|at| f32::from(pixel[at]))).round()).collect()
        };
        Gray::new(width, height, levels)
    }
}

/// Reason why a file is not decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum DecodeFailure {
    /// Fault of the file.
    Broken(String),
    /// The picture has this width and height, which are too many pixels.
    Large([usize; 2]),
}

impl From<String> for DecodeFailure {
    fn from(found: String) -> Self {
        DecodeFailure::Broken(found)
    }
}

/// Capacity for the samples of a picture, if a file of this many bytes can contain it.
fn room(
    size: [usize; 2],
    most: u64,
    bytes_per_pixel: usize,
    file: usize,
) -> std::result::Result<Vec<u8>, DecodeFailure> {
    let too_large = || DecodeFailure::Broken(TOO_LARGE.to_owned());
    let pixels = size[0].checked_mul(size[1]).ok_or_else(too_large)?;
    if pixels as u64 > most {
        return Err(DecodeFailure::Large(size));
    }
    if pixels > file.saturating_mul(PIXELS_PER_BYTE) {
        return Err(too_large());
    }
    let count = pixels.checked_mul(bytes_per_pixel).ok_or_else(too_large)?;
    let mut samples = Vec::new();
    samples.try_reserve_exact(count).map_err(|_| too_large())?;
    samples.resize(count, 0);
    Ok(samples)
}

fn of_png(bytes: &[u8], most: u64) -> std::result::Result<DecodedPicture, DecodeFailure> {
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: BESIDE });
    // Palettes become colours, and samples of fewer bits those of 8; 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(no_png)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    // Data behind the pixels are ignored.
    let orientation = reader.info().exif_metadata.as_deref().and_then(exif::orientation);
    let (colours, depth) = reader.output_color_type();
    let (channels, is_deep) = (colours.samples(), depth == BitDepth::Sixteen);
    let mut samples = room([width, height], most, channels << usize::from(is_deep), bytes.len())?;
    reader.next_frame(&mut samples).map_err(no_png)?;
    Ok(DecodedPicture { width, height, channels, is_deep, samples, orientation: orientation.unwrap_or(1) })
}

/// Fault of a PNG file.
fn no_png(error: DecodingError) -> String {
    match error {
        DecodingError::IoError(error) => error.to_string(),
        DecodingError::Format(error) => decode_message("Png", &error),
        DecodingError::Parameter(error) => format!("The parameter is malformed: {error}"),
        DecodingError::LimitsExceeded => TOO_LARGE.to_owned(),
    }
}

fn of_jpeg(bytes: &[u8], most: u64) -> std::result::Result<DecodedPicture, DecodeFailure> {
    let options = DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut head = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    head.decode_headers().map_err(no_jpeg)?;
    let orientation = head.exif().and_then(|exif| exif::orientation(exif));
    let (width, height) = head.dimensions().unwrap_or_default();
    let is_gray = head.input_colorspace() == Some(ColorSpace::Luma);
    let (space, channels) = if is_gray { (ColorSpace::Luma, 1) } else { (ColorSpace::RGB, 3) };
    let mut samples = room([width, height], most, channels, bytes.len())?;
    let options = options.jpeg_set_out_colorspace(space);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_into(&mut samples).map_err(no_jpeg)?;
    let orientation = orientation.unwrap_or(1);
    Ok(DecodedPicture { width, height, channels, is_deep: false, samples, orientation })
}

/// Fault of a JPEG file.
fn no_jpeg(error: DecodeErrors) -> String {
    if let DecodeErrors::Unsupported(scheme) = &error {
        return format!("The decoder for Jpeg does not support the format features {scheme:?}");
    }
    decode_message("Jpeg", &error)
}

fn decode_message(format: &str, error: &dyn Display) -> String {
    format!("Format error decoding {format}: {error}")
}
