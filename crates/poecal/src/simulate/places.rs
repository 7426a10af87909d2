//! Sessions of devices without a frame of their own: anchors, sockets, planes, spheres, gravity, and pairs of configurations.

use nalgebra::{DMatrix, DVector, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{Configurations, Kind, Simulation, random};
use crate::error::{Error, ErrorKind, Result};
use crate::lie::{Pose, rotation};
use crate::linalg;
use crate::measurement::{
    Dataset, DirectionMeasurement, DistanceMeasurement, FlushMeasurement, HeightMeasurement, Measurement,
    NUMBERS, Observation, PoseMeasurement, SocketMeasurement,
};
use crate::robot::Robot;

/// Distance of the two sockets, metres.
const SOCKETS_APART_M: f64 = 0.2;
/// Radius of the sphere, metres.
const SPHERE_M: f64 = 0.05;
/// Range of the gauge that shows heights, metres.
const GAUGE_M: f64 = 0.02;
/// Random configurations from which one that fulfils a constraint is sought, Newton steps from each, and the largest change of a joint.
const ATTEMPTS: usize = 2000;
const STEPS: usize = 40;
const LARGEST: f64 = 0.4;
/// Residual of a constraint that is fulfilled, metres and radians.
const FULFILLED: f64 = 1e-13;
/// Change of a reading for a difference.
const DIFFERENCE: f64 = 1e-6;

/// A place from which a session measures.
struct Place {
    name: &'static str,
    device_from_base: Pose,
    /// Zero of an instrument's distances, metres.
    zero_m: f64,
}

impl Kind {
    /// Number of places from which a session of this kind measures; none of a device with a frame.
    fn places(self) -> usize {
        match self {
            Kind::Pose | Kind::Point | Kind::Mixed => 0,
            Kind::Distance | Kind::Change | Kind::Plane | Kind::Height | Kind::Flush => 3,
            Kind::Socket => 2,
            Kind::Sphere | Kind::Direction | Kind::BallBar | Kind::Relative => 1,
        }
    }

    /// Whether each measurement is of two configurations.
    fn is_paired(self) -> bool {
        self == Kind::BallBar || self == Kind::Relative
    }

    /// Whether its configurations fulfil a constraint: something is touched in each.
    #[must_use]
    pub fn is_touched(self) -> bool {
        match self {
            Kind::Socket | Kind::Plane | Kind::Height | Kind::Flush | Kind::Sphere => true,
            Kind::Pose
            | Kind::Point
            | Kind::Mixed
            | Kind::Distance
            | Kind::Change
            | Kind::Direction
            | Kind::BallBar
            | Kind::Relative => false,
        }
    }
}

impl Kind {
    /// What a robot would measure in some configurations, by a kind that is neither of a device with a frame nor touches anything: rows, and the
    /// frames of the instruments, which are somewhere around it.
    pub(crate) fn plan(self, robot: &Robot, readings: &[f64]) -> Result<(Dataset, Vec<Pose>)> {
        let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
        let mut generator = ChaCha8Rng::seed_from_u64(exact.seed);
        let mut data = Dataset::new(robot.reading_names());
        let target = data.target_index(None);
        let places = exact.places(robot, self);
        let is_paired = self.is_paired();
        let width = data.reading_names().len().max(1) * if is_paired { 2 } else { 1 };
        for (row, own) in readings.chunks_exact(width).enumerate() {
            let place = &places[row % places.len()];
            let (first, own) = own.split_at(if is_paired { width / 2 } else { 0 });
            let tip = robot.forward_kinematics(own);
            let mut observation = Observation::new(target, Measurement::Socket(SocketMeasurement::default()));
            observation.station = data.station_index(Some(place.name));
            let device_from_base = if is_paired {
                observation.from = Some(data.push_further(first)?);
                robot.forward_kinematics(first).inverse()
            } else {
                place.device_from_base
            };
            observation.measurement = exact.seen(self, place, &(device_from_base * tip), &mut generator);
            data.push_observation(own, observation)?;
        }
        let devices =
            if is_paired { Vec::new() } else { places.iter().map(|it| it.device_from_base).collect() };
        Ok((data, devices))
    }
}

impl Simulation {
    /// Measurements of a kind without a device frame. Places do not depend on the generator, so that further rows have the same.
    pub(super) fn observe_places(
        &self,
        nominal: &Robot,
        actual: &Robot,
        kind: Kind,
        generator: &mut ChaCha8Rng,
    ) -> Result<Dataset> {
        let places = self.places(actual, kind);
        let mut data = Dataset::new(nominal.reading_names());
        let configurations = Configurations::new(nominal);
        let target = data.target_index(None);
        for row in 0..self.count {
            let place = &places[row % places.len()];
            let station = data.station_index(Some(place.name));
            let mut observation = Observation::new(target, Measurement::Socket(SocketMeasurement::default()));
            observation.station = station;
            let readings = if kind.is_touched() {
                let found = self.touching(actual, &configurations, kind, place, generator)?;
                observation.measurement = found.1;
                found.0
            } else {
                let readings = configurations.random(generator);
                let tip = actual.forward_kinematics(&readings);
                let device_from_base = if kind.is_paired() {
                    let other = configurations.random(generator);
                    observation.from = Some(data.push_further(&other)?);
                    actual.forward_kinematics(&other).inverse()
                } else {
                    place.device_from_base
                };
                observation.measurement = self.seen(kind, place, &(device_from_base * tip), generator);
                readings
            };
            data.push_observation(&readings, observation)?;
        }
        Ok(data)
    }

    /// The places of a kind.
    fn places(&self, actual: &Robot, kind: Kind) -> Vec<Place> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(3);
        let names: &[&'static str] = match kind {
            Kind::Pose | Kind::Point | Kind::Mixed => &[""],
            Kind::Distance | Kind::Change => &["wall", "floor", "door"],
            Kind::Plane | Kind::Height | Kind::Flush => &["table", "side", "front"],
            Kind::Socket => &["left", "right"],
            Kind::Sphere => &["ball"],
            Kind::Direction => &["gravity"],
            Kind::BallBar | Kind::Relative => &["pair"],
        };
        let configurations = Configurations::new(actual);
        let middle = self.middle(actual, &configurations, &mut generator);
        let apart = random::direction(&mut generator) * SOCKETS_APART_M;
        let place = |(index, &name): (usize, &&'static str)| {
            let turn = random::rotation(&mut generator);
            let (point, turn) = if matches!(kind, Kind::Distance | Kind::Change) {
                (random::direction(&mut generator) * (1.5 * actual.reach_m()), turn)
            } else if kind == Kind::Socket {
                (middle + apart * index as f64, turn)
            } else if kind == Kind::Direction {
                // Gravity is nearly along the base's z.
                (Vector3::zeros(), rotation::exp(&(random::direction(&mut generator) * 0.02)))
            } else {
                (middle, turn)
            };
            let is_counted = kind == Kind::Change;
            let zero_m = if is_counted { random::uniform(&mut generator) - 0.5 } else { 0.0 };
            Place { name, device_from_base: Pose::new(turn, -(turn * point)), zero_m }
        };
        names.iter().take(kind.places().max(1)).enumerate().map(place).collect()
    }

    /// A point that the tip reaches well: the middle of its places.
    fn middle(
        &self,
        actual: &Robot,
        configurations: &Configurations,
        generator: &mut ChaCha8Rng,
    ) -> Vector3<f64> {
        const SOME: usize = 20;
        let tips =
            (0..SOME).map(|_| actual.forward_kinematics(&configurations.random(generator)).translation);
        let tips: Vec<Vector3<f64>> = tips.collect();
        let outward = tips
            .iter()
            .map(|tip| Vector3::new(tip.x, tip.y, 0.0))
            .fold(Vector3::zeros(), |most, it| if it.norm() > most.norm() { it } else { most });
        let height = tips.iter().map(|tip| tip.z).sum::<f64>() / SOME as f64;
        outward * 0.7 + Vector3::z() * height
    }

    /// What a device sees of a target.
    fn seen(&self, kind: Kind, place: &Place, target: &Pose, generator: &mut ChaCha8Rng) -> Measurement {
        let length_m = random::normal(generator) * self.noise_position_m;
        let turn = random::normal_vector(generator) * self.noise_rotation_rad;
        let distance = target.translation.norm() + length_m;
        if kind == Kind::Change {
            let reading = distance + place.zero_m;
            return Measurement::Distance(DistanceMeasurement::from_unknown_zero(reading));
        }
        if kind == Kind::Direction {
            let up = (rotation::exp(&turn) * target.rotation).row(2).transpose();
            return Measurement::Direction(DirectionMeasurement::along(&up));
        }
        if kind == Kind::Relative {
            let shift = random::normal_vector(generator) * self.noise_position_m;
            let pose = Pose::new(rotation::exp(&turn) * target.rotation, target.translation + shift);
            return Measurement::Pose(PoseMeasurement { pose });
        }
        Measurement::Distance(DistanceMeasurement::new(distance))
    }

    /// A configuration in which the tip touches a place, up to the noise, with what is said of it.
    fn touching(
        &self,
        actual: &Robot,
        configurations: &Configurations,
        kind: Kind,
        place: &Place,
        generator: &mut ChaCha8Rng,
    ) -> Result<(Vec<f64>, Measurement)> {
        let length = random::normal_vector(generator) * self.noise_position_m;
        let turn = random::normal_vector(generator) * self.noise_rotation_rad;
        let flush = |height, normal| Measurement::Flush(FlushMeasurement { height, normal });
        let (exact, said) = if kind == Kind::Plane {
            (
                Measurement::Height(HeightMeasurement { height: length.x }),
                Measurement::Height(HeightMeasurement { height: 0.0 }),
            )
        } else if kind == Kind::Height {
            let height = random::uniform(generator) * GAUGE_M;
            (
                Measurement::Height(HeightMeasurement { height: height + length.x }),
                Measurement::Height(HeightMeasurement { height }),
            )
        } else if kind == Kind::Flush {
            let normal = DirectionMeasurement::of_tilts([turn.x, turn.y]).direction;
            (flush(length.x, normal), flush(0.0, Vector3::z()))
        } else if kind == Kind::Sphere {
            (
                Measurement::Distance(DistanceMeasurement::new(SPHERE_M + length.x)),
                Measurement::Distance(DistanceMeasurement::from_unknown_zero(0.0)),
            )
        } else {
            (
                Measurement::Socket(SocketMeasurement { place: length }),
                Measurement::Socket(SocketMeasurement::default()),
            )
        };
        for _ in 0..ATTEMPTS {
            let start = configurations.random(generator);
            if let Some(found) = fulfilling(actual, &start, &place.device_from_base, &exact)
                && configurations.contain(&found)
            {
                return Ok((found, said));
            }
        }
        let message = format!(
            "found no configuration within the joints' limits in which the tip touches `{}`, expected a robot that reaches it",
            place.name
        );
        Err(Error::new(ErrorKind::Problem, message))
    }
}

