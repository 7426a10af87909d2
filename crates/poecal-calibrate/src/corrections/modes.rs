//! Columns of the linear rows, and combinations of terms that the rows determine.

use nalgebra::{DMatrix, DVector};

use super::matrices::{of_geometry, solve_factored, square};
use poecal_fit::parameters::ParameterSubject;
use poecal_fit::problem::Layout;
use poecal_model::robot::{CorrectionModel, TermGroup};
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Information of a mode, as a share of its prior's, below which it stays at its prior value.
pub(crate) const NEGLIGIBLE: f64 = 0.1;

/// Groups that share one size, and its largest value.
pub(crate) type Class = (&'static [TermGroup], f64);

/// A combination of terms of groups with one size: its coefficient has their prior.
#[derive(Clone, Copy)]
pub(crate) struct TermMode {
    /// A group of its class.
    pub(crate) group: TermGroup,
    /// Information of all rows about it, with geometry free.
    pub(crate) information: f64,
}

/// Subjects of the columns of a layout.
pub(crate) struct ModeColumns {
    pub(crate) known: Vec<usize>,
    /// Indices among the known ones.
    pub(crate) devices: Vec<usize>,
    /// Device frames that the fit holds.
    pub(crate) held: Vec<usize>,
    pub(crate) terms: Vec<TermColumn>,
}

pub(crate) struct TermColumn {
    pub(crate) place: usize,
    /// Index of its class.
    pub(crate) class: usize,
    /// Scaled unknown of a coefficient whose size is 1.
    pub(crate) unit: f64,
}

impl ModeColumns {
    pub(crate) fn new(
        layout: &Layout,
        model: &CorrectionModel,
        classes: &[Class],
        held_station: Option<usize>,
    ) -> Self {
        let groups: Vec<_> = model.terms().zip(&model.groups).collect();
        let (mut known, mut devices, mut held, mut terms) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (parameter, places) in layout.parameters() {
            let at = |(place, _): &(usize, f64)| *place;
            let group = parameter
                .value_term()
                .and_then(|it| groups.iter().find(|(of, _)| *of == (it.joint, it.term)))
                .map(|(_, group)| group);
            if let (Some((group, share)), Some(&(place, scale))) = (group, places.first()) {
                let class = classes.iter().position(|(of, _)| of.contains(group)).unwrap_or_default();
                terms.push(TermColumn { place, class, unit: share.sqrt() * scale });
                continue;
            }
            match parameter.model().subject() {
                ParameterSubject::Instrument(station) if Some(station) == held_station => {
                    held.extend(places.iter().map(at));
                }
                ParameterSubject::Instrument(_) | ParameterSubject::Range(_) | ParameterSubject::Clock(_) => {
                    devices.extend(known.len()..known.len() + places.len());
                    known.extend(places.iter().map(at));
                }
                ParameterSubject::Joint(_) | ParameterSubject::Target(_) => known.extend(places.iter().map(at)),
            }
        }
        ModeColumns { known, devices, held, terms }
    }
}

/// Rotates the terms of each class, whose coefficients share one size, into directions of independent information. The prior is unchanged by it, and
/// directions without information are left out.
pub(crate) fn modes(
    columns: &ModeColumns,
    classes: &[Class],
    (known, terms): (&DMatrix<f64>, &DMatrix<f64>),
    (prior, weight): (&NormalEquations, f64),
) -> Option<(Vec<TermMode>, DMatrix<f64>)> {
    let k = columns.known.len();
    let mut gram = square(known);
    for i in 0..k {
        for j in 0..k {
            gram[(i, j)] += weight * prior.gram[i * k + j];
        }
    }
    let factor = of_geometry(gram)?;
    let mixed = known.transpose() * terms;
    let whole = square(terms) - mixed.transpose() * solve_factored(&factor, &mixed);
    let (mut modes, mut turns): (Vec<TermMode>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
    for (class, (groups, largest)) in classes.iter().enumerate() {
        let Some(&group) = groups.first() else { continue };
        let own: Vec<usize> = (0..columns.terms.len()).filter(|&at| columns.terms[at].class == class).collect();
        let n = own.len();
        let (values, vectors) = linalg::symmetric_eigen(whole.select_rows(&own).select_columns(&own).as_slice(), n);
        for (at, information) in values.into_iter().enumerate().rev() {
            if information * largest * largest < NEGLIGIBLE * weight {
                break;
            }
            let mut turn = DVector::zeros(columns.terms.len());
            own.iter().zip(vectors.column(at).iter()).for_each(|(&place, value)| turn[place] = *value);
            modes.push(TermMode { group, information });
            turns.push(turn);
        }
    }
    let turn = if turns.is_empty() { DMatrix::zeros(columns.terms.len(), 0) } else { DMatrix::from_columns(&turns) };
    Some((modes, turn))
}
