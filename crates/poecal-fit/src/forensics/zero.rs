//! A gross offset of one joint: a fit of its offset from several starts.

use std::f64::consts::FRAC_PI_4;

use super::DiagnosisKind;
use super::change::RowChange;
use super::fitter::Fitter;
use super::hypotheses::{MistakeHypothesis, ReadingColumns};
use crate::state::Sight;
use poecal_model::measurement::{Dataset, Observation};
use poecal_model::robot::{ReadingKind, Term};

/// Smallest gross offset: radians, and share of the reach for prismatic joints. A calibration corrects smaller ones.
const LEAST_RAD: f64 = 0.052;
const LEAST_SHARE: f64 = 0.01;
/// Number of starts, the best of eight, from which an offset is fitted.
const FITTED_STARTS: usize = 3;
const FITTED_ITERATIONS: usize = 30;

/// Best offset of each joint, if it is gross.
pub(crate) fn joint_zeros(fitter: &Fitter<'_>, columns: &ReadingColumns, data: &Dataset) -> Vec<MistakeHypothesis> {
    let robot = fitter.robot;
    let own = |column: &usize| columns.only_joint(robot, *column).is_some();
    // An unknown device frame absorbs the offset of a joint that is before all others.
    let is_taken_in = |column: &usize| {
        let before_all = |row: &Observation| {
            let first = fitter.start.tree.route(Sight::from(row)).first();
            row.from.is_none()
                && first.is_some_and(|it| !it.backward && robot.joints[it.joint].reading.name == columns.names[*column])
        };
        fitter.device_free && data.observations.iter().all(before_all)
    };
    (0..columns.names.len())
        .filter(|column| own(column) && !is_taken_in(column))
        .filter_map(|column| joint_zero(fitter, columns, data, column))
        .collect()
}

fn joint_zero(
    fitter: &Fitter<'_>,
    columns: &ReadingColumns,
    data: &Dataset,
    column: usize,
) -> Option<MistakeHypothesis> {
    let name = columns.names.get(column)?;
    let (joint, of) = columns.only_joint(fitter.robot, column)?;
    let multiplier = of.reading.multiplier;
    let turns = columns.kinds.get(column) == Some(&ReadingKind::Angle);
    let starts: Vec<f64> = if turns { (-3..=4).map(|k| f64::from(k) * FRAC_PI_4).collect() } else { vec![0.0] };
    let rough = |by: f64| {
        let (estimate, misfit) = fitter.roughly_registered(&RowChange::Add(column, by).apply(data));
        (misfit.total_m, by, estimate)
    };
    let mut rough: Vec<_> = starts.into_iter().map(rough).collect();
    rough.sort_by(|a, b| a.0.total_cmp(&b.0));
    let fitted = rough.into_iter().take(FITTED_STARTS).map(|(_, start, estimate)| {
        let data = RowChange::Add(column, start).apply(data);
        let (fitted, misfit) = fitter.with_term(&data, &estimate, (&[joint], Term::OFFSET), FITTED_ITERATIONS);
        (misfit.total_m, start + fitted.coefficient(joint, Term::OFFSET) / multiplier)
    });
    let (_, by) = fitted.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (gross, words) = if turns {
        (by.abs() > LEAST_RAD, format!("{:.1} deg", by.to_degrees()))
    } else {
        (by.abs() > LEAST_SHARE * fitter.reach_m(), format!("{:.1} mm", by * 1e3))
    };
    (gross && by.is_finite()).then(|| {
        MistakeHypothesis::new(
            DiagnosisKind::JointZero,
            RowChange::Add(column, by),
            format!("adding {words} to the readings of {name}"),
            format!("check the zero of {name} in the readings and in the model"),
        )
    })
}
