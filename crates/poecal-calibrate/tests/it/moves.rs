//! Motions within a session are named rightly, with their row and size, and nothing is named if nothing moved.

use std::path::PathBuf;

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::{Calibration, CalibrationOptions, Level, RobustLoss, calibrate};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, SimulationResult, elbow, gantry, random_chain, scara, seven_axis};
use poecal_testing::sessions::{calibrate_session as fit, simulate_session};
use poecal_testing::trials::{choose_some, trials};
use rayon::prelude::*;

const KINDS: [SessionKind; 2] = [SessionKind::POINT, SessionKind::POSE];

fn session(robot: &Robot, kind: SessionKind, count: usize, seed: u64) -> SimulationResult {
    simulate_session(robot, kind, count, 7000 + seed)
}

/// Each measurement as seen after a motion of the device, a function of the row.
fn move_device(made: &SimulationResult, motion: impl Fn(usize) -> Pose) -> Dataset {
    let mut data = made.data.clone();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        let pose = motion(row) * observation.measurement.pose();
        observation.measurement = if observation.measurement.sees_orientation() {
            Measurement::of_pose(&pose)
        } else {
            Measurement::point(pose.translation)
        };
    }
    data
}

fn shift(by: Vector3<f64>) -> Pose {
    Pose::from_translation(by)
}

fn says(found: &Calibration, words: &str) -> bool {
    found.warnings.iter().any(|warning| warning.contains(words))
}

/// All statements, for messages.
fn describe_findings(found: &Calibration) -> String {
    format!("{:?}\n{:?}\n{:?}", found.verdict, found.warnings, found.diagnosis)
}

/// Asserts that with full weight of every row the motion has the same size.
fn assert_size_by_least_squares(robot: &Robot, data: &Dataset) {
    let options = CalibrationOptions { robust: RobustLoss::Off, ..Default::default() };
    let found = calibrate(robot, data, &options).unwrap();
    let far = |it: &String| -> Option<f64> {
        it.split("the measurements are shifted by ").nth(1)?.split(' ').next()?.parse().ok()
    };
    let far = found.warnings.iter().find_map(far).unwrap_or_else(|| panic!("{}", describe_findings(&found)));
    assert!((far - 5.0).abs() < 0.2, "{far} mm");
}

#[test]
fn a_device_moved_late_is_named_and_not_called_gross_rows() {
    for kind in KINDS {
        for (count, seed) in choose_some([(60, 1), (150, 2), (300, 3)]) {
            let made = session(&elbow(), kind, count, seed);
            let from = count * 4 / 5;
            let moved = Vector3::new(3e-3, -4e-3, 0.0);
            let data = move_device(&made, |row| if row < from { Pose::identity() } else { shift(moved) });
            let found = fit(&made.nominal, &data);
            assert_size_by_least_squares(&made.nominal, &data);
            let words = format!("from row {} on the measurements are shifted by ", from + 1);
            assert!(says(&found, &words), "{kind:?} {count}: {}", describe_findings(&found));
            assert!(says(&found, "instrument"), "{}", describe_findings(&found));
            assert!(!says(&found, "outlier"), "{}", describe_findings(&found));
            let far: f64 =
                found.warnings.iter().find_map(|it| it.split(&words).nth(1)?.split(' ').next()?.parse().ok()).unwrap();
            assert!((far - 5.0).abs() < 0.2, "{far} mm");
            assert_eq!(found.verdict.level, Level::DoNotUse);
            assert!(found.verdict.reasons.iter().any(|reason| reason.contains(&words)));
        }
    }
}

#[test]
fn a_device_moved_halfway_is_named_with_its_row() {
    for kind in KINDS {
        let made = session(&elbow(), kind, 200, 4);
        let moved = Pose::from_xyz_rpy([2e-3, 1e-3, -2e-3], [3e-4, 0.0, -5e-4]);
        let data = move_device(&made, |row| if row < 100 { Pose::identity() } else { moved });
        let found = fit(&made.nominal, &data);
        let row = |it: &String| -> Option<usize> { it.split("from row ").nth(1)?.split(' ').next()?.parse().ok() };
        let row = found.warnings.iter().find_map(row).unwrap_or_else(|| panic!("{}", describe_findings(&found)));
        assert!((99..=103).contains(&row), "{}", describe_findings(&found));
        assert_eq!(found.verdict.level, Level::DoNotUse);
    }
}

