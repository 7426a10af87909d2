//! What is planned, and how.

use nalgebra::Vector3;

use crate::analysis::PlannedSession;
use crate::robot::{Corrections, Tolerance};
use crate::simulate::Kind;

/// The fit that will be made of planned measurements: what is measured, and what is believed before.
///
/// ```
/// use poecal::plan::PlannedFit;
/// assert_eq!(PlannedFit::default().count, 30);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFit {
    /// Kind and noise of the measurements, and whether the device's frame is unknown.
    pub session: PlannedSession,
    /// Number of different configurations.
    pub count: usize,
    /// Prior of the axes ([`crate::calibration::CalibrationOptions::tolerance`]).
    pub tolerance: Option<Tolerance>,
    /// Terms of the joints that are expected and will be fitted for the corrected model; of the common sizes unless sizes are given.
    pub corrections: Corrections,
    /// Where weights are pulled, in the base frame.
    pub gravity: Vector3<f64>,
    /// Root mean square error of the tip that geometry leaves however much is measured, metres; 0.3 mm for each metre of reach if unknown.
    pub robot_error_m: Option<f64>,
    /// Number of targets of a nest at the tip, all measured in each configuration.
    pub targets: usize,
    /// Place of the first target in the tip's frame, metres, the others turned about its z; `None` plans for the targets of the model.
    pub target_offset: Option<Vector3<f64>>,
}

impl Default for PlannedFit {
    /// Points with 0.05 mm of 30 configurations.
    fn default() -> Self {
        PlannedFit {
            session: PlannedSession { kind: Kind::POINT, ..PlannedSession::default() },
            count: 30,
            tolerance: Some(Tolerance::default()),
            corrections: Corrections::Auto,
            gravity: -Vector3::z(),
            robot_error_m: None,
            targets: 1,
            target_offset: None,
        }
    }
}

/// What a list of configurations shall be good at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PlanCriterion {
    /// Expected squared error of the tip over the workspace, of the calibrated and of the corrected model, each relative to that of random
    /// configurations.
    #[default]
    Expected,
    /// Determinant of geometry's information.
    D,
    /// Mean variance of geometry's unknowns.
    A,
    /// Largest variance of geometry's unknowns.
    E,
    /// Largest variance of a prediction in the workspace.
    G,
}
