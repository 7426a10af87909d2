//! Cameras of mrcal (`.cameramodel`): a Python literal, which is YAML except for the inputs of its optimisation.

use std::borrow::Cow;

use super::keyed_values::{KeyedValues, exact_numbers, listed_size, refuse};
use super::lens_checks::distortion;
use poecal_model::camera::{Camera, Lens};
use poecal_numerics::error::Result;

/// Keys of mrcal that are read, or do not describe a lens.
pub(super) const OF_MRCAL: &str = "lensmodel intrinsics imagersize rt_cam_ref rt_fromref extrinsics valid_intrinsics_region optimization_inputs \
                        icam_intrinsics";
/// Lens models of mrcal that equal OpenCV's, each with its number of distortion coefficients (in OpenCV's order).
const MRCAL_MODELS: [(&str, usize); 4] = [("PINHOLE", 0), ("OPENCV4", 4), ("OPENCV5", 5), ("OPENCV8", 8)];

/// The camera of mrcal: fx, fy, cx, cy, and coefficients in OpenCV's order.
pub(super) fn of_mrcal(stated: &KeyedValues<'_>) -> Result<Option<Camera>> {
    let Some(model) = stated.word("lensmodel") else { return Ok(None) };
    let known = MRCAL_MODELS.iter().find(|it| model.strip_prefix("LENSMODEL_") == Some(it.0));
    let Some((_, count)) = known else {
        return refuse(
            stated.path,
            format!(
                "found the lens model `{model}` of mrcal, expected LENSMODEL_OPENCV8, 5 or 4, or LENSMODEL_PINHOLE: \
                 `mrcal-convert-lensmodel LENSMODEL_OPENCV8` writes one"
            ),
        );
    };
    let mut numbers = stated.list("intrinsics")?;
    if numbers.len() != 4 + count {
        let message = format!("found {} numbers of `intrinsics`, expected {} of {model}", numbers.len(), 4 + count);
        return refuse(stated.path, message);
    }
    let bent = numbers.split_off(numbers.len().min(4));
    let [fx, fy, cx, cy] = exact_numbers(numbers, "intrinsics", stated.path)?;
    let size_px = listed_size(stated, "imagersize")?;
    let distortion = distortion("opencv", &bent, stated.path)?;
    Ok(Some(Camera::new(String::new(), Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px })))
}

/// The text of a camera of mrcal without the inputs of its optimisation, which are Python bytes and no YAML.
pub(super) fn without_inputs(text: &str) -> Cow<'_, str> {
    let cut = || {
        let (before, rest) = text.split_once("optimization_inputs")?;
        let (between, rest) = rest.split_once("b'")?;
        let (_, after) = rest.split_once('\'')?;
        between
            .chars()
            .all(|it| matches!(it, '\'' | '"' | ':' | ' '))
            .then(|| Cow::Owned(format!("{before}optimization_inputs{between}''{after}")))
    };
    cut().unwrap_or(Cow::Borrowed(text))
}
