//! A session with several instruments: points of a tracker, distances of a wire, and poses of a second instrument, read from one file.

use nalgebra::Vector3;
use poecal_arm::lie::Pose;
use poecal_calibrate::{BlockChoice, CalibrationOptions, Level, calibrate};
use poecal_import::{ReadOptions, parse};
use poecal_model::measurement::Quantity;
use poecal_model::robot::Robot;
use poecal_model::simulate::{Configurations, SessionKind, Simulation, elbow, random};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_testing::sessions::geometry;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;
use std::fmt::Write as _;

const TRACKER_M: f64 = 2e-5;
const WIRE_M: f64 = 2e-4;
const CAMERA: (f64, f64) = (1e-4, 2e-4);

/// The built robot and its nominal model.
fn robots() -> (Robot, Robot) {
    let robot = elbow();
    let home = robot.home * Pose::from_translation(Vector3::new(0.08, 0.0, 0.05));
    let made = Simulation { count: 1, ..Simulation::default() };
    let made = made.run(&Robot { home, ..robot }, SessionKind::POINT).unwrap();
    (made.actual, made.nominal)
}

/// Rows of all three, each with its noise, in sequence.
fn text(actual: &Robot, rows: usize, generator: &mut ChaCha8Rng) -> String {
    let joints = actual.reading_names();
    let mut text = format!("{},instrument,x,y,z,qx,qy,qz,qw,distance[mm]\n", joints.join(","));
    let tracker = Pose::from_xyz_rpy([2.0, -1.0, 0.5], [0.3, -0.2, 1.0]);
    let camera = Pose::from_xyz_rpy([-1.0, 1.5, 1.0], [-0.4, 0.5, -2.0]);
    let anchor = Vector3::new(0.9, 0.8, 0.1);
    let configurations = Configurations::new(actual);
    for row in 0..rows {
        let readings = configurations.random(generator);
        let tip = actual.forward_kinematics(&readings);
        readings.iter().for_each(|reading| write!(text, "{reading:?},").unwrap());
        let noise = random::normal_vector(generator);
        match row % 3 {
            0 => {
                let [x, y, z]: [f64; 3] = (tracker.act(&tip.translation) + noise * TRACKER_M).into();
                writeln!(text, "tracker,{x:?},{y:?},{z:?},,,,,").unwrap();
            }
            1 => {
                let distance = (tip.translation - anchor).norm() + noise.x * WIRE_M;
                writeln!(text, "wire,,,,,,,,{:?}", 1e3 * distance).unwrap();
            }
            _ => {
                let seen = camera * tip;
                let turn = random::normal_vector(generator) * CAMERA.1;
                let rotation = poecal_arm::lie::rotation::exp(&turn) * seen.rotation;
                let seen = Pose::new(rotation, seen.translation + noise * CAMERA.0);
                let [x, y, z]: [f64; 3] = seen.translation.into();
                let [a, b, c, d] = seen.quaternion_xyzw();
                writeln!(text, "camera,{x:?},{y:?},{z:?},{a:?},{b:?},{c:?},{d:?},").unwrap();
            }
        }
    }
    text
}

#[test]
fn points_distances_and_poses_are_calibrated_together_with_a_noise_of_each_instrument() {
    let (actual, nominal) = robots();
    let mut generator = ChaCha8Rng::seed_from_u64(4);
    let file = parse(&text(&actual, 450, &mut generator), "cell.csv", &nominal, &ReadOptions::default()).unwrap();
    // No row is refused: every one is in the fit or held out, and the sums over rows have only one path, that of the kernels.
    assert_eq!(file.data.len(), 450);
    let found = calibrate(&nominal, &file.data, &CalibrationOptions { move_tip: true, ..geometry() }).unwrap();
    assert_eq!(found.fit_rows.len() + found.held_out_rows.len(), 450);
    let held_out = found.accuracy.held_out.unwrap();
    assert_eq!(held_out.count, found.held_out_rows.len());
    for (quantity, nominal) in held_out.registered.iter() {
        let calibrated = held_out.calibrated.get(quantity).unwrap();
        println!(
            "{}: registered {:.4}, calibrated {:.4} {}",
            quantity.name(),
            nominal.rms,
            calibrated.rms,
            quantity.unit().symbol()
        );
    }
    let distance = held_out.calibrated.get(Quantity::Distance).unwrap();
    // The residual of a predicted distance is the error of its measurement: 105 rows determine its size to 7 %, taken three times.
    assert!((distance.rms / (1e3 * WIRE_M) - 1.0).abs() < 0.25, "{}", distance.rms);
    for (name, quantity, truth) in [
        ("tracker", Quantity::Position, TRACKER_M),
        ("wire", Quantity::Distance, WIRE_M),
        ("camera", Quantity::Position, CAMERA.0),
        ("camera", Quantity::Rotation, CAMERA.1),
    ] {
        let station = found.stations.iter().find(|it| it.name.as_deref() == Some(name)).unwrap();
        let noise = station.noise[quantity];
        println!("{name}: {} {noise:.2e}, simulated {truth:.2e}", quantity.name());
        assert!((noise / truth - 1.0).abs() < 0.25, "{name}: {noise:e} instead of {truth:e}");
    }
    assert!(found.identifiability.rank == found.identifiability.parameters);
    assert_eq!(found.verdict.level, Level::Good, "{:?}", found.verdict.reasons);

    // The tip was not measured: it is predicted anywhere, in the tracker's frame.
    let configurations = Configurations::new(&actual);
    let tracker = Pose::from_xyz_rpy([2.0, -1.0, 0.5], [0.3, -0.2, 1.0]);
    let base_from_tracker = found.base_from_device;
    let worst = (0..300).map(|_| {
        let readings = configurations.random(&mut generator);
        let predicted = base_from_tracker.inverse().act(&found.robot.forward_kinematics(&readings).translation);
        (predicted - tracker.act(&actual.forward_kinematics(&readings).translation)).norm()
    });
    let worst = worst.fold(0.0, f64::max);
    println!("farthest prediction: {:.4} mm", 1e3 * worst);
    assert!(worst < 1e-4);
}

