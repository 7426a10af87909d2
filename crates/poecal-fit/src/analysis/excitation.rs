//! Excitation by the configurations: ranges of joints, joints that moved together, turning of the tool, points on an axis.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};

use super::coverage::ranges;
use super::direction::{Cause, Direction};
use super::setup::AnalysisSetup;
use super::subspace;
use crate::parameters::Parameter;
use crate::state::{Linkage, RowChain, Sight, sample_rows};
use poecal_model::robot::JointKind;
use poecal_numerics::linalg;

/// Rows of the subsample for the geometry.
const SAMPLE: usize = 400;
/// Largest range of a joint that stood still: encoders at rest jitter by some 1e-4 rad or 0.01 mm.
const STILL_RAD: f64 = 2.6e-3;
const STILL_M: f64 = 1e-4;
/// Joints moved together if a combination of their values, each scaled by its spread, varies by less than this share of one spread.
const TOGETHER: f64 = 0.01;
/// Sine of the largest angle (about 3°) between axes that count as parallel: it allows for manufacturing errors.
const PARALLEL: f64 = 0.05;
/// Variance about a direction (that of about 1°) below which orientations count as one.
const ONE_ORIENTATION: f64 = 3e-4;
/// A point lies on an axis within this share of the length that a radian counts.
const ON_AXIS: f64 = 0.02;

/// Turning of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ToolTurning {
    /// No turning.
    Not,
    /// About one direction only, in the axes of the last link.
    About(Vector3<f64>),
    /// Turning about more than one direction.
    Freely,
}

/// Excitation by the configurations.
pub(crate) struct Excitation {
    /// For each joint, true if some row's kinematic chain from instrument to target passes it.
    pub(crate) seen_joints: Vec<bool>,
    /// Joint that every kinematic chain passes last; `None` if the chains differ.
    pub(crate) last_joint: Option<usize>,
    /// Range of each joint's value, radians or metres.
    pub(crate) ranges: Vec<f64>,
    /// For each joint, true if it stood still.
    pub(crate) still: Vec<bool>,
    /// Groups of joints that moved only together.
    pub(crate) together: Vec<Vec<usize>>,
    /// Turning of the tool.
    pub(crate) turning: ToolTurning,
    /// Mean rotation of the last link's frame in the device's axes.
    pub(crate) mean_turn: Matrix3<f64>,
    /// For each revolute joint whose axis always passes through all targets: their largest distance from it, metres.
    pub(crate) on_axis_m: Vec<Option<f64>>,
    /// For each pair of joints, row-major: true if both are revolute and their axes always parallel.
    parallel: Vec<bool>,
    /// Number of measured numbers in distinct configurations, counted up to the number of unknowns.
    pub(crate) numbers: usize,
    /// Number of distinct configurations, likewise.
    pub(crate) configurations: usize,
    /// For each target, number of distinct configurations with a measurement of it, counted in the same way.
    seen: Vec<usize>,
}

impl Excitation {
    pub(crate) fn new(setup: &AnalysisSetup<'_>) -> Self {
        let joints = &setup.session.robot.joints;
        let ranges: Vec<f64> = ranges(&setup.session, setup.rows).iter().map(|(a, b)| (b - a).max(0.0)).collect();
        let still: Vec<bool> = ranges
            .iter()
            .zip(joints)
            .map(|(&range, joint)| match joint.kind {
                JointKind::Revolute => range <= STILL_RAD,
                JointKind::Prismatic => range <= STILL_M,
            })
            .collect();
        let (seen_joints, last_joint) = passed_joints(setup);
        let mut found = Excitation {
            seen_joints,
            last_joint,
            together: joint_groups(setup, &still),
            parallel: vec![true; joints.len() * joints.len()],
            on_axis_m: vec![None; joints.len()],
            turning: ToolTurning::Freely,
            mean_turn: Matrix3::zeros(),
            ranges,
            still,
            numbers: 0,
            configurations: 0,
            seen: vec![0; setup.session.data.targets.len()],
        };
        found.look_at_geometry(setup);
        found.count(setup);
        found
    }

