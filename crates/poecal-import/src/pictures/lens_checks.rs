//! Checks of the lenses in files of cameras.

use std::path::Path;

use poecal_model::camera::{Distortion, LENS_NAMES, Lens};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::numbers::LARGEST_NUMBER;

/// Expected form of a file of cameras, for errors.
pub(crate) const EXPECTED: &str = "a camera: CSV with name, fx, fy, cx, cy, k1, … in OpenCV's order, YAML, JSON or XML with a `camera_matrix`, or with fx, fy, \
                        cx, cy (OpenCV, ROS, RealSense, OAK), Kalibr's camchain, or a camera of ViSP, HALCON (.dat) or mrcal";
/// Remedy for a lens of another model.
pub(crate) const OTHERWISE: &str = "or find the lens by the pictures: --camera unknown:WIDTHxHEIGHT";

/// Refuses numbers that belong to no lens.
pub(crate) fn check(name: &str, lens: &Lens) -> Result<()> {
    let of = || if name.is_empty() { String::new() } else { format!(" of camera `{name}`") };
    let [fx, fy] = lens.focal_px;
    let refuse = |found: String, expected: &str| {
        ErrorKind::Measurement.refuse(format!("found {found}{}, expected {expected}", of()))
    };
    let focal = || format!("the focal lengths {fx} and {fy}");
    let is_none = |number: f64| !number.is_finite() || number.abs() > LARGEST_NUMBER;
    if let Some((own, number)) = LENS_NAMES.iter().zip(lens.numbers()).find(|it| is_none(it.1)) {
        let most = format!("a finite number of at most {LARGEST_NUMBER:e}");
        return refuse(format!("{number:?} for `{own}`"), &most);
    }
    if !(fx > 0.0 && fy > 0.0) {
        return refuse(focal(), "pixels above 0");
    }
    // In millimetres they are about 4 to 50, and cx, cy about 2 to 12.
    if fx < 60.0 && fy < 60.0 {
        return refuse(focal(), "pixels, not millimetres: focal length over the size of a pixel");
    }
    if !(0.5..2.0).contains(&(fx / fy)) {
        return refuse(focal(), "two that are nearly alike");
    }
    let [cx, cy] = lens.centre_px;
    if let Some([width, height]) = lens.size_px {
        let inside = |at: f64, size: u32| (0.0..f64::from(size)).contains(&at);
        if !inside(cx, width) || !inside(cy, height) {
            let size = format!(
                "a place in the picture of {width} × {height} pixels; are width and height, or cx and cy, exchanged?"
            );
            return refuse(format!("the centre ({cx}, {cy})"), &size);
        }
    }
    Ok(())
}

/// A distortion by the name of its model and its coefficients.
pub(crate) fn distortion(kind: &str, numbers: &[f64], path: &Path) -> Result<Distortion> {
    let refuse = |expected: &str| {
        let message = format!("found the distortion `{kind}` with {} coefficients, expected {expected}", numbers.len());
        Err(ErrorKind::Measurement.error(message).in_file(path))
    };
    let small = kind.to_ascii_lowercase();
    match small.strip_prefix("distortion.").unwrap_or(&small) {
        // RealSense's inverse model distorts like the plain one, to some hundredths of a pixel: realsense_lenses_by_name of the findings.
        ""
        | "none"
        | "plumb_bob"
        | "radtan"
        | "rational_polynomial"
        | "brown_conrady"
        | "inverse_brown_conrady"
        | "opencv" => {
            // OpenCV writes up to 14, of which those of thin prisms and tilts are mostly 0.
            if numbers.iter().skip(8).any(|it| *it != 0.0) {
                return refuse("none of a thin prism or a tilted sensor");
            }
            let mut k = [0.0; 8];
            k.iter_mut().zip(numbers).for_each(|(k, number)| *k = *number);
            Ok(Distortion::Brown(k))
        }
        "equidistant" | "fisheye" | "kannala_brandt4" => match *numbers {
            [k1, k2, k3, k4, ref rest @ ..] if rest.iter().all(|it| *it == 0.0) => {
                Ok(Distortion::Fisheye([k1, k2, k3, k4]))
            }
            [] => Ok(Distortion::Fisheye([0.0; 4])),
            _ => refuse("4"),
        },
        // No model distorts anything if its coefficients are zero.
        _ if !numbers.is_empty() && numbers.iter().all(|it| *it == 0.0) => Ok(Distortion::Brown([0.0; 8])),
        _ => refuse(&format!(
            "plumb_bob, radtan, rational_polynomial, equidistant, fisheye or none: calibrate it with one of these, {OTHERWISE}"
        )),
    }
}
