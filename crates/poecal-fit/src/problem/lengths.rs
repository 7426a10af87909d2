//! Known distances between stations, beside the rows.

use nalgebra::Vector3;

use super::{Layout, Problem};
use crate::parameters::{Parameter, ParameterSubject};
use crate::state::Estimate;
use poecal_model::measurement::KnownLength;
use poecal_numerics::solve::NormalEquations;

impl Problem<'_> {
    /// Adds `½ Σ ((ℓ - |o_a - o_b|) / σ)²` of the known lengths ℓ between the origins of two stations in the base (theory.md §6 (27b)): to the
    /// cost, to the gradient, and to the upper triangle of `JᵀJ` unless that is empty.
    pub(crate) fn add_lengths(&self, state: &Estimate, mut normal: NormalEquations) -> NormalEquations {
        for length in &self.session.data.lengths {
            add(length, state, &self.layout, &mut normal);
        }
        normal
    }
}

fn add(known: &KnownLength, state: &Estimate, layout: &Layout, normal: &mut NormalEquations) {
    let n = layout.dim();
    let [a, b] = known.stations.map(|station| state.device(station).inverse().translation);
    let apart = a - b;
    let Some(direction) = apart.try_normalize(0.0) else { return };
    let residual = (known.length_m - apart.norm()) / known.sigma_m;
    // Change of the predicted length by each unknown, over σ.
    let mut columns: Vec<(usize, f64)> = Vec::new();
    for (parameter, places) in layout.parameters() {
        let Parameter::DeviceFrame(frame) = parameter else { continue };
        for (station, sign) in known.stations.into_iter().zip([1.0, -1.0]) {
            if parameter.model().subject() != ParameterSubject::Instrument(station) {
                continue;
            }
            let back = state.device(station).rotation.transpose();
            for (&motion, &(place, scale)) in frame.freedom.motions().iter().zip(places) {
                let axis = Vector3::ith(motion % 3, 1.0);
                let moved = if motion < 3 { -(back * axis) } else { back * axis.cross(&frame.about) };
                columns.push((place, sign * direction.dot(&moved) / (known.sigma_m * scale)));
            }
        }
    }
    normal.cost += 0.5 * residual * residual;
    normal.residuals += 1;
    for &(place, value) in &columns {
        normal.gradient[place] += value * residual;
        if normal.gram.is_empty() {
            continue;
        }
        for &(other, also) in columns.iter().filter(|(other, _)| *other >= place) {
            normal.gram[place * n + other] += value * also;
        }
    }
}
