//! How the unknowns of all parameters are arranged and scaled.

use crate::estimate::{Chain, Estimate};
use crate::measurement::TargetTwist;
use crate::parameters::{Parameter, Unit};
use nalgebra::Vector3;

/// The free parameters and the place of each of their unknowns in a step: first those that only shift a target, whose rotation
/// rows are zero, then the others. A step is in metres; radians are multiplied by a length.
///
/// ```
/// use poecal::parameters::{Parameter, TargetFrame};
/// let layout = poecal::problem::Layout::new(vec![Parameter::TargetFrame(TargetFrame { target: 0 })], 0.5);
/// assert_eq!((layout.dim(), layout.shifts()), (6, 3));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    parameters: Vec<Parameter>,
    /// For each unknown in the order of the parameters: its place in the step, and step units per its own unit.
    places: Vec<(usize, f64)>,
    shifts: usize,
}

impl Layout {
    /// Arranges parameters; `length_m` is how many metres one radian counts.
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
                let scale = match column.unit {
                    Unit::Metre => 1.0,
                    Unit::Radian => length_m,
                };
                (*next - 1, scale)
            })
            .collect();
        Layout { parameters, places, shifts }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.places.len()
    }

    /// Number of unknowns that only shift a target; they come first in a step.
    #[must_use]
    pub fn shifts(&self) -> usize {
        self.shifts
    }

    /// The free parameters with the places of their unknowns in a step.
    pub fn parameters(&self) -> impl Iterator<Item = (&Parameter, &[(usize, f64)])> {
        let mut rest = &self.places[..];
        self.parameters.iter().map(move |parameter| {
            let (mine, others) = rest.split_at(parameter.model().columns().len());
            rest = others;
            (parameter, mine)
        })
    }

    /// The target's motion per unit of each scaled unknown, in the order of a step.
    pub(crate) fn target_twists(&self, chain: &Chain, target: usize, out: &mut [TargetTwist]) {
        let mut own = [(Vector3::zeros(), Vector3::zeros()); 6];
        for (parameter, places) in self.parameters() {
            parameter.model().target_twists(chain, target, &mut own[..places.len()]);
            for (&(place, scale), (v, w)) in places.iter().zip(&own) {
                out[place] = if scale == 1.0 { (*v, *w) } else { (v / scale, w / scale) };
            }
        }
    }

    /// The estimate after a scaled step.
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
