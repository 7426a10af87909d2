//! Synthetic robots and measurements with seeded noise: for tests, for learning, and for planning.

mod configuration;
mod frameless_devices;
mod gross_errors;
mod pictures;
pub mod random;
mod robots;

pub use crate::measurement::SessionKind;
pub use configuration::{Configurations, random_configuration};
pub use frameless_devices::plan;
pub use gross_errors::GrossErrors;
pub use pictures::{PictureSimulation, SimulatedPictures};
pub use robots::{elbow, gantry, random_chain, scara, seven_axis};

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use crate::measurement::{Dataset, Measurement, Observation};
use crate::robot::{
    Body, CorrectionExtent, CorrectionModel, FactorReading, Joint, JointKind, Mount, Robot, Sizes, TermGroup,
};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{ErrorKind, Result};

/// A simulated measurement session.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::simulate::{SessionKind, elbow};
/// use poecal::Simulation;
/// let made = Simulation { count: 20, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// assert_eq!(made.data.len(), 20);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simulation {
    /// Angle by which each axis, and the tip, is turned, radians.
    pub error_rotation_rad: f64,
    /// Distance by which each axis, and the tip, is shifted, metres.
    pub error_position_m: f64,
    /// Standard deviation of each position component, metres.
    pub noise_position_m: f64,
    /// Standard deviation of each rotation component, radians.
    pub noise_rotation_rad: f64,
    /// Number of configurations.
    pub count: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// True if the device frame is unknown instead of equal to the robot's base.
    pub device_anywhere: bool,
    /// Root mean squares of the coefficients of the joints' terms beyond geometry.
    pub terms: Sizes,
    /// Direction of gravity, in the base frame.
    pub gravity: Vector3<f64>,
}

/// Message if no joint is between any instrument and any target.
const SAME_LINKS: &str =
    "found instruments and targets on the same links only, expected joints between them: name others";

/// Name of the temperature in simulated sessions.
const TEMPERATURE: &str = "temperature";
/// Range of the temperature, °C.
const TEMPERATURES: [f64; 2] = [18.0, 28.0];

/// Payloads, kg.
const PAYLOADS: [f64; 2] = [0.0, 5.0];

/// Value of a factor: the side from which a joint came from the configuration before, either side of all joints, a payload or none, or a
/// temperature.
fn value_of(
    factor: &FactorReading,
    names: &[String],
    [readings, before]: [&[f64]; 2],
    generator: &mut ChaCha8Rng,
) -> f64 {
    let Some(of) = factor.approached_joint() else {
        if factor.is_payload() {
            return PAYLOADS[usize::from(random::uniform_number(generator) < 0.5)];
        }
        return TEMPERATURES[0] + (TEMPERATURES[1] - TEMPERATURES[0]) * random::uniform_number(generator);
    };
    let came = match names.iter().position(|name| name == of) {
        Some(at) => readings[at] - before[at],
        None => random::uniform_number(generator) - 0.5,
    };
    if came < 0.0 { -1.0 } else { 1.0 }
}

impl Default for Simulation {
    fn default() -> Self {
        Simulation {
            error_rotation_rad: 1f64.to_radians(),
            error_position_m: 2e-3,
            noise_position_m: 5e-5,
            noise_rotation_rad: 0.01f64.to_radians(),
            count: 50,
            seed: 1,
            device_anywhere: true,
            terms: Sizes::NONE,
            gravity: -Vector3::z(),
        }
    }
}

/// A simulated session with its truth.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::SessionKind;
/// #     pub use poecal_model::simulate::Simulation;
/// #     pub use poecal_model::simulate;
/// # }
/// use poecal::{SessionKind, Simulation};
/// use poecal::simulate::scara;
/// let made = Simulation::default().run(&scara(), SessionKind::POINT)?;
/// let readings = made.data.readings(0);
/// let tip = made.device_from_base * made.actual.forward_kinematics(readings);
/// let seen = made.data.observations[0].measurement.pose();
/// // The device measures the actual robot's tip, up to its noise.
/// assert!((tip.translation - seen.translation).norm() < 1e-3);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationResult {
    /// The nominal robot.
    pub nominal: Robot,
    /// The actual robot.
    pub actual: Robot,
    /// `device_from_base` of the truth.
    pub device_from_base: Pose,
    /// The measurements.
    pub data: Dataset,
}

