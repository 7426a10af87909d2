//! Instruments and targets on any body of a tree, in one configuration or two. Tests of the sensitivities of every kinematic chain between
//! them, and of ranks in closed form (theory.md §4 and §7).

use crate::reference;
use nalgebra::Vector3;
use poecal_arm::lie::{Freedom, Pose, Screw, rotation};
use poecal_fit::analysis::{AnalysisSetup, identifiability};
use poecal_fit::parameters::{
    ClockUnknown, DeviceFrame, Parameter, RangeUnknown, TargetFrame, TargetPlace, ValueTerm, screw_axes,
};
use poecal_fit::problem::Problem;
use poecal_fit::state::{
    ClockChange, ClockTerm, Estimate, Linkage, PackedValues, RangeModel, RangeTerm, RowChain, Session, nominal_estimate,
};
use poecal_model::measurement::{Dataset, Measurement, NUMBERS, Noise, Observation};
use poecal_model::robot::{
    Body, CompliantDirections, Gravity, Joint, JointKind, JointTerm, Mount, Robot, Statics, Term, TermKind,
};
use poecal_model::simulate::random;
use poecal_numerics::solve::LeastSquares as _;
use poecal_testing::largest::larger_or_nan;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng as _;
use std::f64::consts::PI;

const NOISE: Noise = Noise::new(1e-4, 2e-4);

/// A measurement of a target's pose in the instrument's frame.
type Function = fn(&Pose) -> Measurement;

const POINT: Function = |pose| Measurement::point(pose.translation);
const POSE: Function = |pose| Measurement::of_pose(pose);

/// Possible measurements, with the number of unknowns that one target and its first instrument add to those of the axes.
const FUNCTIONS: [(&str, Function, usize); 6] = [
    ("poses", POSE, 6),
    ("points", POINT, 3),
    ("distances", |pose| Measurement::distance(pose.translation.norm()), 0),
    ("heights", |pose| Measurement::height(pose.translation.z), 0),
    ("two components", |pose| components(pose, [true, true, false]), 2),
    ("one component", |pose| components(pose, [false, true, false]), 0),
];

fn components(pose: &Pose, measured: [bool; 3]) -> Measurement {
    let of = |k: usize| measured[k].then_some(pose.translation[k]);
    Measurement::components([of(0), of(1), of(2)])
}

/// Further measurements, with values that no constraint would allow.
const OTHERS: [(&str, Function); 4] = [
    ("sockets", |pose| Measurement::socket(pose.translation)),
    ("flush", |pose| {
        let normal = pose.rotation.row(2).transpose();
        Measurement::flush(pose.translation.z, &normal)
    }),
    ("directions", |pose| Measurement::direction(&pose.rotation.row(2).transpose())),
    ("changes", |pose| Measurement::distance_change(pose.translation.norm() + 0.3)),
];

/// A measured target and its instrument, by their names; in two configurations if `apart`.
#[derive(Clone, Copy, Debug)]
struct Sees {
    instrument: Option<&'static str>,
    target: Option<&'static str>,
    seen: Function,
    apart: bool,
}

const fn sees(instrument: Option<&'static str>, target: Option<&'static str>, seen: Function) -> Sees {
    Sees { instrument, target, seen, apart: false }
}

/// A robot with the measurements of it.
struct Cell {
    name: &'static str,
    robot: Robot,
    sees: Vec<Sees>,
    /// Rank of the information in closed form.
    rank: usize,
}

fn place(generator: &mut ChaCha8Rng, scale: f64) -> Pose {
    let turn = rotation::exp(&(random::direction(generator) * PI * random::uniform_number(generator)));
    Pose::new(turn, random::direction(generator) * scale)
}