    /// True if the axes of some joints are always parallel.
    pub(crate) fn are_parallel(&self, joints: &[usize]) -> bool {
        let n = self.still.len();
        joints.iter().all(|a| joints.iter().all(|b| self.parallel.get(a * n + b).copied().unwrap_or(false)))
    }

    fn look_at_geometry(&mut self, setup: &AnalysisSetup<'_>) {
        let n = self.still.len();
        let linkage = Linkage::new(setup.estimate);
        let mut chain = RowChain::default();
        let rows = sample_rows(setup.rows, SAMPLE);
        let mut away_m = vec![0.0_f64; n];
        let mut is_seen = vec![false; n];
        for &row in &rows {
            let row = row as usize;
            chain.evaluate(&linkage, setup.session.packed, row, &setup.session.data.observations[row]);
            self.mean_turn += chain.last.rotation / rows.len() as f64;
            for joint in &chain.joints {
                let a = joint.joint;
                is_seen[a] = true;
                let arm = chain.target.translation - joint.origin;
                let away = if joint.kind == JointKind::Revolute { arm.cross(&joint.z).norm() } else { f64::MAX };
                away_m[a] = away_m[a].max(away);
                for other in &chain.joints {
                    let b = other.joint;
                    let revolute = joint.kind == JointKind::Revolute && other.kind == JointKind::Revolute;
                    self.parallel[a * n + b] &= revolute && joint.z.cross(&other.z).norm() < PARALLEL;
                }
            }
        }
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
            self.parallel[a * n + b] &= is_seen[a] && is_seen[b];
        }
        if !setup.layout.parameters().any(|(it, _)| matches!(it, Parameter::TargetFrame(_))) {
            let near = ON_AXIS * setup.session.length_m;
            let away = away_m.iter().zip(&is_seen);
            self.on_axis_m = away.map(|(&away, &seen)| (seen && away < near).then_some(away)).collect();
        }
        // If the chains differ, the last links turn each in a manner of its own.
        let one_way = self.last_joint.is_some();
        self.turning = if one_way { turning_of_mean(&self.mean_turn) } else { ToolTurning::Freely };
    }

    /// Counts the numbers measured in distinct configurations, until there are enough. Rows within the jitter of encoders are repeats.
    fn count(&mut self, setup: &AnalysisSetup<'_>) {
        let unknowns = setup.layout.dim();
        let step = |joint: usize| match setup.session.robot.joints.get(joint).map(|joint| joint.kind) {
            Some(JointKind::Prismatic) => STILL_M,
            Some(JointKind::Revolute) | None => STILL_RAD,
        };
        let (mut all, mut of_subjects) = (BTreeSet::new(), BTreeSet::new());
        for &row in setup.rows {
            let observation = setup.session.observation(row);
            if self.numbers >= unknowns && self.seen[observation.target] > 1 {
                continue;
            }
            let values = setup.session.packed.joint_values(row as usize).iter().enumerate();
            let place: Vec<i64> = values.map(|(joint, value)| (value / step(joint)).round() as i64).collect();
            all.insert(place.clone());
            let way = setup.estimate.tree.route_index(observation.into());
            if of_subjects.insert((setup.session.data.subject(row), way, place)) {
                self.numbers += observation.measurement.dim();
                self.seen[observation.target] += 1;
            }
        }
        self.configurations = all.len();
    }

    /// Targets, of several, that were seen only once.
    pub(crate) fn seen_once(&self, setup: &AnalysisSetup<'_>) -> Vec<Direction> {
        let mut found = Vec::new();
        if self.seen.len() < 2 {
            return found;
        }
        for (parameter, places) in setup.layout.parameters() {
            let (target, what) = match parameter {
                Parameter::TargetPlace(it) => (it.target, "its place fits that one measurement"),
                Parameter::TargetFrame(it) => (it.target, "its frame fits that one measurement"),
                Parameter::ScrewAxis(_)
                | Parameter::OtherScrew(_)
                | Parameter::ValueTerm(_)
                | Parameter::DeviceFrame(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => continue,
            };
            if self.seen.get(target) == Some(&1) {
                let name = target_name(setup, target);
                found.push(Direction {
                    description: format!(
                        "{name} was measured in one configuration only: {what}, and nothing checks it"
                    ),
                    joints: Vec::new(),
                    cause: Cause::SeenOnce,
                    directions: places.len(),
                });
            }
        }
        found
    }
}

