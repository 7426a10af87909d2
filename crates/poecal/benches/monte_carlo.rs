//! Many fits of one session with new noise each, for `benches/peers/run`: `monte_carlo MODEL EXACT.csv HELD_OUT.csv FITS` prints the CPU
//! time of all fits (packing, the first fit and the sharing of its factor included), mean iterations, and the error of the fitted robots
//! in the configurations held out. Measurements are exact, and get noise of 0.05 mm and 0.0005 rad for each fit.

#![allow(clippy::print_stdout, reason = "what it finds is for a program that reads it")]

mod trials;

use std::path::Path;
use std::time::Instant;

use cpu_time::ProcessTime;
use poecal_calibrate::nominal_estimate;
use poecal_fit::parameters::{Parameter, TargetFrame, screw_axes};
use poecal_fit::problem::{Problem, Refit};
use poecal_fit::state::{Estimate, PackedValues, Session};
use poecal_import as measurements;
use poecal_import::ReadOptions;
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::robot::Robot;
use poecal_numerics::error::{Error, ErrorKind};
use poecal_numerics::solve::{Options, minimize};
use poecal_results::model::Model;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use trials::{NOISE, disturb_measurements};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|it| !it.starts_with("--")).collect();
    let [model, exact, held_out, fits] = &arguments[..] else {
        let message = "expected MODEL EXACT.csv HELD_OUT.csv FITS";
        return Err(Error::new(ErrorKind::Option, message).into());
    };
    let robot = Model::read(Path::new(model), &Default::default())?.robot;
    let [exact, held_out] = [read(exact, &robot)?, read(held_out, &robot)?];
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let trials: Vec<Vec<Measurement>> =
        (0..fits.parse()?).map(|_| disturb_measurements(&exact, &mut generator)).collect();

    let (begin, wall) = (ProcessTime::now(), Instant::now());
    let found = fit_all(&robot, &exact, &trials);
    let [cpu_ms, wall_ms] = [begin.elapsed(), wall.elapsed()].map(|time| time.as_secs_f64() * 1e3);

    let iterations: usize = found.iter().map(|(_, iterations)| iterations).sum();
    let packed = PackedValues::from_dataset(&robot, &held_out);
    let session = Session::new(&robot, &held_out, &packed, false);
    let rows = held_out.all_rows();
    let squares: f64 = found
        .iter()
        .flat_map(|(estimate, _)| session.errors(&rows, estimate))
        .map(|error| error.position_m().norm_squared())
        .sum();
    let mean = |sum: f64, count: usize| sum / count.max(1) as f64;
    let held_out_mm = 1e3 * mean(squares, found.len() * rows.len()).sqrt();
    let iterations = mean(iterations as f64, found.len());
    println!(
        "{{\"cpu_ms\": {cpu_ms}, \"wall_ms\": {wall_ms}, \"iterations\": {iterations}, \"held_out_mm\": {held_out_mm}}}"
    );
    Ok(())
}

fn read(path: &str, robot: &Robot) -> poecal_numerics::error::Result<Dataset> {
    Ok(measurements::read(&[path], robot, &ReadOptions::default())?.data)
}

/// Fits every trial from the optimum of the first; estimates and numbers of iterations.
fn fit_all(robot: &Robot, data: &Dataset, trials: &[Vec<Measurement>]) -> Vec<(Estimate, usize)> {
    let Some(first) = trials.first() else { return Vec::new() };
    let mut begun = data.clone();
    begun.observations.iter_mut().zip(first).for_each(|(row, seen)| row.measurement = *seen);
    let start = nominal_estimate(robot, &begun);
    let packed = PackedValues::from_dataset(robot, &begun);
    let mut free = screw_axes(start.kinds());
    free.push(Parameter::TargetFrame(TargetFrame::new(0)));
    let session = Session::new(robot, &begun, &packed, false).with_length(robot.reach_m() / 3.0);
    let problem = Problem::new(session, begun.all_rows(), free, NOISE);
    let (optimum, _, _) = minimize(&problem, start, &Options::default());
    let refit = Refit::new(problem, optimum, Options::default());
    refit.fit_all(trials, |estimate, _, summary| (estimate, summary.iterations))
}
