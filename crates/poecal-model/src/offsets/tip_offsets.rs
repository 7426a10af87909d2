//! Offsets, base and tool with which the tip itself comes nearest, in position and orientation.

use nalgebra::{Matrix3, Vector3, Vector6};

use super::fit::{OffsetEquations, OffsetState, wrap_angle};
use super::prediction::{PredictionSample, TipError};
use super::{EndConstraint, OffsetOptions, into_screws};
use crate::robot::{JointKind, Robot};
use poecal_arm::lie::{Pose, Twist, hat, rotation};
use poecal_numerics::error::Result;
use poecal_numerics::linalg;

/// Largest number of steps; five are enough if the robots differ by degrees.
const STEPS: usize = 30;

/// Distance that is rounding, over a length of the arm.
const EXACT_M: f64 = 1e-12;

/// Length (m) at which a rotation of the tip counts: that of a tool beyond it. By the tip's position alone the joints of a wrist, whose axes pass
/// near it, would be turned by degrees for tenths of a millimetre.
const TOOL_M: f64 = 0.1;

/// Offsets and base motion, and the tip's motion.
type TipSolution = (OffsetState, Pose);

/// Least squares of the tip's positions and rotations in the configurations in which predictions are compared, theory.md §8 (38d).
pub(crate) struct TipFit<'a> {
    pub(crate) nominal: &'a Robot,
    pub(crate) predictions: &'a PredictionSample,
    pub(crate) options: &'a OffsetOptions,
    /// True if the offsets move; otherwise only the free ends do.
    pub(crate) moves_offsets: bool,
    /// Metres that a radian counts.
    pub(crate) length_m: f64,
}

