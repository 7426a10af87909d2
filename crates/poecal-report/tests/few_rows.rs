//! A calibration of geometry by few rows wakes no thread: the start of threads costs more than the whole calculation.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use poecal_calibrate::{CalibrationOptions, Corrections, calibrate};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_report::calibration_page;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::{Model, ModelSource};
use poecal_results::output::{Contents, ExistingFiles, ReservedFolder, Results, write};
use poecal_results::residuals::{ResidualRows, Residuals};

/// Threads of this process.
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").unwrap().count()
}

// A program of its own with this one test: others would wake threads of the same process meanwhile.
#[test]
fn fifty_rows_are_one_threads_work() {
    let before = threads();
    for kind in [SessionKind::POSE, SessionKind::POINT] {
        let made = Simulation { count: 50, ..Simulation::default() }.run(&elbow(), kind).unwrap();
        let geometry = CalibrationOptions { corrections: Corrections::Off, ..CalibrationOptions::default() };
        let calibration = calibrate(&made.nominal, &made.data, &geometry).unwrap();
        let residuals = Residuals::from_calibration(&made.data, &calibration);
        let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
        let report = Some(calibration_page(&file, &residuals).unwrap());
        let model = Model { robot: made.nominal, source: ModelSource::Toml, path: "elbow.toml".into() };
        let folder = std::env::temp_dir().join(format!("poecal_few_rows_{}", std::process::id()));
        let results = Results { file, residuals: ResidualRows::AtHand(&residuals), report };
        let place = ReservedFolder::reserve(&folder, Contents::Calibration, ExistingFiles::Replaced, &[], &mut |_| ());
        write(place.unwrap(), None, &model, &calibration.robot_with_targets(), results).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
    }
    assert_eq!(threads(), before);
    // Many rows show that the count would have detected threads.
    let many = Simulation { count: 20_000, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
    calibrate(&many.nominal, &many.data, &CalibrationOptions::default()).unwrap();
    if std::thread::available_parallelism().is_ok_and(|count| count.get() > 1) {
        assert!(threads() > before);
    }
}