/// Rows of two files, the second seen from another pose.
fn two_files(made: &SimulationResult, place: Pose, first: usize) -> Dataset {
    let mut data = move_device(made, |row| if row < first { Pose::identity() } else { place });
    data.files = vec![PathBuf::from("monday.csv"), PathBuf::from("tuesday.csv")];
    for (row, observation) in data.observations.iter_mut().enumerate() {
        observation.source.file = u32::from(row >= first);
        observation.source.line = (2 + if row < first { row } else { row - first }) as u32;
    }
    data
}

#[test]
fn files_with_two_device_frames_are_named() {
    let far = Pose::from_xyz_rpy([1.2, -0.7, 0.3], [0.1, 0.2, 2.0]);
    let near = Pose::from_translation(Vector3::new(6e-3, 0.0, 3e-3));
    for kind in KINDS {
        for (place, count, first) in choose_some([(far, 120, 60), (far, 100, 75), (near, 120, 60), (near, 150, 100)]) {
            let made = session(&elbow(), kind, count, 5);
            let found = fit(&made.nominal, &two_files(&made, place, first));
            assert!(
                says(&found, "the files monday.csv and tuesday.csv do not share one device frame"),
                "{kind:?} {count}: {}",
                describe_findings(&found)
            );
            assert!(says(&found, "--device-frames per-file"), "{}", describe_findings(&found));
            assert!(!says(&found, "unit of the noise") && !says(&found, "outlier"), "{}", describe_findings(&found));
            assert!(found.diagnosis.is_empty(), "{}", describe_findings(&found));
            assert_eq!(found.verdict.level, Level::DoNotUse);
        }
    }
}

#[test]
fn a_device_moved_far_within_a_file_is_named() {
    let far = Pose::from_xyz_rpy([0.5, -0.4, 0.2], [0.1, -0.2, 0.6]);
    for kind in KINDS {
        for (count, from) in choose_some([(80, 40), (150, 60), (150, 100), (300, 160)]) {
            let made = session(&elbow(), kind, count, 8);
            let data = move_device(&made, |row| if row < from { Pose::identity() } else { far });
            let found = fit(&made.nominal, &data);
            let statement = found.warnings.iter().find(|it| it.contains("are in another device frame"));
            let statement =
                statement.unwrap_or_else(|| panic!("{kind:?} {count} {from}: {}", describe_findings(&found)));
            let row: usize = statement.split("from row ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
            // First fitted row after the motion.
            assert!((from + 1..from + 8).contains(&row), "{from}: {statement}");
            assert!(!says(&found, "wrong unit"), "{}", describe_findings(&found));
            assert_eq!(found.verdict.level, Level::DoNotUse);
        }
    }
}

/// Points of several targets on the arm, in turn.
fn with_targets(made: &SimulationResult, names: &[&str], knocked: impl Fn(usize, usize) -> Vector3<f64>) -> Dataset {
    let mut data = made.data.clone();
    data.targets = names.iter().map(|name| Some((*name).to_owned())).collect();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        let target = row % names.len();
        observation.target = target;
        let arm = Vector3::new(0.06, -0.04 * target as f64, 0.05 * target as f64) + knocked(row, target);
        let tip = made.device_from_base * made.actual.forward_kinematics(made.data.readings(row));
        let pose = observation.measurement.pose();
        let pose = Pose::new(pose.rotation, pose.translation + tip.rotation * arm);
        observation.measurement = if observation.measurement.sees_orientation() {
            Measurement::of_pose(&pose)
        } else {
            Measurement::point(pose.translation)
        };
    }
    data
}

