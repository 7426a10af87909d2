//! The hot path against the general path: Gram matrix, gradient and cost on many problems, by every instruction set of this machine, and with any
//! number of threads.

use crate::reference;
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_calibrate::fit_screws;
use poecal_fit::parameters::{DeviceFrame, Parameter, ScrewAxis, TargetFrame, TargetPlace, ValueTerm};
use poecal_fit::problem::{Problem, Refit, SimdLevel, simd_levels, stated_level};
use poecal_fit::state::{self as estimate, Estimate, PackedValues, nominal_estimate};
use poecal_model::measurement::{Dataset, Measurement, Noise, Quantity};
use poecal_model::robot::{Robot, Term};
use poecal_model::simulate::{SessionKind, Simulation, elbow, gantry, random, random_chain, scara, seven_axis};
use poecal_numerics::solve::{LeastSquares, NormalEquations, Options, minimize};
use poecal_testing::largest::larger_or_nan;
use poecal_testing::sessions::geometry;
use poecal_testing::trials::choose_some;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

const NOISE: Noise = Noise::new(5e-5, 5e-4);
const LENGTH_M: f64 = 0.4;
/// Both paths sum the same products in another order: rounding, and no more.
const TOLERANCE: f64 = 1e-12;

/// Robots with their names.
fn robots() -> Vec<(String, Robot)> {
    let mut robots = vec![
        ("elbow".to_owned(), elbow()),
        ("scara".to_owned(), scara()),
        ("seven axes".to_owned(), seven_axis()),
        ("gantry".to_owned(), gantry()),
    ];
    for joints in [1, 2, 3, 5, 8, 12, 20, 30] {
        robots.push((format!("random {joints}"), random_chain(joints, joints as u64)));
    }
    robots
}

/// Differences of a problem from the plainest one.
#[derive(Clone, Copy, Debug, Default)]
struct Case {
    rows: usize,
    targets: usize,
    /// Further stations of the device, each with an unknown frame.
    further: usize,
    device: bool,
    weights: bool,
    /// Rows state noise of one ratio, or of any.
    stated: bool,
    any_ratio: bool,
    /// Only rows from this one on state noise or see the last target.
    late: usize,
    /// Only every second axis is unknown.
    some_axes: bool,
    /// Nothing is unknown except the position of the first target, or not even that.
    place_only: bool,
    nothing: bool,
    /// The last rows are turned by this much, radians.
    turned_rad: f64,
}

/// More rows than are sorted at a time; only some late ones are of another kind.
fn many_rows_case() -> Case {
    Case { rows: 9000, targets: 3, stated: true, late: 8500, ..Case::default() }
}

fn cases() -> Vec<Case> {
    let plain = Case { rows: 37, targets: 1, ..Case::default() };
    vec![
        plain,
        Case { rows: 1, ..plain },
        Case { rows: 64, device: true, ..plain },
        Case { rows: 71, targets: 3, device: true, ..plain },
        Case { rows: 55, further: 1, ..plain },
        Case { rows: 83, targets: 2, further: 2, device: true, weights: true, ..plain },
        Case { rows: 50, weights: true, stated: true, ..plain },
        Case { rows: 50, weights: true, stated: true, any_ratio: true, targets: 2, ..plain },
        Case { rows: 40, some_axes: true, device: true, ..plain },
        Case { rows: 40, targets: 2, place_only: true, ..plain },
        Case { rows: 40, nothing: true, ..plain },
        Case { rows: 40, turned_rad: 0.2, ..plain },
        Case { rows: 40, turned_rad: 3.1, any_ratio: true, stated: true, ..plain },
        Case { rows: 2100, targets: 2, ..plain },
        many_rows_case(),
    ]
}

struct Session {
    robot: Robot,
    data: Dataset,
    packed: PackedValues,
    estimate: Estimate,
    free: Vec<Parameter>,
    weights: Vec<f64>,
}

