//! Offsets and base motion by least squares over the screws and the home pose.

use std::f64::consts::{PI, SQRT_2, TAU};

use nalgebra::{DMatrix, Matrix3, Matrix3x6, Vector3, Vector6};

use super::{EndConstraint, OffsetOptions};
use crate::robot::{Joint, JointKind, Robot};
use poecal_arm::lie::{Pose, Screw, Twist, by_turn, by_twist, hat};
use poecal_numerics::linalg;

/// Share of the largest eigenvalue of the normal equations below which a direction is undetermined: models are written with
/// rounded angles (1.5708), which must not determine an offset.
const OPEN: f64 = 1e-8;
/// Smallest share of a joint in an undetermined direction for which it is named, well above rounding.
const NAMED: f64 = 1e-3;

/// Offsets (radians, metres) and the motion of the nominal robot in the base frame.
#[derive(Clone, Debug)]
pub(crate) struct OffsetState {
    pub(crate) offsets: Vec<f64>,
    pub(crate) base: Pose,
}

/// Two robots with the same joints.
pub(crate) struct RobotPair<'a> {
    pub(crate) nominal: &'a Robot,
    pub(crate) actual: &'a Robot,
    pub(crate) options: &'a OffsetOptions,
    /// Metres that a radian counts.
    pub(crate) length_m: f64,
    offsets_free: bool,
}

/// Normal equations at a state, by their eigenvalues; unknowns are counted in metres.
pub(crate) struct OffsetEquations {
    pub(crate) cost: f64,
    gradient: Vec<f64>,
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

/// A residual and its derivative by a spatial motion of all joints from one on.
pub(crate) type ResidualBlock = (Vector3<f64>, Matrix3x6<f64>);

impl OffsetEquations {
    /// Normal equations from the upper half of the normal matrix.
    pub(crate) fn new(gram: &[f64], gradient: Vec<f64>, residuals: &[f64]) -> Self {
        let (values, vectors) = linalg::symmetric_eigen(gram, gradient.len());
        let cost = residuals.iter().map(|residual| residual * residual).sum();
        OffsetEquations { cost, gradient, values, vectors }
    }

    fn largest_eigenvalue(&self) -> f64 {
        self.values.last().copied().unwrap_or(0.0)
    }

    /// Number of undetermined directions, which are the first eigenvectors.
    fn open_directions(&self) -> usize {
        self.values.iter().take_while(|&&value| value <= OPEN * self.largest_eigenvalue()).count()
    }

    /// Damped step, zero in undetermined directions.
    pub(crate) fn step(&self, damping: f64) -> Vec<f64> {
        self.step_by(&self.gradient, damping)
    }

    /// The same step for another gradient.
    pub(crate) fn step_by(&self, gradient: &[f64], damping: f64) -> Vec<f64> {
        let n = gradient.len();
        let mut step = vec![0.0; n];
        for (&value, vector) in self.values.iter().zip(self.vectors.column_iter()).skip(self.open_directions()) {
            let along: f64 = vector.iter().zip(gradient).map(|(a, b)| a * b).sum();
            step.iter_mut().zip(vector.iter()).for_each(|(s, a)| *s -= a * along / (value + damping));
        }
        step
    }
}

impl<'a> RobotPair<'a> {
    pub(crate) fn new(nominal: &'a Robot, actual: &'a Robot, options: &'a OffsetOptions) -> Self {
        RobotPair { nominal, actual, options, length_m: nominal.arm_m() / 3.0, offsets_free: true }
    }

    /// Best state that is reached from zero offsets and from those in closed form; angles are in (-π, π].
    pub(crate) fn best_state(&self) -> OffsetState {
        let mut starts = vec![self.sequential(EndConstraint::Kept), self.unmoved_state()];
        if self.options.base == EndConstraint::Free {
            starts.push(self.sequential(EndConstraint::Free));
        }
        self.best_of(starts)
    }

    /// Best state in which all offsets are zero.
    pub(crate) fn best_without_offsets(&self) -> OffsetState {
        let base_only = RobotPair { offsets_free: false, ..*self };
        let by_first_screws =
            OffsetState { base: base_only.sequential(self.options.base).base, ..self.unmoved_state() };
        base_only.best_of(vec![self.unmoved_state(), by_first_screws])
    }

    fn unmoved_state(&self) -> OffsetState {
        OffsetState { offsets: vec![0.0; self.nominal.joints.len()], base: Pose::identity() }
    }

    fn best_of(&self, starts: Vec<OffsetState>) -> OffsetState {
        let ends = starts.into_iter().map(|start| self.refine(start));
        let best = ends.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
        best.unwrap_or_else(|| self.unmoved_state())
    }

