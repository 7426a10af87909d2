//! The same input leads to the same bits, for any number of threads.

use poecal_compensate::{ChangeOptions, Compensation, Inverse, Kinematics};
use poecal_model::robot::{JointTerm, Term};

use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::residuals::{ResidualRows, Residuals};
use poecal_testing::sessions::with_threads;
use poecal_testing::trials::choose_some;

/// Few rows; and enough of them for a fit, which holds out three tenths, to start on a sample and to sort and sum the rows in several parts.
const ROWS: [usize; 2] = [200, 12_000];

#[test]
fn calibrations_with_one_thread_and_with_two_are_bit_identical() {
    for count in ROWS {
        for kind in choose_some([SessionKind::MIXED, SessionKind::POSE, SessionKind::POINT]) {
            let made = Simulation { count, ..Simulation::default() }.run(&elbow(), kind).unwrap();
            // The debugging form writes every number so that it reads back to the same bits.
            let results = |threads: usize| {
                let options = CalibrationOptions::default();
                with_threads(threads, || {
                    let calibration = calibrate(&made.nominal, &made.data, &options).unwrap();
                    let mut rows = Vec::new();
                    ResidualRows::Of(&made.data, &calibration).write_to(&mut rows).unwrap();
                    assert!(rows == Residuals::from_calibration(&made.data, &calibration).text().into_bytes());
                    (format!("{calibration:?}"), rows)
                })
            };
            let one = results(1);
            println!("{kind:?}, {count} rows: {} characters of results", one.0.len());
            assert!(one == results(2));
            assert!(one == results(2));
        }
    }
}

#[test]
fn kinematics_do_not_depend_on_threads() {
    let nominal = elbow();
    let mut actual = nominal.clone();
    actual.terms.push(JointTerm { joint: 1, term: Term::OFFSET, coefficient: 0.01 });
    let readings: Vec<f64> = (0..6 * 2100).map(|at| (f64::from(at) * 0.37).sin()).collect();
    let found = |threads: usize| {
        with_threads(threads, || {
            let kinematics = Kinematics::new(&actual, &[]).unwrap();
            let (tips, jacobians) = (kinematics.forward_kinematics(&readings), kinematics.jacobians(&readings));
            let inverse = Inverse::new(&actual, &[]).unwrap();
            let near =
                inverse.of_many(&tips[..300], |it, row, tip| it.solve_nearest(tip, &readings[6 * row..][..6], false));
            let compensation = Compensation::new(&nominal, &actual, &[], &ChangeOptions::default()).unwrap();
            (tips, jacobians, near, compensation.of_many(&readings, false).0)
        })
    };
    let one = found(1);
    assert!(one.2.iter().all(Option::is_some));
    for threads in [2, 5] {
        assert!(found(threads) == one, "{threads} threads");
    }
    // Many corrections at once equal those one after the other.
    let mut compensation = Compensation::new(&nominal, &actual, &[], &ChangeOptions::default()).unwrap();
    let each: Vec<f64> = readings.chunks_exact(6).flat_map(|row| compensation.joints(row).readings.to_vec()).collect();
    assert!(each == one.3);
}
