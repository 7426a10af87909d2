//! The original formulation beside the adjoint one, in words.

use super::numbers::{mm, number};
use crate::parameters::Formulation;
use crate::reproduce::{Basin, Reproduction, Run, Seen};
use crate::solve::Method;

/// Without noise, with noise, with offsets, from afar: a paragraph for each that the findings can tell.
pub(super) fn sentences(found: &Reproduction) -> Vec<String> {
    [without_noise(found), with_noise(found), with_offsets(found), from_afar(found)]
        .into_iter()
        .flatten()
        .collect()
}

fn run(found: &Reproduction, formulation: Formulation, seen: Seen, offsets: bool) -> Option<&Run> {
    found.runs.iter().find(|run| {
        (run.formulation, run.measurement, run.offsets_in_truth, run.noise)
            == (formulation, seen, offsets, false)
    })
}

fn without_noise(found: &Reproduction) -> Option<String> {
    let iterations = |formulation, seen| run(found, formulation, seen, false).map(|run| run.iterations);
    let error = |seen| run(found, Formulation::Screw, seen, false).map(|run| mm(run.held_out_rms_m));
    Some(format!(
        "Without noise and offsets, free screws that are normalised after each step (`screw`) are as good: {} iterations from poses and {} \
         from points (`adjoint`: {} and {}), to held-out errors of {} and {} mm.",
        iterations(Formulation::Screw, Seen::Poses)?,
        iterations(Formulation::Screw, Seen::Points)?,
        iterations(Formulation::Adjoint, Seen::Poses)?,
        iterations(Formulation::Adjoint, Seen::Points)?,
        error(Seen::Poses)?,
        error(Seen::Points)?
    ))
}

fn with_noise(found: &Reproduction) -> Option<String> {
    let ratio = |formulation, seen| {
        let way = |it: &&crate::reproduce::Efficiency| {
            (it.formulation, it.measurement, it.residual.as_str(), it.method.as_str())
                == (formulation, seen, "tool", Method::GaussNewton.word())
        };
        found.efficiency.iter().find(way).map(|it| number(it.ratio))
    };
    Some(format!(
        "With noise they are not: the held-out error of `screw` is {} times the Cramér-Rao bound from poses and {} times from points, that of \
         `adjoint` {} and {}. The six free numbers of an axis contain its length, which acts as a gear factor, and its pitch; the data pay \
         for estimating both, and the normalisation throws them away.",
        ratio(Formulation::Screw, Seen::Poses)?,
        ratio(Formulation::Screw, Seen::Points)?,
        ratio(Formulation::Adjoint, Seen::Poses)?,
        ratio(Formulation::Adjoint, Seen::Points)?
    ))
}

fn with_offsets(found: &Reproduction) -> Option<String> {
    let of = |formulation| run(found, formulation, Seen::Poses, true);
    let (original, adjoint) = (of(Formulation::ScrewOffsets)?, of(Formulation::Adjoint)?);
    Some(format!(
        "With joint offsets in the truth, the original (`screw-offsets`) predicts as well as `adjoint` without any ({} and {} mm held out), \
         and its offsets are up to {} deg off the prescribed ones: what it adds are columns without rank.",
        mm(original.held_out_rms_m),
        mm(adjoint.held_out_rms_m),
        number(original.offset_error_max_deg?)
    ))
}

fn from_afar(found: &Reproduction) -> Option<String> {
    let furthest = found.basin.iter().map(|row| row.error_deg).fold(0.0, f64::max);
    let row = |formulation, method: Method| -> Option<&Basin> {
        found.basin.iter().find(|row| {
            (row.formulation, row.measurement, row.method.as_str())
                == (formulation, Seen::Points, method.word())
                && row.error_deg == furthest
        })
    };
    let original = row(Formulation::Screw, Method::GaussNewton)?;
    let share = |row: &Basin| number(100.0 * row.share);
    Some(format!(
        "From afar the original is no worse: from {} deg and {} mm, with points, plain Gauss-Newton reaches the truth from {} % of the starts \
         with `screw` and from {} % with `adjoint`; Levenberg-Marquardt with `adjoint` from {} %.",
        number(original.error_deg),
        number(original.error_mm),
        share(original),
        share(row(Formulation::Adjoint, Method::GaussNewton)?),
        share(row(Formulation::Adjoint, Method::LevenbergMarquardt)?)
    ))
}
