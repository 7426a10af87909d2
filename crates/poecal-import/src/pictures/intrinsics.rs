//! Lenses of industrial_calibration.

use std::path::Path;

use poecal_model::camera::Lens;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::yaml::Leaf;

/// The lens of industrial_calibration: `intrinsics` with fx, fy, cx and cy, without distortion.
pub(crate) fn of_intrinsics(leaves: &[Leaf], path: &Path) -> Result<Option<Lens>> {
    let number = |key: &str| {
        let found = leaves.iter().find(|leaf| leaf.path.iter().eq(["intrinsics", key]))?;
        let number = found.text.parse::<f64>().ok().filter(|value| value.is_finite());
        Some(number.ok_or_else(|| {
            let message = format!("found `{}` in `intrinsics.{key}`, expected a number", found.text);
            Error::new(ErrorKind::Syntax, message).at_line(path, found.line)
        }))
    };
    let all = ["fx", "fy", "cx", "cy"].map(number);
    if all.iter().all(Option::is_none) {
        return Ok(None);
    }
    let [Some(fx), Some(fy), Some(cx), Some(cy)] = all else {
        let message = "found `intrinsics` without all of fx, fy, cx and cy, expected these";
        return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
    };
    Ok(Some(Lens::pinhole([fx?, fy?], [cx?, cy?])))
}
