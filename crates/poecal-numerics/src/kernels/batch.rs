//! State of one vector of rows: the chain, its columns in local axis frames, and their gradient.

use pulp::Simd;

use super::frame::{KernelFrame, move_row, turn_row};
use super::plan::{FixedMotion, KernelPlan};
use super::turn::ResidualRotations;
use super::vector::{LaneBlock, Lanes, Vectors};
use super::work::{JointWork, ValueColumn};

/// State of one vector of rows: part `part` of a block.
pub(crate) struct Batch<'a> {
    pub(crate) plan: &'a KernelPlan,
    pub(crate) part: usize,
    /// Columns of the block, each `stride` after the one before.
    pub(crate) columns: &'a mut [[LaneBlock; 3]],
    pub(crate) stride: usize,
    pub(crate) axes: &'a mut [JointWork],
    pub(crate) terms: &'a mut [ValueColumn],
    pub(crate) shift_gradient: &'a mut [LaneBlock],
    pub(crate) turn_gradient: &'a mut [LaneBlock],
}

/// Weight of each row, and its whitened residual as a wrench on the target.
#[derive(Clone, Copy)]
pub(crate) struct RowWrench<S: Simd> {
    pub(crate) weight: Lanes<S>,
    pub(crate) per_length: Lanes<S>,
    /// Whitened position error.
    pub(crate) force: Vectors<S>,
    /// Whitened rotation error, in the units of a rotation column's gradient.
    pub(crate) torque: Vectors<S>,
}