impl Session {
    fn new(robot: &Robot, kind: SessionKind, case: &Case) -> Self {
        let made = Simulation { count: case.rows, ..Simulation::default() }.run(robot, kind).unwrap();
        let mut data = made.data.clone();
        data.targets = (0..case.targets).map(|target| Some(format!("t{target}"))).collect();
        for (row, observation) in data.observations.iter_mut().enumerate() {
            let is_early = row < case.late;
            observation.target = row % (case.targets - usize::from(is_early));
            observation.station = row / 3 % (1 + case.further);
            if case.stated && !is_early {
                let position_m = 1e-5 * (1 + row % 4) as f64;
                let ratio = if case.any_ratio { 1.0 + (row % 3) as f64 } else { 2.0 };
                observation.stated.set(Quantity::Position, Some(position_m));
                observation.stated.set(Quantity::Rotation, Some(position_m * ratio));
            }
            if row > 20 {
                let turn = rotation::exp(&(Vector3::new(0.6, -0.48, 0.64) * case.turned_rad));
                let turned = |pose: Pose| Pose::new(turn * pose.rotation, pose.translation);
                observation.measurement = observation.measurement.map_pose(turned).unwrap();
            }
        }
        let home = |target: usize| robot.home * Pose::from_translation(Vector3::x() * (0.1 * target as f64));
        let mut estimate = Estimate::new(robot, (0..case.targets).map(home).collect(), made.device_from_base);
        data.stations = (0..=case.further).map(|station| Some(format!("s{station}"))).collect();
        let moved =
            |station: usize| made.device_from_base * Pose::from_xyz_rpy([0.0, 0.1, 0.2], [0.1, station as f64, 0.0]);
        estimate = estimate.with_further_devices((1..=case.further).map(moved).collect());
        let packed = PackedValues::from_dataset(robot, &data);
        let weights = (0..case.rows).map(|row| [1.0, 0.3, 0.0, 2.5][row % 4]).collect();
        let free = parameters(robot, &data, case);
        Session { robot: robot.clone(), data, packed, estimate, free, weights }
    }

    fn problem(&self, case: &Case, level: SimdLevel) -> Problem<'_> {
        let rows = self.data.all_rows();
        let session = in_session(&self.robot, &self.data, &self.packed);
        let problem = Problem::new(session, rows, self.free.clone(), NOISE).with_level(level);
        if case.weights { problem.with_weights(&self.weights) } else { problem }
    }
}

fn in_session<'a>(robot: &'a Robot, data: &'a Dataset, packed: &'a PackedValues) -> estimate::Session<'a> {
    estimate::Session::new(robot, data, packed, false).with_length(LENGTH_M)
}

fn parameters(robot: &Robot, data: &Dataset, case: &Case) -> Vec<Parameter> {
    let mut free = Vec::new();
    if case.place_only {
        free.push(Parameter::TargetPlace(TargetPlace { target: 0 }));
    }
    if case.place_only || case.nothing {
        return free;
    }
    if case.device {
        free.push(Parameter::DeviceFrame(DeviceFrame::new(0, Vector3::new(0.3, -0.2, 0.5))));
    }
    for station in 1..=case.further {
        let about = Vector3::new(0.1 * station as f64, 0.2, -0.1);
        free.push(Parameter::DeviceFrame(DeviceFrame::new(station, about)));
    }
    for (joint, it) in robot.joints.iter().enumerate() {
        if !case.some_axes || joint % 2 == 1 {
            free.push(Parameter::ScrewAxis(ScrewAxis { joint, kind: it.kind }));
        }
    }
    let rows: Vec<u32> = data.all_rows();
    for (target, is_frame) in data.frames(&rows).into_iter().enumerate() {
        free.push(if is_frame {
            Parameter::TargetFrame(TargetFrame::new(target))
        } else {
            Parameter::TargetPlace(TargetPlace { target })
        });
    }
    free
}

/// Largest difference of Gram matrix, gradient and cost, each relative to the size of its summands.
fn difference(fast: &NormalEquations, general: &NormalEquations) -> f64 {
    let n = general.dim();
    let size = |k: usize| general.gram[k * n + k].sqrt();
    let length = (2.0 * general.cost).sqrt();
    let mut worst = (fast.cost - general.cost).abs() / general.cost.max(f64::MIN_POSITIVE);
    for a in 0..n {
        let of = |value: f64, scale: f64| if scale > 0.0 { value.abs() / scale } else { value.abs() };
        worst = larger_or_nan(worst, of(fast.gradient[a] - general.gradient[a], size(a) * length));
        for b in a..n {
            worst = larger_or_nan(worst, of(fast.gram[a * n + b] - general.gram[a * n + b], size(a) * size(b)));
        }
    }
    assert_eq!(fast.residuals, general.residuals);
    worst
}

