//! `MOC.cfg` of a controller of ABB with Absolute Accuracy: errors of this arm's axes that the maker's calibration found, and its compliance.
//!
//! The frames, the order and the signs of its numbers are not public. They state sizes, which determine a tolerance but no robot.

use std::path::Path;

use poecal_model::robot::Tolerance;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::source_text;

const EXPECTED: &str =
    "MOC.cfg of a controller of ABB whose arm has Absolute Accuracy, with error_offset_x and others in ARM_CALIB";
/// Errors of the position of an axis, metres.
const LENGTHS: [&str; 3] = ["error_offset_x", "error_offset_y", "error_offset_z"];
/// Errors of the direction of an axis, radians. `jaw` is the file's own word.
const ANGLES: [&str; 3] = ["error_roll", "error_pitch", "error_jaw"];

/// Results of a maker's calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct AbbCalibration {
    /// Errors of each axis, as far as the file states them: its pattern.
    pub arms: Vec<ArmErrors>,
    /// Names of compliant joints, with their compliance, rad/Nm.
    pub joints: Vec<(String, f64)>,
}

/// Errors of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmErrors {
    /// The axis, such as `rob1_2`.
    pub name: String,
    /// Errors of its position, metres.
    pub lengths_m: Vec<f64>,
    /// Errors of its direction, radians.
    pub angles_rad: Vec<f64>,
}

impl AbbCalibration {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, and those of [`AbbCalibration::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&source_text::read(path, EXPECTED)?, path)
    }

    /// Reads a text; `path` is for messages.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if a number is invalid.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        Self::parse_at(text, path.as_ref())
    }

    /// Compiled once, and not for each kind of path.
    fn parse_at(text: &str, path: &Path) -> Result<Self> {
        let (mut arms, mut joints) = (Vec::new(), Vec::new());
        for entry in entries(text) {
            let name = entry.text("name").unwrap_or_default().to_owned();
            match entry.section {
                "ARM_CALIB" => {
                    let (lengths_m, angles_rad) = (entry.numbers(&LENGTHS, path)?, entry.numbers(&ANGLES, path)?);
                    arms.push(ArmErrors { name, lengths_m, angles_rad });
                }
                "JOINT_CALIB" => {
                    joints.extend(entry.numbers(&["Compl"], path)?.into_iter().map(|gives| (name.clone(), gives)));
                }
                _ => {}
            }
        }
        Ok(AbbCalibration { arms, joints })
    }

    /// Standard deviations of the axes from nominal, if other arms have errors of the size that the maker found here: root mean squares.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the file states no error of an axis.
    pub fn tolerance(&self, path: impl AsRef<Path>) -> Result<Tolerance> {
        let rms = |of: fn(&ArmErrors) -> &Vec<f64>| -> Option<f64> {
            let found: Vec<f64> = self.arms.iter().flat_map(of).copied().collect();
            let square = found.iter().map(|error| error * error).sum::<f64>() / found.len() as f64;
            (square > 0.0).then(|| square.sqrt())
        };
        let (length_m, angle_rad) = (rms(|arm| &arm.lengths_m), rms(|arm| &arm.angles_rad));
        match (length_m, angle_rad) {
            (Some(length_m), Some(angle_rad)) => Ok(Tolerance { angle_rad, length_m }),
            _ => Err(ErrorKind::Model.error(format!("found no errors of axes, expected {EXPECTED}")).in_file(path)),
        }
    }
}

/// An entry of a section: `-key value` each.
struct SectionEntry<'a> {
    section: &'a str,
    /// Words with their lines.
    words: Vec<(&'a str, usize)>,
}

impl SectionEntry<'_> {
    fn value(&self, key: &str) -> Option<(&str, usize)> {
        let at = self.words.iter().position(|(word, _)| word.strip_prefix('-') == Some(key))?;
        self.words.get(at + 1).copied()
    }

    fn text(&self, key: &str) -> Option<&str> {
        Some(self.value(key)?.0.trim_matches('"'))
    }

    /// Numbers of those keys that exist.
    fn numbers(&self, keys: &[&str], path: &Path) -> Result<Vec<f64>> {
        let mut numbers = Vec::new();
        for key in keys {
            let Some((word, line)) = self.value(key) else { continue };
            // Larger errors belong to another unit.
            match word.parse::<f64>() {
                Ok(number) if number.abs() < 1.0 => numbers.push(number),
                _ => {
                    return Err(ErrorKind::Model
                        .error(format!(
                            "found `{word}` for `-{key}`, expected a number of metres, radians or rad/Nm below 1"
                        ))
                        .at_line(path, line));
                }
            }
        }
        Ok(numbers)
    }
}

/// The entries: an empty line ends one, unless the line before ends with a backslash.
fn entries(text: &str) -> Vec<SectionEntry<'_>> {
    let mut section = "";
    let mut found: Vec<SectionEntry<'_>> = Vec::new();
    let mut is_open = false;
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if let Some(name) = line.strip_suffix(':').filter(|name| !name.contains(char::is_whitespace)) {
            (section, is_open) = (name, false);
            continue;
        }
        let (line, goes_on) = line.strip_suffix('\\').map_or((line, false), |line| (line, true));
        let words = line.split_whitespace().filter(|word| *word != "#").map(|word| (word, index + 1));
        match found.last_mut().filter(|_| is_open) {
            Some(entry) => entry.words.extend(words),
            None if line.starts_with('-') => found.push(SectionEntry { section, words: words.collect() }),
            None => {}
        }
        is_open = goes_on;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "MOC:CFG_1.0:6:0::\n#\nARM_CALIB:\n\n      -name \"rob1_1\" -absacc_version 2 -error_offset_x 3E-04\\\n      \
                        -error_offset_y -4E-04 -error_roll 0.001\\\n      -arm_compliance_y 3.1E-06\n\n      -name \"rob1_2\" -error_jaw -0.001\n#\n\
                        JOINT_CALIB:\n\n      -name \"rob1_1\"\n\n      -name \"rob1_2\" -Compl 1.1E-05\n";

    #[test]
    fn sizes_and_pattern_are_read() {
        let found = AbbCalibration::parse(TEXT, "MOC.cfg").unwrap();
        let pattern: Vec<_> =
            found.arms.iter().map(|arm| (arm.name.as_str(), arm.lengths_m.len(), arm.angles_rad.len())).collect();
        assert_eq!(pattern, [("rob1_1", 2, 1), ("rob1_2", 0, 1)]);
        assert_eq!(found.joints, [("rob1_2".to_owned(), 1.1e-5)]);
        let tolerance = found.tolerance("MOC.cfg").unwrap();
        assert!((tolerance.length_m - 12.5e-8_f64.sqrt()).abs() < 1e-18 && (tolerance.angle_rad - 1e-3).abs() < 1e-18);
    }

    #[test]
    fn mistakes_are_told() {
        let error = AbbCalibration::parse(&TEXT.replace("3E-04", "300"), "MOC.cfg").unwrap_err().to_string();
        assert_eq!(
            error,
            "MOC.cfg:5: found `300` for `-error_offset_x`, expected a number of metres, radians or rad/Nm below 1"
        );
        let none = AbbCalibration::parse("ROBOT:\n  -name \"ROB_1\"\n", "MOC.cfg").unwrap();
        let error = none.tolerance("MOC.cfg").unwrap_err().to_string();
        assert!(error.starts_with("MOC.cfg: found no errors of axes, expected MOC.cfg of a controller"), "{error}");
    }
}
