//! Pictures in files.

use std::fmt;
use std::io::Cursor;
use std::path::Path;

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageReader};

use crate::error::{Error, Result};
use crate::gray::Gray;

/// A picture of a file, in gray, upright as its EXIF data say.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Its levels.
    pub gray: Gray,
    /// How it was turned after reading: its camera has other axes than the picture then.
    pub turned: Turned,
}

/// How a picture was turned to stand upright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turned {
    /// Degrees clockwise: 0, 90, 180 or 270.
    pub degrees: u16,
    /// Whether left and right were exchanged, before turning.
    pub mirrored: bool,
}

impl Turned {
    /// Whether anything was done.
    #[must_use]
    pub fn is_turned(&self) -> bool {
        *self != Turned::default()
    }

    fn of(orientation: Orientation) -> Self {
        let (degrees, mirrored) = match orientation {
            Orientation::NoTransforms => (0, false),
            Orientation::Rotate90 => (90, false),
            Orientation::Rotate180 => (180, false),
            Orientation::Rotate270 => (270, false),
            Orientation::FlipHorizontal => (0, true),
            Orientation::FlipVertical => (180, true),
            Orientation::Rotate90FlipH => (270, true),
            Orientation::Rotate270FlipH => (90, true),
        };
        Turned { degrees, mirrored }
    }
}

impl fmt::Display for Turned {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Turned { degrees, mirrored } = self;
        let how = if *mirrored { "mirrored and turned" } else { "turned" };
        write!(formatter, "{how} by {degrees} degrees clockwise")
    }
}

impl Picture {
    /// Reads a PNG or JPEG file of 8 or 16 bits, gray or colour.
    ///
    /// # Errors
    /// If the file cannot be read, or is no such picture: with its path.
    pub fn open(path: &Path) -> Result<Self> {
        let unread =
            |reason: &dyn fmt::Display| Error::new(format!("{}: cannot be read: {reason}", path.display()));
        let bytes = std::fs::read(path).map_err(|error| unread(&error))?;
        Picture::decode(&bytes, path)
    }

    /// The same of the bytes of such a file; `path` is its name in messages.
    ///
    /// # Errors
    /// If it is no such picture: with its path.
    pub fn decode(bytes: &[u8], path: &Path) -> Result<Self> {
        let no_picture = |reason: &dyn fmt::Display| {
            Error::new(format!("{}: found no picture, expected PNG or JPEG ({reason})", path.display()))
        };
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let reader = reader.map_err(|error| no_picture(&error))?;
        let mut decoder = reader.into_decoder().map_err(|error| no_picture(&error))?;
        let orientation = decoder.orientation().map_err(|error| no_picture(&error))?;
        let mut image = DynamicImage::from_decoder(decoder).map_err(|error| no_picture(&error))?;
        image.apply_orientation(orientation);
        let gray = gray_of(&image).map_err(|error| no_picture(&error))?;
        Ok(Picture { gray, turned: Turned::of(orientation) })
    }
}

/// Levels from 0 to 255, colours by the weights of OpenCV (ITU-R BT.601).
fn gray_of(image: &DynamicImage) -> Result<Gray> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    if let DynamicImage::ImageLuma8(bytes) = image {
        return Gray::from_bytes(width, height, bytes.as_raw());
    }
    let weigh = |[red, green, blue]: [f32; 3]| 0.299 * red + 0.587 * green + 0.114 * blue;
    let levels = if image.color().bytes_per_pixel() / image.color().channel_count() == 1 {
        // A pixel of OpenCV is a whole number.
        image.to_rgb8().pixels().map(|pixel| weigh(pixel.0.map(f32::from)).round()).collect()
    } else {
        image.to_rgb16().pixels().map(|pixel| weigh(pixel.0.map(f32::from)) * (255.0 / 65535.0)).collect()
    };
    Gray::new(width, height, levels)
}
