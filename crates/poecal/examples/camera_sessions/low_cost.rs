//! Arms of hobby servos: an SO-101 with zeros off by up to 20 degrees, two signs turned, axes off by 1 degree and 1 mm, play, readings rounded to
//! ticks, and forty pictures of a board by a webcam.

use nalgebra::{Vector2, Vector3};
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::CalibrationOptions;
use poecal_fit::start::{find_zeros, settle_pictures};
use poecal_formats::urdf::ChainSelection;
use poecal_model::camera::{Board, Camera, Corner, Lens, Picture, middle};
use poecal_model::measurement::{Dataset, RowLocation};
use poecal_model::robot::Robot;
use poecal_model::simulate::{Configurations, Simulation, random};
use poecal_numerics::error::{Error, ErrorKind};
use poecal_results::model::Model;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;
use serde_json::{Value, json};

use crate::session::{calibrate_session, delivered_poses, rms};
use poecal_model::measurement::deviation;

const URDF: &str = include_str!("../../../../examples/so101/robot.urdf");
/// Pictures of a session, and further configurations by which it is judged.
const COUNT: usize = 40;
const FURTHER: usize = 40;
/// Largest zero (rad), error of each axis (rad, m), play (rad), tick (rad), noise of a corner (px).
const ZERO_RAD: f64 = 20.0 * std::f64::consts::PI / 180.0;
const AXES: (f64, f64) = (std::f64::consts::PI / 180.0, 1e-3);
const PLAY_RAD: f64 = 0.3 * std::f64::consts::PI / 180.0;
const TICK_RAD: f64 = std::f64::consts::TAU / 4096.0;
const NOISE_PX: f64 = 0.3;

struct Arm {
    nominal: Robot,
    actual: Robot,
    signs: Vec<f64>,
    zeros: Vec<f64>,
    held: Pose,
    other: Pose,
    in_hand: bool,
    lens: Lens,
    board: Board,
}

impl Arm {
    /// Readings of the motors at joint values, with play, in ticks.
    fn motors(&self, joints: &[f64], generator: &mut ChaCha8Rng) -> Vec<f64> {
        let one = |((joint, sign), zero): ((&f64, &f64), &f64)| {
            let play = if random::uniform_number(generator) < 0.5 { -0.5 } else { 0.5 } * PLAY_RAD;
            // joint = sign · motor + zero
            let motor = sign * (joint + play - zero);
            (motor / TICK_RAD).round() * TICK_RAD
        };
        joints.iter().zip(&self.signs).zip(&self.zeros).map(one).collect()
    }

    /// Pose of the board in the camera.
    fn view(&self, joints: &[f64]) -> Pose {
        let held = self.actual.forward_kinematics(joints) * self.held;
        if self.in_hand { held.inverse() * self.other } else { self.other.inverse() * held }
    }

    fn corners(&self, view: &Pose, generator: &mut ChaCha8Rng) -> Option<Vec<Corner>> {
        let center = view.act(&middle(&self.board.points));
        let facing = view.rotation.column(2).dot(&center.normalize());
        if !(0.12..1.2).contains(&center.z) || facing < 0.5 {
            return None;
        }
        let mut corners = Vec::new();
        for (point, place) in (0..).zip(&self.board.points) {
            let exact = self.lens.pixel(&view.act(place))?;
            if !((0.0..1279.0).contains(&exact.x) && (0.0..719.0).contains(&exact.y)) {
                return None;
            }
            let noise = Vector2::new(random::normal(generator), random::normal(generator)) * NOISE_PX;
            corners.push(Corner { point, pixel: exact + noise, sigma_px: None, weight: 1.0, line: 0 });
        }
        Some(corners)
    }

    /// Configurations in which the whole board is seen.
    fn configurations(&self, count: usize, generator: &mut ChaCha8Rng) -> Option<Vec<(Vec<f64>, Vec<Corner>)>> {
        let ranges = Configurations::new(&self.nominal);
        let mut found = Vec::new();
        for _ in 0..400_000 {
            let joints = ranges.random(generator);
            if let Some(corners) = self.corners(&self.view(&joints), generator) {
                found.push((joints, corners));
                if found.len() == count {
                    return Some(found);
                }
            }
        }
        None
    }
}

