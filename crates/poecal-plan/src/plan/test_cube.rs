//! The cube of ISO 9283 (clause 6.8), or a plane: P1 to P5, with sides along the base, in joint readings.

use nalgebra::{Matrix3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::{PlannedRow, RowPurpose};
use poecal_arm::Arm;
use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::Robot;
use poecal_model::simulate::random::{normal_vector, uniform_number};
use poecal_model::simulate::random_configuration;
use poecal_numerics::error::{ErrorKind, Result};

/// Vertices of the diagonal plane C1-C2-C7-C8 of a cube, in half sides, and its middle: P1 to P5.
const POSES: [[f64; 3]; 5] = [[0.0; 3], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0]];
/// The other vertices.
const OTHERS: [[f64; 3]; 4] = [[1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0]];
/// Share of half a diagonal at which P2 to P5 are: 10 % of the diagonal from the vertices.
const INSIDE: f64 = 0.8;
/// Steps from the middle to a vertex, and how many lead to a pose.
const STEPS: usize = 10;
const STEPS_TO_POSE: usize = 8;
/// Largest change of a joint in a step, radians or metres: more is another branch.
const LARGEST_STEP: f64 = 0.5;
/// The order of a cycle, as indices of the poses: P5, P4, P3, P2, P1.
pub const CYCLE: [usize; 5] = [4, 3, 2, 1, 0];
/// Configurations from which cubes grow, and places that are tried about the best.
const STARTS: usize = 300;
const TRIES: usize = 300;
/// Share of the reach at which cubes begin, and by which they grow.
const FIRST: f64 = 0.05;
const GROWTH: f64 = 1.05;
/// Share of the reach that stays free beside the axis of the base.
const BASE: f64 = 0.1;
/// Remainder (m, rad) within which a pose is reached.
const REACHED: f64 = 1e-9;
/// A whole step of middles and sides, metres.
const STEP_M: f64 = 0.01;

/// Vertices of a plane and its middle, P1 to P5, along its two axes.
const IN_PLANE: [[f64; 2]; 5] = [[0.0; 2], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
/// Sides up to this are zero, metres.
const FLAT_M: f64 = 1e-6;

/// Five poses of a test, with the readings that reach them.
#[derive(Clone, Debug, PartialEq)]
pub struct TestCube {
    /// Middle of the cube in the base, metres.
    pub middle_m: [f64; 3],
    /// Sides along the axes of the base, metres; one of a plane is zero.
    pub sides_m: [f64; 3],
    /// P1 to P5: the tip in the base, and the readings.
    pub poses: Vec<(Pose, Vec<f64>)>,
}

impl TestCube {
    /// Rows of so many cycles in the order of the standard.
    #[must_use]
    pub fn rows(&self, cycles: usize) -> Vec<PlannedRow> {
        let order = CYCLE.iter().filter_map(|&at| Some(self.poses.get(at)?.1.clone()));
        let part = RowPurpose::Fit;
        let one: Vec<PlannedRow> =
            order.map(|readings| PlannedRow { readings, part, returns: false, candidate: None }).collect();
        (0..cycles).flat_map(|_| one.clone()).collect()
    }
}

/// Vertices about the middle whose poses are P1 to P5, metres: in the diagonal plane of a cube, or those of a plane.
fn vertices(sides_m: [f64; 3]) -> [Vector3<f64>; 5] {
    let half = 0.5 * Vector3::from(sides_m);
    match sides_m.iter().position(|side| *side <= FLAT_M) {
        None => POSES.map(|it| half.component_mul(&Vector3::from(it))),
        Some(normal) => IN_PLANE.map(|it| {
            let mut along = it.into_iter();
            Vector3::from_fn(|k, _| if k == normal { 0.0 } else { half[k] * along.next().unwrap_or(0.0) })
        }),
    }
}

/// An arm that reaches poses within its limits.
struct ReachingArm<'a> {
    robot: &'a Robot,
    arm: Arm,
    readings: Vec<usize>,
    floor_m: f64,
}

