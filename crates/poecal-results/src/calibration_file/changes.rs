//! Differences of joints from another model's, in `calibration.json`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_calibrate::{Calibration, CommonDirection};
use poecal_fit::uncertainty::Correlations;
use poecal_model::offsets::JointChange;
use poecal_model::robot::JointKind;

/// Difference of a joint from the nominal one, in parts: a joint offset, and the tilt and shift of the axis that offsets and base do not explain.
/// Directions are those of the base frame with all joints at zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointChangeEntry {
    /// In words, with standard deviations.
    pub words: String,
    /// Addition to the value of a joint that turns, degrees; null where base or tool can take its place.
    pub offset_deg: Option<f64>,
    /// Addition to the value of a joint that slides, millimetres.
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

/// A direction in which the measurements determine corrections of several joints only together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonDirectionEntry {
    /// In words: one standard deviation of it, and its effect on predictions.
    pub words: String,
    /// The joints.
    pub joints: Vec<String>,
    /// Its share in the variance of all corrections, 0 to 1.
    pub share: f64,
    /// Root mean square change of predicted positions by one standard deviation, at the measured configurations, millimetres.
    pub effect_mm: f64,
}

impl CommonDirectionEntry {
    /// Entries of a calibration.
    pub(crate) fn all_from_calibration(calibration: &Calibration) -> Vec<Self> {
        let name = |joint: &usize| calibration.robot.joints.get(*joint).map(|joint| joint.name.clone());
        let entry = |found: &CommonDirection| CommonDirectionEntry {
            words: found.words.clone(),
            joints: found.joints.iter().filter_map(name).collect(),
            share: found.share,
            effect_mm: 1e3 * found.effect_m,
        };
        calibration.trust.common.iter().map(entry).collect()
    }
}

/// A strong correlation of two unknowns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrelatedEntry {
    /// The two unknowns.
    pub unknowns: [String; 2],
    /// Their correlation, -1 to 1.
    pub correlation: f64,
}

/// Correlations of the unknowns, by blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrelationsEntry {
    /// The blocks, in the order of their unknowns.
    pub blocks: Vec<String>,
    /// For each block and each up to it the largest size of a correlation between unknowns of the two, 0 to 1.
    pub largest: Vec<Vec<f64>>,
    /// Number of pairs with a correlation of 0.95 or more, of either sign.
    pub strong: usize,
    /// The strongest of these, at most 20.
    pub pairs: Vec<CorrelatedEntry>,
}

impl CorrelationsEntry {
    /// Entry of a covariance (row-major) of named unknowns, whose blocks are their names up to the last dot.
    pub(crate) fn from_covariance(covariance: &[f64], unknowns: &[String]) -> Self {
        let mut blocks: Vec<String> = Vec::new();
        let block = |name: &String| {
            let own = name.rsplit_once('.').map_or(&**name, |(block, _)| block);
            let at = blocks.iter().position(|it| it == own).unwrap_or(blocks.len());
            if at == blocks.len() {
                blocks.push(own.to_owned());
            }
            at
        };
        let of: Vec<usize> = unknowns.iter().map(block).collect();
        let found = Correlations::from_covariance(covariance, &of);
        let pair = |&(i, j, correlation): &(usize, usize, f64)| {
            let unknowns = [unknowns.get(i)?.clone(), unknowns.get(j)?.clone()];
            Some(CorrelatedEntry { unknowns, correlation })
        };
        CorrelationsEntry {
            blocks,
            largest: found.largest,
            strong: found.count,
            pairs: found.pairs.iter().filter_map(pair).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_slide_has_an_offset_in_millimetres_and_no_shift() {
        let entry = JointChangeEntry::from(&JointChange {
            kind: JointKind::Prismatic,
            at: Vector3::zeros(),
            offset: Some(0.0012),
            tilt: Vector3::zeros(),
            shift: Vector3::zeros(),
            sigma_offset: Some(0.0001),
            sigma_tilt: Some(0.0001),
            sigma_shift: None,
            is_estimated: true,
        });
        assert_eq!(entry.words, "no tilt, offset +1.20 ± 0.10 mm");
        assert_eq!((entry.offset_deg, entry.offset_mm, entry.shift_mm), (None, Some(1.2), None));
    }
}