fn arm(seed: u64) -> Option<Arm> {
    let model = Model::parse(URDF, "so101.urdf", &ChainSelection::default()).ok()?;
    let nominal = model.robot;
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0x50_101);
    let errors = Simulation { error_rotation_rad: AXES.0, error_position_m: AXES.1, ..Simulation::default() };
    let actual = errors.perturb(&nominal, &mut generator);
    let count = nominal.joints.len();
    let mut signs = vec![1.0; count];
    let first = (random::uniform_number(&mut generator) * count as f64) as usize % count;
    let step = 1 + (random::uniform_number(&mut generator) * (count - 1) as f64) as usize % (count - 1);
    signs[first] = -1.0;
    signs[(first + step) % count] = -1.0;
    let zeros = (0..count).map(|_| ZERO_RAD * (2.0 * random::uniform_number(&mut generator) - 1.0)).collect();
    let in_hand = seed.is_multiple_of(2);
    let lens = Lens { size_px: Some([1280, 720]), ..Lens::pinhole([920.0, 920.0], [639.5, 359.5]) };
    let board = Board::chessboard("board", [9, 6], if in_hand { 0.028 } else { 0.02 }).ok()?;
    let ranges = Configurations::new(&nominal);
    let ready = ranges.random(&mut generator);
    let turn = rotation::exp(&(random::direction(&mut generator) * 0.3));
    let held = Pose::new(
        turn * rotation::about(0, if in_hand { 0.0 } else { std::f64::consts::PI }),
        random::normal_vector(&mut generator) * 0.02,
    );
    let depth = if in_hand { 0.25 } else { 0.45 };
    let sight = Pose::new(rotation::exp(&(random::direction(&mut generator) * 0.4)), Vector3::new(0.0, 0.0, depth));
    let sight = Pose::new(sight.rotation, sight.translation - sight.rotation * middle(&board.points));
    let at = nominal.forward_kinematics(&ready) * held;
    let other = if in_hand { at * sight } else { at * sight.inverse() };
    Some(Arm { nominal, actual, signs, zeros, held, other, in_hand, lens, board })
}

pub(crate) fn run(seed: u64) -> Result<Vec<Value>, Error> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let made = (0..50).find_map(|attempt| {
        let arm = arm(seed + 1_000_000 * attempt * 2)?;
        let all = arm.configurations(COUNT + FURTHER, &mut generator)?;
        Some((arm, all))
    });
    let Some((arm, all)) = made else {
        return Err(Error::new(ErrorKind::Problem, "found no arm whose camera sees the board"));
    };
    let mut data = Dataset::new(arm.nominal.reading_names());
    data.pictures.cameras = vec![Camera::new("camera".to_owned(), arm.lens)];
    data.pictures.boards = vec![arm.board.clone()];
    for (joints, corners) in all.iter().take(COUNT) {
        let readings = arm.motors(joints, &mut generator);
        let picture = Picture::new(0, 0, Some(format!("{:03}.png", data.len())), corners.clone());
        data.push_picture(&readings, picture, (None, RowLocation::default()))?
            .map_err(|reason| Error::new(ErrorKind::Problem, reason))?;
    }
    data.settle_pixels();
    let started = std::time::Instant::now();
    let found = find_zeros(&data, &arm.nominal).ok_or_else(|| Error::new(ErrorKind::Problem, "no zeros"))?;
    let took = started.elapsed().as_secs_f64();
    let rows = u32::try_from(data.len()).unwrap_or(u32::MAX);
    data.change_readings(rows, |readings| found.apply(readings));
    let said = settle_pictures(&mut data, &arm.nominal).all();
    let is_right = found.signs == arm.signs;
    let zero_errors: Vec<Option<f64>> =
        found.zeros.iter().zip(&arm.zeros).map(|(a, b)| a.map(|a| (a - b).to_degrees())).collect();
    let mut line = json!({"task": "low_cost", "seed": seed, "in_hand": arm.in_hand, "signs": is_right, "found": found.signs, "true": arm.signs,
        "zero_errors_deg": zero_errors, "misfit_mm": 1e3 * found.misfit_m, "before_mm": 1e3 * found.before_m, "other_mm": 1e3 * found.other_m, "odds": found.odds, "evident": found.are_evident(), "took_s": took, "said": said});
    match calibrate_session(
        &arm.nominal,
        &data,
        &CalibrationOptions { held_out: Some(0.0), ..CalibrationOptions::default() },
    ) {
        Ok((calibration, data)) => {
            let mut readings = Vec::new();
            for (joints, _) in all.iter().skip(COUNT) {
                // Play and ticks belong to the motion that is predicted.
                let mut own = arm.motors(joints, &mut generator);
                found.apply(&mut own);
                readings.extend(own);
            }
            let (poses, doubts) = delivered_poses(&calibration, &data, &readings)?;
            let truth = all.iter().skip(COUNT).map(|(joints, _)| {
                let view = arm.view(joints);
                if arm.in_hand { view.inverse() } else { view }
            });
            let deviations: Vec<_> = truth.zip(&poses).map(|(truth, pose)| deviation(pose, &truth)).collect();
            let [error, _] = rms(&deviations);
            line["error_mm"] = json!(1e3 * error);
            line["inside"] = json!(
                deviations
                    .iter()
                    .zip(&doubts)
                    .filter(|(d, e)| d.fixed_rows::<3>(0).norm() <= e.bound_position_m())
                    .count() as f64
                    / FURTHER as f64
            );
            line["level"] = json!(calibration.verdict.level.words());
            line["expected_mm"] = json!(calibration.verdict.expected_error_mm);
            line["repairs"] = json!(calibration.repairs.iter().map(|it| it.statement.clone()).collect::<Vec<_>>());
        }
        Err(error) => line["refused"] = json!(error.to_string()),
    }
    Ok(vec![line])
}
