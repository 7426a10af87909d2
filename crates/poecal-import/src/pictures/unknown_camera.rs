//! A camera of which only the size of its pictures is known.

use super::lens_checks::LARGEST_SIDE;
use poecal_model::camera::{Camera, Lens};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// What begins the words of a camera whose lens is unknown.
pub(crate) const UNKNOWN: &str = "unknown:";
/// Name of a camera that has none.
const NAMELESS: &str = "camera";

/// A camera whose lens is to be found from its pictures, of which the size is known.
pub(crate) fn unknown(size: &str, typed: &str) -> Result<Camera> {
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|it| (1..=LARGEST_SIDE).contains(it));
    let found =
        size.split_once(['x', 'X']).and_then(|(width, height)| Some([number(width)?, number(height)?]));
    let [width, height] = found.ok_or_else(|| {
        let message =
            format!("found the camera `{typed}`, expected the size of its pictures, as unknown:1920x1080");
        Error::new(ErrorKind::Option, message)
    })?;
    // Any lens until the pictures say which.
    let lens = Lens::pinhole([f64::from(width); 2], [0.5 * f64::from(width), 0.5 * f64::from(height)]);
    let lens = Lens { size_px: Some([width, height]), ..lens };
    Ok(Camera { is_guessed: true, ..Camera::new(NAMELESS.to_owned(), lens) })
}