impl Simulation {
    /// Simulates a robot that deviates from `nominal`, measured in random configurations within its limits (±π and ±0.5 m without
    /// limits). Each instrument on the robot measures each target with a body of its own in turn. Without instruments a device beside the
    /// robot measures, and without such targets the tip is measured.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if instruments and targets are on the same links only; otherwise does not fail for a finite robot.
    pub fn run(&self, nominal: &Robot, kind: SessionKind) -> Result<SimulationResult> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        let nominal = &self.with_factors(nominal)?;
        let actual = self.perturb(nominal, &mut generator);
        let actual = self.with_random_terms(actual);
        self.measure(nominal, actual, kind, &mut generator)
    }

    /// The robot with the factors of its terms: the side from which each revolute joint is approached, the temperature, and the payload.
    fn with_factors(&self, nominal: &Robot) -> Result<Robot> {
        let turns = |joint: &&Joint| joint.kind == JointKind::Revolute && joint.reading.name == joint.name;
        let approached =
            nominal.joints.iter().filter(turns).map(|joint| format!("{}_{}", FactorReading::APPROACH, joint.name));
        let sides = approached.filter(|_| self.terms[TermGroup::Backlash] > 0.0);
        let warmth = (self.terms[TermGroup::Factors] > 0.0).then(|| TEMPERATURE.to_owned());
        let payload = (self.terms[TermGroup::Payload] > 0.0).then(|| FactorReading::PAYLOAD.to_owned());
        let missing = |name: &String| !nominal.factors.iter().any(|it| it.name == *name);
        nominal.with_factors(&sides.chain(warmth).chain(payload).filter(missing).collect::<Vec<_>>())
    }

    /// The robot with terms of random coefficients, positive ones under weight; unchanged if there are none.
    fn with_random_terms(&self, robot: Robot) -> Robot {
        if self.terms == Sizes::NONE {
            return robot;
        }
        // It is a further stream of the seed, so that all else does not depend on the terms.
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(2);
        let every = vec![true; robot.joints.len()];
        let extent = CorrectionExtent { gives: self.terms.gives(), ..CorrectionExtent::default() };
        let model = CorrectionModel::new(&robot, self.gravity, &every, extent).with_sizes(&self.terms);
        let deviations: Vec<f64> = model.deviations(&self.terms).collect();
        let own = model.robot.terms.len() - deviations.len();
        let mut robot = model.robot;
        for (term, deviation) in robot.terms.iter_mut().skip(own).zip(deviations) {
            let drawn = random::normal(&mut generator);
            // Joints yield in the direction of the torque.
            term.coefficient = deviation * if term.term.needs_gravity() { drawn.abs() } else { drawn };
        }
        robot
    }

    /// Measures an actual robot.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if instruments and targets are on the same links only; otherwise does not fail for a finite robot.
    pub fn measure(
        &self,
        nominal: &Robot,
        actual: Robot,
        kind: SessionKind,
        generator: &mut ChaCha8Rng,
    ) -> Result<SimulationResult> {
        let device_from_base = if self.device_anywhere {
            let turn = random::rotation(generator);
            Pose::new(turn, random::direction(generator) * 3.0)
        } else {
            Pose::identity()
        };
        let data = self.observe(nominal, &actual, &device_from_base, kind, generator)?;
        Ok(SimulationResult { nominal: nominal.clone(), actual, device_from_base, data })
    }

    /// Further configurations of a simulated session, free of noise, to judge the predictions of a calibration.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if instruments and targets are on the same links only; otherwise does not fail for a finite robot.
    pub fn held_out(&self, made: &SimulationResult, kind: SessionKind, count: usize) -> Result<Dataset> {
        // It is another stream of the same seed, so that these rows do not depend on the number of measured ones.
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(1);
        let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, count, ..*self };
        exact.observe(&made.nominal, &made.actual, &made.device_from_base, kind, &mut generator)
    }

    fn observe(
        &self,
        nominal: &Robot,
        actual: &Robot,
        device_from_base: &Pose,
        kind: SessionKind,
        generator: &mut ChaCha8Rng,
    ) -> Result<Dataset> {
        if !kind.has_device() {
            return self.observe_places(nominal, actual, kind, generator);
        }
        let mut data = Dataset::new(nominal.reading_names()).with_factors(nominal.factors.len());
        let configurations = Configurations::new(nominal);
        let pairs = pairs(actual);
        if pairs.is_empty() {
            return ErrorKind::Problem.refuse(SAME_LINKS);
        }
        let mut before = vec![0.0; data.reading_names().len()];
        for row in 0..self.count {
            let mut readings = configurations.random(generator);
            let first = readings.len() - nominal.factors.len();
            for (at, factor) in nominal.factors.iter().enumerate() {
                readings[first + at] = value_of(factor, data.reading_names(), [&readings, &before], generator);
            }
            before.clone_from(&readings);
            let (instrument, target) = pairs.get(row % pairs.len().max(1)).copied().unwrap_or_default();
            let seen = match (instrument, target) {
                (None, None) => *device_from_base * actual.forward_kinematics(&readings),
                _ => instrument_from_target(actual, device_from_base, (instrument, target), &readings),
            };
            let length = random::normal_vector(generator) * self.noise_position_m;
            let measurement = self.measure_with_noise(kind, &seen, (row, length, 0.0), generator);
            let (target, station) = (
                data.target_index(target.map(|mount| mount.name.as_str())),
                instrument.map_or(0, |mount| data.station_index(Some(&mount.name))),
            );
            let observation = Observation { station, ..Observation::new(target, measurement) };
            data.push_observation(&readings, observation)?;
        }
        Ok(data)
    }

    /// A robot whose every axis, tip, instrument and target is turned and shifted by the stated amounts in random directions, about its own
    /// origin.
    pub fn perturb(&self, nominal: &Robot, generator: &mut ChaCha8Rng) -> Robot {
        let mut motion_about = |point: &Vector3<f64>| {
            let turn = rotation::exp(&(random::direction(generator) * self.error_rotation_rad));
            let shift = random::direction(generator) * self.error_position_m;
            Pose::new(turn, point + shift - turn * point)
        };
        let screws: Vec<_> =
            nominal.joints.iter().map(|joint| joint.screw.transform(&motion_about(&joint.frame.translation))).collect();
        let mut actual = nominal.with_screws(&screws);
        actual.home = motion_about(&nominal.home.translation) * nominal.home;
        let mut moved = |mount: &Mount| {
            let place = actual.base_from(mount);
            let motion = motion_about(&place.translation);
            actual.mount(&mount.name, mount.body, &(motion * place))
        };
        let mounted: Vec<Mount> = actual.mounted.iter().map(&mut moved).collect();
        let instruments: Vec<Mount> = actual.instruments.iter().map(&mut moved).collect();
        (actual.mounted, actual.instruments) = (mounted, instruments);
        // A target at the tip is the tip, or else an instrument there.
        let at_tip = |mounts: &[Mount]| mounts.iter().position(|mount| nominal.is_at_tip(mount));
        if let Some(at) = at_tip(&nominal.mounted) {
            actual.home = actual.base_from(&actual.mounted[at]);
        } else if let Some(at) = at_tip(&nominal.instruments) {
            actual.home = actual.base_from(&actual.instruments[at]);
        }
        actual.name = format!("{}_actual", nominal.name);
        actual
    }
}

