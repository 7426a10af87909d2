//! Mistakes in sessions of anchors, spheres, sockets, planes, gravity and pairs are named, and clean ones raise no alarm.

use crate::mistakes::{Looked, assert_mistakes_are_named, assert_no_alarms, draw_between, pick};
use poecal_arm::lie::Pose;
use poecal_fit::forensics::{Diagnosis, DiagnosisKind, DiagnosisOptions, diagnose};
use poecal_model::measurement::{Dataset, KnownLength, Measurement, Observation, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::random::uniform_number;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, random_chain, seven_axis};
use poecal_testing::trials::trials;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

/// Distance of the two sockets and radius of the sphere in simulated sessions, metres.
const SOCKETS_M: f64 = 0.2;
const SPHERE_M: f64 = 0.05;

/// Sessions, each with its possible mistakes.
const CASES: [(SessionKind, DiagnosisKind); 16] = [
    (SessionKind::DISTANCE, DiagnosisKind::PlacesSwapped),
    (SessionKind::DISTANCE, DiagnosisKind::LengthUnit),
    (SessionKind::DISTANCE, DiagnosisKind::DistanceZero),
    (SessionKind::CHANGE, DiagnosisKind::PlacesSwapped),
    (SessionKind::CHANGE, DiagnosisKind::LengthUnit),
    (SessionKind::SPHERE, DiagnosisKind::DistanceZero),
    (SessionKind::SOCKET, DiagnosisKind::PlacesSwapped),
    (SessionKind::SOCKET, DiagnosisKind::KnownLength),
    (SessionKind::PLANE, DiagnosisKind::PlacesSwapped),
    (SessionKind::HEIGHT, DiagnosisKind::HeightSign),
    (SessionKind::HEIGHT, DiagnosisKind::LengthUnit),
    (SessionKind::FLUSH, DiagnosisKind::PlacesSwapped),
    (SessionKind::DIRECTION, DiagnosisKind::TiltUnit),
    (SessionKind::BALL_BAR, DiagnosisKind::LengthUnit),
    (SessionKind::RELATIVE, DiagnosisKind::PositionUnit),
    (SessionKind::RELATIVE, DiagnosisKind::InvertedPose),
];

/// A session of a robot that differs slightly from its model.
struct Session {
    robot: Robot,
    data: Dataset,
    words: String,
}

/// A robot whose tool is beside its last axis.
fn robot(index: usize) -> Robot {
    let mut robot = match index % 5 {
        0 => elbow(),
        1 => seven_axis(),
        2 => random_chain(6, 2),
        3 => random_chain(6, 3),
        _ => random_chain(7, 5),
    };
    robot.home = robot.home * Pose::from_xyz_rpy([0.12, 0.06, 0.03], [0.3, 0.2, 0.1]);
    robot
}

/// A session drawn by its seed: errors of 0.5 to 2 degrees and 1 to 3 mm, noise, 60 to 180 rows. If a robot does not reach its positions, another is
/// drawn.
fn draw_session(kind: SessionKind, seed: u64) -> Session {
    let g = &mut ChaCha8Rng::seed_from_u64(seed ^ 0x9_1ace5);
    let simulation = Simulation {
        error_rotation_rad: draw_between(g, 0.5, 2.0).to_radians(),
        error_position_m: draw_between(g, 1e-3, 3e-3),
        noise_position_m: draw_between(g, 2e-5, 1e-4),
        noise_rotation_rad: draw_between(g, 5e-3, 2e-2).to_radians(),
        count: 60 + pick(g, 120),
        seed,
        ..Simulation::default()
    };
    // Not every robot can lay a face on planes of any direction.
    let robot = robot(if kind == SessionKind::FLUSH { 0 } else { seed as usize });
    let Some(SimulationResult { mut data, .. }) = simulation.run(&robot, kind).ok() else {
        return draw_session(kind, seed + 1_000_003);
    };
    if kind == SessionKind::SPHERE {
        // The radius is known.
        change_observations(&mut data, |_, row| row.measurement = Measurement::distance(SPHERE_M));
    }
    if kind == SessionKind::SOCKET {
        let known = KnownLength { stations: [0, 1], length_m: SOCKETS_M, sigma_m: KnownLength::SIGMA_M };
        data.lengths.push(known);
    }
    let words = format!(
        "{}: seed {seed}, {}, {} rows, errors {:.1} deg",
        kind.word(),
        robot.name,
        data.len(),
        simulation.error_rotation_rad.to_degrees()
    );
    Session { robot, data, words }
}

fn change_observations(data: &mut Dataset, mut change: impl FnMut(usize, &mut Observation)) {
    data.observations.iter_mut().enumerate().for_each(|(row, observation)| change(row, observation));
}

