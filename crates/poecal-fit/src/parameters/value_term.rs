//! Coefficient of a term of a joint's value.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject};
use crate::state::{Estimate, RowChain};
use poecal_arm::lie::TargetTwist;
use poecal_model::robot::{JointKind, Term};
use poecal_numerics::unit::Unit;

/// A term of joint `joint`, `θ ← θ + c b(θ)`. The column is b times that of the joint's value, `r = Ad_T ξ` of lou2009 (8d). At the target
/// it is `(z × d; z) b`, or `(z; 0) b` for a prismatic joint (theory.md §5 (26)). An offset, b = 1, adds no rank beside free screws
/// (lou2009 Proposition 1, theory.md §3 (9)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueTerm {
    /// Index of the joint.
    pub joint: usize,
    /// Kind.
    pub kind: JointKind,
    /// Term.
    pub term: Term,
}

impl ParameterColumns for ValueTerm {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Joint(self.joint)
    }

    fn columns(&self) -> &'static [Column] {
        const fn column(unit: Unit, shifts_only: bool) -> Column {
            Column { name: "", unit, shifts_only }
        }
        const TURNED: [[Column; 1]; 3] =
            [[column(Unit::Metre, false)], [column(Unit::Radian, false)], [column(Unit::One, false)]];
        const SHIFTED: [[Column; 1]; 3] =
            [[column(Unit::Metre, true)], [column(Unit::Radian, true)], [column(Unit::One, true)]];
        let at = self.kind.unit_of(self.term) as usize;
        match self.kind {
            JointKind::Revolute => &TURNED[at],
            JointKind::Prismatic => &SHIFTED[at],
        }
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        out[0] = (Vector3::zeros(), Vector3::zeros());
        for view in chain.of_joint(self.joint) {
            let basis = chain.basis(view, self.term);
            let z = view.z * if view.backward { -basis } else { basis };
            let (moved, turned) = match self.kind {
                JointKind::Revolute => (z.cross(&(chain.target.translation - view.origin)), z),
                JointKind::Prismatic => (z, Vector3::zeros()),
            };
            out[0].0 += moved;
            out[0].1 += turned;
        }
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        *estimate.coefficient_mut(self.joint, self.term) += step[0];
    }
}
