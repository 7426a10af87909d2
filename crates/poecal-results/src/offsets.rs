//! The joint offsets of the best fit of one model to another, as every command states them.

use super::model::{Model, ModelSource};
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_fit::analysis::within_sampled;
use poecal_model::offsets::{EndConstraint, OffsetExplanation, OffsetOptions, explain};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// The offsets between two models, and the choices of their fit.
///
/// ```
/// use poecal_results::model::{Model, ModelSource};
/// use poecal_results::offsets::ModelOffsets;
/// let model = Model { robot: poecal_model::simulate::elbow(), source: ModelSource::Toml, path: "elbow.toml".into() };
/// let found = ModelOffsets::from_robots(&model, &model, [None, None])?;
/// assert!(found.explanation.offsets.iter().all(|offset| offset.abs() < 1e-12) && !found.is_sampled);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ModelOffsets {
    /// The offsets, and the errors that remain.
    pub explanation: OffsetExplanation,
    /// Reason why the base and the tip are held or free.
    pub reasons: [&'static str; 2],
    /// True if the tips are compared over the range that the calibration sampled, and not within the limits.
    pub is_sampled: bool,
}

impl ModelOffsets {
    /// Offsets that fit `nominal` best to `actual`, with base and tip as stated, or else as `ModelOffsets::ends` decides. The tips are compared over
    /// the sampled range if the actual model is a calibration, otherwise over the nominal limits.
    ///
    /// # Errors
    /// As [`explain`].
    pub fn from_robots(nominal: &Model, actual: &Model, ends: [Option<EndConstraint>; 2]) -> Result<Self> {
        Self::of_robots(&nominal.robot, &actual.robot, actual, ends)
    }

    /// Offsets between robots of the models: `source` is the actual one's.
    pub(crate) fn of_robots(
        nominal: &Robot,
        actual: &Robot,
        source: &Model,
        ends: [Option<EndConstraint>; 2],
    ) -> Result<Self> {
        let coverage = match &source.source {
            ModelSource::Calibration(file) => file.coverage.as_slice(),
            ModelSource::Urdf(_) | ModelSource::Toml => &[],
        };
        let [(base, base_reason), (tip, tip_reason)] = Self::ends(ends, source);
        let options = OffsetOptions { base, tip, ..OffsetOptions::default() };
        let explanation = explain(&within_sampled(nominal, &[coverage]), actual, &options)?;
        Ok(ModelOffsets { explanation, reasons: [base_reason, tip_reason], is_sampled: !coverage.is_empty() })
    }

    /// Decision whether base and tip are held or free, as requested or by default, each with the reason. By default an end is free if the calibration
    /// does not determine it.
    fn ends([base, tip]: [Option<EndConstraint>; 2], actual: &Model) -> [(EndConstraint, &'static str); 2] {
        let both = (EndConstraint::Kept, "both models state it");
        let (usual_base, usual_tip) = match &actual.source {
            ModelSource::Calibration(file) => {
                let base = match file.frame() {
                    DeviceFrameKnowledge::Unknown => (
                        EndConstraint::Free,
                        "the calibration did not know the device's place, so its base frame is a matter of choice",
                    ),
                    DeviceFrameKnowledge::Base => (EndConstraint::Kept, "the calibration was measured in it"),
                };
                (base, (EndConstraint::Free, "a tool is taught on the robot as it is"))
            }
            ModelSource::Urdf(_) | ModelSource::Toml => (both, both),
        };
        let asked = |end: Option<EndConstraint>, usual| end.map_or(usual, |end| (end, "as asked"));
        [asked(base, usual_base), asked(tip, usual_tip)]
    }
}
