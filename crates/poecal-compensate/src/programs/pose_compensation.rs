//! Compensation of poses, and their configurations.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use poecal_arm::{AllBranches, Arm};

use super::super::{ChangeOptions, CompensatedConfiguration, Compensation};
use poecal_arm::lie::{Pose, rotation};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// Compensation of poses for a controller that computes with the nominal robot. If the program means a pose T, reached in the nominal configuration q
/// (`nominal(q) = T`), the controller is sent `T' = nominal(q')` with `actual(q') = T`. It then moves to q', and the tip of the actual robot is at T
/// (theory.md §2).
#[derive(Clone, Debug)]
pub struct PoseCompensation {
    compensation: Compensation,
    branches: Option<AllBranches>,
}

/// Margin (rad) of an unambiguous nearest configuration: over the second nearest, and below a change of half a turn.
const SURE: f64 = 0.05;
/// Change of a joint (rad, m) in a step along a path.
const LARGEST_STEP: f64 = 0.35;
/// Number of times that a step is halved.
const HALVINGS: u32 = 5;
/// Remainder (by the definition of [`Arm::solve_nearest`]) of a reached pose.
const THERE: f64 = 1e-9;

impl PoseCompensation {
    /// Pose compensation between two robots with the same joints, at these values of the actual one's factors.
    ///
    /// # Errors
    /// Those of [`Compensation::new`].
    pub fn new(nominal: &Robot, actual: &Robot, factors: &[f64], options: &ChangeOptions) -> Result<Self> {
        Ok(PoseCompensation::from_compensation(Compensation::new(nominal, actual, factors, options)?))
    }

    /// Pose compensation by a compensation of readings.
    #[must_use]
    pub fn from_compensation(compensation: Compensation) -> Self {
        let branches = AllBranches::new(compensation.nominal_arm());
        PoseCompensation { compensation, branches }
    }

    /// The compensation of readings.
    #[must_use]
    pub fn compensation(&self) -> &Compensation {
        &self.compensation
    }

    /// The compensation of readings, for corrections.
    pub fn readings(&mut self) -> &mut Compensation {
        &mut self.compensation
    }

    /// Pose for the controller in place of the pose of the nominal robot's tip in a configuration (rad, m, in the order of [`Robot::reading_names`]),
    /// and the readings that it then commands.
    pub fn compensate_at(&mut self, q: &[f64]) -> (Pose, CompensatedConfiguration<'_>) {
        let (nominal, at) = (self.compensation.nominal_arm().clone(), self.compensation.readings().to_vec());
        let found = self.compensation.joints(q);
        let commanded: Vec<f64> = at.iter().map(|&it| found.readings.get(it).copied().unwrap_or(0.0)).collect();
        (nominal.forward_kinematics(&commanded), found)
    }

    /// The readings of the nominal arm among those of the robot.
    #[must_use]
    pub(crate) fn of_arm(&self, q: &[f64]) -> Vec<f64> {
        self.compensation.readings().iter().map(|&it| q.get(it).copied().unwrap_or(0.0)).collect()
    }

    pub(crate) fn of_robot(&self, own: &[f64], near: &[f64]) -> Vec<f64> {
        let mut all: Vec<f64> =
            (0..self.compensation.names().len()).map(|it| near.get(it).copied().unwrap_or(0.0)).collect();
        for (&at, value) in self.compensation.readings().iter().zip(own) {
            if let Some(it) = all.get_mut(at) {
                *it = *value;
            }
        }
        all
    }

    /// Every configuration of the nominal robot within its limits that has the tip at a pose, with all whole turns; joints without limits turn once
    /// in either direction. For six turning joints; empty for others.
    #[must_use]
    pub fn all(&self, target: &Pose) -> Vec<Vec<f64>> {
        let Some(branches) = &self.branches else { return Vec::new() };
        let limits = self.compensation.nominal_arm().limits();
        let mut out = Vec::new();
        for branch in branches.branches_at(target).as_slice() {
            let mut found = vec![Vec::new()];
            for (q, &(low, high)) in branch.iter().zip(limits) {
                let (low, high) = (low.max(-2.0 * TAU), high.min(2.0 * TAU));
                let turned = (-2..=2).map(|turns| q + f64::from(turns) * TAU);
                let within: Vec<f64> = turned.filter(|it| (low - SLACK..=high + SLACK).contains(it)).collect();
                let longer = |it: &Vec<f64>| -> Vec<Vec<f64>> {
                    within.iter().map(|&value| it.iter().copied().chain([value]).collect()).collect()
                };
                found = found.iter().flat_map(longer).collect();
            }
            out.extend(found.iter().map(|it| self.of_robot(it, &[])));
        }
        out
    }

