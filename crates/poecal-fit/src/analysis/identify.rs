//! Identifiability of planned configurations, before the measurement.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::coverage::{JointCoverage, coverage};
use super::identifiability::{Identifiability, identifiability};
use super::setup::AnalysisSetup;
use super::spectrum::PLAUSIBLE;
use crate::parameters::{Parameter, screw_axes};
use crate::problem::{MOST_UNKNOWNS, Problem};
use crate::start::{Registration, clock_parameters, device_parameter, range_parameters, register, target_parameters};
use crate::state::{Estimate, Linkage, PackedValues, RowChain, Session, nominal_estimate};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Dataset, Noise, Observation};
use poecal_model::robot::Robot;
use poecal_model::simulate::{
    SessionKind, exact_measurement, instrument_from_target, pairs, plan, random_configuration,
};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::solve::LeastSquares;

/// Number of random configurations for the expected error, and their seed.
const CONFIGURATIONS: usize = 1000;
const SEED: u64 = 1;
/// A prediction is determined if undetermined directions, uncertain by [`PLAUSIBLE`], move it by at most this many of its
/// standard deviations.
const UNDETERMINED_EFFECT: f64 = 1.0;

/// A planned session: measurements and their noise.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::SessionKind;
/// #     pub use poecal_fit::analysis::PlannedSession;
/// # }
/// use poecal::{SessionKind, PlannedSession};
/// let planned = PlannedSession { kind: SessionKind::POINT, ..PlannedSession::default() };
/// assert!(planned.device_free);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedSession {
    /// Kind of the measurements of the tip, or of the targets.
    pub kind: SessionKind,
    /// Noise of each component.
    pub noise: Noise,
    /// True if the device frame is unknown; otherwise measurements are in the robot's base frame.
    pub device_free: bool,
}

impl Default for PlannedSession {
    /// Poses with 0.05 mm and 0.01°, device frame unknown.
    fn default() -> Self {
        let noise = Noise::new(5e-5, 0.01_f64.to_radians());
        PlannedSession { kind: SessionKind::POSE, noise, device_free: true }
    }
}

/// Expected error of predicted tip positions by noise alone, from the covariance at the nominal model: root mean square length of the error
/// vector in one configuration (theory.md §7 (36c)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedError {
    /// Number of random configurations within the joints' limits (±π and ±0.5 m without limits).
    pub configurations: usize,
    /// Number of those whose prediction the measurements determine.
    pub determined: usize,
    /// Mean over these, metres; `None` if there are none.
    pub mean_m: Option<f64>,
    /// Largest of these, metres.
    pub worst_m: Option<f64>,
}

/// Expected result of measuring some configurations.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::SessionKind;
/// #     pub use poecal_fit::analysis::{PlannedSession, identify};
/// #     pub use poecal_model::simulate::Simulation;
/// #     pub use poecal_model::simulate;
/// # }
/// use poecal::{SessionKind, PlannedSession, identify, Simulation};
/// use poecal::simulate::elbow;
/// let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// let foresight = identify(&made.nominal, made.data.all_readings(), &PlannedSession::default())?;
/// assert_eq!((foresight.count, foresight.identifiability.rank), (40, 30));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedUncertainty {
    /// Number of configurations.
    pub count: usize,
    /// Identifiability.
    pub identifiability: Identifiability,
    /// Coverage of each joint's range.
    pub coverage: Vec<JointCoverage>,
    /// Expected error of predictions within the joint limits.
    pub expected: ExpectedError,
    /// Metres that a radian counts.
    pub length_m: f64,
    /// The pictures by which the configurations are judged, if there are any.
    pub pictures: Option<MeasuredPictures>,
}

/// Pictures whose corners determine how accurate their poses are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPictures {
    /// Number of pictures.
    pub count: usize,
    /// Number of corners in all of them.
    pub corners: usize,
    /// Standard deviation of each coordinate of a corner that states none, pixels.
    pub sigma_px: f64,
    /// Standard deviations of each component of the shift (m) and the turn (rad) that the corners of a picture share: usual values before a
    /// calibration.
    pub shared: [f64; 2],
}

