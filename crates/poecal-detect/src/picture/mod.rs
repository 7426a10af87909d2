//! Pictures in files.

pub(crate) mod decoding;
pub(crate) mod exif;
pub(crate) mod preview;

use std::fmt;
use std::path::Path;

use crate::decoding::{DecodeFailure, DecodedPicture};
use crate::error::{Error, Result};
use crate::gray::Gray;

/// A picture of a file, in gray, upright by its EXIF data.
#[derive(Clone, Debug, PartialEq)]
pub struct GrayPicture {
    /// Its levels.
    pub gray: Gray,
    /// Rotation after reading: the axes of its camera then differ from those of the picture.
    pub turned: PictureOrientation,
}

/// Rotation of a picture to upright.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PictureOrientation {
    /// Degrees clockwise: 0, 90, 180 or 270.
    pub degrees: u16,
    /// True if left and right were exchanged, before turning.
    pub mirrored: bool,
}

impl PictureOrientation {
    /// True if the picture was changed.
    #[must_use]
    pub fn is_turned(&self) -> bool {
        *self != PictureOrientation::default()
    }

    /// Rotation by the orientation of EXIF, 1 to 8.
    fn from_exif(orientation: u8) -> Self {
        let (degrees, mirrored) = match orientation {
            2 => (0, true),
            3 => (180, false),
            4 => (180, true),
            5 => (270, true),
            6 => (90, false),
            7 => (90, true),
            8 => (270, false),
            _ => (0, false),
        };
        PictureOrientation { degrees, mirrored }
    }

    /// The picture after this rotation.
    fn apply(self, gray: Gray) -> Result<Gray> {
        if !self.is_turned() {
            return Ok(gray);
        }
        let (width, height) = (gray.width(), gray.height());
        let (columns, rows) = if self.degrees.is_multiple_of(180) { (width, height) } else { (height, width) };
        let before = |column: usize, row: usize| {
            let (x, y) = match self.degrees {
                90 => (row, height - 1 - column),
                180 => (width - 1 - column, height - 1 - row),
                270 => (width - 1 - row, column),
                _ => (column, row),
            };
            let x = if self.mirrored { width - 1 - x } else { x };
            gray.levels()[y * width + x]
        };
        let levels = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Gray::new(columns, rows, levels.map(|(column, row)| before(column, row)).collect())
    }
}

impl fmt::Display for PictureOrientation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PictureOrientation { degrees, mirrored } = self;
        let how = if *mirrored { "mirrored and turned" } else { "turned" };
        write!(formatter, "{how} by {degrees} degrees clockwise")
    }
}

impl GrayPicture {
    /// Reads a PNG or JPEG file of 8 or 16 bits, gray or colour.
    ///
    /// # Errors
    /// If the file cannot be read, or is no such picture; the message contains its path.
    pub fn open(path: &Path) -> Result<Self> {
        let unread = |reason: &dyn fmt::Display| Error::new(format!("{}: cannot be read: {reason}", path.display()));
        let bytes = std::fs::read(path).map_err(|error| unread(&error))?;
        GrayPicture::decode(&bytes, path)
    }

    /// Decodes the bytes of such a file, of at most [`MOST_PIXELS`]; `path` is its name in messages.
    ///
    /// # Errors
    /// If it is no such picture; the message contains its path.
    pub fn decode(bytes: &[u8], path: &Path) -> Result<Self> {
        GrayPicture::decode_up_to(bytes, path, MOST_PIXELS).map_err(|PictureError { error, .. }| error)
    }

    /// Decodes a picture of at most this number of pixels: a file that states more causes no allocation.
    ///
    /// # Errors
    /// Those of [`GrayPicture::decode`], with the size of a picture of more pixels.
    pub fn decode_up_to(bytes: &[u8], path: &Path, most_pixels: u64) -> std::result::Result<Self, PictureError> {
        let no_picture = |reason: &dyn fmt::Display| PictureError {
            error: Error::new(format!("{}: found no picture, expected PNG or JPEG ({reason})", path.display())),
            too_large: None,
        };
        let decoded = DecodedPicture::from_bytes(bytes, most_pixels).map_err(|found| match found {
            DecodeFailure::Broken(reason) => no_picture(&reason),
            DecodeFailure::Large([width, height]) => PictureError {
                error: Error::new(format!(
                    "{}: found a picture of {width} x {height} pixels, expected at most {most_pixels} in all: make it smaller",
                    path.display()
                )),
                too_large: Some([width, height]),
            },
        })?;
        let turned = PictureOrientation::from_exif(decoded.orientation);
        let gray = decoded.gray().map_err(|error| no_picture(&error))?;
        drop(decoded);
        let gray = turned.apply(gray).map_err(|error| no_picture(&error))?;
        Ok(GrayPicture { gray, turned })
    }
}

/// Default limit of the pixels of a picture.
pub const MOST_PIXELS: u64 = 50_000_000;

/// Reason why a file is no picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureError {
    /// Fault, in a sentence.
    pub error: Error,
    /// Width and height of a picture with more than the permitted pixels.
    pub too_large: Option<[usize; 2]>,
}
