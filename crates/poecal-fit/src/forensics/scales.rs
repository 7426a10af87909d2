//! Readings that are too large or too small by factors, a factor for each joint: per cent of the range, or gears of another ratio.

use super::DiagnosisKind;
use super::change::RowChange;
use super::fitter::{Fitter, LONG};
use super::hypotheses::{MistakeHypothesis, ReadingColumns, toml_key};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{ReadingKind, Term};

/// Least difference of a factor from 1 that is a mistake: a calibration corrects smaller errors of gear ratios.
const LEAST: f64 = 0.03;
/// Largest relative difference of a fitted factor from that of per cent of the range at which both count as equal: the nominal screws have
/// errors too.
const SAME: f64 = 0.02;
/// Largest reading in per cent.
const WHOLE: f64 = 100.0;

/// Factors that fit best, if some are gross.
pub(crate) fn joint_scales(fitter: &Fitter<'_>, columns: &ReadingColumns, data: &Dataset) -> Option<MistakeHypothesis> {
    let count = columns.names.len();
    let own = |column: usize| columns.only_joint(fitter.robot, column);
    // Per cent of the range, read as degrees or as radians.
    let of_range = |unit: f64| -> Vec<f64> {
        let factor = |column: usize| {
            let turns = columns.kinds[column] == ReadingKind::Angle;
            let limits = own(column).filter(|_| turns).and_then(|(_, joint)| joint.limits);
            limits.map_or(1.0, |limits| 0.5 * (limits.upper - limits.lower) / (WHOLE * unit))
        };
        (0..count).map(factor).collect()
    };
    let (degrees, radians) = (of_range(1_f64.to_radians()), of_range(1.0));
    let joints: Vec<usize> = (0..count).filter_map(|column| Some(own(column)?.0)).collect();
    let fitted = [vec![1.0; count], degrees.clone(), radians.clone()].into_iter().map(|mut factors| {
        let scaled = RowChange::Scales(factors.clone()).apply(data);
        let (estimate, _) = fitter.roughly_registered(&scaled);
        let (estimate, misfit) = fitter.with_term(&scaled, &estimate, (&joints, Term::RATIO), LONG);
        for (column, factor) in factors.iter_mut().enumerate() {
            *factor *= 1.0 + own(column).map_or(0.0, |(joint, _)| estimate.coefficient(joint, Term::RATIO));
        }
        (misfit.total_m, factors)
    });
    let (_, mut factors) = fitted.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let is_of = |range: &Vec<f64>| {
        range.iter().any(|it| *it != 1.0) && factors.iter().zip(range).all(|(it, of)| (it / of - 1.0).abs() < SAME)
    };
    let per_cent = [degrees, radians].into_iter().find(is_of);
    let is_per_cent = per_cent.is_some();
    factors = per_cent.unwrap_or(factors);
    for factor in &mut factors {
        if (*factor - 1.0).abs() < LEAST || !factor.is_finite() {
            *factor = 1.0;
        }
    }
    describe(columns, factors, is_per_cent)
}

/// Hypothesis of some factors; `None` if each is near 1.
fn describe(columns: &ReadingColumns, factors: Vec<f64>, is_per_cent: bool) -> Option<MistakeHypothesis> {
    let off: Vec<(&str, f64)> =
        columns.names.iter().map(String::as_str).zip(factors.iter().copied()).filter(|it| it.1 != 1.0).collect();
    if off.is_empty() {
        return None;
    }
    let words: Vec<String> = off.iter().map(|(name, factor)| format!("{name}: {factor:.3}")).collect();
    let lines: Vec<String> = off
        .iter()
        .map(|(name, factor)| {
            let key = toml_key(name);
            format!("`{key} = {{ columns = {{ {key} = {factor:.6} }} }}`")
        })
        .collect();
    let why = if is_per_cent {
        "they look like per cent of the joints' ranges, -100 to 100, as LeRobot writes them"
    } else {
        "check their unit, and the ratios of gears"
    };
    Some(MistakeHypothesis::new(
        DiagnosisKind::JointScale,
        RowChange::Scales(factors),
        format!("multiplying the readings by factors ({})", words.join(", ")),
        format!("{why}; in a mapping file: `[joints]` and below it {}", lines.join(", ")),
    ))
}
