//! With few configurations all rows are fitted, and cross-validation judges.

use poecal_calibrate::{AcceptanceLimits, CalibrationOptions, calibrate};
use poecal_model::measurement::{Dataset, Measurement, Quantity, Set};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_testing::sessions::{geometry, simulate_session};

#[test]
fn few_configurations_are_all_fitted_unless_something_else_is_asked_for() {
    let limits = AcceptanceLimits::from_choice(vec!["1mm".parse().unwrap()], None).unwrap();
    let share = |held_out| CalibrationOptions { held_out, ..geometry() };
    let cases = [
        (38, geometry(), 0, Some(38)),
        (39, geometry(), 12, None),
        (38, share(Some(0.3)), 11, None),
        (38, share(Some(0.0)), 0, None),
        (38, CalibrationOptions { accept: limits, ..geometry() }, 11, None),
    ];
    for (count, options, held_out, few) in cases {
        let made = simulate_session(&elbow(), SessionKind::POSE, count, 3);
        let found = calibrate(&made.nominal, &made.data, &options).unwrap();
        assert_eq!((found.held_out_rows.len(), found.accuracy.few_configurations), (held_out, few), "{count}");
        assert_eq!(found.accuracy.held_out.map_or(0, |it| it.count), held_out);
    }
    let mut made = simulate_session(&elbow(), SessionKind::POSE, 38, 3);
    made.data.observations[7].set = Some(Set::HeldOut);
    let found = calibrate(&made.nominal, &made.data, &geometry()).unwrap();
    assert_eq!((&found.held_out_rows[..], found.accuracy.few_configurations), (&[7][..], None));
}

/// Cross-validation predicts each row once, and reports separately the rows outside the range of the others.
#[test]
fn rows_beyond_the_range_of_the_others_are_reported_apart() {
    let made = Simulation { count: 200, seed: 8, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
    let value = |row: usize| made.data.readings(row)[1];
    let near = (0..200).filter(|&row| (value(row) - 0.6).abs() < 0.6).take(40);
    let far = (0..200).filter(|&row| (value(row) - 0.6).abs() > 2.0).take(1);
    let mut data = Dataset::new(made.data.reading_names().to_vec());
    for row in near.chain(far) {
        let pose = made.data.observations[row].measurement.pose();
        data.push(made.data.readings(row), None, Measurement::of_pose(&pose)).unwrap();
    }
    let options = CalibrationOptions { held_out: Some(0.0), ..geometry() };
    let found = calibrate(&made.nominal, &data, &options).unwrap().trust.cross_validation.unwrap();
    let rows: Vec<u32> = found.errors.iter().map(|(row, _)| *row).collect();
    assert_eq!(rows, data.all_rows());
    let outside = found.outside.as_ref().unwrap();
    let [random, inside, outside_m] =
        [found.random.rms, found.inside, outside.rms].map(|it| it.get(Quantity::Position).unwrap());
    println!("{} rows outside: {outside_m} m, inside {inside} m, all {random} m", outside.rows);
    assert!((1..12).contains(&outside.rows));
    // The squares of both together equal those of all.
    let count = (rows.len(), outside.rows);
    let sum = (count.0 - count.1) as f64 * inside.powi(2) + count.1 as f64 * outside_m.powi(2);
    assert!((sum / (count.0 as f64 * random.powi(2)) - 1.0).abs() < 1e-9);
    assert!(inside < random && random < outside_m);
}
