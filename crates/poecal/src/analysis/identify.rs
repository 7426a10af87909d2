//! What measuring some configurations would tell, before anything is measured.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::coverage::{JointCoverage, coverage};
use super::identifiability::{Identifiability, identifiability};
use super::setup::Setup;
use super::spectrum::PLAUSIBLE;
use crate::error::{Error, ErrorKind, Result};
use crate::estimate::{Chain, Linkage, Packed, delivered, radian_m};
use crate::lie::Pose;
use crate::measurement::{Dataset, Measurement, Noise, PointMeasurement, PoseMeasurement};
use crate::parameters::{Parameter, TargetFrame, TargetPlace, screw_axes};
use crate::problem::{MOST_UNKNOWNS, Problem};
use crate::robot::Robot;
use crate::simulate::{Kind, random_configuration};
use crate::solve::LeastSquares;

/// Configurations in which the expected error is looked at, and their seed.
const CONFIGURATIONS: usize = 1000;
const SEED: u64 = 1;
/// A prediction is told if what is open, uncertain by what is plausible, moves it by no more than so many of its standard deviations.
const OPEN_EFFECT: f64 = 1.0;

/// What is to be measured, and how well.
///
/// ```
/// use poecal::{Kind, Session};
/// let session = Session { kind: Kind::Point, ..Session::default() };
/// assert!(session.device_free);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Session {
    /// What the device will see of the tip.
    pub kind: Kind,
    /// Its noise, each component.
    pub noise: Noise,
    /// Whether it stands anywhere, instead of measuring in the robot's base frame.
    pub device_free: bool,
}

impl Default for Session {
    /// Poses, 0.05 mm and 0.01°, anywhere.
    fn default() -> Self {
        let noise = Noise { position_m: 5e-5, rotation_rad: 0.01_f64.to_radians() };
        Session { kind: Kind::Pose, noise, device_free: true }
    }
}

/// The error of predicted tip positions that noise would leave, by the formal covariance at the nominal model: root mean square length
/// of the error vector in one configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedError {
    /// Random configurations looked at, within the joints' limits (±π and ±0.5 m where there are none).
    pub configurations: usize,
    /// Those among them whose prediction the measurements would tell; the others move with what is open.
    pub told: usize,
    /// Mean over those that are told, metres; `None` if none is.
    pub mean_m: Option<f64>,
    /// Largest among them, metres.
    pub worst_m: Option<f64>,
}

/// What configurations would tell.
///
/// ```
/// use poecal::{Kind, Session, Simulation, identify, simulate::elbow};
/// let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::Pose)?;
/// let foresight = identify(&made.nominal, made.data.all_readings(), &Session::default())?;
/// assert_eq!((foresight.count, foresight.identifiability.rank), (40, 30));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Foresight {
    /// Number of configurations.
    pub count: usize,
    /// What they would determine.
    pub identifiability: Identifiability,
    /// How much of each joint's range they sample.
    pub coverage: Vec<JointCoverage>,
    /// The expected error of predictions over the joint range.
    pub expected: ExpectedError,
    /// How many metres a radian counts.
    pub length_m: f64,
}