    /// Joints that have a part in undetermined directions.
    pub(crate) fn undetermined_joints(&self, state: &OffsetState) -> Vec<usize> {
        let normal = self.normal(state);
        let open = normal.open_directions();
        let part = |joint: usize| normal.vectors.row(joint).iter().take(open).map(|part| part * part).sum::<f64>();
        (0..state.offsets.len()).filter(|&joint| part(joint).sqrt() > NAMED).collect()
    }

    /// Screws and home pose of the nominal robot with offsets and base motion.
    pub(crate) fn move_robot(&self, state: &OffsetState) -> (Vec<Screw>, Pose) {
        let mut motion = state.base;
        let mut screws = Vec::with_capacity(self.nominal.joints.len());
        for (joint, &offset) in self.nominal.joints.iter().zip(&state.offsets) {
            let screw = joint.screw.transform(&motion);
            motion = (screw.exp(offset) * motion).orthonormalized();
            screws.push(screw);
        }
        (screws, motion * self.nominal.home)
    }

    /// Descends, makes undetermined offsets as small as they can be, and descends again until nothing moves.
    fn refine(&self, start: OffsetState) -> OffsetState {
        let mut state = start;
        if self.dim() == 0 {
            return state;
        }
        for _ in 0..10 {
            state = self.descend(state);
            let step = self.open_step(&state);
            if norm(&step) < 1e-14 {
                break;
            }
            state = self.retract(&state, &step);
        }
        state
    }

    /// Levenberg-Marquardt, and undamped steps at its end, where differences of the cost are rounding.
    fn descend(&self, start: OffsetState) -> OffsetState {
        let mut state = start;
        let mut normal = self.normal(&state);
        let mut damping = 1e-3 * normal.largest_eigenvalue();
        for _ in 0..200 {
            let candidate = self.retract(&state, &normal.step(damping));
            if self.cost(&candidate) < normal.cost {
                state = candidate;
                normal = self.normal(&state);
                damping *= 0.1;
            } else {
                damping = (10.0 * damping).max(1e-6 * normal.largest_eigenvalue());
            }
            if damping > 1e3 * normal.largest_eigenvalue() {
                break;
            }
        }
        let mut last = f64::INFINITY;
        for _ in 0..20 {
            let step = normal.step(0.0);
            let candidate = self.retract(&state, &step);
            let next = self.normal(&candidate);
            let rounding = 1e-30 * self.length_m * self.length_m;
            if norm(&step) > 0.5 * last || next.cost > normal.cost * (1.0 + 1e-9) + rounding {
                break;
            }
            last = norm(&step);
            (state, normal) = (candidate, next);
        }
        state
    }

    /// Step in undetermined directions that makes the offsets smallest; the base is free to follow.
    fn open_step(&self, state: &OffsetState) -> Vec<f64> {
        let n = self.dim();
        let mut step = vec![0.0; n];
        let normal = self.normal(state);
        let open = normal.open_directions();
        if !self.offsets_free || open == 0 {
            return step;
        }
        let count = state.offsets.len();
        let scaled: Vec<f64> = self.scales().iter().zip(&state.offsets).map(|(scale, offset)| scale * offset).collect();
        let parts: Vec<Vec<f64>> =
            (0..open).map(|k| normal.vectors.column(k).iter().take(count).copied().collect()).collect();
        // The damping determines motions of the base alone.
        if let Some(coefficients) = linalg::combination(&parts, &scaled) {
            for (&coefficient, vector) in coefficients.iter().zip(normal.vectors.column_iter()) {
                step.iter_mut().zip(vector.iter()).for_each(|(s, a)| *s += coefficient * a);
            }
        }
        step
    }

    /// Number of unknowns: offsets, then the base motion, if they are free.
    fn dim(&self) -> usize {
        self.scales().len()
    }

    /// Metres that a unit of each unknown counts.
    pub(crate) fn scales(&self) -> Vec<f64> {
        let mut scales = Vec::new();
        if self.offsets_free {
            scales.extend(self.nominal.joints.iter().map(|joint| match joint.kind {
                JointKind::Revolute => self.length_m,
                JointKind::Prismatic => 1.0,
            }));
        }
        if self.options.base == EndConstraint::Free {
            scales.extend([1.0, 1.0, 1.0, self.length_m, self.length_m, self.length_m]);
        }
        scales
    }

