//! Options of a calibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_arm::lie::Pose;
use poecal_fit::problem::Prior;
use poecal_fit::state::Session;
use poecal_model::measurement::ByQuantity;
use poecal_model::robot::{Extent, GravityDirection, Tolerance};
use poecal_numerics::solve;

use crate::{AcceptanceLimits, BlockChoice, Corrections, Formulation, RepairLimits, Repairs, Robust};

/// What is known of the measuring device's frame.
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
    /// What is known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Which blocks of unknowns are fitted; by default all axes, targets and frames.
    pub blocks: BlockChoice,
    /// `base_from_device` of each station where an earlier calibration has it: a frame that is held stands there. Empty where there is none; a frame that
    /// is held then stands where the model has its instrument, else in the base.
    pub devices: Vec<Pose>,
    /// Stated standard deviation of each component of a quantity, metres or radians; estimated from the data if absent.
    pub sigma: ByQuantity<Option<f64>>,
    /// Share of the configurations held out, 0 to below 1, if rows do not state their set. Where none is asked for, 0.3, or nothing where that
    /// were fewer than 12 configurations, none of them a picture, and no limits are to be accepted: then cross-validation judges.
    pub held_out: Option<f64>,
    /// Seed of that choice and of further starts.
    pub seed: u64,
    /// Parameterisation, residual and method of the fit. All but the default are for comparison.
    pub formulation: Formulation,
    /// Prior: standard deviations of the axes from nominal; a joint's own tolerance precedes. It decides where the measurements determine
    /// little. `None` is no prior. Formulations other than the default have none.
    pub tolerance: Option<Tolerance>,
    /// Whether, instead, the best of (0.05°, 0.5 mm), (0.2°, 2 mm), (0.5°, 5 mm), (1°, 10 mm) and (3°, 10 mm) is taken: that whose fit predicts rows best which are left out.
    pub chooses_tolerance: bool,
    /// Which terms are fitted beside the screws, for the corrected model; with the default formulation only.
    pub corrections: Corrections,
    /// Highest order of the harmonics of a joint's turn among these terms.
    pub harmonics: u8,
    /// Where weights are pulled.
    pub gravity: GravityDirection,
    /// How to treat outliers.
    pub robust: Robust,
    /// Whether the one target, which no row names, becomes the tip: the model ends in its reflector. Otherwise the tip stays where the model has
    /// it on the last link, and what was measured is the target [`MEASURED`](poecal_model::robot::MEASURED).
    pub move_tip: bool,
    /// Whether [`calibrate_repairing`](crate::calibrate_repairing) repairs a session in which something evidently happened.
    pub repair: Repairs,
    /// The largest sizes that are repaired.
    pub repair_limits: RepairLimits,
    /// Limits that the errors of rows that were not fitted shall keep.
    pub accept: Option<AcceptanceLimits>,
    /// Options of the solver.
    pub solver: solve::Options,
    /// Whether mistakes in the input are searched for where the residuals leave room for them; takes some tenths of a second.
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
            harmonics: Extent::default().orders,
            gravity: GravityDirection::default(),
            robust: Robust::default(),
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

    /// Prior of a fit with terms, which has one in any case.
    #[must_use]
    pub(crate) fn prior_with_terms(&self, session: &Session<'_>) -> Prior {
        Prior::from_session(session, self.tolerance.unwrap_or(Tolerance::WIDE))
    }
}