/// Expected result of measuring some configurations, before they are measured: theory.md §7 (36), (36c), with the nominal model and the stated noise.
/// Every instrument on the robot measures every target of the model; a device beside the robot measures the tip. `readings` are one after the other,
/// in the order of [`Robot::reading_names`] (radians, metres).
///
/// # Errors
/// [`ErrorKind::Measurement`] if there is no configuration, the number of readings does not fit the robot, or one is not finite;
/// [`ErrorKind::Problem`] if the robot has more unknowns than one fit allows.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_fit::analysis::{PlannedSession, identify};
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::{PlannedSession, identify, Simulation};
/// use poecal::simulate::{SessionKind, seven_axis};
/// let made = Simulation { count: 40, ..Simulation::default() }.run(&seven_axis(), SessionKind::POSE)?;
/// let found = identify(&seven_axis(), made.data.all_readings(), &PlannedSession::default())?;
/// assert_eq!((found.identifiability.rank, found.identifiability.parameters), (34, 34));
/// assert!(found.expected.mean_m.is_some_and(|mean| mean < 2e-4));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
pub fn identify(robot: &Robot, readings: &[f64], planned: &PlannedSession) -> Result<ExpectedUncertainty> {
    let frames = robot.instruments.len().saturating_sub(1) + robot.mounted.len().max(1);
    check_unknowns(robot, frames)?;
    if planned.kind.is_touched() {
        return ErrorKind::Option.refuse(format!(
            "found the kind `{}` and configurations alone, expected a measurement file that names what each row touches",
            planned.kind.word()
        ));
    }
    let (data, devices) = predicted_data(robot, readings, planned)?;
    let mut estimate = nominal_estimate(robot, &data);
    for (station, device) in devices.into_iter().enumerate() {
        *estimate.device_mut(station) = device;
    }
    let count = readings.len() / robot.reading_names().len().max(1);
    Ok(ExpectedUncertainty { count, ..foresee(robot, &data, estimate, planned)? })
}

/// The same for rows that state more than a configuration (`poecal_import` reads them). Pictures count as their corners determine their poses.
/// Rows may touch balls in sockets, points and faces on planes, or points of spheres. Cameras, boards and touched objects are placed where the
/// nominal robot has them best.
///
/// # Errors
/// As [`identify`].
pub fn identify_measured(robot: &Robot, data: &Dataset, planned: &PlannedSession) -> Result<ExpectedUncertainty> {
    check_unknowns(robot, data.station_count() + data.targets.len())?;
    let packed = PackedValues::from_dataset(robot, data);
    let rows: Vec<u32> = data.all_rows();
    let session = Session::new(robot, data, &packed, planned.device_free);
    let registration = Registration { session, rows: &rows, noise: planned.noise, targets_free: false, prior: None };
    let estimate = register(&registration, &nominal_estimate(robot, data)).0;
    let pictures = (!data.pictures.is_empty()).then(|| MeasuredPictures {
        count: data.pictures.all.len(),
        corners: data.pictures.all.iter().map(|it| it.corners.len()).sum(),
        sigma_px: data.pictures.sigma_px,
        shared: [data.pictures.common.shift_m, data.pictures.common.turn_rad],
    });
    Ok(ExpectedUncertainty { pictures, ..foresee(robot, data, estimate, planned)? })
}

/// Refuses robots with more unknowns than one fit allows.
fn check_unknowns(robot: &Robot, frames: usize) -> Result<()> {
    let unknowns = 4 * robot.joints.len() + 6 * frames;
    if unknowns <= MOST_UNKNOWNS {
        return Ok(());
    }
    ErrorKind::Problem.refuse(format!(
        "found about {unknowns} unknowns of {} joints, expected at most {MOST_UNKNOWNS} in one fit: identify a \
         shorter chain",
        robot.joints.len()
    ))
}

/// Expected result of data, at an estimate that predicts them.
fn foresee(
    robot: &Robot,
    data: &Dataset,
    mut estimate: Estimate,
    planned: &PlannedSession,
) -> Result<ExpectedUncertainty> {
    let packed = PackedValues::from_dataset(robot, data);
    let rows: Vec<u32> = data.all_rows();
    let session = Session::new(robot, data, &packed, planned.device_free);
    estimate.recentre(&session, &rows);
    let mut free = screw_axes(estimate.kinds());
    free.extend(target_parameters(&session, &rows));
    // The first instrument's frame is a choice of the base.
    let further = (1..data.station_count()).filter(|&station| estimate.tree.shared_target(station).is_none());
    free.extend(further.map(|station| device_parameter(data, station, &rows)));
    free.extend(range_parameters(&session, &rows).map(Parameter::RangeUnknown));
    free.extend(clock_parameters(&session, &rows).map(Parameter::ClockUnknown));
    let problem = Problem::new(session, rows.clone(), free, planned.noise);
    let setup =
        AnalysisSetup { session, rows: &rows, estimate: &estimate, layout: problem.layout(), noise: planned.noise };
    let gram = problem.normal(&estimate).gram;
    if !gram.iter().all(|value| value.is_finite()) {
        return ErrorKind::Measurement.refuse(
            "found joint readings beyond what can be computed with, expected radians and metres: check their units",
        );
    }
    let identifiability = identifiability(&setup, &gram, 1.0);
    let expected = predict_error(&setup, &identifiability);
    Ok(ExpectedUncertainty {
        count: data.len(),
        coverage: coverage(&session, &rows),
        identifiability,
        expected,
        length_m: session.length_m,
        pictures: None,
    })
}

