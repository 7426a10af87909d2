//! Order and scale of the unknowns of all parameters.

use crate::parameters::{Parameter, ParameterSubject, Wrench};
use crate::state::{Estimate, RowChain};
use nalgebra::Vector3;
use poecal_arm::lie::TargetTwist;

/// The free parameters and the place of each of their unknowns in a step. Unknowns that only translate a target come first (their
/// rotation rows are zero), then the others. A step is in metres: radians are multiplied by the length L (theory.md §6, *Physical
/// scaling*).
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    parameters: Vec<Parameter>,
    /// For each unknown in the order of the parameters: its place in the step, and step units per its own unit.
    places: Vec<(usize, f64)>,
    shifts: usize,
    length_m: f64,
}

impl Layout {
    /// Orders the unknowns of parameters; a radian counts as `length_m` metres.
    #[must_use]
    pub fn new(parameters: Vec<Parameter>, length_m: f64) -> Self {
        let columns: Vec<_> = parameters.iter().flat_map(|parameter| parameter.model().columns()).collect();
        let shifts = columns.iter().filter(|column| column.shifts_only).count();
        let (mut next_shift, mut next_other) = (0, shifts);
        let places = columns
            .iter()
            .map(|column| {
                let next = if column.shifts_only { &mut next_shift } else { &mut next_other };
                *next += 1;
                (*next - 1, column.unit.metres(length_m))
            })
            .collect();
        Layout { parameters, places, shifts, length_m }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.places.len()
    }

    /// Number of unknowns that only translate a target; they come first in a step.
    #[must_use]
    pub fn shifts(&self) -> usize {
        self.shifts
    }

    /// Metres that a radian counts.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Free parameters with the places of their unknowns in a step.
    pub fn parameters(&self) -> impl Iterator<Item = (&Parameter, &[(usize, f64)])> {
        let mut rest = &self.places[..];
        self.parameters.iter().map(move |parameter| {
            let (mine, others) = rest.split_at(parameter.model().columns().len());
            rest = others;
            (parameter, mine)
        })
    }

    /// True if all screws are in the minimal basis of theory.md §5 (18), without redundant unknowns.
    #[must_use]
    pub fn is_minimal(&self) -> bool {
        self.parameters.iter().all(|parameter| match parameter {
            Parameter::OtherScrew(_) | Parameter::ValueTerm(_) | Parameter::ClockUnknown(_) => false,
            Parameter::ScrewAxis(_)
            | Parameter::TargetPlace(_)
            | Parameter::TargetFrame(_)
            | Parameter::DeviceFrame(_)
            | Parameter::RangeUnknown(_) => true,
        })
    }

    /// True if a term of a joint's value or a clock is unknown, so that joint values depend on the state.
    pub(crate) fn moves_values(&self) -> bool {
        let moves = |it: &Parameter| matches!(it, Parameter::ValueTerm(_) | Parameter::ClockUnknown(_));
        self.parameters.iter().any(moves)
    }

    /// True if zero or scale of an instrument's distances are unknown.
    pub(crate) fn has_range(&self, station: usize) -> bool {
        let is_of = |parameter: &Parameter| matches!(parameter, Parameter::RangeUnknown(it) if it.station == station);
        self.parameters.iter().any(is_of)
    }

    /// True if the screws are unknown in another parameterisation than the minimal basis.
    pub(crate) fn has_other_screws(&self) -> bool {
        self.parameters.iter().any(|parameter| matches!(parameter, Parameter::OtherScrew(_)))
    }

    /// True if every parameter provides its curvature.
    #[must_use]
    pub(crate) fn has_curvature(&self) -> bool {
        self.parameters.iter().all(|parameter| parameter.model().has_curvature())
    }

