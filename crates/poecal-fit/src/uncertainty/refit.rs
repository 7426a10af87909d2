//! Uncertainty of predictions if device frame and targets are refitted from the very rows that are predicted
//! (theory.md §9, *Coverage*).

use nalgebra::DMatrix;

use super::Uncertainty;
use crate::parameters::Parameter;
use crate::problem::{Layout, Problem};
use crate::state::{Estimate, Session};
use poecal_model::measurement::Noise;
use poecal_numerics::linalg;
use poecal_numerics::solve::LeastSquares as _;

/// Share of the largest information of a refitted unknown below which it counts as not determined.
const SMALL: f64 = 1e-12;

/// A refit of device frame and targets: its rows, unknowns and optimum.
#[derive(Clone, Copy, Debug)]
pub struct FrameRefit<'a> {
    /// Robot and rows.
    pub session: Session<'a>,
    /// Refitted device frame and targets.
    pub found: &'a Estimate,
    /// Refitted unknowns.
    pub free: &'a [Parameter],
    /// Scatter of the rows beside the unknowns of the calibration: measurement noise and model error, the D of theory.md §9.
    pub scatter: Noise,
    /// For each target of the rows, its number among the calibration's targets; `None` if it is refitted.
    pub targets: &'a [Option<usize>],
}

impl Uncertainty {
    /// Uncertainty of predictions after a refit, with the targets of its rows: the covariance `(I - P)(A Σ Aᵀ + D)(I - P)ᵀ` of
    /// theory.md §9, *Coverage*. It is written as a covariance of more unknowns: the refitted ones follow the errors of the kept
    /// ones. `None` if the refitted unknowns are not determined.
    #[must_use]
    pub fn after_refit(&self, refit: &FrameRefit<'_>) -> Option<Uncertainty> {
        let (kept, places) = self.kept_parameters(refit);
        let parameters: Vec<Parameter> = kept.iter().chain(refit.free).copied().collect();
        let layout = Layout::new(parameters.clone(), self.length_m);
        let estimate = Estimate { base_from_axis: self.estimate.base_from_axis.clone(), ..refit.found.clone() };
        let session = refit.session.with_length(self.length_m);
        let problem = Problem::new(session, session.data.all_rows(), parameters, refit.scatter);
        let gram = problem.normal(&estimate).gram;
        let n = layout.dim();
        let joint: Vec<usize> = layout.parameters().flat_map(|(_, own)| own.iter().map(|it| it.0)).collect();
        let (before, anew) = joint.split_at(places.len());
        let information = |a: usize, b: usize| gram[a.min(b) * n + a.max(b)];

        // Information of the rows about the refitted unknowns, and the derivatives of these by the others.
        let count = anew.len();
        let own: Vec<f64> =
            anew.iter().flat_map(|&a| anew.iter().map(move |&b| (a, b))).map(|(a, b)| information(a, b)).collect();
        let largest = (0..count).map(|k| own[k * count + k]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&own, count, SMALL * largest)?;
        let inverse = DMatrix::from_row_slice(count, count, &linalg::inverse(&factor));
        let mixed = DMatrix::from_fn(count, before.len(), |i, j| information(anew[i], before[j]));
        let follow = -(&inverse * mixed);

        let all = self.layout.dim();
        let refitted = |known: &[f64]| -> Option<Vec<f64>> {
            let spread = DMatrix::from_fn(places.len(), places.len(), |i, j| known[places[i] * all + places[j]]);
            let both = &follow * &spread;
            // The refit's own variance counts negatively: `N⁻¹`, less `2 N⁻¹` by its correlation with the scatter of the predicted rows.
            let last = &both * follow.transpose() - &inverse;
            let mut covariance = vec![0.0; n * n];
            let mut put = |a: usize, b: usize, value: f64| {
                covariance[a * n + b] = value;
                covariance[b * n + a] = value;
            };
            for (i, &a) in before.iter().enumerate() {
                before.iter().enumerate().for_each(|(j, &b)| put(a, b, spread[(i, j)]));
                anew.iter().enumerate().for_each(|(j, &b)| put(a, b, both[(j, i)]));
            }
            for (i, &a) in anew.iter().enumerate() {
                anew.iter().enumerate().for_each(|(j, &b)| put(a, b, last[(i, j)]));
            }
            covariance.iter().all(|value| value.is_finite()).then_some(covariance)
        };
        let covariance = refitted(&self.covariance)?;
        let covariance_outside = self.covariance_outside.as_deref().and_then(refitted);
        Some(Uncertainty { estimate, layout, covariance, covariance_outside, ..self.clone() })
    }

    /// Parameters that stay as calibrated, targets by their numbers among the rows', and the places of their unknowns.
    fn kept_parameters(&self, refit: &FrameRefit<'_>) -> (Vec<Parameter>, Vec<usize>) {
        let targets = refit.targets;
        let is_refitted = |parameter: &Parameter| {
            let subject = parameter.model().subject();
            refit.free.iter().any(|anew| anew.model().subject() == subject)
        };
        let (mut kept, mut places) = (Vec::new(), Vec::new());
        for (parameter, own) in self.layout.parameters() {
            let number = |known: usize| targets.iter().position(|&target| target == Some(known));
            let renumbered = match *parameter {
                Parameter::TargetPlace(mut place) => number(place.target).map(|target| {
                    place.target = target;
                    Parameter::TargetPlace(place)
                }),
                Parameter::TargetFrame(mut frame) => number(frame.target).map(|target| {
                    frame.target = target;
                    Parameter::TargetFrame(frame)
                }),
                other @ (Parameter::DeviceFrame(_) | Parameter::RangeUnknown(_) | Parameter::ClockUnknown(_)) => {
                    (!is_refitted(&other)).then_some(other)
                }
                other @ (Parameter::ScrewAxis(_) | Parameter::OtherScrew(_) | Parameter::ValueTerm(_)) => Some(other),
            };
            if let Some(parameter) = renumbered {
                kept.push(parameter);
                places.extend(own.iter().map(|it| it.0));
            }
        }
        (kept, places)
    }
}