/// Joints of these kinds with random axes: `r` revolute, `p` prismatic.
fn joints(kinds: &str, prefix: &str, generator: &mut ChaCha8Rng) -> Vec<Joint> {
    let joint = |(index, kind): (usize, char)| {
        let name = format!("{prefix}{}", index + 1);
        let (direction, point) = (random::direction(generator), random::direction(generator) * 0.6);
        match kind {
            'p' => Joint::prismatic(&name, Screw::prismatic(&direction)),
            _ => Joint::revolute(&name, Screw::revolute(&direction, &point)),
        }
    };
    kinds.chars().enumerate().map(joint).collect()
}

fn chain(kinds: &str, seed: u64) -> Robot {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let joints = joints(kinds, "joint", &mut generator);
    Robot::new("chain", joints, place(&mut generator, 0.4)).unwrap()
}

/// A camera in the hand, a board beside the robot.
fn eye_in_hand(kinds: &str) -> Robot {
    let mut robot = chain(kinds, 11);
    let mut generator = ChaCha8Rng::seed_from_u64(12);
    let last = Body::Link(kinds.len() - 1);
    robot.instruments.push(Mount { name: "camera".to_owned(), body: last, pose: place(&mut generator, 0.1) });
    robot.mounted.push(Mount { name: "board".to_owned(), body: Body::Base, pose: place(&mut generator, 0.8) });
    robot
}

/// A torso of two joints with two arms of six, and a head of one that sees both hands.
fn torso() -> Robot {
    let mut generator = ChaCha8Rng::seed_from_u64(21);
    let mut all = joints("rr", "torso", &mut generator);
    for (prefix, kinds) in [("head", "r"), ("left", "rrrrrr"), ("right", "rrrrrr")] {
        let mut branch = joints(kinds, prefix, &mut generator);
        branch[0].stands_on = Some(Body::Link(1));
        all.append(&mut branch);
    }
    let mut robot = Robot::new("torso", all, Pose::identity()).unwrap();
    let on = |name: &str, body: usize, generator: &mut ChaCha8Rng| Mount {
        name: name.to_owned(),
        body: Body::Link(body),
        pose: place(generator, 0.2),
    };
    robot.instruments.push(on("eyes", 2, &mut generator));
    robot.instruments.push(on("chest", 1, &mut generator));
    robot.mounted.push(on("left_hand", 8, &mut generator));
    robot.mounted.push(on("right_hand", 14, &mut generator));
    robot.check_tree().unwrap();
    assert!(!robot.is_serial());
    robot
}

/// Joints below the base frame move the instrument, so that the chain goes back and forth on one arm.
fn cells() -> Vec<Cell> {
    let tip = |seen: Function| vec![sees(None, None, seen)];
    let camera = |seen: Function| vec![sees(Some("camera"), Some("board"), seen)];
    let apart = |seen: Function| vec![Sees { apart: true, ..sees(Some("tool"), Some("tool"), seen) }];
    let cell = |name, robot, sees, rank| Cell { name, robot, sees, rank };
    let g = |kinds: &str| kinds.chars().map(|kind| if kind == 'p' { 2 } else { 4 }).sum::<usize>();
    let mut all = Vec::new();
    for kinds in ["rrrrrr", "rrrrrrr", "rrrppp", "rrpr"] {
        for (name, function, more) in FUNCTIONS {
            all.push(cell(name, chain(kinds, 1), tip(function), g(kinds) + more));
        }
        all.push(cell("eye in hand", eye_in_hand(kinds), camera(POSE), g(kinds) + 6));
        all.push(cell("two configurations", chain(kinds, 3), apart(POSE), g(kinds)));
    }
    let two_hands =
        |of: &'static str| vec![sees(Some(of), Some("left_hand"), POSE), sees(Some(of), Some("right_hand"), POSE)];
    // The chest is on the torso: joints below it cancel. The head's own joint is seen.
    all.push(cell("chest sees both hands", torso(), two_hands("chest"), 48 + 12));
    all.push(cell("head sees both hands", torso(), two_hands("eyes"), 52 + 12));
    // A device on the floor sees the torso as well; a second one shares its targets.
    let floor = vec![sees(None, Some("left_hand"), POSE), sees(None, Some("right_hand"), POINT)];
    all.push(cell("floor sees both hands", torso(), floor.clone(), 8 + 48 + 9));
    let with_chest = [floor, vec![sees(Some("chest"), Some("left_hand"), POSE)]].concat();
    all.push(cell("floor and chest", torso(), with_chest, 8 + 48 + 9 + 6));
    all
}

