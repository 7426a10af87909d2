//! The same input gives the same bits, whatever the number of threads.

use crate::common::with_threads;
use crate::trials::some;
use poecal::calibration::{CalibrationOptions, calibrate};
use poecal::io::residuals::{ResidualRows, Residuals};
use poecal::simulate::{Kind, Simulation, elbow};

/// Few rows; and enough of them for a fit, which keeps three tenths back, to begin on a sample and to sort and sum the rows in several
/// parts.
const ROWS: [usize; 2] = [200, 12_000];

#[test]
fn calibrations_with_one_thread_and_with_two_are_bit_identical() {
    for count in ROWS {
        for kind in some([Kind::Mixed, Kind::Pose, Kind::Point]) {
            let made = Simulation { count, ..Simulation::default() }.run(&elbow(), kind).unwrap();
            // The debugging form writes every number so that it reads back to the same bits.
            let results = |threads: usize| {
                let options = CalibrationOptions::default();
                with_threads(threads, || {
                    let calibration = calibrate(&made.nominal, &made.data, &options).unwrap();
                    let mut rows = Vec::new();
                    ResidualRows::Of(&made.data, &calibration).write_to(&mut rows).unwrap();
                    assert!(rows == Residuals::of(&made.data, &calibration).text().into_bytes());
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
