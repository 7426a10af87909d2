//! Sessions of devices without a frame of their own: anchors, sockets, planes, spheres, gravity, and pairs of configurations.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{Configurations, SessionKind, Simulation, random};
use crate::measurement::{Dataset, Measurement, MeasurementOrigin, NUMBERS, Observation, RandomDraws, StationLayout};
use crate::robot::{Body, Mount, Robot};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;

/// Distance of the two sockets, metres.
const SOCKETS_APART_M: f64 = 0.2;
/// Number of random configurations from which one that fulfils a constraint is sought, Newton steps from each, and the largest change of a
/// joint.
const ATTEMPTS: usize = 2000;
const STEPS: usize = 40;
const LARGEST: f64 = 0.4;
/// Residual of a constraint that is fulfilled, metres and radians.
const FULFILLED: f64 = 1e-13;
/// Change of a reading for a difference.
const DIFFERENCE: f64 = 1e-6;

/// A station of a session.
#[derive(Clone)]
struct DevicePosition {
    name: String,
    base: Base,
    /// Zero of an instrument's distances, metres.
    zero_m: f64,
}

/// Carrier of a station.
#[derive(Clone)]
enum Base {
    /// Beside the robot: `device_from_base`.
    Beside(Pose),
    /// A link of the robot.
    On(Mount),
    /// The target itself in another configuration.
    Before,
}

/// A station with a target of the robot that it measures; `None` is the tip.
struct PlaceView {
    place: DevicePosition,
    target: Option<Mount>,
}

impl PlaceView {
    /// The target in the base frame.
    fn base_from_target(&self, robot: &Robot, readings: &[f64]) -> Pose {
        self.target
            .as_ref()
            .map_or_else(|| robot.forward_kinematics(readings), |target| super::base_from(robot, target, readings))
    }

    /// Target as it is measured, if the station is that of one configuration.
    fn target_pose(&self, robot: &Robot, readings: &[f64]) -> Pose {
        let device_from_base = match &self.place.base {
            Base::Beside(device_from_base) => *device_from_base,
            Base::On(mount) => super::base_from(robot, mount, readings).inverse(),
            Base::Before => Pose::identity(),
        };
        device_from_base * self.base_from_target(robot, readings)
    }

    /// Target relative to its pose in an earlier configuration.
    fn seen_from(&self, robot: &Robot, [before, readings]: [&[f64]; 2]) -> Pose {
        self.base_from_target(robot, before).inverse() * self.base_from_target(robot, readings)
    }

    /// An observation by this station of its target, without a measurement yet.
    fn observation(&self, data: &mut Dataset) -> Observation {
        let target = data.target_index(self.target.as_ref().map(|it| it.name.as_str()));
        let station = data.station_index(Some(&self.place.name));
        let measurement = Measurement::socket(Vector3::zeros());
        Observation { station, ..Observation::new(target, measurement) }
    }
}