impl TipFit<'_> {
    /// State with the tip nearest to the actual one, from the state with the nearest screws; with the tip's motion and the remaining
    /// error. If the tip does not determine a part, that of the screws stays.
    pub(crate) fn find_nearest(&self, start: OffsetState) -> Result<(OffsetState, Pose, TipError)> {
        let (tip, left) = self.compare_tip(&start)?;
        // The robots differ by offsets alone: the start is exact.
        if self.scales().is_empty() || left.rms_m <= EXACT_M * self.length_m {
            return Ok((start, tip, left));
        }
        let (state, _) = self.descend((start.clone(), tip))?;
        let (nearer, less) = self.compare_tip(&state)?;
        let cost = |it: &TipError| it.rms_m.powi(2) + (TOOL_M * it.rms_rad).powi(2);
        Ok(if cost(&less) < cost(&left) { (state, nearer, less) } else { (start, tip, left) })
    }

    /// Best motion of the tip at a state, and the remaining error.
    pub(crate) fn compare_tip(&self, state: &OffsetState) -> Result<(Pose, TipError)> {
        Ok(self.predictions.compare(&into_screws(self.nominal, &state.offsets)?, &state.base))
    }

    /// Gauss-Newton, with steps halved while they do not descend.
    fn descend(&self, start: TipSolution) -> Result<TipSolution> {
        let mut state = start;
        let mut normal = self.normal(&state)?;
        for _ in 0..STEPS {
            let step = normal.step(0.0);
            let mut share = 1.0;
            let next = loop {
                let candidate = self.retract(&state, &step, share);
                let next = self.normal(&candidate)?;
                if next.cost < normal.cost {
                    break Some((candidate, next));
                }
                share *= 0.5;
                if share < 1e-3 {
                    break None;
                }
            };
            let Some((candidate, next)) = next else { break };
            let gained = normal.cost - next.cost;
            (state, normal) = (candidate, next);
            if gained < 1e-12 * normal.cost {
                break;
            }
        }
        Ok(state)
    }

    /// Metres that a unit of each unknown counts: of offsets, base and tip, if they move.
    fn scales(&self) -> Vec<f64> {
        let joint = |kind| match kind {
            JointKind::Revolute => self.length_m,
            JointKind::Prismatic => 1.0,
        };
        let mut scales = Vec::new();
        if self.moves_offsets {
            scales.extend(self.nominal.joints.iter().map(|it| joint(it.kind)));
        }
        if self.options.base == EndConstraint::Free {
            scales.extend([1.0, 1.0, 1.0, self.length_m, self.length_m, self.length_m]);
        }
        if self.options.tip == EndConstraint::Free {
            scales.extend([1.0, 1.0, 1.0, self.length_m, self.length_m, self.length_m]);
        }
        scales
    }

    fn retract(&self, (state, tip): &TipSolution, step: &[f64], share: f64) -> TipSolution {
        let units: Vec<f64> = step.iter().zip(self.scales()).map(|(step, scale)| share * step / scale).collect();
        let mut rest = units.as_slice();
        let mut take = |is_free: bool, count: usize| {
            let (own, others) = rest.split_at(if is_free { count } else { 0 });
            rest = others;
            own
        };
        let offsets = take(self.moves_offsets, state.offsets.len());
        let base = take(self.options.base == EndConstraint::Free, 6);
        let tool = take(self.options.tip == EndConstraint::Free, 6);
        let mut next = (state.clone(), *tip);
        for ((offset, step), joint) in next.0.offsets.iter_mut().zip(offsets).zip(&self.nominal.joints) {
            *offset += step;
            if joint.kind == JointKind::Revolute {
                *offset = wrap_angle(*offset);
            }
        }
        if base.len() == 6 {
            let twist = Twist::from_vector(&Vector6::from_column_slice(base));
            next.0.base = (Pose::exp(&twist) * state.base).orthonormalized();
        }
        if tool.len() == 6 {
            let twist = Twist::from_vector(&Vector6::from_column_slice(tool));
            next.1 = (*tip * Pose::exp(&twist)).orthonormalized();
        }
        next
    }

    /// Normal equations of the tip's positions and rotations.
    fn normal(&self, (state, tip): &TipSolution) -> Result<OffsetEquations> {
        let robot = into_screws(self.nominal, &state.offsets)?;
        let scales = self.scales();
        let n = scales.len();
        let (mut rows, mut residuals) = (Vec::new(), Vec::new());
        for (readings, actual) in self.predictions.pairs() {
            let mut motion = state.base;
            let mut twists = Vec::with_capacity(robot.joints.len());
            for (joint, value) in robot.joints.iter().zip(robot.joint_values(readings)) {
                let screw = joint.screw.transform(&motion);
                motion = screw.exp(value) * motion;
                twists.push(screw.twist());
            }
            let pose = motion * robot.home * *tip;
            let place = pose.translation;
            let turn = rotation::log(&(pose.rotation * actual.rotation.transpose()));
            let residual = [place - actual.translation, turn * TOOL_M];
            // Motion of the tip by that of a joint, of the base, and of the tip in its own frame.
            let mut columns: Vec<[Vector3<f64>; 2]> = Vec::with_capacity(n);
            let zero = Vector3::zeros();
            if self.moves_offsets {
                columns.extend(twists.iter().map(|it| [it.v + it.w.cross(&place), it.w * TOOL_M]));
            }
            if self.options.base == EndConstraint::Free {
                let (turned, axes) = (-hat(&place), Matrix3::<f64>::identity() * TOOL_M);
                columns.extend([Vector3::x(), Vector3::y(), Vector3::z()].map(|it| [it, zero]));
                columns.extend((0..3).map(|k| [turned.column(k).into_owned(), axes.column(k).into_owned()]));
            }
            if self.options.tip == EndConstraint::Free {
                let axes = pose.rotation;
                columns.extend((0..3).map(|k| [axes.column(k).into_owned(), zero]));
                columns.extend((0..3).map(|k| [zero, axes.column(k) * TOOL_M]));
            }
            for (part, residual) in residual.iter().enumerate() {
                for (coordinate, value) in residual.iter().enumerate() {
                    let own = columns.iter().zip(&scales);
                    rows.extend(own.map(|(column, scale)| column[part][coordinate] / scale));
                    residuals.push(*value);
                }
            }
        }
        let (mut gram, mut gradient) = (vec![0.0; n * n], vec![0.0; n]);
        linalg::add_gram(&mut gram, n, &rows, 0);
        linalg::add_gradient(&mut gradient, &rows, &residuals);
        Ok(OffsetEquations::new(&gram, gradient, &residuals))
    }
}