/// Frame of a station, or its position if no row determines its axes.
fn device(data: &Dataset, station: usize, about: Vector3<f64>) -> Parameter {
    let freedom = data.device_freedom(station, &data.all_rows());
    Parameter::DeviceFrame(if freedom == Freedom::FRAME {
        DeviceFrame::new(station, about)
    } else {
        DeviceFrame::from_freedom(station, freedom)
    })
}

/// A cell with measurements, at a state that predicts them but for some residual.
struct Measured {
    robot: Robot,
    data: Dataset,
    packed: PackedValues,
    estimate: Estimate,
    free: Vec<Parameter>,
}

impl Measured {
    fn new(cell: &Cell, rows: usize, off: f64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(77);
        let robot = cell.robot.clone();
        let mut data = Dataset::new(robot.reading_names());
        for row in 0..rows {
            let it = cell.sees[row % cell.sees.len()];
            let mut readings = || -> Vec<f64> {
                let span = |joint: &Joint| if joint.kind == JointKind::Prismatic { 0.5 } else { PI };
                robot
                    .joints
                    .iter()
                    .filter(|joint| joint.give_of.is_none())
                    .map(|joint| span(joint) * (2.0 * random::uniform_number(&mut generator) - 1.0))
                    .collect()
            };
            let from = it.apart.then(|| data.push_further(&readings()).unwrap());
            let (target, station) = (data.target_index(it.target), data.station_index(it.instrument));
            let measurement = (it.seen)(&Pose::identity());
            let observation = Observation { station, from, ..Observation::new(target, measurement) };
            data.push_observation(&readings(), observation).unwrap();
        }
        let packed = PackedValues::from_dataset(&robot, &data);
        let mut estimate = nominal_estimate(&robot, &data);
        if cell.sees.iter().all(|it| it.instrument.is_none()) {
            estimate.device_from_base = place(&mut generator, 0.9);
        }
        let (linkage, mut chain) = (Linkage::new(&estimate), RowChain::default());
        for row in 0..rows {
            chain.evaluate(&linkage, &packed, row, &data.observations[row]);
            let turn = rotation::exp(&(random::direction(&mut generator) * off));
            let position = chain.target.translation + random::direction(&mut generator) * off;
            let seen = cell.sees[row % cell.sees.len()].seen;
            data.observations[row].measurement = seen(&Pose::new(turn * chain.target.rotation, position));
        }
        let mut free: Vec<Parameter> =
            (1..data.station_count()).map(|station| device(&data, station, Vector3::new(0.1, -0.2, 0.3))).collect();
        free.extend(screw_axes(estimate.kinds()));
        let targets = data.target_freedoms(&data.all_rows()).into_iter().enumerate();
        free.extend(targets.map(|(target, freedom)| {
            if freedom == Freedom::PLACE {
                Parameter::TargetPlace(TargetPlace { target })
            } else {
                Parameter::TargetFrame(TargetFrame { target, freedom })
            }
        }));
        Measured { robot, data, packed, estimate, free }
    }

    fn problem(&self, free: Vec<Parameter>) -> Problem<'_> {
        let session = Session::new(&self.robot, &self.data, &self.packed, false).with_length(0.5);
        Problem::new(session, self.data.all_rows(), free, NOISE)
    }
}