    fn retract(&self, state: &OffsetState, step: &[f64]) -> OffsetState {
        let mut next = state.clone();
        let units: Vec<f64> = step.iter().zip(self.scales()).map(|(step, scale)| step / scale).collect();
        let mut base = units.as_slice();
        if self.offsets_free {
            let (offsets, rest) = units.split_at(state.offsets.len());
            base = rest;
            for ((offset, step), joint) in next.offsets.iter_mut().zip(offsets).zip(&self.nominal.joints) {
                *offset += step;
                if joint.kind == JointKind::Revolute {
                    *offset = wrap_angle(*offset);
                }
            }
        }
        if base.len() == 6 {
            let twist = Twist::from_vector(&Vector6::from_column_slice(base));
            next.base = (Pose::exp(&twist) * state.base).orthonormalized();
        }
        next
    }

    /// Residuals of the joints in order, then of the home pose, each with the number of joints that move it.
    pub(crate) fn blocks(&self, state: &OffsetState) -> (Vec<Screw>, Vec<(usize, ResidualBlock)>) {
        let (screws, home) = self.move_robot(state);
        let mut blocks = Vec::new();
        for (index, (screw, joint)) in screws.iter().zip(&self.actual.joints).enumerate() {
            blocks.extend(screw_blocks(screw, joint, self.length_m).map(|block| (index, block)));
        }
        if self.options.tip == EndConstraint::Kept {
            let goal = &self.actual.home;
            blocks.push((screws.len(), (home.translation - goal.translation, by_twist(&home.translation))));
            // Chords between the axes of the two frames: for small angles the square of the rotation, and smooth for large ones.
            let weight = self.length_m / SQRT_2;
            for (axis, goal) in home.rotation.column_iter().zip(goal.rotation.column_iter()) {
                blocks.push((screws.len(), ((axis - goal) * weight, by_turn(&-hat(&axis.into_owned()), weight))));
            }
        }
        (screws, blocks)
    }

    fn cost(&self, state: &OffsetState) -> f64 {
        self.blocks(state).1.iter().map(|(_, (residual, _))| residual.norm_squared()).sum()
    }

    fn normal(&self, state: &OffsetState) -> OffsetEquations {
        let (screws, blocks) = self.blocks(state);
        let (normal, _) = self.equations(&screws, &blocks);
        normal
    }

    /// Normal equations of some blocks, and the derivatives of their residuals by the scaled unknowns, row by row.
    pub(crate) fn equations(&self, screws: &[Screw], blocks: &[(usize, ResidualBlock)]) -> (OffsetEquations, Vec<f64>) {
        let scales = self.scales();
        let n = scales.len();
        let (mut rows, mut residuals) = (Vec::new(), Vec::new());
        for (movers, (residual, derivative)) in blocks {
            // An offset moves all later screws and the home pose by the joint's own screw at its current pose.
            let mut columns: Vec<Vector3<f64>> = Vec::with_capacity(n);
            if self.offsets_free {
                columns.extend(screws.iter().enumerate().map(|(index, screw)| {
                    if index < *movers { derivative * screw.twist().to_vector() } else { Vector3::zeros() }
                }));
            }
            if self.options.base == EndConstraint::Free {
                columns.extend(derivative.column_iter().map(|column| column.into_owned()));
            }
            for (coordinate, value) in residual.iter().enumerate() {
                rows.extend(columns.iter().zip(&scales).map(|(column, scale)| column[coordinate] / scale));
                residuals.push(*value);
            }
        }
        let (mut gram, mut gradient) = (vec![0.0; n * n], vec![0.0; n]);
        linalg::add_gram(&mut gram, n, &rows, 0);
        linalg::add_gradient(&mut gradient, &rows, &residuals);
        (OffsetEquations::new(&gram, gradient, &residuals), rows)
    }
}

/// Tilt (as a chord at `length_m`) and shift of a screw from the actual joint's, relative to the origin of that one.
fn screw_blocks(screw: &Screw, actual: &Joint, length_m: f64) -> impl Iterator<Item = ResidualBlock> + use<> {
    let direction = screw.direction();
    let tilt = ((direction - actual.screw.direction()) * length_m, by_turn(&-hat(&direction), length_m));
    let shift = (!screw.is_prismatic()).then(|| {
        let origin = actual.screw.nearest_point(&actual.frame.translation);
        let at = screw.nearest_point(&origin);
        let off = at - origin;
        let across = Matrix3::identity() - direction * direction.transpose();
        // The nearest point moves along an axis that tilts.
        let sliding = by_turn(&(direction * off.cross(&direction).transpose()), 1.0);
        (off, across * by_twist(&at) + sliding)
    });
    [Some(tilt), shift].into_iter().flatten()
}

fn norm(step: &[f64]) -> f64 {
    step.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// The same angle in (-π, π]; an angle in this interval is unchanged, to the last digit.
pub(crate) fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}
