//! Internal camera parameters of HALCON: lines `Key:key: value;` with metres of the sensor, and the division model.

use std::collections::BTreeMap;
use std::path::Path;

use super::lens_checks::OTHERWISE;
use poecal_model::camera::{Camera, Distortion, Lens, size_of_pictures};
use poecal_numerics::error::{ErrorKind, Result};

/// A word of such files, and of no others.
const MARK: &str = "ParGroup:";
/// Parameters that are read.
const READ: [&str; 8] = ["Focus", "Kappa", "Sx", "Sy", "Cx", "Cy", "ImageWidth", "ImageHeight"];
/// Largest product of Kappa and the squared distance on the sensor for which the fractions below are exact to 0.001 px.
const MOST_BENT: f64 = 0.1;

/// The camera of a text of HALCON; `None` if the text is another.
pub(crate) fn read_halcon(text: &str, path: &Path) -> Result<Option<(Vec<Camera>, Vec<String>)>> {
    if !text.lines().any(|line| line.trim_start().starts_with(MARK)) {
        return Ok(None);
    }
    let refuse = |message: String| Err(ErrorKind::Measurement.error(message).in_file(path));
    let mut numbers = BTreeMap::new();
    for (line, text) in (1..).zip(text.lines()) {
        let refuse = |message: String| ErrorKind::Measurement.error(message).at_line(path, line);
        let Some((key, number)) = parameter(text).map_err(refuse)? else { continue };
        if numbers.insert(key, number).is_some() {
            return Err(refuse(format!("found `{key}` a second time, expected one camera")));
        }
    }
    if let Some((key, number)) = numbers.iter().find(|(key, number)| !READ.contains(key) && **number != 0.0) {
        return refuse(format!(
            "found {number} for `{key}` of HALCON's camera, expected an area scan camera with the division model (Kappa): calibrate it so, {OTHERWISE}"
        ));
    }
    let [Some(focus), Some(kappa), Some(sx), Some(sy), Some(cx), Some(cy), width, height] =
        READ.map(|key| numbers.get(key).copied())
    else {
        return refuse(format!("found HALCON's camera without one of {}, expected them", READ.join(", ")));
    };
    let size_px = size_of_pictures([width, height]).map_err(|error| error.in_file(path))?;
    let focal_px = [focus / sx, focus / sy];
    // u = 2 u' / (1 + sqrt(1 - 4 Kappa r'²)) at positions u' without distortion, as a continued fraction: OpenCV's rational model.
    let bent = kappa * focus * focus;
    let far = [(cx, width, focal_px[0]), (cy, height, focal_px[1])];
    let far = far.map(|(centre, size, focal)| centre.max(size.unwrap_or(2.0 * centre) - centre) / focal);
    if (bent * (far[0] * far[0] + far[1] * far[1])).abs() > MOST_BENT {
        return refuse(format!(
            "found the distortion Kappa = {}, which bends the corners of the picture by more than a tenth, expected less: {OTHERWISE}",
            kappa
        ));
    }
    let [second, third] = [bent * bent, bent * bent * bent];
    let distortion =
        Distortion::Brown([-5.0 * bent, 6.0 * second, 0.0, 0.0, -third, -6.0 * bent, 10.0 * second, -4.0 * third]);
    let lens = Lens { focal_px, centre_px: [cx, cy], distortion, size_px };
    let said =
        if bent == 0.0 { Vec::new() } else { vec!["HALCON's division model as OpenCV's rational one".to_owned()] };
    Ok(Some((vec![Camera::new(String::new(), lens)], said)))
}

/// The parameter of a line, if it has one.
fn parameter(line: &str) -> std::result::Result<Option<(&str, f64)>, String> {
    let mut parts = line.trim().splitn(3, ':');
    let (Some(key), Some(short), Some(value)) = (parts.next(), parts.next(), parts.next()) else {
        return Ok(None);
    };
    // Lines below a parameter are its type with bounds, and words.
    if !short.starts_with(|it: char| it.is_ascii_alphabetic()) || key.starts_with(['#', '"']) {
        return Ok(None);
    }
    let value = value.trim().trim_end_matches(';').trim();
    match value.parse() {
        Ok(number) if f64::is_finite(number) => Ok(Some((key, number))),
        _ => Err(format!("found `{value}` for `{key}`, expected one number with a decimal point")),
    }
}