impl ReachingArm<'_> {
    /// Readings of the arm that reach a pose within limits, from near ones.
    fn reach(&self, pose: &Pose, near: &[f64]) -> Option<Vec<f64>> {
        let mut q = near.to_vec();
        let left = self.arm.solve_nearest(pose, &mut q);
        let limits = self.arm.limits();
        let is_within = q.iter().zip(limits).all(|(q, (low, high))| *low <= *q && *q <= *high);
        (left < REACHED && is_within).then_some(q)
    }

    /// The pose and its readings after so many steps in a straight line from the middle of a cube towards a vertex, all within limits on one branch.
    fn walk(&self, middle: (&Pose, &[f64]), half: Vector3<f64>, steps: usize) -> Option<(Pose, Vec<f64>)> {
        let (mut pose, mut q) = (*middle.0, middle.1.to_vec());
        for step in 1..=steps {
            let share = step as f64 / STEPS as f64;
            pose = Pose::new(pose.rotation, middle.0.translation + half * share);
            let next = self.reach(&pose, &q)?;
            if next.iter().zip(&q).any(|(a, b)| (a - b).abs() > LARGEST_STEP) {
                return None;
            }
            q = next;
        }
        Some((pose, q))
    }

    /// P1 to P5 of a cube or plane, reached from the middle in straight lines; else the first that is not, by its index.
    fn cube(
        &self,
        middle: &Pose,
        sides_m: [f64; 3],
        near: &[f64],
    ) -> std::result::Result<Vec<(Pose, Vec<f64>)>, usize> {
        let first = self.reach(middle, near).ok_or(0usize)?;
        let pose = |(at, half): (usize, Vector3<f64>)| self.walk((middle, &first), half, STEPS_TO_POSE).ok_or(at);
        vertices(sides_m).into_iter().enumerate().map(pose).collect()
    }

    /// True if all vertices of a cube are reached from its middle, and the base is outside.
    fn is_whole(&self, middle: &Pose, side_m: f64, first: &[f64]) -> bool {
        let vertices = POSES.iter().skip(1).chain(&OTHERS);
        let is_reached =
            |vertex: &[f64; 3]| self.walk((middle, first), Vector3::from(*vertex) * (0.5 * side_m), STEPS).is_some();
        let beside = middle.translation.xy().abs().max();
        let is_above = middle.translation.z - 0.5 * side_m >= self.floor_m;
        beside > 0.5 * side_m + BASE * self.arm.reach_m() && is_above && vertices.into_iter().all(is_reached)
    }

    /// All readings of the robot, those that do not move the tip zero.
    fn all(&self, q: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.robot.reading_names().len()];
        for (&at, value) in self.readings.iter().zip(q) {
            if let Some(it) = all.get_mut(at) {
                *it = *value;
            }
        }
        all
    }

    /// Readings of the arm among all of the robot.
    fn own_readings(&self, all: &[f64]) -> Vec<f64> {
        self.readings.iter().map(|&at| all.get(at).copied().unwrap_or(0.0)).collect()
    }
}

/// The largest cube beside the base that is found whose five poses and vertices are reached within limits, in straight lines from its middle and with one
/// orientation of the tip, from a fixed seed; or a stated one, from one vertex to the opposite one, metres, whose poses are reached so; a box with one side of zero is a plane. Nothing else in the
/// way is looked at but a floor, above which the largest cube stays, metres.
///
/// # Errors
/// [`ErrorKind::Problem`] if a pose of the stated cube is not reached, with its name, or no cube is; [`ErrorKind::Option`] for a box of unequal sides;
/// as [`Robot::arm`].
pub fn test_cube(robot: &Robot, stated: Option<[[f64; 3]; 2]>, floor_m: Option<f64>) -> Result<TestCube> {
    let references: Vec<f64> = robot.factors.iter().map(|it| it.reference).collect();
    let (arm, readings) = robot.arm(&references)?;
    let it = ReachingArm { robot, arm, readings, floor_m: floor_m.unwrap_or(f64::NEG_INFINITY) };
    let mut random = ChaCha8Rng::seed_from_u64(9283);
    let turns: [Matrix3<f64>; 2] = [robot.home.rotation, rotation::about(1, std::f64::consts::PI)];
    let starts: Vec<Vec<f64>> = (0..STARTS).map(|_| random_configuration(robot, &mut random)).collect();
    let found = match stated {
        Some(corners) => stated_cube(&it, corners, &starts, &turns)?,
        None => find_largest_cube(&it, &starts, &turns, &mut random)?,
    };
    let (middle, sides_m, poses) = found;
    let poses = poses.into_iter().map(|(pose, q)| (pose, it.all(&q))).collect();
    Ok(TestCube { middle_m: middle.translation.into(), sides_m, poses })
}

/// A cube or plane: its middle, its sides, its poses.
type CubePlacement = (Pose, [f64; 3], Vec<(Pose, Vec<f64>)>);

fn round_to_step(value: f64) -> f64 {
    (value / STEP_M).round() * STEP_M
}