/// Joints on the kinematic chains of the rows, and the last joint of a single chain.
fn passed_joints(setup: &AnalysisSetup<'_>) -> (Vec<bool>, Option<usize>) {
    let tree = &setup.estimate.tree;
    let mut seen = vec![false; tree.kinds().len()];
    let mut ways = BTreeMap::new();
    for &row in setup.rows {
        let sight = Sight::from(setup.session.observation(row));
        ways.entry(tree.route_index(sight)).or_insert(sight);
    }
    let mut lasts = ways.values().map(|&sight| tree.route(sight)).map(|way| {
        way.iter().for_each(|passed| seen[passed.joint] = true);
        way.last().map(|passed| passed.joint)
    });
    let last = lasts.next().flatten();
    let others = lasts.count();
    (seen, last.filter(|_| others == 0))
}

/// A target by name.
pub(crate) fn target_name(setup: &AnalysisSetup<'_>, target: usize) -> String {
    match setup.session.data.targets.get(target).and_then(Option::as_deref) {
        Some(name) => format!("target {name}"),
        None => "the tip".to_owned(),
    }
}

/// Turning of rotations with this mean R̄: a direction u is kept if `uᵀ(I - R̄ᵀR̄)u` vanishes (theory.md §7, `one_turning_direction`).
fn turning_of_mean(mean: &Matrix3<f64>) -> ToolTurning {
    let spread = Matrix3::identity() - mean.transpose() * mean;
    let upper: Vec<f64> = (0..9).map(|k| spread[(k / 3, k % 3)]).collect();
    let (values, vectors) = linalg::symmetric_eigen(&upper, 3);
    match values.iter().filter(|&&value| value < ONE_ORIENTATION).count() {
        0 => ToolTurning::Freely,
        1 => ToolTurning::About(Vector3::new(vectors[(0, 0)], vectors[(1, 0)], vectors[(2, 0)])),
        _ => ToolTurning::Not,
    }
}

/// Groups of joints with a combination of values that stays constant while they move.
fn joint_groups(setup: &AnalysisSetup<'_>, still: &[bool]) -> Vec<Vec<usize>> {
    let moved: Vec<usize> = (0..still.len()).filter(|&joint| !still[joint]).collect();
    let rows = sample_rows(setup.rows, 10 * SAMPLE);
    let k = moved.len();
    if k < 2 || rows.len() < 3 * k {
        return Vec::new();
    }
    let count = rows.len() as f64;
    let value = |row: u32, joint: usize| setup.session.packed.joint_values(row as usize)[joint];
    let means: Vec<f64> =
        moved.iter().map(|&joint| rows.iter().map(|&row| value(row, joint)).sum::<f64>() / count).collect();
    let spreads: Vec<f64> = moved
        .iter()
        .zip(&means)
        .map(|(&joint, mean)| (rows.iter().map(|&row| (value(row, joint) - mean).powi(2)).sum::<f64>() / count).sqrt())
        .collect();
    let mut correlation = vec![0.0; k * k];
    for &row in &rows {
        let scaled: Vec<f64> = (0..k).map(|i| (value(row, moved[i]) - means[i]) / spreads[i]).collect();
        linalg::add_gram(&mut correlation, k, &scaled, 0);
    }
    correlation.iter_mut().for_each(|c| *c /= count);
    let (values, vectors) = linalg::symmetric_eigen(&correlation, k);
    let tied = values.iter().take_while(|&&value| value < TOGETHER * TOGETHER).count();
    let mut groups: Vec<BTreeSet<usize>> = Vec::new();
    for relation in subspace::sparse_basis(&vectors.columns(0, tied).into_owned()) {
        let mut group: BTreeSet<usize> = (0..k).filter(|&i| relation[i].abs() > 0.1).map(|i| moved[i]).collect();
        groups.retain(|other| {
            let apart = other.is_disjoint(&group);
            if !apart {
                group.extend(other);
            }
            apart
        });
        groups.push(group);
    }
    groups.sort();
    groups.into_iter().map(|group| group.into_iter().collect()).collect()
}