/// The same cell with joints that sag, wobble and tilt, with coefficients that are not zero.
fn deviate_cell(cell: &Cell) -> Cell {
    let all: Vec<usize> = (0..cell.robot.joints.len()).collect();
    // All directions are used for the shortest arm, whose terms are fewest.
    let directions = if all.len() <= 4 { CompliantDirections::All } else { CompliantDirections::Tilting };
    let (mut robot, _) = cell.robot.with_compliance(&all, directions);
    let gravity = Gravity::of_unit_weights(&robot, Vector3::new(0.2, -0.1, -0.9));
    let weights = gravity.weights.len();
    robot.gravity = Some(gravity);
    let statics = Statics::new(&robot).unwrap();
    let harmonics = (1..3).flat_map(|order| [TermKind::Sine, TermKind::Cosine].map(|it| it.with_number(order)));
    let mut terms = Vec::new();
    for (joint, it) in robot.joints.iter().enumerate() {
        let sags = (0..weights).filter(|&weight| statics.is_carried(joint, weight));
        let sags = sags.map(|weight| TermKind::Sag.with_index(weight));
        let ratio = it.give_of.is_none().then_some(Term::RATIO);
        for (k, term) in harmonics.clone().chain(sags).chain(ratio).enumerate() {
            terms.push(JointTerm { joint, term, coefficient: 1e-3 * (1 + (joint + 3 * k) % 5) as f64 });
        }
    }
    robot.terms = terms;
    Cell { name: cell.name, robot, sees: cell.sees.clone(), rank: cell.rank }
}

/// Unknowns of a cell, with these terms, and the first device as well.
fn with_terms(made: &Measured, terms: impl Iterator<Item = (usize, Term)>) -> Vec<Parameter> {
    let kinds = made.estimate.kinds();
    let mut free = made.free.clone();
    free.extend(terms.map(|(joint, term)| Parameter::ValueTerm(ValueTerm { joint, kind: kinds[joint], term })));
    if made.estimate.tree.shared_target(0).is_none() {
        free.insert(0, device(&made.data, 0, Vector3::new(0.2, 0.1, 0.0)));
    }
    free
}

/// The gradient of the kernels is the derivative of their own cost by every unknown, for every kinematic chain from instrument to
/// target. Their products are those of the formulas row by row.
#[test]
fn sensitivities_of_every_way_are_those_of_differences() {
    for cell in cells() {
        let made = Measured::new(&cell, 24, 0.05);
        // Terms of every joint's value, at coefficients that are not zero.
        let mut estimate = made.estimate.clone();
        let joints = 0..made.robot.joints.len();
        let terms: Vec<_> = joints.flat_map(|joint| Term::unnumbered().map(move |term| (joint, term))).collect();
        for &(joint, term) in &terms {
            let k = usize::from(term == Term::RATIO);
            *estimate.coefficient_mut(joint, term) = 0.02 * (1 + joint + k) as f64;
        }
        compare(&made, &estimate, with_terms(&made, terms.into_iter()), cell.name);
    }
}

/// The same test for contacts, for a direction, and for instruments whose zero and scale are unknown.
#[test]
fn sensitivities_of_every_kind_are_those_of_differences() {
    for (name, seen) in OTHERS {
        for kinds in ["rrrrrr", "rrpr"] {
            let two = vec![sees(Some("here"), None, seen), sees(Some("there"), None, seen)];
            let made = Measured::new(&Cell { name, robot: chain(kinds, 1), sees: two, rank: 0 }, 25, 0.05);
            let mut estimate = made.estimate.clone();
            estimate.base_from_target[0] =
                estimate.base_from_target[0] * Pose::from_xyz_rpy([0.0; 3], [0.02, -0.03, 0.01]);
            estimate.further_devices[0] = place(&mut ChaCha8Rng::seed_from_u64(3), 0.7);
            let mut free = with_terms(&made, std::iter::empty());
            if name == "changes" {
                estimate.ranges =
                    vec![RangeModel { zero_m: 0.2, scale: 0.03 }, RangeModel { zero_m: -0.1, scale: -0.01 }];
                let terms = RangeTerm::ALL.into_iter();
                let ranges = terms.flat_map(|term| [0, 1].map(|station| RangeUnknown { station, term }));
                free.extend(ranges.map(Parameter::RangeUnknown));
            }
            compare(&made, &estimate, free, name);
        }
    }
}

