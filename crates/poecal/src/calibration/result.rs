//! Result of a calibration.

use std::sync::Arc;

use super::{
    Accuracy, CalibrationOptions, DeviceFrameKnowledge, Formulation, Models, NoiseSource, Robustness,
    SolverReport, Trust, Verdict, fit_screws,
};
use crate::analysis::Identifiability;
use crate::estimate::{Estimate, Packed, Session, Unknowns};
use crate::forensics::Diagnosis;
use crate::lie::Pose;
use crate::measurement::{Dataset, Noise};
use crate::problem::Prior;
use crate::robot::{Mount, Robot};
use crate::solve;
use crate::threads;

/// A target as calibrated.
///
/// ```
/// # use poecal::{CalibrationOptions, Kind, Simulation, calibrate, simulate::elbow};
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::Pose)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let [tip] = &calibration.targets[..] else { unreachable!() };
/// assert!(tip.name.is_none() && tip.is_frame && tip.tip_from_target.translation.norm() < 1e-12);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedTarget {
    /// Its name; `None` is the tip itself.
    pub name: Option<String>,
    /// Whether its orientation was measured; otherwise only the position means something.
    pub is_frame: bool,
    /// `tip_from_target` in the calibrated robot; of a target of its `mounted`, which is on a body of its own, at zero joint values.
    pub tip_from_target: Pose,
}

/// A station of the device, as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedStation {
    /// Its name, if the measurements name it.
    pub name: Option<String>,
    /// `base_from_device` there; of an instrument on the robot, at zero joint values.
    pub base_from_device: Pose,
    /// Noise of its rows that state none.
    pub noise: Noise,
}

/// A finished calibration.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let simulation = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
/// let made = simulation.run(&elbow(), Kind::Pose)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let held_out = calibration.accuracy.held_out.expect("30 % are held out");
/// assert!(held_out.calibrated.position_mm().max < 1e-6);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The nominal robot.
    pub nominal: Robot,
    /// The calibrated robot. The single unnamed target is its tip; targets and instruments of the model that were used are at their
    /// calibrated places.
    pub robot: Robot,
    /// The targets.
    pub targets: Vec<CalibratedTarget>,
    /// What was known of the device's frame.
    pub frame: DeviceFrameKnowledge,
    /// What the fit changed.
    pub unknowns: Unknowns,
    /// How the fit was written and minimised.
    pub formulation: Formulation,
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
    /// Which unknowns the measurements determine.
    pub identifiability: Identifiability,
    /// Uncertainty, cross-validation, corrections.
    pub trust: Trust,
    /// Verdict with its reasons.
    pub verdict: Verdict,
    /// Noise by which residuals were whitened where a row stated none; of the first of several instruments.
    pub noise: Noise,
    /// Noise of each instrument in units of the first one's; empty if all are alike.
    pub noise_ratios: Vec<Noise>,
    /// Source of that noise.
    pub noise_source: NoiseSource,
    /// Outliers, and the judgement of each row.
    pub robustness: Robustness,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// Mistakes found in all rows: named, not corrected.
    pub diagnosis: Vec<Diagnosis>,
    /// Rows fitted.
    pub fit_rows: Vec<u32>,
    /// Rows held out.
    pub held_out_rows: Vec<u32>,
    /// Joint values of its measurements with their sines and cosines.
    pub(super) packed: Arc<Packed>,
}

impl Calibration {
    /// Joint values of measurements; the stored ones for the data of the calibration.
    pub(crate) fn packed(&self, data: &Dataset) -> Arc<Packed> {
        if self.packed.is_of(&self.nominal, data) {
            return Arc::clone(&self.packed);
        }
        Arc::new(Packed::of(&self.nominal, data))
    }

    /// The session of these measurements and their joint values.
    pub(crate) fn session<'a>(&'a self, data: &'a Dataset, packed: &'a Packed) -> Session<'a> {
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

    /// Solves the least-squares problem of a finished calibration again, from the nominal (with an unknown device frame, the registered)
    /// model to the optimum: packing and minimisation, with the final noise and all fitted rows at full weight. For comparisons of solvers.
    #[must_use]
    pub fn solve_again(&self, data: &Dataset, options: &CalibrationOptions) -> solve::Summary {
        threads::in_pool(data.len(), || self.solved_again(data, options))
    }

    fn solved_again(&self, data: &Dataset, options: &CalibrationOptions) -> solve::Summary {
        let packed = Packed::of(&self.nominal, data);
        let session = self.session(data, &packed);
        let start = match self.frame {
            DeviceFrameKnowledge::Base => self.models.nominal.clone(),
            DeviceFrameKnowledge::Unknown => self.models.registered.clone(),
        };
        let prior = options.prior(&session);
        let looseness = |prior: &Prior| prior.looseness(&self.models.calibrated);
        let prior = prior.as_ref().map(|prior| (prior, 1.0 / looseness(prior)));
        fit_screws(session, &self.fit_rows, start, self.noise, prior, options).2
    }
}

