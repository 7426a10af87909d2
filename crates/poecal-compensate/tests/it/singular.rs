//! Corrections at singularities: for published arms, at their homes and along paths through every singularity, no joint moves farther than its limit,
//! and the tip's point is at its intended position.

use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::{CalibrationOptions, Corrections, calibrate};
use poecal_compensate::{ChangeOptions, Compensation, CorrectionOutcome, MaxCorrection};
use poecal_model::robot::Robot;
use poecal_model::simulate::random::uniform_number;
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use poecal_testing::trials::trials;

/// Axes and points (m) on them at zero, and the flange.
type Axes = ([([f64; 3], [f64; 3]); 6], [f64; 3]);

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
const BACK: [f64; 3] = [-1.0, 0.0, 0.0];
const RIGHT: [f64; 3] = [0.0, -1.0, 0.0];

/// Dimensions from the makers' data sheets, and homes in degrees. Upright, arms of UR10e and TX2-60 are stretched over their first axis with a
/// straight wrist: there the point moves in one plane only, and such homes are corrected or listed.
const ARMS: [(&str, Axes, &[[f64; 6]]); 6] = [
    (
        "IRB 120",
        (
            [
                (Z, [0.0; 3]),
                (Y, [0.0, 0.0, 0.290]),
                (Y, [0.0, 0.0, 0.560]),
                (X, [0.0, 0.0, 0.630]),
                (Y, [0.302, 0.0, 0.630]),
                (X, [0.302, 0.0, 0.630]),
            ],
            [0.374, 0.0, 0.630],
        ),
        &[[0.0; 6], [0.0, 0.0, 0.0, 0.0, 30.0, 0.0]],
    ),
    (
        "M-20iA",
        (
            [
                (Z, [0.0; 3]),
                (Y, [0.150, 0.0, 0.525]),
                (RIGHT, [0.150, 0.0, 1.315]),
                (BACK, [0.150, 0.0, 1.565]),
                (RIGHT, [0.985, 0.0, 1.565]),
                (BACK, [0.985, 0.0, 1.565]),
            ],
            [1.085, 0.0, 1.565],
        ),
        &[[0.0; 6]],
    ),
    (
        "KR 10 R1100",
        (
            [
                (DOWN, [0.0; 3]),
                (Y, [0.025, 0.0, 0.400]),
                (Y, [0.585, 0.0, 0.400]),
                (BACK, [0.585, 0.0, 0.435]),
                (Y, [1.100, 0.0, 0.435]),
                (BACK, [1.100, 0.0, 0.435]),
            ],
            [1.190, 0.0, 0.435],
        ),
        &[[0.0, -90.0, 90.0, 0.0, 0.0, 0.0]],
    ),
    (
        "UR10e",
        (
            [
                (Z, [0.0; 3]),
                (Y, [0.0, 0.0, 0.1807]),
                (Y, [0.6127, 0.0, 0.1807]),
                (Y, [1.18425, 0.17415, 0.1807]),
                (DOWN, [1.18425, 0.17415, 0.1807]),
                (Y, [1.18425, 0.17415, 0.06085]),
            ],
            [1.18425, 0.2907, 0.06085],
        ),
        &[[0.0; 6]],
    ),
    (
        "TX2-60",
        (
            [
                (Z, [0.0; 3]),
                (Y, [0.0, 0.0, 0.375]),
                (Y, [0.0, 0.020, 0.665]),
                (Z, [0.0, 0.020, 0.665]),
                (Y, [0.0, 0.020, 0.975]),
                (Z, [0.0, 0.020, 0.975]),
            ],
            [0.0, 0.020, 1.045],
        ),
        &[[0.0, 0.0, 90.0, 0.0, 0.0, 0.0]],
    ),
    (
        "GP7",
        (
            [
                (Z, [0.0; 3]),
                (Y, [0.040, 0.0, 0.330]),
                (RIGHT, [0.040, 0.0, 0.775]),
                (BACK, [0.040, 0.0, 0.815]),
                (RIGHT, [0.480, 0.0, 0.815]),
                (BACK, [0.480, 0.0, 0.815]),
            ],
            [0.560, 0.0, 0.815],
        ),
        &[[0.0; 6]],
    ),
];

/// The arm of some axes.
fn arm((axes, flange): &Axes) -> Robot {
    let mut robot = elbow();
    for (joint, (direction, point)) in robot.joints.iter_mut().zip(axes) {
        joint.screw = Screw::revolute(&(*direction).into(), &(*point).into());
        joint.limits = None;
    }
    robot.home = Pose::from_translation((*flange).into());
    robot
}