/// The same test for joints that sag, wobble and tilt: for compliant joints only their terms are unknown.
#[test]
fn sensitivities_of_what_joints_do_are_those_of_differences() {
    // For the torso, which has hundreds of terms, only the case with all chains is tested.
    let all_ways = |cell: &Cell| cell.robot.is_serial() || cell.name == "floor and chest";
    for cell in cells().into_iter().filter(all_ways) {
        let made = Measured::new(&deviate_cell(&cell), 24, 0.05);
        let terms = made.robot.terms.iter().map(|it| (it.joint, it.term));
        let mut free = with_terms(&made, terms);
        let is_give = |joint: usize| made.robot.joints[joint].give_of.is_some();
        free.retain(|it| !matches!(it, Parameter::ScrewAxis(axis) if is_give(axis.joint)));
        compare(&made, &made.estimate, free, cell.name);
    }
}

/// The same test for clocks with errors, with rows that were measured in motion.
#[test]
fn sensitivities_of_clocks_are_those_of_differences() {
    for cell in cells() {
        let mut made = Measured::new(&cell, 24, 0.05);
        let mut generator = ChaCha8Rng::seed_from_u64(78);
        let width = made.data.reading_names().len();
        for row in 0..made.data.len() {
            let rates: Vec<f64> = (0..width).map(|_| 2.0 * random::uniform_number(&mut generator) - 1.0).collect();
            // Every fifth row was measured at rest.
            if row % 5 != 4 {
                made.data.state_motion(row, &rates, row as f64 / 24.0 - 0.5);
            }
        }
        made.packed = PackedValues::from_dataset(&made.robot, &made.data);
        let mut estimate = made.estimate.clone();
        let stations = 0..made.data.station_count();
        estimate.clocks =
            stations.clone().map(|at| ClockChange { lag_s: 0.02 + at as f64 / 100.0, drift: -0.03 }).collect();
        *estimate.coefficient_mut(0, Term::RATIO) = 0.02;
        let mut free = with_terms(&made, [(0, Term::RATIO)].into_iter());
        let clocks = stations.flat_map(|station| ClockTerm::ALL.map(|term| ClockUnknown { station, term }));
        free.extend(clocks.map(Parameter::ClockUnknown));
        // For an instrument that measures in two configurations, no clock moves anything.
        free.retain(|it| !matches!(it, Parameter::ClockUnknown(_)) || cell.sees.iter().all(|it| !it.apart));
        compare(&made, &estimate, free, cell.name);
    }
}

fn compare(made: &Measured, estimate: &Estimate, free: Vec<Parameter>, name: &str) {
    let problem = made.problem(free);
    let normal = problem.normal(estimate);
    let n = problem.dim();
    let (mut worst, mut size) = (0.0, 0.0);
    for unknown in 0..n {
        // Central differences of fourth order: at 2e-4 of a radian or metre truncation is 1e-15, rounding of the cost 1e-12 of it.
        const STEP: f64 = 2e-4;
        let cost = |by: f64| {
            let mut step = vec![0.0; n];
            step[unknown] = by * STEP;
            problem.gradient(&problem.retract(estimate, &step)).unwrap().cost
        };
        let difference = (8.0 * (cost(1.0) - cost(-1.0)) - (cost(2.0) - cost(-2.0))) / (12.0 * STEP);
        // The gradient is that of the residuals' sign: `Jᵀe` with J of the prediction.
        worst = larger_or_nan(worst, (difference + normal.gradient[unknown]).abs());
        size = larger_or_nan(size, normal.gradient[unknown].abs());
    }
    println!("{name:22} {n:3} unknowns: {:.1e} of the gradient", worst / size);
    assert!(worst < 1e-8 * size, "{name}: {:e}", worst / size);

    let by_rows = reference::normal(&problem, estimate);
    let largest = (0..n).map(|k| by_rows.gram[k * n + k]).fold(0.0, larger_or_nan);
    let scale = |k: usize| by_rows.gram[k * n + k].sqrt().max(1e-9);
    for (a, b) in (0..n).flat_map(|a| (a..n).map(move |b| (a, b))) {
        let apart = (normal.gram[a * n + b] - by_rows.gram[a * n + b]).abs();
        // A column that cancels, such as of the first joint's zero in two configurations, leaves the rounding of its parts.
        assert!(apart < 1e-11 * scale(a) * scale(b) + 1e-15 * largest, "{name}: {a}, {b}: {apart:e}");
    }
}

