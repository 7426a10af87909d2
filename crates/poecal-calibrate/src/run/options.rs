//! Options of a calibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_arm::lie::Pose;
use poecal_fit::problem::Prior;
use poecal_fit::state::Session;
use poecal_model::measurement::ByQuantity;
use poecal_model::robot::{CorrectionExtent, GravityDirection, Tolerance};
use poecal_numerics::solve;

use crate::{AcceptanceLimits, BlockChoice, Corrections, Formulation, RepairLimits, Repairs, RobustLoss};

/// Prior knowledge of the measuring device's frame.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::{CalibrationOptions, DeviceFrameKnowledge};
/// # }
/// use poecal::{CalibrationOptions, DeviceFrameKnowledge};
/// let options = CalibrationOptions { frame: DeviceFrameKnowledge::Base, ..Default::default() };
/// assert_ne!(options, CalibrationOptions::default());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "FrameWord", description = "Knowledge of the device frame.")]
pub enum DeviceFrameKnowledge {
    /// The device frame is unknown and is fitted (exactly redundant with the screws, docs/theory.md §8).
    #[default]
    #[schemars(description = "It was fitted.")]
    Unknown,
    /// Measurements are in the robot's base frame, as in lou2009.
    #[schemars(description = "Measurements are in the base frame.")]
    Base,
}

/// Options of a calibration.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::CalibrationOptions;
/// # }
/// use poecal::CalibrationOptions;
/// let options = CalibrationOptions { held_out: Some(0.2), ..Default::default() };
/// assert_eq!(options.seed, 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// Prior knowledge of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Blocks of unknowns that are fitted; by default all axes, targets and frames.
    pub blocks: BlockChoice,
    /// `base_from_device` of each station from an earlier calibration, used for held frames. If empty, a held frame is that of the model's
    /// instrument, else the base.
    pub devices: Vec<Pose>,
    /// Stated standard deviation of each component of a quantity, metres or radians; estimated from the data if absent.
    pub sigma: ByQuantity<Option<f64>>,
    /// Share of the configurations held out, 0 to below 1, if rows do not state their set. By default it is 0.3; or nothing if that is fewer than 12
    /// configurations, none of them a picture, and no limits are to be accepted: then cross-validation judges.
    pub held_out: Option<f64>,
    /// Seed of that choice and of further starts.
    pub seed: u64,
    /// Parameterisation, residual and method of the fit. All but the default are for comparison.
    pub formulation: Formulation,
    /// Prior: standard deviations of the axes from nominal; a joint's own tolerance precedes. It decides directions that the measurements hardly
    /// determine. `None` is no prior. Formulations other than the default have none.
    pub tolerance: Option<Tolerance>,
    /// True if the tolerance is chosen instead among (0.05°, 0.5 mm), (0.2°, 2 mm), (0.5°, 5 mm), (1°, 10 mm) and (3°, 10 mm): the one whose fit
    /// predicts left-out rows best.
    pub chooses_tolerance: bool,
    /// Terms that are fitted beside the screws, for the corrected model; with the default formulation only.
    pub corrections: Corrections,
    /// Highest order of the harmonics of a joint's turn among these terms.
    pub harmonics: u8,
    /// Direction of gravity.
    pub gravity: GravityDirection,
    /// Treatment of outliers.
    pub robust: RobustLoss,
    /// True if the one target, which no row names, becomes the tip: the model ends in its reflector. Otherwise the tip stays on the last link as in
    /// the model, and the measured target is [`MEASURED`](poecal_model::robot::MEASURED).
    pub move_tip: bool,
    /// Choice whether [`calibrate_repairing`](crate::calibrate_repairing) repairs a session with evident events.
    pub repair: Repairs,
    /// The largest sizes that are repaired.
    pub repair_limits: RepairLimits,
    /// Limits for the errors of rows that were not fitted.
    pub accept: Option<AcceptanceLimits>,
    /// Options of the solver.
    pub solver: solve::Options,
    /// True if mistakes in the input are searched for when the residuals are large enough; takes some tenths of a second.
    pub diagnose: bool,
    /// Most further starts if the fit may have converged to a local minimum.
    pub restarts: usize,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        CalibrationOptions {
            frame: DeviceFrameKnowledge::Unknown,
            blocks: BlockChoice::default(),
            devices: Vec::new(),
            sigma: ByQuantity::default(),
            held_out: None,
            seed: 1,
            formulation: Formulation::default(),
            tolerance: Some(Tolerance::default()),
            chooses_tolerance: false,
            corrections: Corrections::default(),
            harmonics: CorrectionExtent::default().orders,
            gravity: GravityDirection::default(),
            robust: RobustLoss::default(),
            move_tip: false,
            repair: Repairs::default(),
            repair_limits: RepairLimits::default(),
            accept: None,
            solver: solve::Options::default(),
            diagnose: true,
            restarts: 24,
        }
    }
}

impl CalibrationOptions {
    /// Prior of the fit: `None` with formulations for comparison.
    #[must_use]
    pub(crate) fn prior(&self, session: &Session<'_>) -> Option<Prior> {
        let tolerance = self.tolerance.filter(|_| self.formulation == Formulation::default());
        tolerance.map(|tolerance| Prior::from_session(session, tolerance))
    }

    /// Prior of a fit with terms, which always has one.
    #[must_use]
    pub(crate) fn prior_with_terms(&self, session: &Session<'_>) -> Prior {
        Prior::from_session(session, self.tolerance.unwrap_or(Tolerance::WIDE))
    }
}