/// Measurement of a target by a kind of session, without noise.
pub fn exact_measurement(kind: SessionKind, row: usize, target: &Pose) -> Measurement {
    let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
    let mut generator = ChaCha8Rng::seed_from_u64(exact.seed);
    exact.measure_with_noise(kind, target, (row, Vector3::zeros(), 0.0), &mut generator)
}

/// Pairs of an instrument on the robot and a target with a body of its own; `None` is the device beside the robot, and the tip. Empty if both
/// are all there is. Instruments do not see targets on their own bodies.
pub fn pairs(robot: &Robot) -> Vec<(Option<&Mount>, Option<&Mount>)> {
    let some_or_none = |mounts: &'_ [Mount]| mounts.is_empty().then_some(None);
    let instruments = || some_or_none(&robot.instruments).into_iter().chain(robot.instruments.iter().map(Some));
    let targets = || some_or_none(&robot.mounted).into_iter().chain(robot.mounted.iter().map(Some));
    let body = |target: Option<&Mount>| target.map_or_else(|| robot.tip_body(), |mount| mount.body);
    let moves = |(instrument, target): &(Option<&Mount>, Option<&Mount>)| {
        instrument.map_or(Body::Base, |mount| mount.body) != body(*target)
    };
    instruments().flat_map(|instrument| targets().map(move |target| (instrument, target))).filter(moves).collect()
}

/// `instrument_from_target`; without an instrument, as measured by the device beside the robot.
pub fn instrument_from_target(
    robot: &Robot,
    device_from_base: &Pose,
    (instrument, target): (Option<&Mount>, Option<&Mount>),
    readings: &[f64],
) -> Pose {
    let base_from = |mount: &Mount| base_from(robot, mount, readings);
    let base_from_target = target.map_or_else(|| robot.forward_kinematics(readings), base_from);
    let instrument_from_base = instrument.map_or(*device_from_base, |mount| base_from(mount).inverse());
    instrument_from_base * base_from_target
}

/// A target or an instrument of a robot in the base frame.
fn base_from(robot: &Robot, mount: &Mount, readings: &[f64]) -> Pose {
    robot.motion_of(mount.body, &robot.joint_values(readings)) * robot.base_from(mount)
}
