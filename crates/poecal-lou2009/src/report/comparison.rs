//! The original formulation compared with the adjoint one, in words selected by the numbers.

use super::numbers::{format_stated, mm, number, percent};
use crate::{ElbowRun, MeasurementKind, Method, PaperFormulation, PaperResidual, Reproduction};

/// Without noise, with noise, with offsets, from distant starts: a paragraph for each supported by the findings.
pub(super) fn sentences(found: &Reproduction) -> Vec<String> {
    [without_noise(found), with_noise(found), with_offsets(found), from_afar(found)].into_iter().flatten().collect()
}

fn without_noise(found: &Reproduction) -> Option<String> {
    let pair = |seen| {
        let run = |formulation| found.exact_run(formulation, seen, false);
        Some((run(PaperFormulation::Screw)?, run(PaperFormulation::Adjoint)?))
    };
    let (poses, points) = (pair(MeasurementKind::Poses)?, pair(MeasurementKind::Points)?);
    let as_good = |(screw, adjoint): (&ElbowRun, &ElbowRun)| {
        screw.converged && adjoint.converged && screw.iterations <= adjoint.iterations + 1
    };
    let verdict = if as_good(poses) && as_good(points) { "are as good" } else { "are not as good" };
    let end = |run: &ElbowRun| if run.converged { "" } else { " (not converged)" };
    let words = |(screw, adjoint): (&ElbowRun, &ElbowRun), seen: MeasurementKind| {
        format!(
            "from {} {} iterations{} to a held-out error of {} mm (`adjoint`: {}{})",
            seen.word(),
            screw.iterations,
            end(screw),
            mm(screw.held_out_rms_m),
            adjoint.iterations,
            end(adjoint)
        )
    };
    Some(format!(
        "Without noise and offsets, free screws that are normalised after each step (`screw`) {verdict}: {}, {}.",
        words(poses, MeasurementKind::Poses),
        words(points, MeasurementKind::Points)
    ))
}

fn with_noise(found: &Reproduction) -> Option<String> {
    let fits = |formulation, seen| found.noisy_fits(formulation, seen, PaperResidual::Tool);
    let (mut told, mut worse) = (Vec::new(), 0);
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        let (screw, adjoint) = (fits(PaperFormulation::Screw, seen)?, fits(PaperFormulation::Adjoint, seen)?);
        let verdict = if screw.exceeds(adjoint) {
            worse += 1;
            "`screw` is worse"
        } else if adjoint.exceeds(screw) {
            "`screw` is better"
        } else {
            "there are too few trials to decide"
        };
        told.push(format!(
            "From {}, {verdict}: {} times the Cramér-Rao bound, `adjoint` {} times.",
            seen.word(),
            screw.ratio_words(),
            adjoint.ratio_words()
        ));
    }
    let reason = " The six free numbers of an axis contain its length, which acts as a gear factor, and its pitch; the data pay for \
                  estimating both, and the normalisation throws them away.";
    Some(format!(
        "With noise, the held-out errors are compared. {} The number after ± is one standard deviation of chance; a difference counts from three on.{}",
        told.join(" "),
        if worse == told.len() { reason } else { "" }
    ))
}

fn with_offsets(found: &Reproduction) -> Option<String> {
    let of = |formulation| found.exact_run(formulation, MeasurementKind::Poses, true);
    let (original, adjoint) = (of(PaperFormulation::ScrewOffsets)?, of(PaperFormulation::Adjoint)?);
    let verdict = match (original.converged, adjoint.converged) {
        (true, true) => "predicts as well as `adjoint` without any",
        (true, false) => "predicts better than `adjoint` without any",
        (false, _) => "does not reach the truth",
    };
    Some(format!(
        "With joint offsets in the truth, the original (`screw-offsets`) {verdict} (held out {} mm, `adjoint` {} mm), and its offsets are \
         up to {} deg off the prescribed ones: {} of its {} columns add no rank.",
        mm(original.held_out_rms_m),
        mm(adjoint.held_out_rms_m),
        number(original.offset_error_max_deg?),
        original.parameters.saturating_sub(original.rank),
        original.parameters
    ))
}

fn from_afar(found: &Reproduction) -> Option<String> {
    let furthest = found.basin.iter().map(|row| row.error_deg).fold(0.0, f64::max);
    let row = |formulation, method| {
        found.basins(formulation, MeasurementKind::Points, method).find(|row| row.error_deg == furthest)
    };
    let (screw, adjoint) =
        (row(PaperFormulation::Screw, Method::GaussNewton)?, row(PaperFormulation::Adjoint, Method::GaussNewton)?);
    let verdict = if screw.exceeds(adjoint) {
        "the original is better"
    } else if adjoint.exceeds(screw) {
        "the original is worse"
    } else {
        "these starts show no difference"
    };
    Some(format!(
        "From afar {verdict}: from {} deg and {} mm, with points, plain Gauss-Newton reaches the truth from {} of the starts with `screw` \
         and from {} with `adjoint`; Levenberg-Marquardt with `adjoint` from {}.",
        format_stated(screw.error_deg),
        format_stated(screw.error_mm),
        percent(screw.share),
        percent(adjoint.share),
        percent(row(PaperFormulation::Adjoint, Method::LevenbergMarquardt)?.share)
    ))
}
