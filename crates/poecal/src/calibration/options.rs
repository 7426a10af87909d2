//! How to calibrate.

use crate::measurement::PoseResidual;
use crate::parameters::Formulation;
use crate::robot::Tolerance;
use crate::solve;

use super::Robust;

/// What is known of the measuring device's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum DeviceFrameKnowledge {
    /// The device stands anywhere: its frame is found (and is exactly redundant with the screws, docs/theory.md §8).
    #[default]
    Unknown,
    /// Measurements are in the robot's base frame, as in lou2009.
    Base,
}

/// How to calibrate.
///
/// ```
/// use poecal::calibration::CalibrationOptions;
/// let options = CalibrationOptions { held_out: 0.2, ..Default::default() };
/// assert_eq!(options.seed, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// What is known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Standard deviation of each measured position component, metres; estimated from the data if absent.
    pub sigma_position_m: Option<f64>,
    /// Standard deviation of each measured rotation component, radians; estimated from the data if absent.
    pub sigma_rotation_rad: Option<f64>,
    /// Share of the configurations held out where the data do not say (0 to below 1).
    pub held_out: f64,
    /// Seed of that choice and of restarts.
    pub seed: u64,
    /// How the errors of the joints are written as unknowns. All but the default are for comparison (lou2009).
    pub formulation: Formulation,
    /// How the errors of measured frames are written. The paper's is for comparison.
    pub pose_residual: PoseResidual,
    /// How far the axes may stand off the drawing: a belief that counts beside the measurements where these say little, and for a joint
    /// whose model states its own tolerance that one. `None` believes nothing. It has no part in the formulations for comparison.
    pub tolerance: Option<Tolerance>,
    /// What to do about grossly wrong rows.
    pub robust: Robust,
    /// Options of the solver.
    pub solver: solve::Options,
    /// Whether mistakes in the input are looked for where the fit leaves room for them; that can take some tenths of a second.
    pub diagnose: bool,
    /// Further starts tried when the fit looks as if it ended beside the optimum.
    pub restarts: usize,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        CalibrationOptions {
            frame: DeviceFrameKnowledge::Unknown,
            sigma_position_m: None,
            sigma_rotation_rad: None,
            held_out: 0.3,
            seed: 1,
            formulation: Formulation::default(),
            pose_residual: PoseResidual::default(),
            tolerance: Some(Tolerance::default()),
            robust: Robust::default(),
            solver: solve::Options::default(),
            diagnose: true,
            restarts: 24,
        }
    }
}

impl CalibrationOptions {
    /// The same options for a formulation, with the method that belongs to it: plain Gauss-Newton where screws are free numbers, since
    /// steps that are judged by the cost after normalisation are cut short again and again (docs/theory.md §3).
    ///
    /// ```
    /// use poecal::{calibration::CalibrationOptions, parameters::Formulation, solve::Method};
    /// let options = CalibrationOptions::default().with_formulation(Formulation::Screw);
    /// assert_eq!(options.solver.method, Method::GaussNewton);
    /// ```
    #[must_use]
    pub fn with_formulation(mut self, formulation: Formulation) -> Self {
        self.formulation = formulation;
        self.solver.method = if formulation.has_free_screws() {
            solve::Method::GaussNewton
        } else {
            solve::Method::LevenbergMarquardt
        };
        self
    }

    /// The tolerance that counts in the fit: none with formulations, residuals and methods that are there for comparison.
    #[must_use]
    pub(in crate::calibration) fn believed(&self) -> Option<Tolerance> {
        let usual = Self::default();
        let is_usual = self.formulation == usual.formulation
            && self.pose_residual == usual.pose_residual
            && self.solver.method == usual.solver.method;
        self.tolerance.filter(|_| is_usual)
    }
}