fn find_largest_cube(
    it: &ReachingArm<'_>,
    starts: &[Vec<f64>],
    turns: &[Matrix3<f64>],
    random: &mut ChaCha8Rng,
) -> Result<CubePlacement> {
    let mut best: Option<(CubePlacement, Vec<f64>)> = None;
    let grow = |middle: Pose, near: &[f64], best: &mut Option<(CubePlacement, Vec<f64>)>| {
        let mut side_m = best.as_ref().map_or(FIRST * it.arm.reach_m(), |(found, _)| found.1[0] + STEP_M);
        loop {
            side_m = round_to_step(side_m).max(STEP_M);
            let Ok(poses) = it.cube(&middle, [side_m; 3], near) else { return };
            let first = poses.first().map(|it| it.1.clone()).unwrap_or_default();
            if !it.is_whole(&middle, side_m, &first) {
                return;
            }
            *best = Some(((middle, [side_m; 3], poses), first));
            side_m = (side_m * GROWTH).max(side_m + STEP_M);
        }
    };
    for start in starts {
        let place = it.robot.forward_kinematics(start).translation.map(round_to_step);
        for turn in turns {
            grow(Pose::new(*turn, place), &it.own_readings(start), &mut best);
        }
    }
    for _ in 0..TRIES {
        let Some(((middle, [side_m, ..], _), near)) = best.clone() else { break };
        let step = normal_vector(random) * (0.3 * side_m * uniform_number(random));
        grow(Pose::new(middle.rotation, (middle.translation + step).map(round_to_step)), &near, &mut best);
    }
    let none = || {
        ErrorKind::Problem.error(
            "found no cube whose five poses are reached within the joints' limits with one orientation of the tip, expected one: state it with --workspace",
        )
    };
    best.map(|it| it.0).ok_or_else(none)
}

fn stated_cube(
    it: &ReachingArm<'_>,
    [from, to]: [[f64; 3]; 2],
    starts: &[Vec<f64>],
    turns: &[Matrix3<f64>],
) -> Result<CubePlacement> {
    let sides_m: [f64; 3] = std::array::from_fn(|k| (to[k] - from[k]).abs());
    let is_cube = sides_m.iter().all(|side| (side - sides_m[0]).abs() <= FLAT_M && *side > FLAT_M);
    let is_plane = sides_m.iter().filter(|side| **side <= FLAT_M).count() == 1;
    if !is_cube && !is_plane {
        let [x, y, z] = sides_m.map(|side| 1e3 * side);
        return ErrorKind::Option.refuse(format!(
            "found a box of {x:.1}, {y:.1}, {z:.1} mm, expected a cube, whose sides are equal, or a plane, of which one is zero: ISO 9283 has no other box (clause 6.8.2)"
        ));
    }
    let middle = Vector3::from_fn(|k, _| 0.5 * (from[k] + to[k]));
    let mut missed = 0;
    for turn in turns {
        for start in starts {
            match it.cube(&Pose::new(*turn, middle), sides_m, &it.own_readings(start)) {
                Ok(poses) => return Ok((Pose::new(*turn, middle), sides_m, poses)),
                Err(at) => missed = missed.max(at),
            }
        }
    }
    let own = middle + INSIDE * vertices(sides_m)[missed];
    let [x, y, z]: [f64; 3] = (1e3 * own).into();
    ErrorKind::Problem.refuse(format!(
        "found P{} at {x:.1}, {y:.1}, {z:.1} mm out of reach or beyond limits, expected all five poses within them: state a smaller or nearer one with --workspace",
        missed + 1
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::elbow;

    #[test]
    fn cubes_are_reached_within_limits() {
        let robot = elbow();
        let found = test_cube(&robot, None, Some(0.1)).unwrap();
        println!("side {} m about {:?}", found.sides_m[0], found.middle_m);
        assert!(found.sides_m[0] > 0.3 && found.middle_m[2] - 0.5 * found.sides_m[0] >= 0.1);
        for (pose, readings) in &found.poses {
            let (shift, turn) = robot.forward_kinematics(readings).distance_and_angle(pose);
            assert!(shift < 1e-8 && turn < 1e-8);
        }
        let apart = found.poses[1].0.translation - found.poses[3].0.translation;
        assert!((apart.norm() - INSIDE * 3f64.sqrt() * found.sides_m[0]).abs() < 1e-12);
        let middle = found.middle_m;
        let corners = |half: f64| [middle.map(|it| it - half), middle.map(|it| it + half)];
        assert!(test_cube(&robot, Some(corners(0.1)), None).is_ok());
        let mut flat = corners(0.1);
        flat[1][0] += 0.05;
        assert!(
            test_cube(&robot, Some(flat), None).unwrap_err().to_string().contains("or a plane, of which one is zero")
        );
        (flat[0][2], flat[1][2]) = (middle[2], middle[2]);
        let plane = test_cube(&robot, Some(flat), None).unwrap();
        let own = |at: usize| plane.poses[at].0.translation - plane.poses[0].0.translation;
        assert!((own(1) - Vector3::new(0.1, 0.08, 0.0)).norm() < 1e-12, "{:?}", own(1));
        assert!((own(1) + own(3)).norm() < 1e-12 && (own(2) + own(4)).norm() < 1e-12);
        let far = test_cube(&robot, Some(corners(2.0)), None).unwrap_err().to_string();
        assert!(far.contains("found P2 at") && far.contains("out of reach"), "{far}");
    }
}
