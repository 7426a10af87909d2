//! Violation of the constraints `v·ω = 0` and `|ω| = 1` of screws during a fit, before any correction.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Twist};
use poecal_fit::parameters::Parameter;
use poecal_fit::problem::Problem;
use poecal_fit::state::Estimate;
use poecal_model::robot::JointKind;
use poecal_numerics::solve::{LeastSquares, NormalEquations};

/// A violation of the constraints of a revolute screw.
#[derive(Clone, Copy, Default)]
pub(super) struct ConstraintMiss {
    /// `|v·ω|`, metres.
    pub(super) pitch_m: f64,
    /// `||ω| - 1|`.
    pub(super) length: f64,
}

impl ConstraintMiss {
    fn from_screw(screw: &Twist) -> Self {
        ConstraintMiss { pitch_m: screw.v.dot(&screw.w).abs(), length: (screw.w.norm() - 1.0).abs() }
    }

    fn or_larger(self, other: ConstraintMiss) -> Self {
        ConstraintMiss { pitch_m: self.pitch_m.max(other.pitch_m), length: self.length.max(other.length) }
    }
}

/// A problem that records the constraints of the screws in its steps.
pub(super) struct WatchedProblem<'a>(pub(super) &'a Problem<'a>);

/// An estimate, and the constraints up to it.
#[derive(Clone)]
pub(super) struct WatchedState {
    pub(super) estimate: Estimate,
    /// Screws that were moved only by `ξ ← Ad(e^η) ξ`, without any projection.
    screws: Vec<Twist>,
    /// Largest violation by `ξ + dξ` before it is normalised, or by a screw that was moved as a body.
    pub(super) miss: ConstraintMiss,
}

impl WatchedState {
    pub(super) fn new(estimate: Estimate) -> Self {
        let screws = estimate.screws().iter().map(|screw| screw.twist()).collect();
        WatchedState { estimate, screws, miss: ConstraintMiss::default() }
    }
}

impl LeastSquares for WatchedProblem<'_> {
    type State = WatchedState;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn normal(&self, state: &WatchedState) -> NormalEquations {
        self.0.normal(&state.estimate)
    }

    fn project_constraints(&self, step: &mut [f64]) {
        self.0.project_constraints(step);
    }

    fn rounding(&self) -> f64 {
        self.0.rounding()
    }

    fn retract(&self, state: &WatchedState, step: &[f64]) -> WatchedState {
        let (mut screws, mut miss) = (state.screws.clone(), state.miss);
        for (parameter, places) in self.0.layout().parameters() {
            let own: Vec<f64> = places.iter().map(|&(place, scale)| step[place] / scale).collect();
            match parameter {
                Parameter::OtherScrew(free) => {
                    if let (JointKind::Revolute, &[vx, vy, vz, wx, wy, wz]) = (free.kind, own.as_slice()) {
                        // In the axis frame: length and pitch are the same in every frame.
                        let freed = Twist::new(Vector3::new(vx, vy, vz), Vector3::new(wx, wy, 1.0 + wz));
                        miss = miss.or_larger(ConstraintMiss::from_screw(&freed));
                    }
                }
                Parameter::ScrewAxis(axis) => {
                    if let &[vx, vy, wx, wy] = own.as_slice() {
                        let local = Twist::new(Vector3::new(vx, vy, 0.0), Vector3::new(wx, wy, 0.0));
                        let eta = state.estimate.base_from_axis[axis.joint].transform(&local);
                        screws[axis.joint] = Pose::exp(&eta).transform(&screws[axis.joint]);
                        miss = miss.or_larger(ConstraintMiss::from_screw(&screws[axis.joint]));
                    }
                }
                Parameter::ValueTerm(_)
                | Parameter::TargetPlace(_)
                | Parameter::TargetFrame(_)
                | Parameter::DeviceFrame(_)
                | Parameter::RangeUnknown(_)
                | Parameter::ClockUnknown(_) => {}
            }
        }
        WatchedState { estimate: self.0.retract(&state.estimate, step), screws, miss }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MeasurementKind, runs};
    use super::*;
    use crate::{PaperFormulation, PaperResidual};
    use poecal_model::measurement::Noise;

    /// A step of 1e-2 in every unknown.
    fn step_unknowns(formulation: PaperFormulation) -> WatchedState {
        let session = runs::session(false, MeasurementKind::Poses, 1);
        let data = session.data(PaperResidual::Spatial, &session.exact_poses()).unwrap();
        let noise = Noise::new(1.0, 1.0);
        let free = session.free_parameters(formulation);
        let problem = Problem::new(session.session_with_data(&data, 1.0), session.rows(), free, noise);
        WatchedProblem(&problem).retract(&WatchedState::new(session.start()), &vec![1e-2; problem.dim()])
    }

    #[test]
    fn free_screws_miss_their_constraints_and_moved_ones_do_not() {
        let free = step_unknowns(PaperFormulation::Screw).miss;
        // dξ = 0.01 (1, 1, 1; 1, 1, 1) about the axis z: v·ω = 0.01 (0.01 + 0.01 + 1.01), |ω|² = 2e-4 + 1.01².
        assert!((free.pitch_m - 0.0103).abs() < 1e-15 && (free.length - (1.0203_f64.sqrt() - 1.0)).abs() < 1e-15);
        let moved = step_unknowns(PaperFormulation::Adjoint);
        assert!(moved.miss.pitch_m < 1e-15 && moved.miss.length < 1e-15);
        // The recorded screws are those of the estimate, except for rounding.
        for (watched, screw) in moved.screws.iter().zip(moved.estimate.screws()) {
            assert!((watched.to_vector() - screw.twist().to_vector()).amax() < 1e-14);
        }
    }
}
