//! `RAYON_NUM_THREADS=1 cargo bench -p poecal --bench files`: a measurement file read and `residuals.csv` written, in bytes a second
//! of one core.

#![allow(clippy::expect_used, reason = "a benchmark may end in a panic")]

use std::fmt::Write as _;

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_import::{ReadOptions, read};
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow};
use poecal_results::residuals::{ResidualRows, Residuals};

fn main() {
    divan::main();
}

const ROWS: usize = 50_000;

fn session() -> SimulationResult {
    let simulation = Simulation { count: ROWS, device_anywhere: false, ..Simulation::default() };
    simulation.run(&elbow(), SessionKind::POSE).expect("a simulation of a finite robot")
}

/// The rows as a file of the project's form, every number with this number of decimals, or else to its last digit.
fn table(made: &SimulationResult, decimals: Option<usize>) -> String {
    let mut text = made.data.reading_names().join(",") + ",x,y,z,qx,qy,qz,qw\n";
    for (row, observation) in made.data.observations.iter().enumerate() {
        let pose = observation.measurement.pose();
        let measured = pose.translation.iter().copied().chain(pose.quaternion_xyzw());
        for (column, number) in made.data.readings(row).iter().copied().chain(measured).enumerate() {
            let separator = if column == 0 { "" } else { "," };
            match decimals {
                Some(decimals) => write!(text, "{separator}{number:.decimals$}").expect("memory"),
                None => write!(text, "{separator}{number}").expect("memory"),
            }
        }
        text.push('\n');
    }
    text
}

#[divan::bench]
fn read_poses(bencher: Bencher<'_, '_>) {
    read_text(bencher, None);
}

#[divan::bench]
fn read_poses_of_seven_decimals(bencher: Bencher<'_, '_>) {
    read_text(bencher, Some(7));
}

fn read_text(bencher: Bencher<'_, '_>, decimals: Option<usize>) {
    let made = session();
    let text = table(&made, decimals);
    let path = std::env::temp_dir().join(format!("poecal_bench_{}.csv", std::process::id()));
    std::fs::write(&path, &text).expect("a folder for temporary files");
    bencher
        .counter(BytesCount::of_str(&text))
        .bench_local(|| black_box(read(&[&path], &made.nominal, &ReadOptions::default()).expect("our own form")));
    std::fs::remove_file(&path).expect("the file just written");
}

/// `residuals.csv` of available rows: the text alone.
#[divan::bench]
fn write_residuals_at_hand(bencher: Bencher<'_, '_>) {
    write(bencher, true);
}

/// `residuals.csv` of rows that are computed meanwhile: errors of three models, leverage and studentised residual.
#[divan::bench]
fn write_residuals(bencher: Bencher<'_, '_>) {
    write(bencher, false);
}

fn write(bencher: Bencher<'_, '_>, at_hand: bool) {
    let made = session();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).expect("a calibration");
    let residuals = Residuals::from_calibration(&made.data, &calibration);
    let rows = if at_hand { ResidualRows::AtHand(&residuals) } else { ResidualRows::Of(&made.data, &calibration) };
    bencher
        .counter(BytesCount::new(residuals.text().len()))
        .bench_local(|| rows.write_to(&mut std::io::sink()).expect("a sink takes all"));
}