/// Measurements of a robot in some configurations, by a kind that is neither of a device with a frame nor a contact: rows, and the frames of
/// the instruments, which are somewhere around it.
pub fn plan(kind: SessionKind, robot: &Robot, readings: &[f64]) -> Result<(Dataset, Vec<Pose>)> {
    let exact = Simulation { noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
    let mut generator = ChaCha8Rng::seed_from_u64(exact.seed);
    let mut data = Dataset::new(robot.reading_names());
    let sights = exact.sights(robot, kind)?;
    let is_paired = kind.is_paired();
    let width = data.reading_names().len().max(1) * if is_paired { 2 } else { 1 };
    for (row, own) in readings.chunks_exact(width).enumerate() {
        let sight = &sights[row % sights.len()];
        let (first, own) = own.split_at(if is_paired { width / 2 } else { 0 });
        let mut observation = sight.observation(&mut data);
        let seen = if is_paired {
            observation.from = Some(data.push_further(first)?);
            sight.seen_from(robot, [first, own])
        } else {
            sight.target_pose(robot, own)
        };
        observation.measurement = exact.measure_target(kind, &sight.place, (row, &seen), &mut generator);
        data.push_observation(own, observation)?;
    }
    let device = |name: &Option<String>| {
        let own = sights.iter().find(|it| name.as_ref() == Some(&it.place.name))?;
        match &own.place.base {
            Base::Beside(device_from_base) => Some(*device_from_base),
            Base::On(_) | Base::Before => None,
        }
    };
    let devices = data.stations.iter().filter_map(device).collect();
    Ok((data, devices))
}

impl Simulation {
    /// Measurements of a kind without a device frame. Stations do not depend on the generator, so that further rows have the same.
    pub(crate) fn observe_places(
        &self,
        nominal: &Robot,
        actual: &Robot,
        kind: SessionKind,
        generator: &mut ChaCha8Rng,
    ) -> Result<Dataset> {
        let sights = self.sights(actual, kind)?;
        let mut data = Dataset::new(nominal.reading_names());
        let configurations = Configurations::new(nominal);
        for row in 0..self.count {
            let sight = &sights[row % sights.len()];
            let mut observation = sight.observation(&mut data);
            let readings = if kind.is_touched() {
                let found = self.touching_configuration(actual, (&configurations, row), kind, sight, generator)?;
                observation.measurement = found.1;
                found.0
            } else {
                let readings = configurations.random(generator);
                let seen = if kind.is_paired() {
                    let other = configurations.random(generator);
                    observation.from = Some(data.push_further(&other)?);
                    sight.seen_from(actual, [&other, &readings])
                } else {
                    sight.target_pose(actual, &readings)
                };
                observation.measurement = self.measure_target(kind, &sight.place, (row, &seen), generator);
                readings
            };
            data.push_observation(&readings, observation)?;
        }
        Ok(data)
    }

    /// Pairs of station and target: those of the kind, or the robot's own instruments, and each target with a body of its own, or the tip.
    fn sights(&self, actual: &Robot, kind: SessionKind) -> Result<Vec<PlaceView>> {
        let mut places = self.places(actual, kind);
        if !actual.instruments.is_empty() && !kind.is_paired() {
            let on = |mount: &Mount| DevicePosition {
                name: mount.name.clone(),
                base: Base::On(mount.clone()),
                zero_m: places.first().map_or(0.0, |it| it.zero_m),
            };
            places = actual.instruments.iter().map(on).collect();
        }
        let targets: Vec<Option<Mount>> = match actual.mounted.as_slice() {
            [] => vec![None],
            mounted => mounted.iter().cloned().map(Some).collect(),
        };
        let body = |it: &Option<Mount>| it.as_ref().map_or_else(|| actual.tip_body(), |mount| mount.body);
        let sight = |place: &DevicePosition, target: &Option<Mount>| {
            let mut place = place.clone();
            // The name is that of files for the pairs of a target.
            if let (Base::Before, Some(mount)) = (&place.base, target) {
                place.name = format!("{}/{}", place.name, mount.name);
            }
            PlaceView { place, target: target.clone() }
        };
        let all = targets.iter().flat_map(|target| places.iter().map(move |place| sight(place, target)));
        let moves = |sight: &PlaceView| match &sight.place.base {
            Base::On(mount) => mount.body != body(&sight.target),
            Base::Beside(_) | Base::Before => body(&sight.target) != Body::Base,
        };
        let found: Vec<PlaceView> = all.filter(moves).collect();
        if found.is_empty() {
            return ErrorKind::Problem.refuse(super::SAME_LINKS);
        }
        Ok(found)
    }

    /// Stations of a kind.
    fn places(&self, actual: &Robot, kind: SessionKind) -> Vec<DevicePosition> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(3);
        let session = kind.session();
        let configurations = Configurations::new(actual);
        let middle = self.middle(actual, &configurations, &mut generator);
        let apart = random::direction(&mut generator) * SOCKETS_APART_M;
        let place = |(index, name): (usize, &&'static str)| {
            let turn = random::rotation(&mut generator);
            let (point, turn) = match session.stands {
                StationLayout::Around => (random::direction(&mut generator) * (1.5 * actual.reach_m()), turn),
                StationLayout::InARow => (middle + apart * index as f64, turn),
                StationLayout::Upward => (Vector3::zeros(), rotation::exp(&(random::direction(&mut generator) * 0.02))),
                StationLayout::Anywhere | StationLayout::Within | StationLayout::Before => (middle, turn),
            };
            let is_counted = session.function.zero_is_unknown && !kind.is_touched();
            let zero_m = if is_counted { random::uniform_number(&mut generator) - 0.5 } else { 0.0 };
            let base = match kind.is_paired() {
                true => Base::Before,
                false => Base::Beside(Pose::new(turn, -(turn * point))),
            };
            DevicePosition { name: (*name).to_owned(), base, zero_m }
        };
        session.places.iter().enumerate().map(place).collect()
    }

    /// A point that all targets reach well: the middle of their positions.
    fn middle(&self, actual: &Robot, configurations: &Configurations, generator: &mut ChaCha8Rng) -> Vector3<f64> {
        const SOME: usize = 20;
        let place = |readings: &[f64]| {
            let targets = actual.mounted.iter().filter(|it| it.body != Body::Base);
            let places = targets.map(|it| super::base_from(actual, it, readings).translation);
            let (count, sum) = places.fold((0, Vector3::zeros()), |(count, sum), place| (count + 1, sum + place));
            match count {
                0 => actual.forward_kinematics(readings).translation,
                count => sum / f64::from(count),
            }
        };
        let tips = (0..SOME).map(|_| place(&configurations.random(generator)));
        let tips: Vec<Vector3<f64>> = tips.collect();
        let outward = tips
            .iter()
            .map(|tip| Vector3::new(tip.x, tip.y, 0.0))
            .fold(Vector3::zeros(), |most, it| if it.norm() > most.norm() { it } else { most });
        let height = tips.iter().map(|tip| tip.z).sum::<f64>() / SOME as f64;
        outward * 0.7 + Vector3::z() * height
    }

    /// Measurement of a target by a device.
    fn measure_target(
        &self,
        kind: SessionKind,
        place: &DevicePosition,
        (row, target): (usize, &Pose),
        generator: &mut ChaCha8Rng,
    ) -> Measurement {
        let length = Vector3::x() * (random::normal(generator) * self.noise_position_m);
        self.measure_with_noise(kind, target, (row, length, place.zero_m), generator)
    }

    /// Measurement of a target by a device, with noise of lengths that is already drawn.
    pub(crate) fn measure_with_noise(
        &self,
        kind: SessionKind,
        target: &Pose,
        (row, length, zero_m): (usize, Vector3<f64>, f64),
        generator: &mut ChaCha8Rng,
    ) -> Measurement {
        self.with_noise(row, length, zero_m, generator, |drawn| match kind.session().drawn {
            MeasurementOrigin::Seen(measure) => measure(target, drawn),
            MeasurementOrigin::Touched(constraint) => constraint(drawn)[1],
        })
    }

    /// Draws further noise of a measurement.
    fn with_noise<T>(
        &self,
        row: usize,
        length: Vector3<f64>,
        zero_m: f64,
        generator: &mut ChaCha8Rng,
        of: impl FnOnce(&mut RandomDraws<'_>) -> T,
    ) -> T {
        let turn = random::normal_vector(generator) * self.noise_rotation_rad;
        let generator = RefCell::new(generator);
        let mut lengths = || random::normal_vector(&mut generator.borrow_mut()) * self.noise_position_m;
        let mut uniform = || random::uniform_number(&mut generator.borrow_mut());
        of(&mut RandomDraws { row, length, turn, zero_m, lengths: &mut lengths, uniform: &mut uniform })
    }

    /// A configuration in which the tip touches a station, up to the noise, with the recorded measurement.
    fn touching_configuration(
        &self,
        actual: &Robot,
        (configurations, row): (&Configurations, usize),
        kind: SessionKind,
        sight: &PlaceView,
        generator: &mut ChaCha8Rng,
    ) -> Result<(Vec<f64>, Measurement)> {
        let length = random::normal_vector(generator) * self.noise_position_m;
        let [exact, said] = self.with_noise(row, length, 0.0, generator, |drawn| match kind.session().drawn {
            MeasurementOrigin::Touched(constraint) => constraint(drawn),
            MeasurementOrigin::Seen(measure) => [measure(&Pose::identity(), drawn); 2],
        });
        for _ in 0..ATTEMPTS {
            let start = configurations.random(generator);
            if let Some(found) = fulfil_measurement(actual, &start, sight, &exact)
                && configurations.contain(&found)
            {
                return Ok((found, said));
            }
        }
        ErrorKind::Problem.refuse(format!(
            "found no configuration within the joints' limits in which `{}` is touched, expected a robot that reaches it",
            sight.place.name
        ))
    }
}

/// Readings near these with which a measurement fits exactly, by Newton's method with the least change of the joints.
fn fulfil_measurement(robot: &Robot, start: &[f64], sight: &PlaceView, exact: &Measurement) -> Option<Vec<f64>> {
    let numbers = exact.dim();
    let residual = |readings: &[f64]| {
        let mut e = [0.0; NUMBERS];
        exact.residual(&sight.target_pose(robot, readings), &mut e);
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
