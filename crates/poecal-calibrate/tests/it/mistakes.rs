//! Simulated sessions of many robots, and mistakes put into them.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3, Vector4};
use poecal_arm::lie::{Pose, rotation};
use poecal_fit::forensics::{Diagnosis, DiagnosisKind};
use poecal_model::measurement::{Dataset, Measurement, Observation};
use poecal_model::robot::{JointKind, Robot};
use poecal_model::simulate::random::{direction, shuffle, uniform_number};
use poecal_model::simulate::{self, Simulation, elbow, gantry, random_chain, random_configuration, scara, seven_axis};
use poecal_testing::trials::Trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use rayon::prelude::*;

/// A session of a robot that differs slightly from its model.
pub(crate) struct Session {
    pub(crate) robot: Robot,
    pub(crate) data: Dataset,
    pub(crate) device_free: bool,
    pub(crate) turned: bool,
    pub(crate) words: String,
}

/// The ten robots.
pub(crate) fn robot(index: usize) -> Robot {
    match index % 10 {
        0 => elbow(),
        1 => scara(),
        2 => gantry(),
        3 => seven_axis(),
        4 => random_chain(5, 1),
        5 => random_chain(6, 2),
        6 => random_chain(6, 3),
        7 => random_chain(6, 4),
        8 => random_chain(7, 5),
        _ => random_chain(7, 6),
    }
}

pub(crate) fn pick(generator: &mut ChaCha8Rng, count: usize) -> usize {
    ((uniform_number(generator) * count as f64) as usize).min(count - 1)
}

pub(crate) fn draw_between(generator: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * uniform_number(generator)
}