/// The published arms, then others of their kinds, with each length scaled by 0.7 to 1.3: axes that meet in a point still meet.
fn arms(count: usize) -> Vec<(String, Robot, Vec<[f64; 6]>)> {
    let scaled = |at: usize| {
        let (name, (axes, flange), homes) = &ARMS[at % ARMS.len()];
        let mut generator = ChaCha8Rng::seed_from_u64(at as u64);
        let factors: [f64; 3] = core::array::from_fn(|_| match at < ARMS.len() {
            true => 1.0,
            false => 0.7 + 0.6 * uniform_number(&mut generator),
        });
        let scale = |point: &[f64; 3]| core::array::from_fn(|axis| factors[axis] * point[axis]);
        let axes = core::array::from_fn(|joint| (axes[joint].0, scale(&axes[joint].1)));
        let name = if at < ARMS.len() { (*name).to_owned() } else { format!("{name}, {factors:.2?}") };
        (name, arm(&(axes, scale(flange))), homes.to_vec())
    };
    (0..count).map(scaled).collect()
}

/// The compensation of a calibrated session: the nominal robot as taught, and the calibrated one.
fn calibrate_compensation(nominal: &Robot, seed: u64) -> Compensation {
    let simulation = Simulation {
        count: 60,
        error_rotation_rad: 0.05_f64.to_radians(),
        error_position_m: 0.3e-3,
        noise_position_m: 3e-5,
        noise_rotation_rad: 3e-5,
        seed,
        ..Simulation::default()
    };
    let made = simulation.run(nominal, SessionKind::POSE).unwrap();
    let options = CalibrationOptions { corrections: Corrections::Off, ..CalibrationOptions::default() };
    let calibration = calibrate(nominal, &made.data, &options).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
    let actual = file.robot().unwrap();
    let taught = file.taught_robot(&actual).unwrap().robot;
    Compensation::new(&taught, &actual, &[], &ChangeOptions::default()).unwrap()
}

/// True if a turn of a joint by up to `degrees` moves the arm through a singularity.
fn is_near_singular(compensation: &Compensation, q: &[f64], degrees: f64) -> bool {
    let arm = compensation.nominal_arm();
    let hand = arm.handedness(q);
    hand == 0.0
        || (1..5).any(|joint| {
            [-1.0, -0.5, 0.5, 1.0].into_iter().any(|share: f64| {
                let mut moved = q.to_vec();
                moved[joint] += (share * degrees).to_radians();
                arm.handedness(&moved) != hand
            })
        })
}

/// Outcomes of rows: number, and number corrected.
#[derive(Default)]
struct Counted {
    regular: (usize, usize),
    singular: (usize, usize),
    homes: (usize, usize),
    /// Largest remainder of the point (m), of the rotation (rad), change relative to the limit, and step beyond the programmed one over twice the
    /// correction.
    worst: (f64, f64, f64, f64),
}

impl Counted {
    /// Corrects a path.
    fn way(&mut self, compensation: &mut Compensation, rows: &[[f64; 6]], is_home: bool) {
        let mut before: Option<([f64; 6], Vec<f64>, f64)> = None;
        for q in rows {
            let found = compensation.joints(q);
            let (outcome, is_corrected) = (found.outcome, found.is_corrected);
            let (left_m, left_rad, readings) = (found.left_m, found.left_rad, found.readings.to_vec());
            let turned_rad = found.turned_rad;
            let of = match (is_home, is_near_singular(compensation, q, 1.0)) {
                (true, _) => &mut self.homes,
                (false, true) => &mut self.singular,
                (false, false) => &mut self.regular,
            };
            of.0 += 1;
            of.1 += usize::from(is_corrected);
            if !is_corrected {
                assert_eq!(readings, q, "what is left as it is");
                before = None;
                continue;
            }
            assert!(outcome == CorrectionOutcome::Turned || left_rad < 1e-9);
            // Arms like these usually have errors of 0.1 deg, the worst of them twice that in the median.
            assert!(left_rad <= turned_rad.max(1f64.to_radians()), "much farther off than without correction");
            // The arm itself confirms it.
            let apart = compensation.actual_arm().forward_kinematics(&readings);
            let target = compensation.nominal_arm().forward_kinematics(q);
            let (metres, _) = apart.distance_and_angle(&target);
            self.worst.0 = self.worst.0.max(left_m).max(metres);
            self.worst.1 = self.worst.1.max(left_rad);
            self.worst.2 = self.worst.2.max(compensation.share_of_most(q, &readings));
            let largest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let change = largest(&readings, q);
            if let Some((meant, commanded, changed)) = &before {
                let beyond = largest(&readings, commanded) - largest(q, meant);
                self.worst.3 = self.worst.3.max(beyond / (2.0 * change.max(*changed)));
            }
            before = Some((*q, readings, change));
        }
    }
}