#[test]
fn a_process_works_at_the_level_that_is_stated() {
    let name = stated_level().unwrap().name();
    println!("level {}", name.unwrap());
    assert_eq!(SimdLevel::best_level().name(), name);
    match std::env::var("POECAL_SIMD").ok().filter(|stated| !stated.is_empty()) {
        Some(stated) => assert_eq!(name, Some(stated.as_str())),
        None => assert_eq!(name, simd_levels()[0].name()),
    }
}

#[test]
fn both_paths_agree() {
    for (name, robot) in robots() {
        let mut worst = (0.0, String::new());
        for kind in [SessionKind::POSE, SessionKind::POINT, SessionKind::MIXED] {
            for case in choose_some(cases()).iter().filter(|case| robot.joints.len() < 20 || case.rows < 100) {
                let session = Session::new(&robot, kind, case);
                let general = reference::normal(&session.problem(case, SimdLevel::BASELINE), &session.estimate);
                for level in simd_levels() {
                    let problem = session.problem(case, level);
                    let fast = problem.normal(&session.estimate);
                    let difference = difference(&fast, &general);
                    assert!(difference < TOLERANCE, "{name} {kind:?} {level:?} {case:?}: {difference:e}");
                    if difference >= worst.0 {
                        worst = (difference, format!("{kind:?} {level:?} {case:?}"));
                    }
                    let gradient = problem.gradient(&session.estimate).unwrap();
                    assert_eq!((&gradient.gradient, gradient.cost), (&fast.gradient, fast.cost), "{name}");
                    // The approximation omits terms of rotations alone, and of `JᵀJ` alone.
                    let nearly = problem.nearly_normal(&session.estimate);
                    assert_eq!((&nearly.gradient, nearly.cost), (&fast.gradient, fast.cost), "{name}");
                    assert!(kind != SessionKind::POINT || nearly == fast, "{name}");
                }
            }
        }
        println!("{name:12} {:.1e} ({})", worst.0, worst.1);
    }
}

#[test]
fn sums_do_not_depend_on_threads() {
    let case = many_rows_case();
    let session = Session::new(&elbow(), SessionKind::MIXED, &case);
    let of = |threads: usize| {
        let problem = session.problem(&case, SimdLevel::best_level());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| problem.normal(&session.estimate))
    };
    assert!((2..5).all(|threads| of(threads) == of(1)));
}

/// Fits use few passes (many rows begin on a sample, last steps use gradients alone, the very last one the model); the reference is one plain
/// minimisation whose every step uses all rows in full.
#[test]
fn few_passes_have_the_same_optimum() {
    let cases = [50, 50, 50, 500, 6000].into_iter().zip(1..);
    for (kind, (count, seed)) in
        [SessionKind::POSE, SessionKind::POINT].into_iter().flat_map(|kind| cases.clone().map(move |case| (kind, case)))
    {
        let simulation = Simulation { count, seed, ..Simulation::default() };
        let made = simulation.run(&elbow(), kind).unwrap();
        let packed = PackedValues::new(&made.nominal, made.data.all_readings(), 6);
        let rows = made.data.all_rows();
        let mut start = nominal_estimate(&made.nominal, &made.data);
        start.device_from_base = made.device_from_base;
        let options = geometry();
        let session = in_session(&made.nominal, &made.data, &packed);
        let (quick, _, summary) = fit_screws(session, &rows, start.clone(), NOISE, None, &options);
        let free = parameters(&made.nominal, &made.data, &Case::default());
        let problem = Problem::new(session, rows.clone(), free, NOISE);
        let strict = Options { decrement: 1e-12, ..Options::default() };
        let (plain, normal, _) = minimize(&Plain(&problem), start, &strict);
        // Improvement of a prediction by further steps from the quick optimum, compared with the uncertainty due to noise.
        let rest = problem.normal(&quick);
        let apart = farthest_prediction(&session, &rows, &quick, &plain);
        let excess = (rest.cost - normal.cost) / normal.mean_square();
        println!(
            "{kind:?} {count}: {} iterations, predictions apart by {apart:.1e} m, cost above by {excess:.1e}",
            summary.iterations
        );
        // Iterations end at a decrement of 1e-7, which is 4.5e-4 of a standard deviation: with 50 rows some 1e-8 m.
        assert!(apart < 1e-9 * (6000.0 / count as f64).sqrt());
        assert!(excess < 1e-6);
    }
}