/// The measurements that the nominal model predicts, and device frames that are not the model's.
pub fn predicted_data(robot: &Robot, readings: &[f64], planned: &PlannedSession) -> Result<(Dataset, Vec<Pose>)> {
    let mut data = Dataset::new(robot.reading_names());
    let width = data.reading_names().len();
    if readings.is_empty() || !readings.len().is_multiple_of(width.max(1)) {
        return ErrorKind::Measurement.refuse(format!(
            "found {} joint readings, expected configurations of {width} readings each: {}",
            readings.len(),
            data.reading_names().join(", ")
        ));
    }
    if !planned.kind.has_device() {
        return plan(planned.kind, robot, readings);
    }
    let pairs = pairs(robot);
    if pairs.is_empty() {
        return ErrorKind::Problem
            .refuse("found instruments and targets on the same links only, expected joints between them: name others");
    }
    let planned_rows = readings.chunks_exact(width).enumerate();
    let planned_rows = planned_rows.flat_map(|(row, readings)| pairs.iter().map(move |&pair| (row, readings, pair)));
    for (row, readings, (instrument, target)) in planned_rows {
        let pose = match (instrument, target) {
            (None, None) => robot.forward_kinematics(readings),
            pair => instrument_from_target(robot, &Pose::identity(), pair, readings),
        };
        let measurement = exact_measurement(planned.kind, row, &pose);
        let station = instrument.map_or(0, |mount| data.station_index(Some(&mount.name)));
        let target = data.target_index(target.map(|mount| mount.name.as_str()));
        let observation = Observation { station, ..Observation::new(target, measurement) };
        data.push_observation(readings, observation)?;
    }
    Ok((data, Vec::new()))
}

/// Expected error of predicted positions in random configurations: theory.md §7 (36c).
fn predict_error(setup: &AnalysisSetup<'_>, found: &Identifiability) -> ExpectedError {
    let robot = setup.session.robot;
    let mut generator = ChaCha8Rng::seed_from_u64(SEED);
    let readings: Vec<f64> = (0..CONFIGURATIONS).flat_map(|_| random_configuration(robot, &mut generator)).collect();
    let packed = PackedValues::new(robot, &readings, robot.reading_names().len());
    let mut estimate = setup.estimate.clone();
    estimate.device_from_base = Pose::identity();
    let linkage = Linkage::new(&estimate);
    let spectrum = &found.spectrum;
    let plausible_m = PLAUSIBLE * setup.session.length_m;
    let mut chain = RowChain::default();
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); setup.layout.dim()];
    let mut sigmas_m = Vec::new();
    for row in 0..packed.rows() {
        chain.evaluate(&linkage, &packed, row, 0);
        setup.layout.target_twists(&chain, 0, &mut twists);
        let (mut variance, mut undetermined) = (0.0, 0.0);
        for (k, vector) in spectrum.vectors.column_iter().enumerate() {
            let moved: Vector3<f64> = vector.iter().zip(&twists).map(|(part, (v, _))| v * *part).sum();
            if k < spectrum.undetermined {
                undetermined += moved.norm_squared() * plausible_m * plausible_m;
            } else {
                variance += moved.norm_squared() * spectrum.sigma_m(k).powi(2);
            }
        }
        if undetermined <= variance * UNDETERMINED_EFFECT * UNDETERMINED_EFFECT {
            sigmas_m.push(variance.sqrt());
        }
    }
    let mean_m = (!sigmas_m.is_empty()).then(|| sigmas_m.iter().sum::<f64>() / sigmas_m.len() as f64);
    let worst_m = sigmas_m.iter().copied().reduce(f64::max);
    ExpectedError { configurations: CONFIGURATIONS, determined: sigmas_m.len(), mean_m, worst_m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::{Simulation, elbow};

    /// The rank is that of a calibration by them: 4 of each of six joints and 2 more; the size of the robot stays undetermined.
    #[test]
    fn balls_in_sockets_have_the_rank_of_the_closed_form() {
        let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::SOCKET).unwrap();
        let planned = PlannedSession { kind: SessionKind::SOCKET, ..PlannedSession::default() };
        let found = identify_measured(&elbow(), &made.data, &planned).unwrap();
        assert_eq!(found.identifiability.rank, 26);
    }
}
