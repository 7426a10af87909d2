//! Possible changes, as columns of the Jacobian.

use nalgebra::{DMatrix, Vector3};

use super::explain::{ExplanationKind, MotionHypothesis, pick_columns};
use super::options::TrackOptions;
use super::visit::{ChangeColumns, ColumnSubject, Visit};

/// Columns of the unknowns that are free in any case: frames of newly set up devices, and targets of a newly mounted tool.
pub(crate) fn find_free_columns(jacobian: &DMatrix<f64>, visit: &Visit, options: &TrackOptions) -> DMatrix<f64> {
    pick_columns(jacobian, &visit.columns, |of| match of {
        ColumnSubject::Device(_) => !visit.device_is_known,
        ColumnSubject::Target(_) => options.tool_is_anew,
        ColumnSubject::Lengths | ColumnSubject::Zero(_) | ColumnSubject::Axis(_) | ColumnSubject::Give(_) => false,
    })
}

/// All possible explanations of changes.
pub(crate) fn hypotheses(jacobian: &DMatrix<f64>, visit: &Visit, options: &TrackOptions) -> Vec<MotionHypothesis> {
    let columns = &visit.columns;
    let one = |kind: ExplanationKind, it: &ChangeColumns| MotionHypothesis {
        kind,
        of: vec![it.of],
        columns: jacobian.select_columns(&it.places),
        turns: it.turns.clone(),
        is_candidate: true,
    };
    let mut found = Vec::new();
    let targets: Vec<&ChangeColumns> = columns.iter().filter(|it| matches!(it.of, ColumnSubject::Target(_))).collect();
    if !options.tool_is_anew {
        match targets.as_slice() {
            [] => {}
            [only] => found.push(one(ExplanationKind::Tool, only)),
            several => {
                found.push(tool(jacobian, visit, several));
                found.extend(several.iter().map(|it| one(ExplanationKind::Target, it)));
            }
        }
    }
    let mut zeros = Vec::new();
    for it in columns {
        let kind = match it.of {
            ColumnSubject::Device(_) if visit.device_is_known => ExplanationKind::Device,
            ColumnSubject::Device(_) | ColumnSubject::Target(_) => continue,
            ColumnSubject::Lengths => ExplanationKind::Lengths,
            ColumnSubject::Zero(_) => ExplanationKind::Zero,
            ColumnSubject::Axis(_) => ExplanationKind::Axis,
            ColumnSubject::Give(_) => ExplanationKind::Give,
        };
        let own = one(kind, it);
        if kind == ExplanationKind::Zero {
            zeros.push(own.clone());
        }
        found.push(own);
    }
    for (at, first) in zeros.iter().enumerate() {
        for second in &zeros[at + 1..] {
            found.push(MotionHypothesis {
                kind: ExplanationKind::TwoZeros,
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
fn tool(jacobian: &DMatrix<f64>, visit: &Visit, targets: &[&ChangeColumns]) -> MotionHypothesis {
    let pose = |it: &ChangeColumns| match it.of {
        ColumnSubject::Target(target) => visit.targets.get(target),
        ColumnSubject::Device(_)
        | ColumnSubject::Lengths
        | ColumnSubject::Zero(_)
        | ColumnSubject::Axis(_)
        | ColumnSubject::Give(_) => None,
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
    MotionHypothesis {
        kind: ExplanationKind::Tool,
        of,
        columns,
        turns: (0..6).map(|k| k >= 3).collect(),
        is_candidate: true,
    }
}
