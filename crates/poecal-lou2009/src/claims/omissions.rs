//! Findings that the paper leaves out.

use super::super::{Claim, ElbowRun, MeasurementKind, literal, runs, tables};
use super::{ClaimEvidence, left_out};
use crate::{PaperFormulation, PaperResidual};
use poecal_fit::state::Estimate;
use poecal_numerics::error::Result;

/// Rank of the first matrix of the point simulation, and at its end.
const FIRST_RANK: usize = 25;
const LAST_RANK: usize = 27;
/// Least error of v·ω that rounding to four decimals of millimetres causes in Table II, mm.
const ROUNDED_MM: f64 = 1e-6;

pub(super) fn redundancy(evidence: &ClaimEvidence<'_>) -> Result<Claim> {
    let [poses, points] = evidence.both_runs(PaperFormulation::Adjoint, false)?;
    let redundant = |run: &ElbowRun| run.rank < run.parameters && run.rank == run.unknowns;
    Ok(left_out(
        "The components of η are redundant.",
        "(18) and (26) take six for each joint; nothing is said of their rank.",
        (
            "The matrix lacks rank, and has as much as the minimal basis has unknowns, for poses and for points."
                .to_owned(),
            redundant(poses) && redundant(points),
        ),
        format!(
            "A motion about and along the own axis does nothing: rank {} of {} columns for poses and {} of {} for points, so that the \
             normal equations are singular. The minimal basis has {} and {} unknowns.",
            poses.rank, poses.parameters, points.rank, points.parameters, poses.unknowns, points.unknowns
        ),
    ))
}

pub(super) fn point_on_axis(evidence: &ClaimEvidence<'_>) -> Result<Claim> {
    let session = runs::session(false, MeasurementKind::Points, evidence.seed);
    let rank =
        |estimate: &Estimate| literal::singular_values(&runs::matrix(&session, estimate, PaperFormulation::Adjoint)).1;
    let start = rank(&session.start());
    let end = rank(evidence.end_of_points()?);
    Ok(left_out(
        "The nominal point lies on axis 6, so the first Jacobian has rank 25.",
        "Table II puts the nominal point on nominal axis 6; nothing is said of it.",
        (
            format!("Rank {FIRST_RANK} at the nominal robot and {LAST_RANK} at the identified one."),
            (start, end) == (FIRST_RANK, LAST_RANK),
        ),
        format!(
            "Rank {start} at the nominal robot and {end} at the identified one: while the point lies on axis 6, tilting that axis and \
             shifting it move the point alike. A method that fixed the rank at the start would stall."
        ),
    ))
}

pub(super) fn lever_arm(evidence: &ClaimEvidence<'_>) -> Result<Claim> {
    let of = |residual| evidence.noisy_fits(PaperFormulation::Adjoint, MeasurementKind::Poses, residual);
    let (spatial, tool) = (of(PaperResidual::Spatial)?, of(PaperResidual::Tool)?);
    Ok(left_out(
        "The spatial logarithm costs accuracy.",
        "Before (18): the \"spatial residue\" df·f⁻¹, a twist at the base.",
        (
            "Its held-out error is larger than that of the residual at the tool by more than three standard deviations of chance."
                .to_owned(),
            spatial.exceeds(tool),
        ),
        format!(
            "It counts rotation noise as position noise times the distance from the base. With {:.2} mm and {:.2} deg of noise its \
             held-out error is {} times the Cramér-Rao bound; position and rotation at the tool, weighted by the same noise, give {}.",
            1e3 * evidence.found.noise_position_m,
            evidence.found.noise_rotation_rad.to_degrees(),
            spatial.ratio_words(),
            tool.ratio_words()
        ),
    ))
}

pub(super) fn rounding(_: &ClaimEvidence<'_>) -> Result<Claim> {
    let rounding = tables::rounding();
    Ok(left_out(
        "Table II's screws, as printed, are not quite screws.",
        "Table II, four decimals.",
        (
            format!("v·ω of some printed screw is off zero by more than {ROUNDED_MM:.0e} mm."),
            rounding.pitch_mm > ROUNDED_MM,
        ),
        format!(
            "v·ω is off zero by up to {:.4} mm and the length of ω off one by up to {:.1e}; the experiment uses them projected.",
            rounding.pitch_mm, rounding.length
        ),
    ))
}
