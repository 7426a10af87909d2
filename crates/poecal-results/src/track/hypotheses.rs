//! Possible changes, as columns of the Jacobian.

use nalgebra::{DMatrix, Vector3};

use super::explain::{Hypothesis, Kind, picked};
use super::options::TrackOptions;
use super::visit::{Columns, Of, Visit};

/// Columns of the unknowns that are free in any case: frames of newly set up devices, and targets of a newly mounted tool.
pub(crate) fn free(jacobian: &DMatrix<f64>, visit: &Visit, options: &TrackOptions) -> DMatrix<f64> {
    picked(jacobian, &visit.columns, |of| match of {
        Of::Device(_) => !visit.device_is_known,
        Of::Target(_) => options.tool_is_anew,
        Of::Lengths | Of::Zero(_) | Of::Axis(_) | Of::Give(_) => false,
    })
}

/// All possible explanations of changes.
pub(crate) fn hypotheses(jacobian: &DMatrix<f64>, visit: &Visit, options: &TrackOptions) -> Vec<Hypothesis> {
    let columns = &visit.columns;
    let one = |kind: Kind, it: &Columns| Hypothesis {
        kind,
        of: vec![it.of],
        columns: jacobian.select_columns(&it.places),
        turns: it.turns.clone(),
        is_candidate: true,
    };
    let mut found = Vec::new();
    let targets: Vec<&Columns> = columns.iter().filter(|it| matches!(it.of, Of::Target(_))).collect();
    if !options.tool_is_anew {
        match targets.as_slice() {
            [] => {}
            [only] => found.push(one(Kind::Tool, only)),
            several => {
                found.push(tool(jacobian, visit, several));
                found.extend(several.iter().map(|it| one(Kind::Target, it)));
            }
        }
    }
    let mut zeros = Vec::new();
    for it in columns {
        let kind = match it.of {
            Of::Device(_) if visit.device_is_known => Kind::Device,
            Of::Device(_) | Of::Target(_) => continue,
            Of::Lengths => Kind::Lengths,
            Of::Zero(_) => Kind::Zero,
            Of::Axis(_) => Kind::Axis,
            Of::Give(_) => Kind::Give,
        };
        let own = one(kind, it);
        if kind == Kind::Zero {
            zeros.push(own.clone());
        }
        found.push(own);
    }
    for (at, first) in zeros.iter().enumerate() {
        for second in &zeros[at + 1..] {
            found.push(Hypothesis {
                kind: Kind::TwoZeros,
                of: [first.of.clone(), second.of.clone()].concat(),
                columns: DMatrix::from_columns(&[first.columns.column(0), second.columns.column(0)]),
                turns: [first.turns.clone(), second.turns.clone()].concat(),
                is_candidate: true,
            });
        }
    }
    found
}

/// All targets as one body.
fn tool(jacobian: &DMatrix<f64>, visit: &Visit, targets: &[&Columns]) -> Hypothesis {
    let pose = |it: &Columns| match it.of {
        Of::Target(target) => visit.targets.get(target),
        Of::Device(_) | Of::Lengths | Of::Zero(_) | Of::Axis(_) | Of::Give(_) => None,
    };
    let places: Vec<Vector3<f64>> = targets.iter().filter_map(|it| Some(pose(it)?.0.translation)).collect();
    let middle = places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64;
    let mut columns = DMatrix::zeros(jacobian.nrows(), 6);
    for it in targets {
        let Some((place, motions)) = pose(it) else { continue };
        let (turn, arm) = (place.rotation, place.translation - middle);
        for k in 0..6 {
            let axis = Vector3::ith(k % 3, 1.0);
            let (shift, angle) = if k < 3 { (axis, Vector3::zeros()) } else { (axis.cross(&arm), axis) };
            let (shift, angle) = (turn.transpose() * shift, turn.transpose() * angle);
            for (&motion, &place) in motions.iter().zip(&it.places) {
                let step = if motion < 3 { shift[motion] } else { angle[motion - 3] };
                columns.column_mut(k).axpy(step, &jacobian.column(place), 1.0);
            }
        }
    }
    let of = targets.iter().map(|it| it.of).collect();
    Hypothesis { kind: Kind::Tool, of, columns, turns: (0..6).map(|k| k >= 3).collect(), is_candidate: true }
}