/// theory.md §7: 4 for a revolute joint that is seen, 2 for a prismatic one, and the frames, less the choice of the base.
#[test]
fn ranks_are_those_of_the_closed_form() {
    for cell in cells() {
        let made = Measured::new(&cell, 60 * cell.sees.len(), 0.0);
        let problem = made.problem(made.free.clone());
        let rows = made.data.all_rows();
        let session = Session::new(&made.robot, &made.data, &made.packed, false).with_length(0.5);
        let setup =
            AnalysisSetup { session, rows: &rows, estimate: &made.estimate, layout: problem.layout(), noise: NOISE };
        let found = identifiability(&setup, &problem.normal(&made.estimate).gram, 1.0);
        println!("{:22} {:?}: rank {} of {}", cell.name, made.robot.joints.len(), found.rank, problem.dim());
        for direction in found.unidentifiable.iter().chain(&found.structural) {
            println!("    {}", direction.description);
        }
        assert_eq!(found.rank, cell.rank, "{}", cell.name);
    }
}

fn of_order(order: usize) -> [Term; 2] {
    [TermKind::Sine, TermKind::Cosine].map(|it| it.with_number(order))
}

/// A robot of revolute joints, each with compliant joints in all directions, and harmonics of orders 1 and 2.
fn giving_everywhere(count: usize) -> Robot {
    let rigid = chain(&"r".repeat(count), 41);
    let (mut robot, _) = rigid.with_compliance(&(0..count).collect::<Vec<_>>(), CompliantDirections::All);
    let orders = [1, 2].into_iter().flat_map(of_order);
    let of_joint = |joint: usize| orders.clone().map(move |term| JointTerm { joint, term, coefficient: 0.0 });
    robot.terms = (0..robot.joints.len()).flat_map(of_joint).collect();
    robot
}