/// The stations of the device.
pub(super) fn stations(session: &Session<'_>, estimate: &Estimate, noise: Noise) -> Vec<CalibratedStation> {
    let data = session.data;
    let of = |station| CalibratedStation {
        noise: session.usual_noise(station, noise),
        name: data.stations.get(station).cloned().flatten(),
        base_from_device: estimate.device_at_zero(station).inverse(),
    };
    (0..data.station_count()).map(of).collect()
}

/// The calibrated robot with its tip, and the targets in that tip. A single unnamed target becomes the tip (measured as points, with its
/// nominal orientation to the last joint), and so does a target, or an instrument, of the model at its very place; otherwise the tip keeps its nominal pose on
/// the last joint. Targets and instruments of the model with bodies of their own stay on these.
pub(super) fn place_tip(
    robot: &Robot,
    data: &Dataset,
    frames: &[bool],
    estimate: &Estimate,
) -> (Robot, Vec<CalibratedTarget>) {
    let mut calibrated = robot.with_screws(&estimate.screws());
    calibrated.terms.clone_from(&estimate.terms);
    calibrated.terms.retain(|it| it.coefficient != 0.0);
    let last_joint = calibrated.tip_body().joint().and_then(|joint| calibrated.joints.get(joint));
    calibrated.home =
        last_joint.map_or_else(Pose::identity, |joint| joint.frame) * robot.last_joint_from_tip();
    place_mounts(robot, &mut calibrated, data, frames, estimate);
    for (target, name) in data.targets.iter().enumerate() {
        if name.is_none() {
            let seen = estimate.base_from_target[target];
            let rotation = if frames[target] { seen.rotation } else { calibrated.home.rotation };
            calibrated.home = Pose::new(rotation, seen.translation);
        }
    }
    let tip_from_base = calibrated.home.inverse();
    let targets = data
        .targets
        .iter()
        .enumerate()
        .map(|(target, name)| {
            let is_frame = frames[target];
            let tip_from_target = tip_from_base * estimate.base_from_target[target];
            let rotation = if is_frame { tip_from_target.rotation } else { nalgebra::Matrix3::identity() };
            CalibratedTarget {
                name: name.clone(),
                is_frame,
                tip_from_target: Pose::new(rotation, tip_from_target.translation),
            }
        })
        .collect();
    (calibrated, targets)
}

/// Puts the measured targets and the instruments of the model to their calibrated places. A target at the tip moves it too, or else an
/// instrument there.
fn place_mounts(robot: &Robot, calibrated: &mut Robot, data: &Dataset, frames: &[bool], estimate: &Estimate) {
    // The unnamed target is the tip.
    let mut is_placed = data.targets.iter().any(Option::is_none);
    for (target, name) in data.targets.iter().enumerate() {
        let known = calibrated.mounted.iter().position(|mount| Some(&mount.name) == name.as_ref());
        if let Some(index) = known {
            let Mount { name, body, .. } = calibrated.mounted[index].clone();
            let seen = estimate.base_from_target[target];
            let nominal = calibrated.base_from(&calibrated.mounted[index]);
            let rotation = if frames[target] { seen.rotation } else { nominal.rotation };
            let pose = Pose::new(rotation, seen.translation);
            if !is_placed && robot.is_at_tip(&robot.mounted[index]) {
                is_placed = true;
                calibrated.home = pose;
            }
            calibrated.mounted[index] = calibrated.mount(&name, body, &pose);
        }
    }
    for (station, name) in data.stations.iter().enumerate() {
        let known = calibrated.instruments.iter().position(|mount| Some(&mount.name) == name.as_ref());
        if let Some(index) = known {
            let Mount { name, body, .. } = calibrated.instruments[index].clone();
            let pose = estimate.device_at_zero(station).inverse();
            if !is_placed && robot.is_at_tip(&robot.instruments[index]) {
                is_placed = true;
                calibrated.home = pose;
            }
            calibrated.instruments[index] = calibrated.mount(&name, body, &pose);
        }
    }
}
