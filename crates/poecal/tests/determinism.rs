//! The same input gives the same bits, whatever the number of threads.

use poecal::calibration::{CalibrationOptions, calibrate};
use poecal::simulate::{Kind, Simulation, elbow};

/// Few rows; and enough of them for a fit to begin on a sample and to be summed in several parts.
const ROWS: [usize; 2] = [200, 9000];

#[test]
fn calibrations_with_one_thread_and_with_two_are_bit_identical() {
    for count in ROWS {
        for kind in [Kind::Pose, Kind::Point, Kind::Mixed] {
            let made = Simulation { count, ..Simulation::default() }.run(&elbow(), kind).unwrap();
            // The debugging form writes every number so that it reads back to the same bits.
            let with_threads = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let options = CalibrationOptions::default();
                format!("{:?}", pool.install(|| calibrate(&made.nominal, &made.data, &options).unwrap()))
            };
            let one = with_threads(1);
            println!("{kind:?}, {count} rows: {} characters of results", one.len());
            assert_eq!(one, with_threads(2));
            assert_eq!(one, with_threads(2));
        }
    }
}