    /// Projects a scaled step onto the constraints that the retraction restores, to first order.
    pub(crate) fn project_constraints(&self, step: &mut [f64]) {
        let mut own = [0.0; 6];
        for (parameter, places) in self.parameters() {
            for (value, &(place, _)) in own.iter_mut().zip(places) {
                *value = step[place];
            }
            parameter.model().project_constraints(&mut own[..places.len()]);
            for (value, &(place, _)) in own.iter().zip(places) {
                step[place] = *value;
            }
        }
    }

    /// Target twist `(v; ω)` per unit of each scaled unknown, in the order of a step and in the device's axes (theory.md §4 (14)).
    pub fn target_twists(&self, chain: &RowChain, target: usize, out: &mut [TargetTwist]) {
        let mut own = [(Vector3::zeros(), Vector3::zeros()); 6];
        for (parameter, places) in self.parameters() {
            parameter.model().target_twists(chain, target, &mut own[..places.len()]);
            for (&(place, scale), (v, w)) in places.iter().zip(&own) {
                out[place] = if scale == 1.0 { (*v, *w) } else { (v / scale, w / scale) };
            }
        }
    }

    /// Adds `-wrench · ∂²(target's motion)` of every pair of unknowns to the upper triangle of a row-major matrix. With `a` before `b`
    /// in the chain the second derivative is `ω_a × v_b` of the position and `½ ω_a × ω_b` of the rotation (theory.md §6 (31a)).
    pub(crate) fn add_curvature(&self, chain: &RowChain, target: usize, wrench: &Wrench, out: &mut [f64]) {
        let n = self.dim();
        let mut add = |a: usize, b: usize, value: f64| out[a.min(b) * n + a.max(b)] -= value;
        let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); n];
        self.target_twists(chain, target, &mut twists);
        let mut own = [0.0; 36];
        // The order is that of this chain; a parameter outside it does not move the target.
        let mut in_order: Vec<_> = self
            .parameters()
            .map(|(parameter, places)| {
                let place = match parameter.model().subject() {
                    ParameterSubject::Instrument(_) => 0,
                    ParameterSubject::Joint(joint) => {
                        1 + chain.joints.iter().position(|view| view.joint == joint).unwrap_or(joint)
                    }
                    ParameterSubject::Target(_) | ParameterSubject::Range(_) | ParameterSubject::Clock(_) => usize::MAX,
                };
                (place, parameter, places)
            })
            .collect();
        in_order.sort_by_key(|&(place, ..)| place);
        for (first, &(_, parameter, places)) in in_order.iter().enumerate() {
            let dim = places.len();
            own.fill(0.0);
            parameter.model().curvature(chain, wrench, &mut own[..dim * dim]);
            for (i, &(a, scale_a)) in places.iter().enumerate() {
                for (j, &(b, scale_b)) in places.iter().enumerate().skip(i) {
                    add(a, b, own[i * dim + j] / (scale_a * scale_b));
                }
                let turn = twists[a].1;
                let (pull, twist) = (wrench.force.cross(&turn), wrench.torque.cross(&turn) * 0.5);
                for (_, _, later) in &in_order[first + 1..] {
                    for &(b, _) in *later {
                        add(a, b, pull.dot(&twists[b].0) + twist.dot(&twists[b].1));
                    }
                }
            }
        }
    }

    /// Estimate after a scaled step: the retraction `x ⊕ δ` of theory.md §6 (27).
    #[must_use]
    pub fn retract(&self, estimate: &Estimate, step: &[f64]) -> Estimate {
        let mut moved = estimate.clone();
        let mut own = [0.0; 6];
        for (parameter, places) in self.parameters() {
            for (value, &(place, scale)) in own.iter_mut().zip(places) {
                *value = step[place] / scale;
            }
            parameter.model().retract(&mut moved, &own[..places.len()]);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::TargetFrame;

    #[test]
    fn a_target_has_three_shifts_among_six_unknowns() {
        let layout = Layout::new(vec![Parameter::TargetFrame(TargetFrame::new(0))], 0.5);
        assert_eq!((layout.dim(), layout.shifts()), (6, 3));
    }
}