#[test]
fn no_row_is_sent_to_another_branch() {
    let mut all = Counted::default();
    let percent = |(all, corrected): (usize, usize)| 100.0 * corrected as f64 / all.max(1) as f64;
    // The weekly test has 40 arms; a test of a change has the published ones.
    let count = if trials(40).count < 40 { ARMS.len() } else { 40 };
    for (at, (name, nominal, homes)) in arms(count).into_iter().enumerate() {
        let mut counted = Counted::default();
        for seed in trials(8).seeds() {
            let mut compensation = calibrate_compensation(&nominal, 100 * at as u64 + seed);
            for home in &homes {
                counted.way(&mut compensation, &[home.map(f64::to_radians)], true);
            }
            for upright in [[0.0; 6], [0.0, -90.0, 0.0, -90.0, 0.0, 0.0]] {
                counted.way(&mut compensation, &[upright.map(f64::to_radians)], false);
            }
            // Paths lead through singularities, not along them: if a joint that is not moved is a degree from one, every row needs larger changes.
            let drawn = |base: u32| -> [f64; 6] {
                core::array::from_fn(|joint| (f64::from(base) + 1.7 * joint as f64 + seed as f64).sin())
            };
            let starts = (0..).map(drawn).filter(|q| !is_near_singular(&compensation, q, 5.0)).take(3);
            for start in starts.collect::<Vec<_>>() {
                for joint in [1, 2, 4] {
                    let rows: Vec<[f64; 6]> = (-1800..1800)
                        .map(|step| {
                            let mut q = start;
                            q[joint] = (0.1 * f64::from(step) + 0.013).to_radians();
                            q
                        })
                        .collect();
                    counted.way(&mut compensation, &rows, false);
                }
            }
        }
        println!(
            "{name}: corrected {:.3} % of {} rows, {:.2} % of {} within 1 deg of a singularity, {} of {} homes; left at most {:.1e} m, {:.2e} deg; \
             changes up to {:.2} of what is allowed, steps up to {:.2} of twice the correction longer",
            percent(counted.regular),
            counted.regular.0,
            percent(counted.singular),
            counted.singular.0,
            counted.homes.1,
            counted.homes.0,
            counted.worst.0,
            counted.worst.1.to_degrees(),
            counted.worst.2,
            counted.worst.3
        );
        let add = |to: &mut (usize, usize), of: (usize, usize)| (to.0, to.1) = (to.0 + of.0, to.1 + of.1);
        add(&mut all.regular, counted.regular);
        add(&mut all.singular, counted.singular);
        add(&mut all.homes, counted.homes);
        assert!(counted.worst.0 < 1e-9 && counted.worst.2 < 1.0 + 1e-6 && counted.worst.3 <= 1.0, "{name}");
    }
    let share = |(all, corrected): (usize, usize)| corrected as f64 / all as f64;
    println!("all: {:.3} %, {:.2} %", percent(all.regular), percent(all.singular));
    // With errors of 0.05° a joint has to move by 2° if it is some 1.5° from a singularity: one or two rows of a thousand. Nearer to it one in eight
    // would turn the tip farther than five times the usual error, and is unchanged.
    assert!(share(all.regular) > 0.997 && share(all.singular) > 0.8 && share(all.homes) == 1.0);
}

#[test]
fn a_straight_wrist_stays_straight() {
    let nominal = arm(&ARMS[0].1);
    let simulation = Simulation { count: 1, error_rotation_rad: 1e-3, error_position_m: 3e-4, ..Simulation::default() };
    let actual = simulation.run(&nominal, SessionKind::POSE).unwrap().actual;
    let mut compensation = Compensation::new(&nominal, &actual, &[], &ChangeOptions::default()).unwrap();
    let found = compensation.joints(&[0.0; 6]);
    let changes: Vec<f64> = found.readings.iter().map(|it| it.to_degrees()).collect();
    println!("{:?}: {changes:.3?} deg, {:.3} deg left", found.outcome, found.left_rad.to_degrees());
    assert!(found.is_corrected && found.left_m < 1e-9);
    // No larger change is allowed: the list then names the joint.
    let most = MaxCorrection { turning_rad: 1e-5, sliding_m: 1e-3 };
    let options = ChangeOptions { most_change: most, nearest: false };
    let mut narrow = Compensation::new(&nominal, &actual, &[], &options).unwrap();
    let found = narrow.joints(&[0.3, 0.2, 0.4, 0.5, 0.6, 0.7]);
    let (outcome, left, is_corrected) = (found.outcome, (found.left_m, found.left_rad), found.is_corrected);
    let reason = narrow.reason(outcome, left);
    println!("{reason}");
    assert!(!is_corrected && matches!(outcome, CorrectionOutcome::TooFar(..)));
    assert!(reason.contains("deg beyond its zero, where 0.001 deg are allowed"));
}
