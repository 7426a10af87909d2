//! A joint's screw, in the minimal basis of its axis frame (theory.md §5 (18)).

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject, Wrench};
use crate::state::{Estimate, RowChain};
use poecal_arm::lie::{Pose, TargetTwist, Twist};
use poecal_model::robot::JointKind;

/// The screw of joint `joint`, moved by the adjoint of a local step `ε` in its axis frame: `A ← A exp(ε)`, which is
/// `ξ ← Ad_exp(η) ξ` with `η = Ad_A ε` (theory.md §5 (18); lou2009 (16) to (18) without the kernel of η).
///
/// Revolute, `ε = (tx, ty, 0; rx, ry, 0)`, 4 unknowns: with `Δx = (1 - cos θ) x - sin θ y`, `Δy = sin θ x + (1 - cos θ) y` and
/// `d` from the axis frame's origin to the target, the columns are `(Δx; 0), (Δy; 0), (Δx × d; Δx), (Δy × d; Δy)`:
/// theory.md §5 (20) and (21).
/// Prismatic, `ε = (0; rx, ry, 0)`, 2 unknowns: `(-θ y; 0), (θ x; 0)`, theory.md §5 (22).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewAxis {
    /// Index of the joint.
    pub joint: usize,
    /// Kind.
    pub kind: JointKind,
}

const TURNED: [Column; 4] = [Column::shift("x"), Column::shift("y"), Column::turn("rx"), Column::turn("ry")];
const SLID: [Column; 2] = [Column::direction("rx"), Column::direction("ry")];

impl ParameterColumns for ScrewAxis {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Joint(self.joint)
    }

    fn columns(&self) -> &'static [Column] {
        match self.kind {
            JointKind::Revolute => &TURNED,
            JointKind::Prismatic => &SLID,
        }
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        out.fill((Vector3::zeros(), Vector3::zeros()));
        let mut add = |k: usize, (moved, turned): TargetTwist| {
            out[k].0 += moved;
            out[k].1 += turned;
        };
        for joint in chain.of_joint(self.joint) {
            match self.kind {
                JointKind::Revolute => {
                    let versine = 1.0 - joint.cosine_or_value;
                    let dx = joint.x * versine - joint.y * joint.sine;
                    let dy = joint.x * joint.sine + joint.y * versine;
                    let arm = chain.target.translation - joint.origin;
                    add(0, (dx, Vector3::zeros()));
                    add(1, (dy, Vector3::zeros()));
                    add(2, (dx.cross(&arm), dx));
                    add(3, (dy.cross(&arm), dy));
                }
                JointKind::Prismatic => {
                    add(0, (joint.y * -joint.cosine_or_value, Vector3::zeros()));
                    add(1, (joint.x * joint.cosine_or_value, Vector3::zeros()));
                }
            }
        }
    }

    fn curvature(&self, chain: &RowChain, wrench: &Wrench, out: &mut [f64]) {
        let Some(joint) = chain.of_joint(self.joint).next() else { return };
        let arm = chain.target.translation - joint.origin;
        let (turned_x, turned_y) = match self.kind {
            JointKind::Revolute => (
                joint.x * joint.cosine_or_value + joint.y * joint.sine,
                joint.y * joint.cosine_or_value - joint.x * joint.sine,
            ),
            JointKind::Prismatic => (joint.x, joint.y),
        };
        // exp(ε) exp(ẑθ) exp(-ε): one twist before the joint's motion, its opposite after. They are stored as (linear velocity at the
        // target, rotation).
        let zero = Vector3::zeros();
        let (before, after): (Vec<TargetTwist>, Vec<TargetTwist>) = match self.kind {
            JointKind::Revolute => (
                vec![(joint.x, zero), (joint.y, zero), (joint.x.cross(&arm), joint.x), (joint.y.cross(&arm), joint.y)],
                vec![
                    (turned_x, zero),
                    (turned_y, zero),
                    (turned_x.cross(&arm), turned_x),
                    (turned_y.cross(&arm), turned_y),
                ],
            ),
            JointKind::Prismatic => {
                let moved = arm - joint.z * joint.cosine_or_value;
                (
                    vec![(joint.x.cross(&arm), joint.x), (joint.y.cross(&arm), joint.y)],
                    vec![(joint.x.cross(&moved), joint.x), (joint.y.cross(&moved), joint.y)],
                )
            }
        };
        let dim = before.len();
        for a in 0..dim {
            for b in 0..dim {
                let second = |outer: &TargetTwist, inner: &TargetTwist| outer.1.cross(&inner.0);
                let position = (second(&before[a], &before[b]) + second(&before[b], &before[a])) * 0.5
                    + (second(&after[a], &after[b]) + second(&after[b], &after[a])) * 0.5
                    - second(&before[a], &after[b])
                    - second(&before[b], &after[a]);
                let turn = (before[a].1.cross(&after[b].1) + before[b].1.cross(&after[a].1)) * -0.5;
                out[a * dim + b] = wrench.force.dot(&position) + wrench.torque.dot(&turn);
            }
        }
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let local = match self.kind {
            JointKind::Revolute => Twist::new(Vector3::new(step[0], step[1], 0.0), Vector3::new(step[2], step[3], 0.0)),
            JointKind::Prismatic => Twist::new(Vector3::zeros(), Vector3::new(step[0], step[1], 0.0)),
        };
        let frame = &mut estimate.base_from_axis[self.joint];
        *frame = (*frame * Pose::exp(&local)).orthonormalized();
    }
}
