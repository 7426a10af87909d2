//! Events during a session are found, named, and repaired if they are evident; nothing is found in a session without events.

use nalgebra::Vector3;
use poecal_arm::lie::rotation;
use poecal_calibrate::{
    Calibration, CalibrationOptions, EventKind, RepairedSession, Repairs, calibrate, calibrate_repairing,
};
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow};

use poecal_testing::trials::trials;

const COUNT: usize = 80;
/// Part of the statement about readings that were all early.
const EARLY: &str = "before they came to rest";

fn session(seed: u64, kind: SessionKind) -> SimulationResult {
    // Compliant gears, so that the robot has errors of its own beside the noise.
    let simulation = Simulation { count: COUNT, seed, noise_position_m: 5e-5, ..Simulation::default() };
    simulation.run(&elbow(), kind).unwrap()
}

/// The measured positions moved from one row on.
fn move_rows_from(data: &mut Dataset, first: usize, by: impl Fn(usize, Vector3<f64>) -> Vector3<f64>) {
    for (row, observation) in data.observations.iter_mut().enumerate().skip(first) {
        observation.measurement = Measurement::point(by(row, observation.measurement.position().unwrap()));
    }
}

fn calibrate_repaired(robot: &Robot, data: &Dataset, options: &CalibrationOptions) -> (Calibration, Dataset) {
    let RepairedSession { calibration, data } = calibrate_repairing(robot, data, options, &mut |_| {}).unwrap();
    (calibration, data.into_owned())
}

/// Error of the first target's distances between positions of the truth, which no frame changes. `slipped` is the increase of the second joint's
/// reading.
fn error_mm(made: &SimulationResult, calibration: &Calibration, slipped: f64) -> f64 {
    let rows: Vec<&[f64]> = (0..COUNT).map(|row| made.data.readings(row)).collect();
    let target = calibration.targets[0].tip_from_target.translation;
    let is = |k: usize| made.actual.forward_kinematics(rows[k]).translation;
    let found = |k: usize| {
        let mut readings = rows[k].to_vec();
        readings[1] += slipped;
        calibration.robot.forward_kinematics(&readings).act(&target)
    };
    let off = |k: usize| {
        let other = (k + 17) % COUNT;
        (is(k) - is(other)).norm() - (found(k) - found(other)).norm()
    };
    let squares = (0..COUNT).map(|k| off(k).powi(2)).sum::<f64>();
    1e3 * (squares / COUNT as f64).sqrt()
}

#[test]
fn a_move_of_the_device_of_a_target_of_a_zero_and_a_drift_are_repaired() {
    let trials = trials(8).at_least(4);
    let tilt = |v: Vector3<f64>| rotation::exp(&Vector3::new(0.0, 0.002, 0.004)) * v;
    for seed in trials.seeds() {
        let clean = session(seed, SessionKind::POINT);
        let (calibration, _) = calibrate_repaired(&clean.nominal, &clean.data, &CalibrationOptions::default());
        assert!(calibration.repairs.is_empty() && calibration.suspicions.is_empty(), "{:?}", calibration.repairs);
        assert!(!calibration.warnings.iter().any(|it| it.contains(EARLY)), "{:?}", calibration.warnings);
        let usual = error_mm(&clean, &calibration, 0.0);
        let mut lines = vec![format!("seed {seed}: clean {usual:.4} mm")];
        let mut check = |words: &str, data: &Dataset, kind: EventKind, from_row: usize, size: f64, within: f64| {
            let (calibration, repaired) = calibrate_repaired(&clean.nominal, data, &CalibrationOptions::default());
            let told: Vec<String> = calibration.suspicions.iter().map(|it| it.statement.clone()).collect();
            assert_eq!(calibration.repairs.len(), 1, "{words}: {told:?} {:?}", calibration.repairs);
            let event = &calibration.repairs[0];
            let own = event.size_mm.or(event.size_deg).unwrap();
            let slipped = if kind == EventKind::Zero { size.to_radians() } else { 0.0 };
            let error = error_mm(&clean, &calibration, slipped);
            lines.push(format!("  {words}: {} {error:.4} mm", event.statement));
            assert_eq!((event.kind, event.from_row), (kind, from_row), "{}", event.statement);
            assert!((own - size).abs() < within, "{}", event.statement);
            assert!(event.error_after_mm.unwrap() < 0.8 * event.error_before_mm.unwrap());
            // Half of the rows determine the arm with six numbers more: the error increases only a little.
            assert!(error < 1.35 * usual + 0.01, "{words}: {error} mm, clean {usual} mm");
            assert_eq!(repaired.len(), COUNT);
            repaired
        };
        let mut data = clean.data.clone();
        move_rows_from(&mut data, 40, |_, place| tilt(place) + Vector3::new(0.0, 0.002, 0.0));
        let (calibration, _) = calibrate_repaired(&clean.nominal, &data, &CalibrationOptions::default());
        assert_eq!(calibration.repairs[0].kind, EventKind::Device);
        let mut data = clean.data.clone();
        move_rows_from(&mut data, 40, |_, place| place + Vector3::new(0.0, 0.0006, 0.0008));
        let repaired = check("device 1 mm", &data, EventKind::Device, 41, 1.0, 0.1);
        assert_eq!(repaired.stations.iter().flatten().collect::<Vec<_>>(), ["device", "device.2"]);
        let mut data = clean.data.clone();
        let axes: Vec<_> = (0..COUNT).map(|row| clean.actual.forward_kinematics(clean.data.readings(row))).collect();
        move_rows_from(&mut data, 40, |row, place| {
            place + clean.device_from_base.rotation * axes[row].rotation * Vector3::new(0.001, 0.0, 0.0)
        });
        let repaired = check("target 1 mm", &data, EventKind::Target, 41, 1.0, 0.1);
        assert_eq!(repaired.targets.iter().flatten().collect::<Vec<_>>(), ["measured", "measured.2"]);
        let data = with_readings(&clean.data, |row, readings| {
            if row >= 40 {
                readings[1] += 0.2_f64.to_radians();
            }
        });
        check("zero 0.2 deg", &data, EventKind::Zero, 41, 0.2, 0.02);
        let mut data = clean.data.clone();
        move_rows_from(&mut data, 0, |row, place| place + Vector3::new(0.0, 1e-3 * row as f64 / COUNT as f64, 0.0));
        check("drift 1 mm", &data, EventKind::Drift, 1, 1.0, 0.15);
        println!("{}", lines.join("\n"));
    }
}