/// The session's data with a mistake of a kind, and its description.
fn make_mistake(session: &Session, kind: DiagnosisKind, seed: u64) -> (Dataset, String) {
    let g = &mut ChaCha8Rng::seed_from_u64(seed ^ 0x0ddb_a115);
    let mut data = session.data.clone();
    let words = match kind {
        DiagnosisKind::PlacesSwapped => rename_places(&mut data, g),
        DiagnosisKind::LengthUnit => {
            let factor = [25.4, 1.0 / 25.4, 10.0, 0.1, 1e3, 1e-3][pick(g, 6)];
            change_observations(&mut data, |_, row| {
                if [Quantity::Distance, Quantity::Height].iter().any(|it| row.measurement.has(*it)) {
                    row.measurement.values_mut()[0] *= factor;
                }
            });
            format!("lengths times {factor}")
        }
        DiagnosisKind::DistanceZero => {
            // The radius of a probe's ball, a hook: 4 % to 20 % of a sphere's radius, or some of a wire.
            let by_m = if uniform_number(g) < 0.5 { -1.0 } else { 1.0 } * draw_between(g, 2e-3, 1e-2);
            change_observations(&mut data, |_, row| {
                if row.measurement.has(Quantity::Distance) {
                    row.measurement.values_mut()[0] += by_m;
                }
            });
            format!("{:.2} mm longer", by_m * 1e3)
        }
        DiagnosisKind::KnownLength => {
            let factor = [0.5, 2.0, 10.0, 0.1, 25.4, 1.2, 0.8][pick(g, 7)];
            data.lengths[0].length_m *= factor;
            format!("distance of the sockets times {factor}")
        }
        DiagnosisKind::HeightSign => {
            // All heights over an unknown plane may count either way: its normal is found with them.
            let (start, end) = part(data.len(), g);
            let plane = pick(g, 4);
            change_observations(&mut data, |row, seen| {
                let is_own = plane == 3 || plane == seen.station;
                if seen.measurement.has(Quantity::Height) && (start..end).contains(&row) && is_own {
                    seen.measurement.values_mut()[0] *= -1.0;
                }
            });
            format!("rows {start} to {end}, plane {plane}")
        }
        DiagnosisKind::TiltUnit => {
            change_observations(&mut data, |_, row| {
                row.measurement = row.measurement.with_angles_times(1f64.to_radians());
            });
            "degrees as radians".to_owned()
        }
        DiagnosisKind::PositionUnit | DiagnosisKind::InvertedPose => {
            let factor = [25.4, 1e-3, 1e3][pick(g, 3)];
            change_observations(&mut data, |_, row| {
                let mut pose = row.measurement.pose();
                if kind == DiagnosisKind::PositionUnit {
                    pose.translation *= factor;
                } else {
                    pose = pose.inverse();
                }
                row.measurement = Measurement::of_pose(&pose);
            });
            format!("times {factor}")
        }
        DiagnosisKind::JointUnit
        | DiagnosisKind::JointSign
        | DiagnosisKind::JointsSwapped
        | DiagnosisKind::JointsCoupled
        | DiagnosisKind::JointScale
        | DiagnosisKind::BoardSize
        | DiagnosisKind::JointZero
        | DiagnosisKind::QuaternionOrder
        | DiagnosisKind::EulerConvention
        | DiagnosisKind::LeftHanded
        | DiagnosisKind::RowShift
        | DiagnosisKind::TargetsSwapped
        | DiagnosisKind::TargetsUnnamed
        | DiagnosisKind::DuplicateRows => panic!("{kind:?} is no mistake of these sessions"),
    };
    (data, words)
}

/// A part of a session: a tenth to four tenths of its rows.
fn part(count: usize, g: &mut ChaCha8Rng) -> (usize, usize) {
    let start = (count as f64 * draw_between(g, 0.0, 0.6)) as usize;
    (start, start + (count as f64 * draw_between(g, 0.1, 0.4)) as usize)
}

/// Rows of one anchor that name another: a part of the session, or both names exchanged in it.
fn rename_places(data: &mut Dataset, g: &mut ChaCha8Rng) -> String {
    let places = data.station_count();
    let (first, both) = (pick(g, places), uniform_number(g) < 0.5);
    let second = (first + 1 + pick(g, places - 1)) % places;
    let (start, end) = part(data.len(), g);
    change_observations(data, |row, observation| {
        if (start..end).contains(&row) {
            if observation.station == first {
                observation.station = second;
            } else if both && observation.station == second {
                observation.station = first;
            }
        }
    });
    format!("rows {start} to {end} of {first} name {second}, both ways: {both}")
}

fn diagnose_session(session: &Session, data: &Dataset) -> Vec<Diagnosis> {
    diagnose(&session.robot, data, &data.all_rows(), &DiagnosisOptions::default())
}

#[test]
fn mistakes_of_places_are_named() {
    assert_mistakes_are_named(trials(64), |index| {
        let (measured, kind) = CASES[index as usize % CASES.len()];
        let session = draw_session(measured, index);
        let (data, words) = make_mistake(&session, kind, index);
        let found = diagnose_session(&session, &data);
        let is_right = found.len() == 1 && found[0].kind == kind;
        let words = format!("({words}); {}", session.words);
        Looked { label: format!("{measured:?}, {kind:?}"), words, is_right, found }
    });
}

#[test]
fn clean_sessions_of_places_raise_no_alarm() {
    let kinds: Vec<SessionKind> = SessionKind::all().into_iter().filter(|kind| !kind.has_device()).collect();
    assert_no_alarms(trials(64), |index| {
        let session = draw_session(kinds[index as usize % kinds.len()], index + 7_000_000);
        let found = diagnose_session(&session, &session.data);
        (session.words, found)
    });
}