/// The kernels serve every kind of unknown.
#[test]
fn kernels_serve_the_kinds_that_they_know() {
    let robot = elbow();
    let kind = robot.joints[0].kind;
    for seen in [SessionKind::POSE, SessionKind::POINT] {
        let mut session = Session::new(&robot, seen, &Case { rows: 5, targets: 1, ..Case::default() });
        for parameter in [
            Parameter::ScrewAxis(ScrewAxis { joint: 0, kind }),
            Parameter::ValueTerm(ValueTerm { joint: 0, kind, term: Term::OFFSET }),
            Parameter::TargetPlace(TargetPlace { target: 0 }),
            Parameter::TargetFrame(TargetFrame::new(0)),
            Parameter::DeviceFrame(DeviceFrame::new(0, Vector3::zeros())),
        ] {
            session.free = vec![parameter];
            let problem = session.problem(&Case::default(), SimdLevel::BASELINE);
            println!("{seen:?} by {parameter:?}");
            let (fast, by_rows) = (problem.normal(&session.estimate), reference::normal(&problem, &session.estimate));
            assert!(difference(&fast, &by_rows) < TOLERANCE);
        }
    }
}

/// Other measurements in the same configurations: shared packing and factor, and the same optimum as a fit of its own.
#[test]
fn refits_have_the_same_optimum() {
    for kind in [SessionKind::POSE, SessionKind::POINT] {
        let simulation = Simulation { device_anywhere: false, ..Simulation::default() };
        let made = simulation.run(&elbow(), kind).unwrap();
        let packed = PackedValues::new(&made.nominal, made.data.all_readings(), 6);
        let rows: Vec<u32> = made.data.all_rows();
        let free = parameters(&made.nominal, &made.data, &Case::default());
        let first = Problem::new(in_session(&made.nominal, &made.data, &packed), rows.clone(), free.clone(), NOISE);
        let start = nominal_estimate(&made.nominal, &made.data);
        let strict = Options { decrement: 1e-12, ..Options::default() };
        let (optimum, _, _) = minimize(&first, start.clone(), &strict);
        let mut refit = Refit::new(first, optimum.clone(), strict);
        let (mut worst, mut iterations): (f64, usize) = (0.0, 0);
        let mut generator = ChaCha8Rng::seed_from_u64(7);
        for trial in 0..40 {
            // One in four has large errors, so that shared steps do not suffice.
            let scale = if trial % 4 == 3 { 300.0 } else { 1.0 };
            let mut data = made.data.clone();
            for observation in &mut data.observations {
                let shift = random::normal_vector(&mut generator) * (scale * NOISE[Quantity::Position]);
                let shifted = |pose: Pose| Pose::new(pose.rotation, pose.translation + shift);
                observation.measurement = observation.measurement.map_pose(shifted).unwrap();
            }
            let measured: Vec<Measurement> = data.observations.iter().map(|seen| seen.measurement).collect();
            let (quick, _, summary) = refit.fit(&measured);
            let session = in_session(&made.nominal, &data, &packed);
            let own = Problem::new(session, rows.clone(), free.clone(), NOISE);
            let (plain, _, _) = minimize(&Plain(&own), optimum.clone(), &strict);
            worst = larger_or_nan(worst, farthest_prediction(&session, &rows, &quick, &plain) / scale);
            iterations += summary.iterations;
        }
        println!("{kind:?}: {:.1} iterations, predictions apart by {worst:.1e} m", iterations as f64 / 40.0);
        assert!(worst < 1e-9);
    }
}

/// A problem row by row, whose every step has a `JᵀJ` of its own.
struct Plain<'a>(&'a Problem<'a>);

impl LeastSquares for Plain<'_> {
    type State = Estimate;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn normal(&self, state: &Estimate) -> NormalEquations {
        reference::normal(self.0, state)
    }

    fn second_order(&self, state: &Estimate, step: &[f64]) -> Vec<f64> {
        self.0.second_order(state, step)
    }

    fn curvature(&self, state: &Estimate) -> Option<Vec<f64>> {
        self.0.curvature(state)
    }

    fn rounding(&self) -> f64 {
        self.0.rounding()
    }

    fn retract(&self, state: &Estimate, step: &[f64]) -> Estimate {
        self.0.retract(state, step)
    }
}

/// Largest distance between the positions that two estimates predict, metres.
fn farthest_prediction(session: &estimate::Session<'_>, rows: &[u32], a: &Estimate, b: &Estimate) -> f64 {
    let errors = |estimate| session.errors(rows, estimate);
    errors(a).iter().zip(errors(b)).map(|(a, b)| (a.position_m() - b.position_m()).norm()).fold(0.0, larger_or_nan)
}
