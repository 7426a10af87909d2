//! A device at several stations: each has a frame of its own, the robot and its targets are common.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::{Calibration, CalibrationOptions, DeviceFrameKnowledge, calibrate, row_influence};
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::{Dataset, Measurement, Quantity, Set};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow, gantry, random, scara, seven_axis};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;

/// Another pose of the device, in the first one's frame.
fn station_pose(station: usize) -> Pose {
    Pose::from_xyz_rpy([1.5, -2.0 * station as f64, 0.3], [0.2, -0.1, 1.1 * station as f64])
}

/// The measurement as the device sees it from another pose.
fn seen_from(place: &Pose, measurement: &Measurement) -> Measurement {
    let pose = *place * measurement.pose();
    if measurement.sees_orientation() { Measurement::of_pose(&pose) } else { Measurement::point(pose.translation) }
}

/// The rows of a session distributed over several stations.
fn deal_out_rows(made: &SimulationResult, stations: usize) -> Dataset {
    let mut data = made.data.clone();
    let parts = data.len().div_ceil(stations);
    data.stations = (0..stations).map(|station| Some(format!("tracker {station}"))).collect();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        observation.station = row / parts;
        if observation.station > 0 {
            observation.measurement = seen_from(&station_pose(observation.station), &observation.measurement);
        }
    }
    data
}

fn session(robot: &Robot, kind: SessionKind, count: usize, seed: u64) -> (Simulation, SimulationResult) {
    let simulation = Simulation { count, seed, ..Simulation::default() };
    (simulation, simulation.run(robot, kind).unwrap())
}

fn fit(robot: &Robot, data: &Dataset) -> Calibration {
    calibrate(robot, data, &CalibrationOptions { held_out: Some(0.0), ..Default::default() }).unwrap()
}

/// Root mean square distance from the truth in configurations that no fit saw, metres, in the first station's frame.
fn unseen_m(simulation: &Simulation, made: &SimulationResult, kind: SessionKind, calibration: &Calibration) -> f64 {
    let unseen = simulation.held_out(made, kind, 300).unwrap();
    let packed = PackedValues::from_dataset(&made.nominal, &unseen);
    let session = Session::new(&made.nominal, &unseen, &packed, true);
    let errors = session.errors(&unseen.all_rows(), &calibration.models.calibrated);
    (errors.iter().map(|error| error.position_m().norm_squared()).sum::<f64>() / 300.0).sqrt()
}

#[test]
fn several_places_calibrate_as_one_does() {
    for (robot, kind) in [
        (elbow(), SessionKind::POINT),
        (elbow(), SessionKind::POSE),
        (scara(), SessionKind::POSE),
        (seven_axis(), SessionKind::MIXED),
    ] {
        let (mut one, mut two) = (0.0_f64, 0.0);
        for seed in 1..=4 {
            let (simulation, made) = session(&robot, kind, 120, seed);
            let alone = fit(&robot, &made.data);
            let found = fit(&robot, &deal_out_rows(&made, 2));
            one += unseen_m(&simulation, &made, kind, &alone).powi(2);
            two += unseen_m(&simulation, &made, kind, &found).powi(2);
            assert_eq!(found.stations.len(), 2);
            let apart = found.stations[1].base_from_device.inverse() * found.stations[0].base_from_device;
            let off = apart.inverse() * station_pose(1);
            let angle = rotation::log(&off.rotation).norm();
            assert!(off.translation.norm() < 1e-3 && angle < 1e-3, "{} m, {angle} rad", off.translation.norm());
            assert!(found.warnings.is_empty(), "{:?}", found.warnings);
            assert_eq!(found.verdict.level, alone.verdict.level, "{:?}", found.verdict);
        }
        let ratio = (two / one).sqrt();
        println!("{} {kind:?}: {:.4} mm, with two places {ratio:.2} times", robot.name, (one / 4.0).sqrt() * 1e3);
        // Six more unknowns take some of the numbers, no more.
        assert!(ratio < 1.3, "{ratio}");
    }
}