#[test]
fn distances_alone_give_a_robot_that_predicts_distances() {
    let (actual, nominal) = robots();
    let mut generator = ChaCha8Rng::seed_from_u64(9);
    let rows = text(&actual, 900, &mut generator);
    let wire: Vec<&str> = rows.lines().filter(|line| !line.contains("tracker") && !line.contains("camera")).collect();
    let file = parse(&wire.join("\n"), "wire.csv", &nominal, &ReadOptions::default()).unwrap();
    assert_eq!(file.data.len(), 300);
    let found = calibrate(&nominal, &file.data, &geometry()).unwrap();
    let held_out = found.accuracy.held_out.unwrap();
    let [registered, calibrated] =
        [&held_out.registered, &held_out.calibrated].map(|it| it.get(Quantity::Distance).unwrap().rms);
    println!("registered {registered:.3}, calibrated {calibrated:.3} mm, rank {}", found.identifiability.rank);
    assert!(calibrated < 1.3e3 * WIRE_M && registered > 5.0 * calibrated);
    // 24 of the axes and 3 of the point, less the turns about the anchor, which no distance determines.
    assert_eq!((found.identifiability.rank, found.identifiability.parameters), (24, 24));
}

/// Distances of one wire, as a file with these changes of its lines.
fn wire(rows: usize, seed: u64, change: impl Fn(usize, f64) -> f64) -> (Robot, Robot, String) {
    let (actual, nominal) = robots();
    let rows = text(&actual, 3 * rows, &mut ChaCha8Rng::seed_from_u64(seed));
    let mut lines = rows.lines().filter(|line| !line.contains("tracker,") && !line.contains("camera,"));
    let mut text = lines.next().unwrap().to_owned() + "\n";
    for (row, line) in lines.enumerate() {
        let (rest, distance) = line.rsplit_once(',').unwrap();
        writeln!(text, "{rest},{:?}", change(row, distance.parse().unwrap())).unwrap();
    }
    (actual, nominal, text)
}

#[test]
fn a_gross_error_of_a_distance_is_one_suspected_row() {
    let (_, nominal, text) = wire(200, 3, |row, distance| if row == 7 { distance + 50.0 } else { distance });
    let file = parse(&text, "wire.csv", &nominal, &ReadOptions::default()).unwrap();
    let found = calibrate(&nominal, &file.data, &geometry()).unwrap();
    let suspected: Vec<usize> = (0..200).filter(|&row| found.robustness.rows[row].suspected).collect();
    println!("{suspected:?} {:?} {:?}", found.verdict.level, found.diagnosis);
    assert_eq!(suspected, [7]);
    assert!(found.diagnosis.is_empty() && found.verdict.level != Level::DoNotUse, "{:?}", found.verdict);
}

#[test]
fn distances_of_another_unit_or_below_zero_are_refused() {
    let refused = |change: fn(usize, f64) -> f64, from: &str, to: &str| {
        let (_, nominal, text) = wire(60, 5, change);
        parse(&text.replace(from, to), "wire.csv", &nominal, &ReadOptions::default()).unwrap_err().to_string()
    };
    let message = refused(|_, distance| distance, "distance[mm]", "distance");
    println!("{message}");
    assert!(message.contains("expected another unit, most likely mm"));
    let message = refused(|row, distance| if row == 3 { -distance } else { distance }, "?", "?");
    println!("{message}");
    assert!(message.starts_with("wire.csv:5:") && message.contains("expected a distance above 0"));
}

#[test]
fn a_calibration_by_distances_with_held_blocks_is_read_back() {
    let (_, nominal, text) = wire(200, 6, |_, distance| distance);
    let file = parse(&text, "wire.csv", &nominal, &ReadOptions::default()).unwrap();
    let fix = vec!["joint2".to_owned()];
    let blocks = BlockChoice { fix, ..BlockChoice::default() };
    let options = CalibrationOptions { blocks, ..geometry() };
    let found = calibrate(&nominal, &file.data, &options).unwrap();
    let written = CalibrationFile::new(&found, &file.data, Inputs::default());
    let read = CalibrationFile::parse(&written.to_text().unwrap(), "calibration.json").unwrap();
    assert!(read.uncertainty(&[None]).is_ok());
    assert!(read.unknowns().unwrap().contains(&"frame.wire.x".to_owned()));
}