impl Session {
    /// A session drawn by its seed: robot, errors of 0.5 to 2 degrees and 1 to 3 mm, noise, 30 to 200 rows of one to three targets, poses or points
    /// or both, random configurations or a smooth path, device anywhere or at the base.
    pub(crate) fn from_seed(seed: u64) -> Session {
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0xf0e5_1c00);
        let g = &mut generator;
        let mut robot = robot(seed as usize);
        let simulation = Simulation {
            error_rotation_rad: draw_between(g, 0.5, 2.0).to_radians(),
            error_position_m: draw_between(g, 1e-3, 3e-3),
            ..Simulation::default()
        };
        let (noise_m, noise_rad) = (draw_between(g, 2e-5, 1e-4), draw_between(g, 5e-3, 2e-2).to_radians());
        let targets = 1 + pick(g, 3);
        let count = 30 + 10 * (targets - 1) + pick(g, 150);
        let kind = pick(g, 3);
        let device_free = uniform_number(g) < 0.75;
        let smooth = uniform_number(g) < 0.25;
        // Reflectors are beside the flange: one on the last axis would not distinguish a moving axis from a still one.
        let nominal: Vec<Pose> = (0..targets)
            .map(|_| Pose::new(simulate::random::rotation(g), direction(g) * draw_between(g, 0.06, 0.15)))
            .collect();
        robot.targets = nominal.iter().enumerate().map(|(k, pose)| (format!("target{k}"), *pose)).collect();
        let actual = simulation.perturb(&robot, g);
        let placed: Vec<Pose> = nominal
            .iter()
            .map(|pose| *pose * Pose::exp(&poecal_testing::sessions::random_twist(0.02, 2e-3, g)))
            .collect();
        let device =
            if device_free { Pose::new(simulate::random::rotation(g), direction(g) * 3.0) } else { Pose::identity() };
        let mut data = Dataset::new(robot.reading_names());
        let waves: Vec<[f64; 2]> =
            robot.reading_names().iter().map(|_| [draw_between(g, 0.15, 0.5), draw_between(g, 0.0, 6.3)]).collect();
        for row in 0..count {
            let readings = if smooth { on_path(&robot, &waves, row) } else { random_configuration(&robot, g) };
            let target = row % targets;
            let seen = device * actual.forward_kinematics(&readings) * placed[target];
            let position = seen.translation + simulate::random::normal_vector(g) * noise_m;
            let turn = rotation::exp(&(simulate::random::normal_vector(g) * noise_rad));
            let pose = Pose::new(turn * seen.rotation, position);
            let measurement = match kind {
                0 => Measurement::point(position),
                2 if row % (targets + 1) == 0 => Measurement::point(position),
                _ => Measurement::of_pose(&pose),
            };
            data.push(&readings, Some(&format!("target{target}")), measurement).unwrap();
        }
        let words = format!(
            "seed {seed}: {}, {count} rows, {targets} targets, {}, {}{}, errors {:.1} deg",
            robot.name,
            ["points", "poses", "mixed"][kind],
            if device_free { "device anywhere" } else { "device at the base" },
            if smooth { ", smooth path" } else { "" },
            simulation.error_rotation_rad.to_degrees()
        );
        Session { robot, data, device_free, turned: kind != 0, words }
    }

    fn with_changed_rows(&self, mut change: impl FnMut(usize, &mut [f64], &mut Observation)) -> Dataset {
        let mut data = Dataset::new(self.data.reading_names().to_vec());
        data.targets.clone_from(&self.data.targets);
        for row in 0..self.data.len() {
            let mut readings = self.data.readings(row).to_vec();
            let mut observation = self.data.observations[row];
            change(row, &mut readings, &mut observation);
            data.push_observation(&readings, observation).unwrap();
        }
        data
    }

    fn with_changed_poses(&self, change: impl Fn(Pose) -> Pose) -> Dataset {
        self.with_changed_rows(|_, _, observation| {
            let pose = change(observation.measurement.pose());
            observation.measurement = if observation.measurement.sees_orientation() {
                Measurement::of_pose(&pose)
            } else {
                Measurement::point(pose.translation)
            };
        })
    }

    /// The data with a mistake of a kind, and its description; `None` if this session cannot have it.
    pub(crate) fn with_mistake(&self, kind: DiagnosisKind, seed: u64) -> Option<(Dataset, String)> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x3157_a4e5);
        let g = &mut generator;
        let n = self.robot.reading_names().len();
        let kinds: Vec<JointKind> = self.robot.joints.iter().map(|joint| joint.kind).collect();
        let column = pick(g, n);
        let slides = kinds[column] == JointKind::Prismatic;
        let poses = self.turned;
        match kind {
            DiagnosisKind::JointUnit => {
                let all = uniform_number(g) < 0.5;
                let factor = if slides { 1e3 } else { 1f64.to_degrees() };
                let factor = if uniform_number(g) < 0.5 { factor } else { 1.0 / factor };
                let data = self.with_changed_rows(|_, readings, _| {
                    for (k, reading) in readings.iter_mut().enumerate() {
                        *reading *= if k == column || all && kinds[k] == kinds[column] { factor } else { 1.0 };
                    }
                });
                Some((data, format!("column {column}{} times {factor}", if all { " and its like" } else { "" })))
            }
            DiagnosisKind::PositionUnit => {
                let factor = [1e3, 1e-3, 1.0 / 0.0254, 1.0 / 25.4][pick(g, 4)];
                let data = self.with_changed_poses(|pose| Pose::new(pose.rotation, pose.translation * factor));
                Some((data, format!("times {factor}")))
            }
            DiagnosisKind::JointSign => {
                let other = if uniform_number(g) < 0.25 { pick(g, n) } else { column };
                let data = self.with_changed_rows(|_, readings, _| {
                    readings[column] = -readings[column];
                    if other != column {
                        readings[other] = -readings[other];
                    }
                });
                Some((data, format!("columns {column} and {other}")))
            }
            DiagnosisKind::JointZero => {
                let by = if slides { draw_between(g, 0.05, 0.3) } else { draw_between(g, 8.0, 180.0).to_radians() };
                let by = if uniform_number(g) < 0.5 { by } else { -by };
                Some((
                    self.with_changed_rows(|_, readings, _| readings[column] += by),
                    format!("column {column} by {by}"),
                ))
            }
            DiagnosisKind::JointsSwapped => {
                let other = pick(g, n);
                let fits = other != column && kinds[other] == kinds[column];
                fits.then(|| {
                    (self.with_changed_rows(|_, r, _| r.swap(column, other)), format!("columns {column}, {other}"))
                })
            }
            DiagnosisKind::QuaternionOrder => {
                let wxyz_as_xyzw = uniform_number(g) < 0.5;
                let reordered = |pose: Pose| {
                    let q = rotation::to_quaternion_xyzw(&pose.rotation);
                    let q =
                        if wxyz_as_xyzw { Vector4::new(q.w, q.x, q.y, q.z) } else { Vector4::new(q.y, q.z, q.w, q.x) };
                    Pose::new(rotation::from_quaternion_xyzw(&q), pose.translation)
                };
                poses.then(|| (self.with_changed_poses(reordered), format!("w first: {wxyz_as_xyzw}")))
            }
            DiagnosisKind::InvertedPose => {
                let whole = uniform_number(g) < 0.7;
                let inverse = |pose: Pose| {
                    if whole { pose.inverse() } else { Pose::new(pose.rotation.transpose(), pose.translation) }
                };
                let data = self.with_changed_rows(|_, _, observation| {
                    if let Some(pose) = observation.measurement.frame() {
                        observation.measurement = Measurement::of_pose(&inverse(pose));
                    }
                });
                poses.then_some((data, format!("positions too: {whole}")))
            }
            DiagnosisKind::EulerConvention => {
                let (meant, read) = (pick(g, 4), pick(g, 4));
                // The same convention twice: radians read as degrees.
                let factor = if meant == read { 1f64.to_radians() } else { 1.0 };
                let other = |pose: Pose| {
                    Pose::new(from_angles(read, angles(meant, &pose.rotation).map(|a| a * factor)), pose.translation)
                };
                poses.then(|| (self.with_changed_poses(other), format!("meant {meant}, read {read}")))
            }
            DiagnosisKind::LeftHanded => {
                let mut mirror = Matrix3::identity();
                let words = match pick(g, 2) {
                    0 => {
                        let axis = pick(g, 3);
                        mirror[(axis, axis)] = -1.0;
                        format!("axis {axis}")
                    }
                    _ => {
                        let axis = pick(g, 3);
                        mirror.swap_columns(axis, (axis + 1) % 3);
                        format!("exchange from {axis}")
                    }
                };
                let turns = uniform_number(g) < 0.5;
                // A mirrored SCARA is one with a reversed slide, since all its axes are parallel.
                let same = self.robot.name == "scara" && (turns || !poses || words == "axis 2");
                let mirrored = |pose: Pose| {
                    let turned = if turns { mirror * pose.rotation * mirror } else { pose.rotation };
                    Pose::new(turned, mirror * pose.translation)
                };
                (!same).then(|| (self.with_changed_poses(mirrored), format!("{words}, orientations too: {turns}")))
            }
            DiagnosisKind::RowShift => {
                let by = (1 + pick(g, 3)) * self.data.targets.len();
                let later = uniform_number(g) < 0.5;
                let mut data = Dataset::new(self.data.reading_names().to_vec());
                data.targets.clone_from(&self.data.targets);
                for row in by..self.data.len() {
                    let (readings, seen) = if later { (row - by, row) } else { (row, row - by) };
                    data.push_observation(self.data.readings(readings), self.data.observations[seen]).unwrap();
                }
                Some((data, format!("by {by}, later: {later}")))
            }
            DiagnosisKind::JointScale => {
                let factors: Vec<f64> = (0..n).map(|_| draw_between(g, 0.5, 0.9)).collect();
                let data = self.with_changed_rows(|_, readings, _| {
                    readings.iter_mut().zip(&factors).for_each(|(reading, factor)| *reading *= factor);
                });
                Some((data, format!("times {factors:?}")))
            }
            DiagnosisKind::JointsCoupled => {
                let couples = column > 0 && !slides && kinds[column - 1] == JointKind::Revolute;
                let factor = if uniform_number(g) < 0.5 { 1.0 } else { -1.0 };
                couples.then(|| {
                    let data =
                        self.with_changed_rows(|_, readings, _| readings[column] += factor * readings[column - 1]);
                    (data, format!("column {column} by {factor} of the one before"))
                })
            }
            DiagnosisKind::TargetsSwapped => self.exchange_names(g),
            // These sessions see one target in each configuration, from a device with a frame.
            DiagnosisKind::TargetsUnnamed
            | DiagnosisKind::BoardSize
            | DiagnosisKind::LengthUnit
            | DiagnosisKind::DistanceZero
            | DiagnosisKind::KnownLength
            | DiagnosisKind::HeightSign
            | DiagnosisKind::TiltUnit
            | DiagnosisKind::PlacesSwapped => None,
            DiagnosisKind::DuplicateRows => {
                let mut data = self.data.clone();
                let copies = 1 + pick(g, 3);
                let exact = uniform_number(g) < 0.5;
                let mut order: Vec<usize> = (0..data.len()).collect();
                shuffle(g, &mut order);
                for k in 0..copies {
                    let (from, mut seen) = (order[k], self.data.observations[order[k]]);
                    if !exact {
                        let target = seen.target;
                        let other = order[copies..].iter().find(|&&row| self.data.observations[row].target == target);
                        seen = self.data.observations[*other.unwrap()];
                    }
                    data.push_observation(self.data.readings(from), seen).unwrap();
                }
                Some((data, format!("{copies} copies, exact: {exact}")))
            }
        }
    }

    /// The names of two targets exchanged in all rows, from a row on, or in single rows.
    fn exchange_names(&self, g: &mut ChaCha8Rng) -> Option<(Dataset, String)> {
        if self.data.targets.len() < 2 {
            return None;
        }
        let count = self.data.len();
        let (how, from) = (pick(g, 3), (count as f64 * draw_between(g, 0.2, 0.8)) as usize);
        let single: Vec<usize> = (0..1 + pick(g, 3)).map(|_| pick(g, count)).collect();
        let concerned = |row: usize| match how {
            0 => true,
            1 => row >= from,
            _ => single.contains(&row),
        };
        let any = (0..count).any(|row| concerned(row) && self.data.observations[row].target < 2);
        let data = self.with_changed_rows(|row, _, observation| {
            if concerned(row) && observation.target < 2 {
                observation.target = 1 - observation.target;
            }
        });
        any.then(|| {
            (data, ["in all rows".to_owned(), format!("from row {from} on"), format!("rows {single:?}")][how].clone())
        })
    }
}

