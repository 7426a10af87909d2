//! Columns of the linear rows, and combinations of terms of which the rows say something.

use nalgebra::{DMatrix, DVector};

use super::matrices::{of_geometry, solved, square};
use crate::linalg;
use crate::parameters::Subject;
use crate::problem::Layout;
use crate::robot::{CorrectionModel, TermGroup};
use crate::solve::Normal;

/// Information of a mode, as a share of its prior's, below which it stays where the prior has it.
pub(super) const NEGLIGIBLE: f64 = 0.1;

/// Groups of one size, and the largest that it may be.
pub(super) type Class = (&'static [TermGroup], f64);

/// A combination of terms of groups whose sizes are one: its coefficient has their prior.
#[derive(Clone, Copy)]
pub(super) struct Mode {
    /// A group of its class.
    pub(super) group: TermGroup,
    /// What all rows say of it, with geometry free.
    pub(super) information: f64,
}

/// Which columns of a layout are of what.
pub(super) struct Columns {
    pub(super) known: Vec<usize>,
    /// Indices among the known ones.
    pub(super) devices: Vec<usize>,
    /// Device frames that the fit holds.
    pub(super) held: Vec<usize>,
    pub(super) terms: Vec<TermColumn>,
}

pub(super) struct TermColumn {
    pub(super) place: usize,
    /// Index of its class.
    pub(super) class: usize,
    /// Scaled unknown of a coefficient whose size is 1.
    pub(super) unit: f64,
}

impl Columns {
    pub(super) fn new(
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
                Subject::Instrument(station) if Some(station) == held_station => {
                    held.extend(places.iter().map(at));
                }
                Subject::Instrument(_) | Subject::Range(_) | Subject::Clock(_) => {
                    devices.extend(known.len()..known.len() + places.len());
                    known.extend(places.iter().map(at));
                }
                Subject::Joint(_) | Subject::Target(_) => known.extend(places.iter().map(at)),
            }
        }
        Columns { known, devices, held, terms }
    }
}

/// Turns the terms of each class, whose coefficients have one size, so that what the rows say of them is told apart: the prior stays what
/// it is, and what nothing is said of is left out.
pub(super) fn modes(
    columns: &Columns,
    classes: &[Class],
    (known, terms): (&DMatrix<f64>, &DMatrix<f64>),
    (prior, weight): (&Normal, f64),
) -> Option<(Vec<Mode>, DMatrix<f64>)> {
    let k = columns.known.len();
    let mut gram = square(known);
    for i in 0..k {
        for j in 0..k {
            gram[(i, j)] += weight * prior.gram[i * k + j];
        }
    }
    let factor = of_geometry(gram)?;
    let mixed = known.transpose() * terms;
    let whole = square(terms) - mixed.transpose() * solved(&factor, &mixed);
    let (mut modes, mut turns): (Vec<Mode>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
    for (class, (groups, largest)) in classes.iter().enumerate() {
        let Some(&group) = groups.first() else { continue };
        let own: Vec<usize> =
            (0..columns.terms.len()).filter(|&at| columns.terms[at].class == class).collect();
        let n = own.len();
        let (values, vectors) =
            linalg::symmetric_eigen(whole.select_rows(&own).select_columns(&own).as_slice(), n);
        for (at, information) in values.into_iter().enumerate().rev() {
            if information * largest * largest < NEGLIGIBLE * weight {
                break;
            }
            let mut turn = DVector::zeros(columns.terms.len());
            own.iter().zip(vectors.column(at).iter()).for_each(|(&place, value)| turn[place] = *value);
            modes.push(Mode { group, information });
            turns.push(turn);
        }
    }
    let turn =
        if turns.is_empty() { DMatrix::zeros(columns.terms.len(), 0) } else { DMatrix::from_columns(&turns) };
    Some((modes, turn))
}
