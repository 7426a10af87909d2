//! Result of a fit of screws and terms.

use super::choice::{SizesReason, TriedSizes};
use super::effects::Effects;
use crate::calibration::accuracy::ModelAccuracy;
use crate::calibration::coverage_check::CoverageCheck;
use crate::calibration::expected::Expectations;
use crate::calibration::options::DeviceFrameKnowledge;
use crate::calibration::placed::{CalibratedStation, CalibratedTarget};
use crate::estimate::{Estimate, Packed, RowError, Session, Unknowns};
use crate::measurement::{Dataset, Noise};
use crate::robot::{CorrectionModel, Robot, Sizes};
use crate::uncertainty::Uncertainty;

/// A fit of screws and terms: the robot that it found, with all that predicts rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// The robot with its gives and terms, as in the model.
    pub model: CorrectionModel,
    /// Prior sizes of the groups of terms.
    pub sizes: Sizes,
    /// Why it has terms of these sizes.
    pub reason: SizesReason,
    /// Sizes that cross-validation tried, if it chose.
    pub tried: Vec<TriedSizes>,
    /// The robot that was found, with its gives and its terms, and its tip as that of [`Calibration::robot`](crate::Calibration).
    /// It predicts as the fit does.
    pub robot: Robot,
    /// The targets.
    pub targets: Vec<CalibratedTarget>,
    /// All stations.
    pub stations: Vec<CalibratedStation>,
    /// What was fitted.
    pub unknowns: Unknowns,
    /// What was found.
    pub estimate: Estimate,
    /// Noise of the fit.
    pub noise: Noise,
    /// What was known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Errors on the training rows.
    pub training: ModelAccuracy,
    /// Errors on the held-out rows.
    pub held_out: Option<ModelAccuracy>,
    /// Covariance of the unknowns and of terms that may be there, and model error.
    pub uncertainty: Option<Uncertainty>,
    /// What the terms do; nothing without any.
    pub effects: Effects,
    /// Expected errors.
    pub expected: Expectations,
    /// Error of positions in cross-validation (metres, RMS): that of geometry alone times the share that terms leave; `None` if no sizes were
    /// tried.
    pub left_out_m: Option<f64>,
    /// Coverage on the held-out rows.
    pub kept: Option<CoverageCheck>,
    /// What is said of a direction of gravity that was not found.
    pub doubt: Option<String>,
    /// Weight of the priors in the fit.
    pub(in crate::calibration) prior_weight: f64,
    pub(in crate::calibration) packed: Packed,
}

impl Correction {
    /// Errors of rows of the data that were fitted ([`Session::errors`]).
    #[must_use]
    pub fn errors(&self, data: &Dataset, rows: &[u32]) -> Vec<RowError> {
        Session::new(&self.model.robot, data, &self.packed, true).errors(rows, &self.estimate)
    }

    /// Errors of the rows that were held out, or of those that were fitted where there are no such.
    pub(in crate::calibration) fn judging_errors(&self) -> &ModelAccuracy {
        self.held_out.as_ref().unwrap_or(&self.training)
    }

    /// Whether it has terms at all, rather than geometry alone.
    #[must_use]
    pub fn has_terms(&self) -> bool {
        self.sizes != Sizes::NONE
    }
}