fn with_readings(data: &Dataset, change: impl Fn(usize, &mut [f64])) -> Dataset {
    let mut other = Dataset::new(data.reading_names().to_vec());
    other.targets.clone_from(&data.targets);
    for row in 0..data.len() {
        let mut readings = data.readings(row).to_vec();
        change(row, &mut readings);
        other.push_observation(&readings, data.observations[row]).unwrap();
    }
    other
}

#[test]
fn configurations_that_are_wrong_as_a_whole_are_left_out() {
    let clean = session(3, SessionKind::POSE);
    let (calibration, _) = calibrate_repaired(&clean.nominal, &clean.data, &CalibrationOptions::default());
    let usual = error_mm(&clean, &calibration, 0.0);
    // Readings taken a degree before the arm was there.
    let wrong = [7, 20, 33, 51, 64];
    let data = with_readings(&clean.data, |row, readings| {
        if wrong.contains(&row) {
            readings.iter_mut().for_each(|value| *value += 0.01);
        }
    });
    let (calibration, _) = calibrate_repaired(&clean.nominal, &data, &CalibrationOptions::default());
    let error = error_mm(&clean, &calibration, 0.0);
    let known: Vec<u32> = calibration.robustness.suspects().collect();
    println!("clean {usual:.4} mm, with wrong configurations {error:.4} mm: {known:?} {:?}", calibration.repairs);
    assert_eq!(known, wrong.map(|row| row as u32));
    assert!(error < 1.25 * usual);
}

#[test]
fn without_repairs_an_evident_move_is_a_reason_not_to_use_the_result() {
    let mut made = session(5, SessionKind::POINT);
    move_rows_from(&mut made.data, 40, |_, place| place + Vector3::new(0.0, 0.002, 0.0));
    let options = CalibrationOptions { repair: Repairs::Off, ..CalibrationOptions::default() };
    let (calibration, data) = calibrate_repaired(&made.nominal, &made.data, &options);
    let [event] = &calibration.suspicions[..] else { panic!("{:?}", calibration.suspicions) };
    println!("{:?}: {}", calibration.verdict.level, event.statement);
    assert!(calibration.repairs.is_empty() && data == made.data);
    assert_eq!((event.kind, event.error_after_mm), (EventKind::Device, None));
    assert_eq!(calibration.verdict.reasons.first(), Some(&event.statement));
    // Plain `calibrate`, which repairs nothing, reports the event too.
    let plain = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    assert!(
        plain.repairs.is_empty() && plain.warnings.iter().any(|it| it.contains("shifted by")),
        "{:?}",
        plain.warnings
    );
}