impl Batch<'_> {
    /// The chain from the device to the last joint's moved frame; writes the axes' shift columns: theory.md §5 (20) and (22).
    #[inline(always)]
    pub(crate) fn chain<S: Simd, const PLAIN: bool>(
        &mut self,
        simd: S,
        steps: &[FixedMotion],
        (values, factors): (&[[LaneBlock; 2]], &[LaneBlock]),
        weight: Lanes<S>,
        per_length: Lanes<S>,
    ) -> KernelFrame<S> {
        let part = self.part;
        let mut link = KernelFrame([[Lanes::splat(simd, 0.0); 4]; 3]);
        let joints = self.plan.joints.iter().zip(steps).zip(values).zip(&mut *self.axes);
        for (index, (((joint, step), [cosine, sine]), axis)) in joints.enumerate() {
            if index == 0 {
                link = KernelFrame::from_step(simd, step);
            }
            let (cosine, sine) = (Lanes::load(simd, cosine, part), Lanes::load(simd, sine, part));
            let (slide, own_sine) = (weight * cosine * per_length, weight * sine);
            let versine = weight - weight * cosine;
            for (k, row) in link.0.iter_mut().enumerate() {
                let still = if index == 0 { *row } else { turn_row(simd, *row, step) };
                let [x, y, _, origin] = still;
                *row = move_row(still, joint.turns, cosine, sine);
                let (a, b) = if joint.turns {
                    (y.times_from(own_sine, x * versine), x.times_plus(own_sine, y * versine))
                } else {
                    (-(y * slide), x * slide)
                };
                a.store(&mut axis.shifts[0][k], part);
                b.store(&mut axis.shifts[1][k], part);
                origin.store(&mut axis.origin[k], part);
            }
            if PLAIN || joint.terms.1 == 0 {
                continue;
            }
            // The joint's own motion does not change its direction.
            let along = link.column(2);
            let terms = joint.terms.0..joint.terms.0 + joint.terms.1;
            for (term, factor) in self.terms[terms.clone()].iter_mut().zip(&factors[terms]) {
                let factor = Lanes::load(simd, factor, part);
                for (z, out) in along.0.into_iter().zip(&mut term.direction) {
                    (z * factor * weight).store(out, part);
                }
            }
        }
        link
    }

    /// Columns of the device's frame: theory.md §5 (25).
    #[inline(always)]
    pub(crate) fn add_device<S: Simd, const FULL: bool>(
        &mut self,
        simd: S,
        target: &KernelFrame<S>,
        wrench: &RowWrench<S>,
    ) {
        let Some(device) = &self.plan.device else { return };
        let part = self.part;
        let arm = (target.origin() - Vectors::splat(simd, &device.about)).scale(wrench.per_length);
        let moment = arm.cross(wrench.force) + wrench.torque;
        for k in 0..3 {
            let mut axis = Vectors([Lanes::splat(simd, 0.0); 3]);
            axis.0[k] = wrench.weight;
            (wrench.weight * wrench.force.0[k]).add_to(&mut self.shift_gradient[k], part);
            if device.turns {
                (wrench.weight * moment.0[k]).add_to(&mut self.turn_gradient[k], part);
            }
            if FULL {
                axis.store(&mut self.columns[k * self.stride], part);
                if device.turns {
                    axis.cross(arm).store(&mut self.columns[(self.plan.shifts + k) * self.stride], part);
                }
            }
        }
    }

    /// Columns of the axes' tilts, theory.md §5 (21), and the gradient of all their unknowns.
    #[inline(always)]
    pub(crate) fn add_axes<S: Simd, const FULL: bool, const PLAIN: bool>(
        &mut self,
        simd: S,
        target: &KernelFrame<S>,
        wrench: &RowWrench<S>,
    ) {
        let (part, stride) = (self.part, self.stride);
        if !PLAIN && !self.plan.terms.is_empty() {
            self.add_terms::<S, FULL>(simd, target, wrench);
        }
        for (joint, axis) in self.plan.joints.iter().zip(&mut *self.axes) {
            let Some((shift, tilt)) = joint.columns else { continue };
            let (a, b) = (Vectors::load(simd, &axis.shifts[0], part), Vectors::load(simd, &axis.shifts[1], part));
            a.dot(wrench.force).add_to(&mut axis.gradient[0], part);
            b.dot(wrench.force).add_to(&mut axis.gradient[1], part);
            if FULL {
                a.store(&mut self.columns[shift * stride], part);
                b.store(&mut self.columns[(shift + 1) * stride], part);
            }
            if !joint.turns {
                continue;
            }
            let arm = (target.origin() - Vectors::load(simd, &axis.origin, part)).scale(wrench.per_length);
            let moment = arm.cross(wrench.force) + wrench.torque;
            a.dot(moment).add_to(&mut axis.gradient[2], part);
            b.dot(moment).add_to(&mut axis.gradient[3], part);
            if FULL {
                let column = (self.plan.shifts + tilt) * stride;
                a.cross(arm).store(&mut self.columns[column], part);
                b.cross(arm).store(&mut self.columns[column + stride], part);
            }
        }
    }

    /// Columns and gradient of the unknown terms of joint values.
    #[inline(always)]
    fn add_terms<S: Simd, const FULL: bool>(&mut self, simd: S, target: &KernelFrame<S>, wrench: &RowWrench<S>) {
        let (part, stride) = (self.part, self.stride);
        for (joint, axis) in self.plan.joints.iter().zip(&*self.axes).filter(|(joint, _)| joint.terms.1 > 0) {
            let arm = (target.origin() - Vectors::load(simd, &axis.origin, part)).scale(wrench.per_length);
            let moment = arm.cross(wrench.force) + wrench.torque;
            let (first, end) = (joint.terms.0, joint.terms.0 + joint.terms.1);
            for (plan, found) in self.plan.terms[first..end].iter().zip(&mut self.terms[first..end]) {
                let along = Vectors::load(simd, &found.direction, part);
                let pull = if joint.turns { along.dot(moment) } else { along.dot(wrench.force) };
                pull.add_to(&mut found.gradient, part);
                if FULL {
                    along.store(&mut self.columns[plan.shift * stride], part);
                    if let Some(turn) = plan.turn {
                        along.cross(arm).store(&mut self.columns[(self.plan.shifts + turn) * stride], part);
                    }
                }
            }
        }
    }

    /// Columns of the target's position and frame: theory.md §5 (23) and (24).
    #[inline(always)]
    pub(crate) fn add_place<S: Simd, const FULL: bool>(&mut self, target: &KernelFrame<S>, wrench: &RowWrench<S>) {
        let Some(place) = self.plan.place else { return };
        let part = self.part;
        for k in 0..3 {
            let axis = target.column(k).scale(wrench.weight);
            axis.dot(wrench.force).add_to(&mut self.shift_gradient[place + k], part);
            if let Some(frame) = self.plan.frame {
                axis.dot(wrench.torque).add_to(&mut self.turn_gradient[frame + k], part);
            }
            if FULL {
                axis.store(&mut self.columns[(place + k) * self.stride], part);
            }
        }
    }

    /// Rows that rotation adds to the products of rotation columns; `ratio` is that of a rotation column to its translation column.
    #[inline(always)]
    pub(crate) fn add_turned<S: Simd>(
        &self,
        simd: S,
        turn: &ResidualRotations<S>,
        ratio: Lanes<S>,
        out: &mut [LaneBlock],
        rows: usize,
    ) {
        let columns = self.plan.turns.iter().map(|&shift| &self.columns[shift * self.stride]);
        let outs = out.chunks_mut((rows * self.stride).max(1));
        if self.plan.ratio.is_some() {
            let [first, second] = turn.excess();
            for (column, out) in columns.zip(outs) {
                let w = Vectors::load(simd, column, self.part);
                first.dot(w).store(&mut out[0], self.part);
                second.dot(w).store(&mut out[1], self.part);
            }
        } else {
            for (column, out) in columns.zip(outs) {
                let moved = turn.apply(Vectors::load(simd, column, self.part).scale(ratio));
                for (out, number) in out.iter_mut().zip(moved.0) {
                    number.store(out, self.part);
                }
            }
        }
    }
}