#[test]
fn exact_measurements_from_three_places_leave_nothing() {
    for robot in [elbow(), scara(), gantry()] {
        for kind in [SessionKind::POSE, SessionKind::POINT] {
            let exact =
                Simulation { count: 90, noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
            let made = exact.run(&robot, kind).unwrap();
            let found = fit(&robot, &deal_out_rows(&made, 3));
            let worst = found.accuracy.training.calibrated.position_mm().max;
            println!("{} {kind:?}: {worst:.1e} mm", robot.name);
            assert!(worst < 1e-6, "{worst}");
        }
    }
}

#[test]
fn each_further_place_adds_six_to_the_rank() {
    for (robot, kind, plain) in [
        (elbow(), SessionKind::POINT, 27),
        (elbow(), SessionKind::POSE, 30),
        (scara(), SessionKind::POSE, 20),
        (gantry(), SessionKind::POSE, 24),
    ] {
        let (_, made) = session(&robot, kind, 90, 2);
        for stations in 1..=3 {
            let data = deal_out_rows(&made, stations);
            let found = fit(&robot, &data);
            let expected = plain + 6 * (stations - 1);
            assert_eq!(found.identifiability.parameters, expected);
            assert_eq!(found.identifiability.rank, expected, "{}", robot.name);
            // The same rank, by another path: the leverage of each row.
            let dims = data.observations.iter().map(|row| row.measurement.dim() as f64);
            let leverages = row_influence(&found, &data, &data.all_rows());
            let sum: f64 = leverages.iter().zip(dims).map(|(row, dim)| row.leverage * dim).sum();
            assert!((sum - expected as f64).abs() < 1e-3, "{sum}");
        }
    }
}

#[test]
fn a_target_that_only_one_place_saw_is_found_too() {
    let robot = elbow();
    let (_, made) = session(&robot, SessionKind::POINT, 120, 3);
    let mut data = deal_out_rows(&made, 2);
    data.targets = vec![Some("a".into()), Some("b".into()), Some("c".into())];
    for (row, observation) in data.observations.iter_mut().enumerate() {
        observation.target = [row % 2, 1 + row % 2][observation.station];
        let shift = Vector3::new(0.05, 0.02, -0.03) * observation.target as f64;
        let tip = made.device_from_base * made.actual.forward_kinematics(made.data.readings(row));
        let by = tip.rotation * shift;
        let by = if observation.station == 0 { by } else { station_pose(1).rotation * by };
        let shifted = |pose: Pose| Pose::new(pose.rotation, pose.translation + by);
        observation.measurement = observation.measurement.map_pose(shifted).unwrap();
    }
    let found = fit(&robot, &data);
    assert_eq!(found.identifiability.rank, 24 + 9 + 6);
    assert!(found.accuracy.training.calibrated.position_mm().rms < 0.1);
}

fn refusal(robot: &Robot, data: &Dataset, options: &CalibrationOptions) -> String {
    calibrate(robot, data, options).unwrap_err().to_string()
}

#[test]
fn places_that_cannot_be_found_are_refused() {
    let robot = elbow();
    let (_, made) = session(&robot, SessionKind::POINT, 60, 1);
    let data = deal_out_rows(&made, 2);
    let base = CalibrationOptions { frame: DeviceFrameKnowledge::Base, ..Default::default() };
    assert_eq!(
        refusal(&robot, &data, &base),
        "found measurements of 2 instruments that are to be in the base frame (--device-frame base), expected one of the two: leave the \
         instruments' names out if all measure in the base frame, or --device-frame base if each has a frame of its own"
    );
    let mut few = data.clone();
    few.observations.iter_mut().skip(32).for_each(|observation| observation.station = 0);
    let all = CalibrationOptions { held_out: Some(0.0), ..Default::default() };
    assert_eq!(
        refusal(&robot, &few, &all),
        "found 2 measurements of instrument `tracker 1` to find its frame from, expected at least 3: measure more from there, hold \
         out fewer, or leave its rows out"
    );
}

/// A station that only held-out rows name is determined from these, with the robot as the others fitted it.
#[test]
fn the_frame_of_a_held_out_place_is_found_from_its_own_rows() {
    let robot = elbow();
    let (simulation, made) = session(&robot, SessionKind::POINT, 120, 1);
    let mut data = deal_out_rows(&made, 2);
    for observation in &mut data.observations {
        observation.set = Some(if observation.station == 0 { Set::Fit } else { Set::HeldOut });
    }
    let found = fit(&robot, &data);
    assert_eq!(found.identifiability.rank, 24 + 3);
    let held_out = found.accuracy.held_out.unwrap();
    println!("{:.4} mm", held_out.calibrated.position_mm().rms);
    // The noise of the measurements, and the uncertainty of a fit of 60 points.
    assert!(held_out.calibrated.position_mm().rms < 3.0 * 3f64.sqrt() * 1e3 * simulation.noise_position_m);
    assert!(held_out.registered.position_mm().rms > 1.0);
}

#[test]
fn mistakes_are_named_whatever_place_they_were_seen_from() {
    let robot = elbow();
    let (_, made) = session(&robot, SessionKind::POSE, 80, 1);
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    let two = deal_out_rows(&made, 2);
    for row in 0..two.len() {
        let mut readings = two.readings(row).to_vec();
        readings[2] = -readings[2];
        let name = two.stations[two.observations[row].station].clone();
        let station = data.station_index(name.as_deref());
        data.push(&readings, None, two.observations[row].measurement).unwrap();
        data.observations[row].station = station;
    }
    let found = fit(&robot, &data);
    assert_eq!(found.diagnosis.len(), 1, "{:?}", found.diagnosis);
    assert!(found.diagnosis[0].statement.contains("joint3"), "{}", found.diagnosis[0].statement);
}

/// Two instruments that see the same target: the noise of each is estimated apart, and the better one counts more.
#[test]
fn the_noise_of_each_instrument_is_found() {
    let robot = elbow();
    let (simulation, made) = session(&robot, SessionKind::POSE, 240, 5);
    let mut data = deal_out_rows(&made, 2);
    let mut generator = ChaCha8Rng::seed_from_u64(3);
    // The second one is ten times noisier in position, three times in rotation.
    let [position_m, rotation_rad] = [10.0 * simulation.noise_position_m, 3.0 * simulation.noise_rotation_rad];
    for observation in data.observations.iter_mut().filter(|it| it.station == 1) {
        let seen = observation.measurement.pose();
        let turn = rotation::exp(&(random::normal_vector(&mut generator) * rotation_rad));
        let position = seen.translation + random::normal_vector(&mut generator) * position_m;
        observation.measurement = Measurement::of_pose(&Pose::new(turn * seen.rotation, position));
    }
    let found = fit(&made.nominal, &data);
    let [first, second] = [0, 1].map(|station| found.stations[station].noise);
    let ratios = [Quantity::Position, Quantity::Rotation].map(|quantity| second[quantity] / first[quantity]);
    let expected = [101f64.sqrt(), 10f64.sqrt()];
    println!("ratios {ratios:.2?}, expected {expected:.2?}, first {:.1e} m", first[Quantity::Position]);
    for (ratio, expected) in ratios.into_iter().zip(expected) {
        // 360 numbers of each: 3.7 % standard deviation of either noise.
        assert!((ratio / expected).ln().abs() < 0.15, "{ratio} instead of {expected}");
    }
    assert!((first[Quantity::Position] / simulation.noise_position_m).ln().abs() < 0.15);
    // With one noise for both, the better instrument has hardly any weight.
    let unseen = unseen_m(&simulation, &made, SessionKind::POSE, &found);
    let mut stated = data.clone();
    stated.observations.iter_mut().for_each(|row| row.stated.set(Quantity::Position, Some(0.36e-3)));
    let together = unseen_m(&simulation, &made, SessionKind::POSE, &fit(&made.nominal, &stated));
    println!("unseen {:.4} mm, with one noise for both {:.4} mm", 1e3 * unseen, 1e3 * together);
    assert!(unseen < 0.5 * together);
}