#[test]
fn a_knocked_nest_is_named_with_target_and_row() {
    for kind in KINDS {
        for (count, share) in choose_some([(90, 0.5), (150, 0.7), (300, 0.3), (300, 0.8)]) {
            let made = session(&elbow(), kind, count, 6);
            let from = (count as f64 * share) as usize;
            let knock = Vector3::new(0.48e-3, 0.0, -0.64e-3);
            let data = with_targets(&made, &["left", "middle", "right"], |row, target| {
                if target == 1 && row >= from { knock } else { Vector3::zeros() }
            });
            let found = fit(&made.nominal, &data);
            let statement = found.warnings.iter().find(|it| it.contains("target `middle` is shifted"));
            let statement =
                statement.unwrap_or_else(|| panic!("{kind:?} {count} {share}: {}", describe_findings(&found)));
            let number = |after: &str| -> f64 {
                statement.split(after).nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
            };
            let (row, far) = (number("from row "), number("is shifted by "));
            // First row of this target after the knock.
            let first = (from..).find(|row| row % 3 == 1).unwrap() + 1;
            assert_eq!(row as usize, first, "{statement}");
            assert!((far - 0.8).abs() < 0.25, "{statement}");
            assert_eq!(found.verdict.level, Level::DoNotUse, "{}", describe_findings(&found));
        }
    }
}

#[test]
fn a_slow_drift_is_called_a_drift() {
    for kind in KINDS {
        for (count, seed) in choose_some([(60, 1), (80, 2), (150, 3), (300, 4), (300, 5)]) {
            let made = session(&elbow(), kind, count, 20 + seed);
            let far = Vector3::new(0.12e-3, 0.0, 0.16e-3);
            let data = move_device(&made, |row| shift(far * (row as f64 / (count - 1) as f64)));
            let found = fit(&made.nominal, &data);
            let statement = found.warnings.iter().find(|it| it.contains("the measurements drift by"));
            let statement = statement.unwrap_or_else(|| panic!("{kind:?} {count}: {}", describe_findings(&found)));
            let size: f64 = statement.split("drift by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
            assert!((size - 0.2).abs() < 0.06, "{statement}");
            assert!(!says(&found, "moved"), "{}", describe_findings(&found));
            assert_eq!(found.verdict.level, Level::DoNotUse, "{}", describe_findings(&found));
        }
    }
}

/// True if a change is named.
fn is_doubted(found: &Calibration) -> bool {
    ["moved", "drift", "knocked", "do not share", "another device frame"].iter().any(|words| says(found, words))
}

#[test]
fn nothing_is_named_in_sessions_where_nothing_moved() {
    let robots = [elbow(), scara(), seven_axis(), gantry(), random_chain(6, 3)];
    // Every robot with every kind and number of rows, at least once.
    let doubted: Vec<String> = (trials(240).at_least(75).seeds())
        .into_par_iter()
        .filter_map(|seed| {
            let robot = &robots[seed as usize % robots.len()];
            let kind = [SessionKind::POINT, SessionKind::POSE, SessionKind::MIXED][seed as usize / 5 % 3];
            let count = [40, 60, 90, 150, 300][seed as usize / 15 % 5];
            let made = session(robot, kind, count, 100 + seed);
            let data = match seed % 4 {
                1 => with_targets(&made, &["a", "b", "c"], |_, _| Vector3::zeros()),
                2 => two_files(&made, Pose::identity(), count / 2),
                _ => made.data.clone(),
            };
            let found = fit(&made.nominal, &data);
            is_doubted(&found).then(|| format!("{seed} {} {kind:?} {count}: {}", robot.name, describe_findings(&found)))
        })
        .collect();
    assert!(doubted.is_empty(), "{doubted:#?}");
}

/// Configurations ordered along each joint, of a robot with compliant links: its errors vary with time, since the joints do.
#[test]
fn an_orderly_session_of_a_robot_that_gives_is_not_called_a_drift() {
    for seed in 0..6 {
        let made = session(&elbow(), SessionKind::POINT, 150, 400 + seed);
        let mut order: Vec<usize> = (0..made.data.len()).collect();
        order.sort_by(|&a, &b| made.data.readings(a)[0].total_cmp(&made.data.readings(b)[0]));
        let mut data = Dataset::new(made.data.reading_names().to_vec());
        for row in order {
            let readings = made.data.readings(row);
            let sag = 2e-4 * (2.0 * readings[0]).sin() + 1e-4 * (readings[0] + readings[1]).cos();
            let position = made.data.observations[row].measurement.pose().translation;
            let position = position + made.device_from_base.rotation * Vector3::new(0.0, sag, 0.0);
            data.push(readings, None, Measurement::point(position)).unwrap();
        }
        let found = fit(&made.nominal, &data);
        assert!(!is_doubted(&found), "{seed}: {}", describe_findings(&found));
    }
}
