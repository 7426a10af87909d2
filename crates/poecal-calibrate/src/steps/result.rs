//! Result of a calibration.

use std::borrow::Cow;
use std::sync::Arc;

use crate::pictures::image_map::ImageMap;
use crate::run::calibrated_places::{CalibratedStation, CalibratedTarget};
use crate::{
    Acceptance, Accuracy, CalibrationOptions, Correction, DeviceFrameKnowledge, Event, Formulation, Models,
    NoiseSource, Robustness, SolverReport, Trust, Verdict, fit_screws,
};
use poecal_arm::lie::Pose;
use poecal_fit::analysis::Identifiability;
use poecal_fit::forensics::Diagnosis;
use poecal_fit::problem::Prior;
use poecal_fit::state::{PackedValues, Session, Unknowns};
use poecal_model::measurement::{Dataset, Noise};
use poecal_model::robot::{Robot, Tolerance};
use poecal_numerics::{solve, threads};

/// A finished calibration.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::{CalibrationOptions, calibrate};
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::{CalibrationOptions, calibrate, Simulation};
/// use poecal::simulate::{SessionKind, elbow};
/// let simulation = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
/// let made = simulation.run(&elbow(), SessionKind::POSE)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let held_out = calibration.accuracy.held_out.expect("30 % are held out");
/// assert!(held_out.calibrated.position_mm().max < 1e-6);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The nominal robot.
    pub nominal: Robot,
    /// The calibrated robot; used targets and instruments of the model are at their calibrated poses.
    pub robot: Robot,
    /// The targets.
    pub targets: Vec<CalibratedTarget>,
    /// Prior knowledge of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// Unknowns of the fit.
    pub unknowns: Unknowns,
    /// Formulation of the fit, and its minimisation.
    pub formulation: Formulation,
    /// Tolerance of the prior, if cross-validation chose it.
    pub chosen_tolerance: Option<Tolerance>,
    /// `base_from_device`, of the first station.
    pub base_from_device: Pose,
    /// All stations, in the order of [`Dataset::stations`]; at least one.
    pub stations: Vec<CalibratedStation>,
    /// The three models.
    pub models: Models,
    /// Errors of the three models on training and held-out rows.
    pub accuracy: Accuracy,
    /// The minimisation.
    pub solver: SolverReport,
    /// Determined unknowns.
    pub identifiability: Identifiability,
    /// Uncertainty, cross-validation, corrections.
    pub trust: Trust,
    /// Decision whether the requested limits are kept; `None` without limits.
    pub acceptance: Option<Acceptance>,
    /// Verdict with its reasons, on the delivered model.
    pub verdict: Verdict,
    /// Noise by which residuals of rows without a stated noise were whitened; with several instruments that of the first.
    pub noise: Noise,
    /// Noise of each instrument in units of the first one's; empty if all are alike.
    pub noise_ratios: Vec<Noise>,
    /// Source of that noise.
    pub noise_source: NoiseSource,
    /// Outliers, and the judgement of each row.
    pub robustness: Robustness,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// Mistakes found in all rows: reported, not corrected.
    pub diagnosis: Vec<Diagnosis>,
    /// Repaired events of the session ([`calibrate_repairing`](crate::calibrate_repairing)).
    pub repairs: Vec<Event>,
    /// Suspected events that were not repaired.
    pub suspicions: Vec<Event>,
    /// Rows fitted.
    pub fit_rows: Vec<u32>,
    /// Rows held out.
    pub held_out_rows: Vec<u32>,
    /// The corrected model: screws and terms fitted together; `None` if no terms were requested.
    pub correction: Option<Box<Correction>>,
    /// Errors of corners over the image of each camera whose picture has a known size.
    pub images: Vec<ImageMap>,
    /// Joint values of its measurements with their sines and cosines.
    pub(crate) packed: Arc<PackedValues>,
}

/// A calibration, and its session.
#[derive(Clone, Debug)]
pub struct RepairedSession<'a> {
    /// The calibration, with repaired and suspected events.
    pub calibration: Calibration,
    /// The measurements as they were fitted: the supplied ones if rows were only left out.
    pub data: Cow<'a, Dataset>,
}

impl Calibration {
    /// Joint values of measurements; the stored ones for the data of the calibration.
    pub fn packed_values(&self, data: &Dataset) -> Arc<PackedValues> {
        if self.packed.is_of(&self.nominal, data) {
            return Arc::clone(&self.packed);
        }
        Arc::new(PackedValues::from_dataset(&self.nominal, data))
    }

    /// The session of these measurements and their joint values.
    pub fn session<'a>(&'a self, data: &'a Dataset, packed: &'a PackedValues) -> Session<'a> {
        Session::new(&self.nominal, data, packed, self.frame == DeviceFrameKnowledge::Unknown)
            .with_unknowns(&self.unknowns)
    }

    /// The calibrated robot with the named targets in its tip frame, as written to model files.
    #[must_use]
    pub fn robot_with_targets(&self) -> Robot {
        let is_mounted = |name: &str| self.robot.mounted.iter().any(|mount| mount.name == name);
        let named = |target: &CalibratedTarget| {
            let name = target.name.clone().filter(|name| !is_mounted(name))?;
            Some((name, target.tip_from_target))
        };
        Robot { targets: self.targets.iter().filter_map(named).collect(), ..self.robot.clone() }
    }

    /// Solves the least-squares problem of a finished calibration again, from the nominal model (with an unknown device frame, the registered one) to
    /// the optimum: packing and minimisation, with the final noise and all fitted rows at full weight. It serves comparisons of solvers.
    #[must_use]
    pub fn solve_again(&self, data: &Dataset, options: &CalibrationOptions) -> solve::Summary {
        threads::in_pool(data.len(), || self.solved_again(data, options))
    }

    fn solved_again(&self, data: &Dataset, options: &CalibrationOptions) -> solve::Summary {
        let packed = PackedValues::from_dataset(&self.nominal, data);
        let session = self.session(data, &packed);
        let start = match self.frame {
            DeviceFrameKnowledge::Base => self.models.nominal.clone(),
            DeviceFrameKnowledge::Unknown => self.models.registered.clone(),
        };
        let prior = options.prior(&session);
        let lacks_length = session.lacks_length(&self.fit_rows);
        let of = |prior: &Prior| prior.looseness(&self.models.calibrated);
        let looseness = |prior: &Prior| if lacks_length { 1.0 } else { of(prior) };
        let prior = prior.as_ref().map(|prior| (prior, 1.0 / looseness(prior)));
        fit_screws(session, &self.fit_rows, start, self.noise, prior, options).2
    }
}