/// theory.md §6: terms of a bearing that the screws have already, by the rank of the information. A tilted and shifted axis is a first
/// harmonic across it, 4 a joint; a point's own rotation is one of the last joint. There are no others.
#[test]
fn ranks_of_what_bearings_do_are_those_of_the_closed_form() {
    // The columns are joints, measurement, order, and the number of directions in which screws do the same.
    let cases: [(usize, &str, Function, u8, usize); 6] = [
        (6, "poses", POSE, 1, 24),
        (6, "poses", POSE, 2, 0),
        (6, "points", POINT, 1, 30),
        (6, "points", POINT, 2, 6),
        (7, "poses", POSE, 1, 28),
        (7, "points", POINT, 1, 34),
    ];
    for (count, words, function, order, redundant) in cases {
        let robot = giving_everywhere(count);
        let cell = Cell { name: "giving", robot, sees: vec![sees(None, None, function)], rank: 0 };
        let made = Measured::new(&cell, 400, 0.0);
        let is_give = |joint: usize| made.robot.joints[joint].give_of.is_some();
        let rank = |terms: Vec<(usize, Term)>| {
            let mut free = with_terms(&made, terms.into_iter());
            free.retain(|it| !matches!(it, Parameter::ScrewAxis(axis) if is_give(axis.joint)));
            let problem = made.problem(free);
            let n = problem.dim();
            let gram = problem.normal(&made.estimate).gram;
            // Columns of length 1: singular values are then of order 1, or rounding.
            let scale = |k: usize| gram[k * n + k].sqrt().max(1e-300);
            let scaled = nalgebra::DMatrix::from_fn(n, n, |a, b| gram[a.min(b) * n + a.max(b)] / scale(a) / scale(b));
            let mut values: Vec<f64> = scaled.symmetric_eigenvalues().iter().copied().collect();
            values.sort_by(|a, b| b.total_cmp(a));
            let rank = values.iter().filter(|value| **value > 1e-10).count();
            let after = values.get(rank).copied().unwrap_or(0.0).abs();
            (rank, values[rank - 1], after)
        };
        let terms: Vec<(usize, Term)> = (0..made.robot.joints.len())
            .flat_map(|joint| of_order(usize::from(order)).map(|term| (joint, term)))
            .collect();
        let columns = terms.len();
        let (of_geometry, ..) = rank(Vec::new());
        let (of_all, least, rounding) = rank(terms);
        let found = columns - (of_all - of_geometry);
        println!(
            "{count}R, {words}, order {order}: {found} of {columns} redundant (least {least:.0e}, rounding {rounding:.0e})"
        );
        assert_eq!(found, redundant, "{count}R, {words}, order {order}");
    }
}

/// Ratio and harmonics of every joint's own value are no part of the screws.
#[test]
fn what_joints_turn_is_told_from_their_screws() {
    for (words, function) in [("poses", POSE), ("points", POINT)] {
        let cell = Cell { name: "chain", robot: chain("rrrrrr", 43), sees: vec![sees(None, None, function)], rank: 0 };
        let made = Measured::new(&cell, 300, 0.0);
        let own = ["ratio", "sin1", "cos1", "sin2", "cos2"].map(|name| name.parse().unwrap());
        let terms: Vec<(usize, Term)> = (0..6).flat_map(|joint| own.map(|term| (joint, term))).collect();
        let rank = |terms: Vec<(usize, Term)>| {
            let problem = made.problem(with_terms(&made, terms.into_iter()));
            let rows = made.data.all_rows();
            let session = Session::new(&made.robot, &made.data, &made.packed, false).with_length(0.5);
            let setup = AnalysisSetup {
                session,
                rows: &rows,
                estimate: &made.estimate,
                layout: problem.layout(),
                noise: NOISE,
            };
            identifiability(&setup, &problem.normal(&made.estimate).gram, 1.0).rank
        };
        let (without, with) = (rank(Vec::new()), rank(terms));
        println!("{words}: rank {without}, with 30 terms {with}");
        assert_eq!(with, without + 30, "{words}");
    }
}

/// Errors are those of the formulas, for all kinematic chains of the rows.
#[test]
fn errors_of_every_way_are_measured_minus_predicted() {
    for cell in cells() {
        let made = Measured::new(&cell, 31, 0.05);
        let session = Session::new(&made.robot, &made.data, &made.packed, false);
        let errors = session.errors(&made.data.all_rows(), &made.estimate);
        let (linkage, mut chain) = (Linkage::new(&made.estimate), RowChain::default());
        for (row, error) in errors.iter().enumerate() {
            let seen = &made.data.observations[row];
            chain.evaluate(&linkage, &made.packed, row, seen);
            let mut expected = [0.0; NUMBERS];
            seen.measurement.residual(&chain.target, &mut expected);
            assert_eq!(error.dim(), seen.measurement.dim());
            for ((_, found), expected) in error.numbers().zip(expected) {
                // Rounding of a few products of numbers of about one, and of a logarithm.
                assert!((found - expected).abs() < 1e-13, "{} {row}: {found:e} {expected:e}", cell.name);
            }
        }
    }
}