/// A configuration on a smooth path within the limits.
fn on_path(robot: &Robot, waves: &[[f64; 2]], row: usize) -> Vec<f64> {
    let value = |(joint, [speed, phase]): (&poecal_model::robot::Joint, &[f64; 2])| {
        let limits = joint.limits.unwrap();
        let wave = (speed * row as f64 + phase).sin();
        0.5 * (limits.lower + limits.upper) + 0.5 * (limits.upper - limits.lower) * wave
    };
    robot.joints.iter().zip(waves).map(value).collect()
}

/// Angles of a rotation: 0 roll, pitch, yaw; 1 intrinsic xyz; 2 intrinsic zyz; 3 rotation vector.
fn angles(convention: usize, r: &Matrix3<f64>) -> [f64; 3] {
    match convention {
        0 => rotation::to_rpy(r),
        1 => [(-r[(1, 2)]).atan2(r[(2, 2)]), r[(0, 2)].asin(), (-r[(0, 1)]).atan2(r[(0, 0)])],
        2 => [r[(1, 2)].atan2(r[(0, 2)]), r[(2, 2)].acos(), r[(2, 1)].atan2(-r[(2, 0)])],
        _ => rotation::log(r).into(),
    }
}

fn from_angles(convention: usize, [a, b, c]: [f64; 3]) -> Matrix3<f64> {
    match convention {
        0 => rotation::from_rpy(a, b, c),
        1 => rotation::about(0, a) * rotation::about(1, b) * rotation::about(2, c),
        2 => rotation::about(2, a) * rotation::about(1, b) * rotation::about(2, c),
        _ => rotation::exp(&Vector3::new(a, b, c)),
    }
}

