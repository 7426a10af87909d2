//! Single components of positions, and noise that is not the same in all directions (theory.md §4 (15), (17a)).

use nalgebra::{Matrix3, Vector3};
use poecal_calibrate::{Calibration, CalibrationOptions, RobustLoss, calibrate};
use poecal_fit::problem::Problem;
use poecal_fit::state::{PackedValues, Session};
use poecal_import::{InstrumentNoise, MeasurementFile, ReadOptions, parse};
use poecal_model::measurement::{Dataset, Measurement, Noise, NoiseShape, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::{SessionKind, Simulation, SimulationResult, elbow};
use poecal_numerics::solve::LeastSquares;
use poecal_testing::sessions::geometry;

fn session(count: usize, seed: u64, noise_position_m: f64) -> SimulationResult {
    let simulation = Simulation { count, seed, noise_position_m, ..Simulation::default() };
    simulation.run(&elbow(), SessionKind::POINT).unwrap()
}

fn fit(robot: &Robot, data: &Dataset) -> Calibration {
    let options = CalibrationOptions { robust: RobustLoss::Off, ..geometry() };
    calibrate(robot, data, &options).unwrap()
}

/// The points of a session with some of their components.
fn with_components(data: &Dataset, measured: impl Fn(usize) -> [bool; 3]) -> Dataset {
    let mut data = data.clone();
    for (row, observation) in data.observations.iter_mut().enumerate() {
        let (position, measured) = (observation.measurement.position().unwrap(), measured(row));
        let of = |k: usize| measured[k].then_some(position[k]);
        if measured != [true; 3] {
            observation.measurement = Measurement::components([of(0), of(1), of(2)]);
        }
    }
    data
}

/// True for each component of a row that is measured.
type Measured = fn(usize) -> [bool; 3];

/// Components are missing: one of some points, two of all, another one in each row.
#[test]
fn rows_without_some_components_find_the_robot() {
    let made = session(150, 1, 0.0);
    let cases: [(&str, usize, Measured); 5] = [
        ("z of every third", 30, |row| [true, true, row % 3 != 0]),
        ("each row another one", 30, |row| [row % 3 != 0, row % 3 != 1, row % 3 != 2]),
        ("one component a row", 30, |row| [row % 3 == 0, row % 3 == 1, row % 3 == 2]),
        ("two points, and x and z", 30, |row| [true, row < 2, true]),
        ("x and y alone", 29, |_| [true, true, false]),
    ];
    for (name, rank, measured) in cases {
        let found = fit(&made.nominal, &with_components(&made.data, measured));
        let held_out = found.accuracy.held_out.as_ref().unwrap().calibrated.position_mm().max;
        let rank_found = found.identifiability.rank;
        println!("{name}: held out {held_out:e} mm, rank {rank_found} of {}", found.identifiability.parameters);
        assert!(held_out < 1e-6, "{name}");
        // The elbow's tip is on its last axis: one unknown is that of the axis' tilt about it.
        assert_eq!(rank_found + 3, rank, "{name}");
    }
}

/// The whitened cost is that of the covariance, `½ eᵀ Σ⁻¹ e`, by every path of the library.
#[test]
fn the_cost_is_that_of_the_covariance() {
    let made = session(40, 2, 1e-4);
    let sight = Vector3::new(0.3, -0.5, 0.8).normalize();
    let mut data = made.data.clone();
    for row in 0..data.len() {
        data.state_noise(row, NoiseShape::from_sight(&sight, 1e-5, 7e-5));
    }
    let along = sight * sight.transpose();
    let covariance = along * 1e-10 + (Matrix3::identity() - along) * 49e-10;
    let packed = PackedValues::from_dataset(&made.nominal, &data);
    let session = Session::new(&made.nominal, &data, &packed, true);
    let estimate = poecal_fit::state::nominal_estimate(&made.nominal, &data);
    let errors = session.errors(&data.all_rows(), &estimate);
    let inverse = covariance.try_inverse().unwrap();
    let expected: f64 = errors.iter().map(|error| 0.5 * error.position_m().dot(&(inverse * error.position_m()))).sum();
    let problem = Problem::new(session, data.all_rows(), Vec::new(), Noise::new(1.0, 1.0));
    let cost = problem.normal(&estimate).cost;
    println!("{cost:e} {expected:e}");
    assert!((cost / expected - 1.0).abs() < 1e-12);
}

const HEADER: &str = "joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]";

fn read(text: &str, options: &ReadOptions) -> poecal_numerics::error::Result<MeasurementFile> {
    parse(text, "points.csv", &elbow(), options)
}

#[test]
fn an_empty_cell_is_a_component_that_was_not_measured() {
    let text = format!("{HEADER},x[mm],y[mm],z[mm]\n0,1,2,3,4,5,100,,300\n0,1,2,3,4,6,1,2,3\n");
    let file = read(&text, &ReadOptions::default()).unwrap();
    let seen = file.data.observations[0].measurement;
    assert_eq!(seen.position_components(), [Some(0.1), None, Some(0.3)]);
    assert_eq!(
        file.warnings,
        [
            "points.csv: took one row (line 2) as positions of which only some components were measured; --strict refuses empty cells"
        ]
    );
    let strict = ReadOptions { strict: true, ..ReadOptions::default() };
    assert!(read(&text, &strict).unwrap_err().to_string().contains(":2:17: found an empty cell in column `y`"));
}

#[test]
fn noise_is_stated_by_component_and_by_expanded_uncertainty() {
    let rows = "0,1,2,3,4,5,100,200,300,0.01,0.02,0.04\n0,1,2,3,4,6,1,2,,0.01,0.04,\n";
    let text = format!("{HEADER},x[mm],y[mm],z[mm],sigma_x[mm],sigma_y[mm],sigma_z[mm]\n{rows}");
    let data = read(&text, &ReadOptions::default()).unwrap().data;
    for (row, expected, sigmas) in [(0, 2e-5, [1e-5, 2e-5, 4e-5]), (1, 2e-5, [1e-5, 4e-5, f64::NAN])] {
        let observation = &data.observations[row];
        let sigma = observation.stated.get(Quantity::Position).unwrap();
        assert!((sigma / expected - 1.0).abs() < 1e-12, "{sigma}");
        let whitened = data.noise_shape(observation).unwrap().whiten_vector(&Vector3::repeat(1.0)) / sigma;
        for (one, expected) in whitened.iter().zip(sigmas).filter(|(_, sigma)| sigma.is_finite()) {
            assert!((one * expected - 1.0).abs() < 1e-12);
        }
    }
    let expanded = format!("{HEADER},x[mm],y[mm],z[mm],U95_position[um]\n0,1,2,3,4,5,100,200,300,30\n");
    let data = read(&expanded, &ReadOptions::default()).unwrap().data;
    let sigma = data.observations[0].stated.get(Quantity::Position).unwrap();
    assert!((sigma - 1.5e-5).abs() < 1e-18);
    for (header, row, expected) in [
        (
            "sigma_position[mm],U95_position[mm]",
            "0.1,0.2",
            "points.csv:1:110: found `U95_position` beside `sigma_position`, expected one of the two",
        ),
        (
            "sigma_x[mm],sigma_y[mm]",
            "0.1,0.2",
            "points.csv:2:25: found a standard deviation of some components, expected one of each that was measured, or of none",
        ),
        (
            "sigma_x[mm],sigma_y[mm],sigma_z[mm]",
            "0.1,-0.2,0.1",
            "points.csv:2:29: found `-0.2` in column `sigma_y`, expected a standard deviation above 0",
        ),
    ] {
        let text = format!("{HEADER},x[mm],y[mm],z[mm],{header}\n0,1,2,3,4,5,100,200,300,{row}\n");
        assert_eq!(read(&text, &ReadOptions::default()).unwrap_err().to_string(), expected);
    }
}

#[test]
fn noise_of_an_instrument_grows_across_its_line_of_sight() {
    let text = format!("{HEADER},instrument,x[m],y[m],z[m]\n0,1,2,3,4,5,tracker,0,0,4\n0,1,2,3,4,6,arm,0,0,1\n");
    let of = |noise: &str| {
        let instrument_noise = vec![noise.parse::<InstrumentNoise>()?];
        read(&text, &ReadOptions { instrument_noise, ..ReadOptions::default() })
    };
    let data = of("tracker:10um+5um/m").unwrap().data;
    let sigma = data.observations[0].stated.get(Quantity::Position).unwrap();
    let one = data.noise_shape(&data.observations[0]).unwrap().whiten_vector(&Vector3::repeat(1.0)) / sigma;
    let across = 1e-5f64.hypot(2e-5);
    assert!((one.z * 1e-5 - 1.0).abs() < 1e-12 && (one.x * across - 1.0).abs() < 1e-12);
    assert_eq!(data.observations[1].stated.get(Quantity::Position), None);
    assert!(of("10um").unwrap().data.observations.iter().all(|it| it.noise_shape.is_some()));
    for (noise, expected) in [
        ("laser:10um", "found noise of the instrument `laser`, expected one of tracker, arm"),
        (
            "tracker:10",
            "found `tracker:10` as the noise of an instrument, expected a standard deviation in all directions and one across the line of sight for each metre, like tracker:10um+5um/m",
        ),
        (
            "tracker:10um+5um",
            "found `tracker:10um+5um` as the noise of an instrument, expected a standard deviation in all directions and one across the line of sight for each metre, like tracker:10um+5um/m",
        ),
    ] {
        assert_eq!(of(noise).unwrap_err().to_string(), expected);
    }
}

/// Positions are accurate along the line of sight and inaccurate across it. A fit with this noise predicts better than a fit with equal noise, and
/// its predicted uncertainty holds.
#[test]
fn a_fit_that_knows_the_noise_is_better() {
    let (along, across) = (2e-6, 2e-4);
    let mut ratios = Vec::new();
    for seed in 0..8 {
        let exact = session(120, 40 + seed, 0.0);
        let noise = Simulation { count: 120, seed: 900 + seed, noise_position_m: 1.0, ..Simulation::default() };
        // Unit noise of another session, made along and across the line of sight.
        let unit = noise.run(&elbow(), SessionKind::POINT).unwrap();
        let clean = Simulation { noise_position_m: 0.0, ..noise }.run(&elbow(), SessionKind::POINT).unwrap();
        let (mut known, mut alike) = (exact.data.clone(), exact.data.clone());
        for row in 0..exact.data.len() {
            let place = |data: &Dataset| data.observations[row].measurement.position().unwrap();
            let sight = place(&exact.data).normalize();
            let chance = place(&unit.data) - place(&clean.data);
            let shift = sight * (sight.dot(&chance) * along) + (chance - sight * sight.dot(&chance)) * across;
            let seen = Measurement::point(place(&exact.data) + shift);
            known.observations[row].measurement = seen;
            alike.observations[row].measurement = seen;
            known.state_noise(row, NoiseShape::from_sight(&sight, along, across));
        }
        let further = Simulation { count: 200, seed: 40 + seed, noise_position_m: 0.0, ..Simulation::default() }
            .held_out(&exact, SessionKind::POINT, 200)
            .unwrap();
        let error = |data: &Dataset| {
            let found = fit(&exact.nominal, data);
            let packed = PackedValues::from_dataset(&exact.nominal, &further);
            let session = Session::new(&exact.nominal, &further, &packed, true);
            let errors = session.errors(&further.all_rows(), &found.models.calibrated);
            let squares: f64 = errors.iter().map(|error| error.position_m().norm_squared()).sum();
            (squares / errors.len() as f64).sqrt()
        };
        let (by_known, by_alike) = (error(&known), error(&alike));
        println!("seed {seed}: {:.4} mm with the shape, {:.4} mm without", by_known * 1e3, by_alike * 1e3);
        ratios.push(by_known / by_alike);
    }
    ratios.sort_by(f64::total_cmp);
    // A third of the numbers are a hundred times better; their effect on the robot depends on the configurations.
    assert!(ratios[4] < 0.5, "{ratios:?}");
}
