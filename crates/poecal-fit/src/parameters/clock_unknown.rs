//! Lag or drift of an instrument's clock.

use nalgebra::Vector3;

use super::columns::{Column, ParameterColumns, ParameterSubject};
use crate::state::{ClockTerm, Estimate, RowChain};
use poecal_arm::lie::TargetTwist;
use poecal_model::robot::JointKind;
use poecal_numerics::unit::Unit;

/// A term of an instrument's clock. Its column is `Σ_j f q̇_j` times that of the value of joint j, with the joint's rate q̇. The factor is `f = -1`
/// for the lag, `-t` for the drift (theory.md §5 (26a)). It is zero in rows of another station, and in rows that were measured at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockUnknown {
    /// Index of the station.
    pub station: usize,
    /// Term.
    pub term: ClockTerm,
}

const LAG: [Column; 1] = [Column { name: "", unit: Unit::Second, shifts_only: false }];
const DRIFT: [Column; 1] = [Column { name: "", unit: Unit::One, shifts_only: false }];

impl ParameterColumns for ClockUnknown {
    fn subject(&self) -> ParameterSubject {
        ParameterSubject::Clock(self.station)
    }

    fn columns(&self) -> &'static [Column] {
        match self.term {
            ClockTerm::Lag => &LAG,
            ClockTerm::Drift => &DRIFT,
        }
    }

    fn target_twists(&self, chain: &RowChain, _: usize, out: &mut [TargetTwist]) {
        let mut twist = (Vector3::zeros(), Vector3::zeros());
        if let Some((rates, time_s)) = chain.motion_rates().filter(|_| chain.station == self.station) {
            let factor = self.term.factor(time_s);
            for view in &chain.joints {
                let rate = factor * rates.get(view.joint).copied().unwrap_or_default();
                let z = view.z * if view.backward { -rate } else { rate };
                match view.kind {
                    JointKind::Revolute => {
                        twist.0 += z.cross(&(chain.target.translation - view.origin));
                        twist.1 += z;
                    }
                    JointKind::Prismatic => twist.0 += z,
                }
            }
        }
        out.fill(twist);
    }

    fn has_curvature(&self) -> bool {
        false
    }

    fn retract(&self, estimate: &mut Estimate, step: &[f64]) {
        let clock = estimate.clock_mut(self.station);
        let term = match self.term {
            ClockTerm::Lag => &mut clock.lag_s,
            ClockTerm::Drift => &mut clock.drift,
        };
        *term += step.first().copied().unwrap_or_default();
    }
}
