//! Zero or scale of an instrument's distances.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject};
use crate::state::{Estimate, RangeModel, RangeTerm, RowChain};
use poecal_arm::lie::TargetTwist;
use poecal_numerics::unit::Unit;

/// A term of an instrument's range: column `(p/|p|; 0)` of its zero, `(p; 0)` of its scale. These are motions of the measured position of
/// the target (theory.md §5 (25b)). It is zero in rows of another station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeUnknown {
    /// Index of the station.
    pub station: usize,
    /// Term.
    pub term: RangeTerm,
}

const ZERO: [Column; 1] = [Column::shift("")];
const SCALE: [Column; 1] = [Column { name: "", unit: Unit::One, shifts_only: true }];

impl ParameterColumns for RangeUnknown {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Range(self.station)
    }

    fn columns(&self) -> &'static [Column] {
        match self.term {
            RangeTerm::Zero => &ZERO,
            RangeTerm::Scale => &SCALE,
        }
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        let moved =
            if chain.station == self.station { RangeModel::motion(&chain.target, self.term) } else { Vector3::zeros() };
        out.fill((moved, Vector3::zeros()));
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let range = estimate.range_mut(self.station);
        let term = match self.term {
            RangeTerm::Zero => &mut range.zero_m,
            RangeTerm::Scale => &mut range.scale,
        };
        *term += step.first().copied().unwrap_or_default();
    }
}
