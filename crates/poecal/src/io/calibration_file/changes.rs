//! How joints differ from another model's, in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::offsets::JointChange;
use crate::robot::JointKind;

/// How a joint differs from the nominal one, in parts: a joint offset, and the tilt and shift of the axis that offsets and base do not
/// explain. Directions are those of the base frame with all joints at zero.
///
/// ```
/// use poecal::io::calibration_file::JointChangeEntry;
/// let change = poecal::offsets::JointChange {
///     kind: poecal::robot::JointKind::Prismatic,
///     at: nalgebra::Vector3::zeros(),
///     offset: Some(0.0012),
///     tilt: nalgebra::Vector3::zeros(),
///     shift: nalgebra::Vector3::zeros(),
///     sigma_offset: Some(0.0001),
///     sigma_tilt: Some(0.0001),
///     sigma_shift: None,
///     is_estimated: true,
/// };
/// let entry = JointChangeEntry::from(&change);
/// assert_eq!(entry.words, "no tilt, offset +1.20 ± 0.10 mm");
/// assert_eq!((entry.offset_mm, entry.shift_mm), (Some(1.2), None));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointChangeEntry {
    /// In words, with standard deviations.
    pub words: String,
    /// What is to be added to the value of a joint that turns, degrees; null where base or tool can take its place.
    pub offset_deg: Option<f64>,
    /// The same of a joint that slides, millimetres.
    pub offset_mm: Option<f64>,
    /// Standard deviation of the offset in its unit; null where it is not determined.
    pub sigma_offset: Option<f64>,
    /// Tilt of the axis: a rotation vector across it, degrees.
    pub tilt_deg: [f64; 3],
    /// Its standard deviation (root mean square), degrees.
    pub sigma_tilt_deg: Option<f64>,
    /// Shift of the axis across itself, millimetres; null of a joint that slides.
    pub shift_mm: Option<[f64; 3]>,
    /// Its standard deviation (root mean square), millimetres.
    pub sigma_shift_mm: Option<f64>,
    /// The point of the axis for which the shift is stated: the nearest to the joint's origin, metres.
    pub at_m: [f64; 3],
}

impl From<&JointChange> for JointChangeEntry {
    fn from(found: &JointChange) -> Self {
        let turns = found.kind == JointKind::Revolute;
        JointChangeEntry {
            words: found.words(),
            offset_deg: found.offset.filter(|_| turns).map(f64::to_degrees),
            offset_mm: found.offset.filter(|_| !turns).map(|it| 1e3 * it),
            sigma_offset: found
                .sigma_offset
                .filter(|_| found.offset.is_some())
                .map(|it| if turns { it.to_degrees() } else { 1e3 * it }),
            tilt_deg: found.tilt.map(f64::to_degrees).into(),
            sigma_tilt_deg: found.sigma_tilt.map(f64::to_degrees),
            shift_mm: turns.then(|| (found.shift * 1e3).into()),
            sigma_shift_mm: found.sigma_shift.filter(|_| turns).map(|it| 1e3 * it),
            at_m: found.at.into(),
        }
    }
}