/// Judges configurations (readings one after the other, in the order of [`Robot::reading_names`]; radians, metres) before they are
/// measured: theory.md §7 (36), (36c). The robot is taken as its model has it, the noise as given.
///
/// # Errors
/// [`ErrorKind::Measurement`] if there is no configuration, the number of readings does not fit the robot, or one is not finite;
/// [`ErrorKind::Problem`] if the robot has more unknowns than a fit can bear.
///
/// ```
/// use poecal::analysis::{Session, identify};
/// use poecal::simulate::{Kind, Simulation, seven_axis};
/// let made = Simulation { count: 40, ..Simulation::default() }.run(&seven_axis(), Kind::Pose)?;
/// let found = identify(&seven_axis(), made.data.all_readings(), &Session::default())?;
/// assert_eq!((found.identifiability.rank, found.identifiability.parameters), (34, 34));
/// assert!(found.expected.mean_m.is_some_and(|mean| mean < 2e-4));
/// # Ok::<(), poecal::Error>(())
/// ```
pub fn identify(robot: &Robot, readings: &[f64], session: &Session) -> Result<Foresight> {
    let unknowns = 4 * robot.joints.len() + 6;
    if unknowns > MOST_UNKNOWNS {
        let message = format!(
            "found about {unknowns} unknowns of {} joints, expected at most {MOST_UNKNOWNS} in one fit: identify a \
             shorter chain",
            robot.joints.len()
        );
        return Err(Error::new(ErrorKind::Problem, message));
    }
    let data = imagined(robot, readings, session)?;
    let packed = Packed::of(robot, &data);
    let rows: Vec<u32> = data.all_rows();
    let length_m = radian_m(robot, &packed);
    let mut estimate = delivered(robot, &data);
    estimate.recentre(&data, &packed, &rows);
    let mut free = screw_axes(&estimate.kinds);
    free.push(match session.kind {
        Kind::Point => Parameter::TargetPlace(TargetPlace { target: 0 }),
        Kind::Pose | Kind::Mixed => Parameter::TargetFrame(TargetFrame { target: 0 }),
    });
    let problem = Problem::new(&data, &packed, rows.clone(), free, session.noise, length_m);
    let setup = Setup {
        robot,
        data: &data,
        packed: &packed,
        rows: &rows,
        estimate: &estimate,
        layout: problem.layout(),
        noise: session.noise,
        length_m,
        device_free: session.device_free,
    };
    let gram = problem.normal(&estimate).gram;
    if !gram.iter().all(|value| value.is_finite()) {
        let message = "found joint readings beyond what can be computed with, expected radians and metres: check their units";
        return Err(Error::new(ErrorKind::Measurement, message));
    }
    let identifiability = identifiability(&setup, &gram, 1.0);
    let expected = expected(&setup, &identifiability);
    Ok(Foresight {
        count: data.len(),
        coverage: coverage(robot, &packed, &rows),
        identifiability,
        expected,
        length_m,
    })
}

/// The measurements that the model as it is would give.
fn imagined(robot: &Robot, readings: &[f64], session: &Session) -> Result<Dataset> {
    let mut data = Dataset::new(robot.reading_names());
    let width = data.reading_names().len();
    if readings.is_empty() || !readings.len().is_multiple_of(width.max(1)) {
        let message = format!(
            "found {} joint readings, expected configurations of {width} readings each: {}",
            readings.len(),
            data.reading_names().join(", ")
        );
        return Err(Error::new(ErrorKind::Measurement, message));
    }
    for (row, readings) in readings.chunks_exact(width).enumerate() {
        let pose = robot.forward_kinematics(readings);
        let as_pose = match session.kind {
            Kind::Pose => true,
            Kind::Point => false,
            Kind::Mixed => row.is_multiple_of(2),
        };
        let measurement = if as_pose {
            Measurement::Pose(PoseMeasurement { pose })
        } else {
            Measurement::Point(PointMeasurement { position: pose.translation })
        };
        data.push(readings, None, measurement)?;
    }
    Ok(data)
}

/// The formal error of predicted positions on random configurations: theory.md §7 (36c).
fn expected(setup: &Setup<'_>, found: &Identifiability) -> ExpectedError {
    let robot = setup.robot;
    let mut generator = ChaCha8Rng::seed_from_u64(SEED);
    let readings: Vec<f64> =
        (0..CONFIGURATIONS).flat_map(|_| random_configuration(robot, &mut generator)).collect();
    let packed = Packed::new(robot, &readings, robot.reading_names().len());
    let mut estimate = setup.estimate.clone();
    estimate.device_from_base = Pose::identity();
    let linkage = Linkage::new(&estimate);
    let spectrum = &found.spectrum;
    let plausible_m = PLAUSIBLE * setup.length_m;
    let mut chain = Chain::default();
    let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); setup.layout.dim()];
    let mut told = Vec::new();
    for row in 0..packed.rows() {
        chain.evaluate(&linkage, &packed, row, 0);
        setup.layout.target_twists(&chain, 0, &mut twists);
        let (mut variance, mut open) = (0.0, 0.0);
        for (k, vector) in spectrum.vectors.column_iter().enumerate() {
            let moved: Vector3<f64> = vector.iter().zip(&twists).map(|(part, (v, _))| v * *part).sum();
            if k < spectrum.open {
                open += moved.norm_squared() * plausible_m * plausible_m;
            } else {
                variance += moved.norm_squared() * spectrum.sigma_m(k).powi(2);
            }
        }
        if open <= variance * OPEN_EFFECT * OPEN_EFFECT {
            told.push(variance.sqrt());
        }
    }
    let mean_m = (!told.is_empty()).then(|| told.iter().sum::<f64>() / told.len() as f64);
    let worst_m = told.iter().copied().reduce(f64::max);
    ExpectedError { configurations: CONFIGURATIONS, told: told.len(), mean_m, worst_m }
}