/// Readings near these with which a measurement fits exactly, by Newton's method with the least change of the joints.
fn fulfilling(
    robot: &Robot,
    start: &[f64],
    device_from_base: &Pose,
    exact: &Measurement,
) -> Option<Vec<f64>> {
    let numbers = exact.observe().dim();
    let residual = |readings: &[f64]| {
        let mut e = [0.0; NUMBERS];
        exact.observe().residual(&(*device_from_base * robot.forward_kinematics(readings)), &mut e);
        DVector::from_column_slice(&e[..numbers])
    };
    let mut readings = start.to_vec();
    let mut best = f64::INFINITY;
    for _ in 0..STEPS {
        let e = residual(&readings);
        if e.amax() < FULFILLED || (e.amax() < 10.0 * FULFILLED && e.amax() >= best) {
            return Some(readings);
        }
        best = e.amax();
        let mut jacobian = DMatrix::zeros(numbers, readings.len());
        for joint in 0..readings.len() {
            let mut at = |by: f64| {
                let before = readings[joint];
                readings[joint] = before + by;
                let e = residual(&readings);
                readings[joint] = before;
                e
            };
            let change = (at(DIFFERENCE) - at(-DIFFERENCE)) / (2.0 * DIFFERENCE);
            jacobian.set_column(joint, &-change);
        }
        let damped = &jacobian * jacobian.transpose() + DMatrix::identity(numbers, numbers) * 1e-12;
        let factor = linalg::cholesky(damped.as_slice(), numbers, 0.0)?;
        let pull = linalg::cholesky_solve(&factor, e.as_slice());
        let step = jacobian.transpose() * DVector::from_vec(pull);
        let scale = (LARGEST / step.amax().max(f64::MIN_POSITIVE)).min(1.0);
        readings.iter_mut().zip(step.iter()).for_each(|(reading, step)| *reading += scale * step);
    }
    None
}