/// An examined session: its description, the decision whether the finding is right, and the finding.
pub(crate) struct Looked {
    /// Label by which sessions are counted together.
    pub(crate) label: String,
    pub(crate) words: String,
    pub(crate) is_right: bool,
    pub(crate) found: Vec<Diagnosis>,
}

/// Examines sessions with a mistake in each: 95 % of the findings must be right.
pub(crate) fn assert_mistakes_are_named(sessions: Trials, look: impl Fn(u64) -> Looked + Sync) {
    let count = sessions.count;
    let looked: Vec<Looked> = sessions.seeds().into_par_iter().map(&look).collect();
    let mut by_label: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (index, Looked { label, words, is_right, found }) in looked.iter().enumerate() {
        if !is_right {
            println!("MISSED {index} {label} {words}");
            found.iter().for_each(|one| println!("    found {:?}: {}", one.kind, one.statement));
        }
        let entry = by_label.entry(label).or_default();
        entry.0 += usize::from(*is_right);
        entry.1 += 1;
    }
    for (label, (right, all)) in &by_label {
        println!("{label}: {right} of {all}");
    }
    let right = looked.iter().filter(|one| one.is_right).count();
    println!("named correctly: {right} of {count}");
    assert!(right as f64 >= (0.95 - sessions.more_of_a_share(0.95)) * count as f64, "{right} of {count}");
}

/// Examines sessions without a mistake, by their words and findings: 1 % may raise an alarm.
pub(crate) fn assert_no_alarms(sessions: Trials, look: impl Fn(u64) -> (String, Vec<Diagnosis>) + Sync) {
    let count = sessions.count;
    let alarms: Vec<String> = (sessions.seeds())
        .into_par_iter()
        .flat_map_iter(|index| {
            let (words, found) = look(index);
            found.into_iter().map(move |one| format!("{words}: {:?}: {}", one.kind, one.statement))
        })
        .collect();
    alarms.iter().for_each(|alarm| println!("ALARM {alarm}"));
    println!("alarms: {} of {count}", alarms.len());
    assert!(alarms.len() as f64 <= (0.01 + sessions.more_of_a_share(0.01)) * count as f64);
}
