//! Arms of hobby servos: an SO-101 with zeros off by up to 20 degrees, two signs turned, axes off by 1 degree and 1 mm, play, readings rounded to
//! ticks, and forty pictures of a board by a webcam.

use poecal_fit::start::{JointZeros, find_zeros, settle_pictures};
use poecal_formats::motors::TICKS;
use poecal_formats::urdf::ChainSelection;
use poecal_model::camera::{Board, Distortion, Lens};
use poecal_model::measurement::deviation;
use poecal_model::robot::Robot;
use poecal_model::simulate::{PictureSimulation, SimulatedPictures, Simulation, random};
use poecal_numerics::error::{Error, ErrorKind};
use poecal_results::model::Model;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use serde_json::{Value, json};

use crate::session::{all_rows, calibrate_session, delivered_poses, rebuild_pictures, rms};

const URDF: &str = include_str!("../../../../examples/so101/robot.urdf");
/// Pictures of a session, and further configurations by which it is judged.
const COUNT: usize = 40;
const FURTHER: usize = 40;
/// Largest zero, error of each axis (rad, m), play, rad.
const ZERO_RAD: f64 = 20.0 * std::f64::consts::PI / 180.0;
const AXES: (f64, f64) = (std::f64::consts::PI / 180.0, 1e-3);
const PLAY_RAD: f64 = 0.3 * std::f64::consts::PI / 180.0;
const TICK_RAD: f64 = std::f64::consts::TAU / TICKS;

/// Signs and zeros of the motors, `joint = sign · motor + zero`.
struct Motors {
    signs: Vec<f64>,
    zeros: Vec<f64>,
}

impl Motors {
    /// Two signs turned, zeros anywhere within their largest.
    fn random(count: usize, generator: &mut ChaCha8Rng) -> Self {
        let mut at: Vec<usize> = (0..count).collect();
        random::shuffle(generator, &mut at);
        let signs = (0..count).map(|joint| if at[..2].contains(&joint) { -1.0 } else { 1.0 }).collect();
        let zeros = (0..count).map(|_| ZERO_RAD * (2.0 * random::uniform_number(generator) - 1.0)).collect();
        Motors { signs, zeros }
    }

    /// Readings at joint values, with play, in whole ticks.
    fn read(&self, joints: &mut [f64], generator: &mut ChaCha8Rng) {
        for ((joint, sign), zero) in joints.iter_mut().zip(&self.signs).zip(&self.zeros) {
            let play = if random::uniform_number(generator) < 0.5 { -0.5 } else { 0.5 } * PLAY_RAD;
            *joint = (sign * (*joint + play - zero) / TICK_RAD).round() * TICK_RAD;
        }
    }
}

/// Pictures of the arm, by a camera beside it or on its wrist.
fn simulate(nominal: &Robot, seed: u64, in_hand: bool) -> Result<SimulatedPictures, Error> {
    let session = Simulation {
        count: COUNT + FURTHER,
        seed,
        error_rotation_rad: AXES.0,
        error_position_m: AXES.1,
        ..Simulation::default()
    };
    let distortion = Distortion::Brown([-0.08, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let lens = Lens { size_px: Some([1280, 720]), distortion, ..Lens::pinhole([920.0, 920.0], [639.5, 359.5]) };
    let simulation = PictureSimulation {
        lens,
        board: Board::chessboard("board", [9, 6], if in_hand { 0.028 } else { 0.02 }).unwrap_or_default(),
        distance_m: if in_hand { [0.25, 0.45] } else { [0.35, 0.8] },
        ..PictureSimulation::with_usual_camera(session, in_hand)
    };
    simulation.run(nominal)
}

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let nominal = Model::parse(URDF, "so101.urdf", &ChainSelection::default())?.robot;
    let in_hand = seed.is_multiple_of(2);
    // An arm that cannot show the board is another one.
    let made = (0..50).find_map(|attempt| simulate(&nominal, seed + 1_000_000 * attempt, in_hand).ok());
    let made = made.ok_or_else(|| Error::new(ErrorKind::Problem, "found no arm whose camera sees the board"))?;
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x50_101);
    let motors = Motors::random(nominal.joints.len(), &mut generator);
    let pictures = &made.data.pictures;
    let mut data = rebuild_pictures(&made.data, 0..COUNT, (&pictures.cameras, &pictures.boards))?;
    data.change_readings(COUNT as u32, |readings| motors.read(readings, &mut generator));
    let found = find_zeros(&data, &nominal).ok_or_else(|| Error::new(ErrorKind::Problem, "no zeros"))?;
    data.change_readings(COUNT as u32, |readings| found.apply(readings));
    let said = settle_pictures(&mut data, &nominal).all();
    let mut line = described(&found, &motors);
    (line["seed"], line["in_hand"], line["said"]) = (json!(seed), json!(in_hand), json!(said));
    let (calibration, data) = match calibrate_session(&nominal, &data, &all_rows()) {
        Ok(fitted) => fitted,
        Err(error) => {
            line["refused"] = json!(error.to_string());
            return Ok(vec![line]);
        }
    };
    // Play and ticks belong to the motion that is predicted.
    let mut readings = made.data.all_readings()[COUNT * nominal.joints.len()..].to_vec();
    for row in readings.chunks_exact_mut(nominal.joints.len()) {
        motors.read(row, &mut generator);
        found.apply(row);
    }
    let (poses, doubts) = delivered_poses(&calibration, &data, &readings)?;
    let truth = made.camera_from_board[COUNT..].iter().map(|it| if in_hand { it.inverse() } else { *it });
    let deviations: Vec<_> = truth.zip(&poses).map(|(truth, pose)| deviation(pose, &truth)).collect();
    let inside =
        deviations.iter().zip(&doubts).filter(|(own, bound)| own.fixed_rows::<3>(0).norm() <= bound.bound_position_m());
    line["inside"] = json!(inside.count() as f64 / FURTHER as f64);
    line["error_mm"] = json!(1e3 * rms(&deviations)[0]);
    line["expected_mm"] = json!(calibration.verdict.expected_error_mm);
    line["level"] = json!(calibration.verdict.level.words());
    Ok(vec![line])
}

/// Signs and zeros that were found, beside the true ones.
fn described(found: &JointZeros, motors: &Motors) -> Value {
    let errors = found.zeros.iter().zip(&motors.zeros).map(|(own, zero)| own.map(|own| (own - zero).to_degrees()));
    json!({
        "task": "low_cost", "signs": found.signs == motors.signs, "evident": found.are_evident(), "odds": found.odds,
        "zero_errors_deg": errors.collect::<Vec<_>>(), "misfit_mm": 1e3 * found.misfit_m, "before_mm": 1e3 * found.before_m,
    })
}