#[test]
fn what_is_larger_than_a_repair_may_be_is_named_and_not_acted_upon() {
    let mut made = session(5, SessionKind::POINT);
    move_rows_from(&mut made.data, 40, |_, place| place + Vector3::new(0.0, 0.08, 0.0));
    let (calibration, data) = calibrate_repaired(&made.nominal, &made.data, &CalibrationOptions::default());
    let [event] = &calibration.suspicions[..] else { panic!("{:?}", calibration.suspicions) };
    println!("{}", event.statement);
    assert!(calibration.repairs.is_empty() && data == made.data && event.kind == EventKind::Device);
    assert!(event.statement.contains("more than the 50 mm that --repair-limit device=50mm"));
    assert_eq!(calibration.verdict.reasons.first(), Some(&event.statement));
    let repair_limits = "device=100mm".parse().unwrap();
    let options = CalibrationOptions { repair_limits, ..CalibrationOptions::default() };
    let (calibration, _) = calibrate_repaired(&made.nominal, &made.data, &options);
    assert_eq!((calibration.repairs.len(), calibration.suspicions.len()), (1, 0));
}

#[test]
fn a_mistake_that_explains_more_is_named_and_nothing_is_repaired() {
    for seed in trials(4).at_least(2).seeds() {
        let mut made = session(seed, SessionKind::POINT);
        move_rows_from(&mut made.data, 0, |_, place| Vector3::new(place.x, place.y, 1e-3 * place.z));
        for repair_limits in ["device=50mm", "device=10m,tool=10m,zero=180deg"] {
            let repair_limits = repair_limits.parse().unwrap();
            let options = CalibrationOptions { repair_limits, ..CalibrationOptions::default() };
            let (calibration, _) = calibrate_repaired(&made.nominal, &made.data, &options);
            let said: Vec<&String> = calibration.diagnosis.iter().map(|it| &it.statement).collect();
            println!("seed {seed}: {said:?} {:?}", calibration.suspicions);
            assert!(calibration.repairs.is_empty(), "{:?}", calibration.repairs);
            assert!(said.iter().any(|it| it.contains("multiplying z alone by 1000")), "{said:?}");
        }
    }
}

/// Joints that turn at one speed and are read a constant time early.
#[test]
fn readings_that_are_all_early_are_named_with_their_angle() {
    for (seed, early_deg) in [(1, 0.05), (2, 0.2), (3, 0.1)] {
        let made = session(seed, SessionKind::POINT);
        let data = with_readings(&made.data, |row, readings| {
            let Some(before) = row.checked_sub(1).map(|row| made.data.readings(row)) else { return };
            let way: Vec<f64> = readings.iter().zip(before).map(|(own, before)| own - before).collect();
            let largest = way.iter().fold(0.0, |most: f64, it| most.max(it.abs()));
            readings.iter_mut().zip(&way).for_each(|(own, way)| *own -= f64::to_radians(early_deg) * way / largest);
        });
        let (calibration, _) = calibrate_repaired(&made.nominal, &data, &CalibrationOptions::default());
        let said: Vec<&String> = calibration.warnings.iter().filter(|it| it.contains(EARLY)).collect();
        println!("{early_deg} deg: {said:?} {:?}", calibration.repairs);
        let [said] = said[..] else { panic!("{:?}", calibration.warnings) };
        assert!(said.contains(&format!("{early_deg:.2} deg")), "{said}");
        // In reverse order no reading was early.
        let data = with_readings(&made.data, |row, readings| {
            if row + 1 < COUNT {
                let after = made.data.readings(row + 1);
                let way: Vec<f64> = after.iter().zip(&*readings).map(|(after, own)| after - own).collect();
                let largest = way.iter().fold(0.0, |most: f64, it| most.max(it.abs()));
                readings.iter_mut().zip(&way).for_each(|(own, way)| *own += 1e-3 * way / largest);
            }
        });
        let (calibration, _) = calibrate_repaired(&made.nominal, &data, &CalibrationOptions::default());
        assert!(!calibration.warnings.iter().any(|it| it.contains(EARLY)), "{:?}", calibration.warnings);
    }
}

/// Rounding counts as noise, up to half of the residuals: the robot is better than its rows suggest.
#[test]
fn the_rounding_of_readings_is_noise_and_no_error_of_the_robot() {
    for seed in trials(6).at_least(3).seeds() {
        let made = session(seed, SessionKind::POINT);
        let step = 0.1_f64.to_radians();
        let data = with_readings(&made.data, |_, readings| {
            readings.iter_mut().for_each(|value| *value = (*value / step).round() * step);
        });
        let (calibration, _) = calibrate_repaired(&made.nominal, &data, &CalibrationOptions::default());
        assert!(calibration.warnings.iter().any(|it| it.contains("are rounded to 0.1 deg")));
        let left_mm = calibration.accuracy.held_out.unwrap().calibrated.position_mm().rms;
        let expected_mm = calibration.verdict.expected_error_mm.unwrap();
        // The truth concerns points of the tip, which no row shows exactly, so distances of pairs are compared.
        let error_mm = error_mm(&made, &calibration, 0.0);
        println!("seed {seed}: {left_mm:.3} mm left, {expected_mm:.3} mm expected, {error_mm:.3} mm of distances");
        assert!(error_mm < 1.5 * expected_mm && expected_mm < 0.95 * left_mm);
    }
}