    /// The nominal configuration at a pose nearest to another one, if there is one and it is certainly the nearest: by the joint that moves most and
    /// by the root of squares, with no other nearly as near. For six turning joints; `None` for others.
    #[must_use]
    pub fn solve_nearest(&self, target: &Pose, near: &[f64]) -> Option<Vec<f64>> {
        let branches = self.branches.as_ref()?;
        let start: [f64; 6] = self.of_arm(near).try_into().ok()?;
        let found = branches.within_limits(target, &start);
        let most = |q: &[f64; 6]| q.iter().zip(&start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let root = |q: &[f64; 6]| q.iter().zip(&start).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let (first, others) = found.as_slice().split_first()?;
        let is_sure = most(first) < PI - SURE
            && others.iter().all(|it| most(it) > most(first) + SURE && root(it) > root(first) + SURE);
        is_sure.then(|| self.of_robot(first, near))
    }

    /// The nominal configuration at the end of a straight path of the tool from another configuration; `None` if the path passes a singularity or
    /// leaves the robot's reach or limits.
    #[must_use]
    pub fn follow(&self, from: &[f64], target: &Pose, tip_from_tool: &Pose) -> Option<Vec<f64>> {
        let arm = self.compensation.nominal_arm();
        let mut q = self.of_arm(from);
        let start = arm.forward_kinematics(&q) * *tip_from_tool;
        let end = *target * *tip_from_tool;
        let turn: Vector3<f64> = rotation::log(&(start.rotation.transpose() * end.rotation));
        let (metres, radians) = start.distance_and_angle(&end);
        let steps = (20.0 * metres / arm.reach_m()).max(5.0 * radians).ceil().clamp(2.0, 200.0);
        let tool_from_tip = tip_from_tool.inverse();
        let between = |share: f64| {
            let at = start.translation + (end.translation - start.translation) * share;
            Pose::new(start.rotation * rotation::exp(&(turn * share)), at) * tool_from_tip
        };
        for step in 1..=steps as u32 {
            let (before, after) = (f64::from(step - 1) / steps, f64::from(step) / steps);
            advance(arm, &between, (before, after), &mut q, HALVINGS)?;
        }
        let is_within = q.iter().zip(arm.limits()).all(|(q, (low, high))| (low - SLACK..=high + SLACK).contains(q));
        (is_within && arm.forward_kinematics(&q).distance_and_angle(target).0 < 1e-8).then(|| self.of_robot(&q, from))
    }

    /// True if the nominal arm is so near a singularity that a pose hardly determines the configuration.
    #[must_use]
    pub fn is_singular(&self, q: &[f64]) -> bool {
        let arm = self.compensation.nominal_arm();
        arm.joints() == 6 && arm.smallest_singular_value(&self.of_arm(q)) < SINGULAR
    }

    /// True if all branches of the nominal robot can be found.
    #[must_use]
    pub fn has_branches(&self) -> bool {
        self.branches.is_some()
    }
}

/// Excess of a joint value over a limit (rad) that is rounding of a program's numbers.
const SLACK: f64 = 1e-5;
/// Smallest singular value, lengths over the reach, below which a configuration is singular: a wrist within some tenths of a degree of straight.
const SINGULAR: f64 = 1e-3;

/// Moves joint values along a path from one share of it to another, in halves if they change much; `None` if it cannot be followed.
fn advance(
    arm: &Arm,
    way: &dyn Fn(f64) -> Pose,
    (from, to): (f64, f64),
    q: &mut Vec<f64>,
    halvings: u32,
) -> Option<()> {
    let before = q.clone();
    let left = arm.solve_nearest(&way(to), q);
    let is_small = q.iter().zip(&before).all(|(a, b)| (a - b).abs() < LARGEST_STEP);
    if left < THERE && is_small && arm.handedness(&before) * arm.handedness(q) >= 0.0 {
        return Some(());
    }
    q.clone_from(&before);
    let halvings = halvings.checked_sub(1)?;
    let middle = 0.5 * (from + to);
    advance(arm, way, (from, middle), q, halvings)?;
    advance(arm, way, (middle, to), q, halvings)
}
