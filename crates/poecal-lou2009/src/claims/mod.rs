//! The statements of lou2009, and findings that it leaves out, compared with the runs.

mod accuracy;
mod offsets;
mod omissions;
mod simulations;

use super::runs::FinishedRun;
use super::{Basin, Claim, Efficiency, ElbowRun, MeasurementKind, Reproduction, find_exact_run};
use crate::{Method, PaperFormulation, PaperResidual};
use poecal_fit::state::Estimate;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Difference below which a coordinate is recovered and a prediction right: metres, or without unit for a unit vector.
const RECOVERED: f64 = 1e-9;
/// Residual of an identity by rounding.
const ROUNDING: f64 = 1e-12;

/// Evidence that decides the claims.
pub(super) struct ClaimEvidence<'a> {
    pub(super) runs: &'a [FinishedRun],
    pub(super) found: &'a Reproduction,
    pub(super) seed: u64,
}

impl ClaimEvidence<'_> {
    /// A noise-free run.
    fn run(&self, formulation: PaperFormulation, seen: MeasurementKind, offsets: bool) -> Result<&ElbowRun> {
        let run = self.found.exact_run(formulation, seen, offsets);
        run.ok_or_else(|| missing_error("run", formulation, seen))
    }

    /// The noise-free runs from poses and from points.
    fn both_runs(&self, formulation: PaperFormulation, offsets: bool) -> Result<[&ElbowRun; 2]> {
        Ok([
            self.run(formulation, MeasurementKind::Poses, offsets)?,
            self.run(formulation, MeasurementKind::Points, offsets)?,
        ])
    }

    /// Final estimate of the noise-free run of the adjoint form from points.
    fn end_of_points(&self) -> Result<&Estimate> {
        let ended = find_exact_run(self.runs, PaperFormulation::Adjoint, MeasurementKind::Points, false);
        ended
            .map(|it| &it.estimate)
            .ok_or_else(|| missing_error("run", PaperFormulation::Adjoint, MeasurementKind::Points))
    }

    /// The fits with noise by plain Gauss-Newton.
    fn noisy_fits(
        &self,
        formulation: PaperFormulation,
        seen: MeasurementKind,
        residual: PaperResidual,
    ) -> Result<&Efficiency> {
        let fits = self.found.noisy_fits(formulation, seen, residual);
        fits.ok_or_else(|| missing_error("noisy fit", formulation, seen))
    }

    /// The distant starts, the nearest first.
    fn basins(&self, formulation: PaperFormulation, seen: MeasurementKind, method: Method) -> Result<Vec<&Basin>> {
        let basins: Vec<&Basin> = self.found.basins(formulation, seen, method).collect();
        if basins.is_empty() {
            return Err(missing_error("start from afar", formulation, seen));
        }
        Ok(basins)
    }
}

fn missing_error(what: &str, formulation: PaperFormulation, seen: MeasurementKind) -> Error {
    ErrorKind::Problem.error(format!(
        "found no {what} of `{}` with {}, expected one to judge a claim by",
        formulation.word(),
        seen.word()
    ))
}

/// A statement of the paper.
fn make_claim(claim: &str, paper: &str, (criterion, holds): (String, bool), measured: String) -> Claim {
    Claim { claim: claim.to_owned(), paper: paper.to_owned(), measured, criterion, holds, said_by_paper: true }
}

/// A finding that the paper leaves out.
fn left_out(claim: &str, paper: &str, judged: (String, bool), measured: String) -> Claim {
    Claim { said_by_paper: false, ..make_claim(claim, paper, judged, measured) }
}

/// All claims, in the order of the paper; then the findings that it leaves out.
pub(super) fn claims(evidence: &ClaimEvidence<'_>) -> Result<Vec<Claim>> {
    let parts: [fn(&ClaimEvidence<'_>) -> Result<Claim>; 17] = [
        offsets::original_without_offsets,
        offsets::original_parameters_with_offsets,
        offsets::original_prediction_with_offsets,
        offsets::equivalence,
        offsets::proposition,
        offsets::can_be_left_out,
        simulations::constraints,
        accuracy::normalisation,
        simulations::poses_iterations,
        simulations::points_iterations,
        simulations::twice_as_many,
        simulations::table,
        accuracy::convergence,
        omissions::redundancy,
        omissions::point_on_axis,
        omissions::lever_arm,
        omissions::rounding,
    ];
    parts.iter().map(|part| part(evidence)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_without_evidence_is_an_error() {
        let found =
            super::super::lou2009(&super::super::ReproductionOptions { trials: 1, starts: 1, seed: 3 }).unwrap();
        let runs = super::super::runs::runs(3).unwrap();
        let without_fits = Reproduction { efficiency: vec![], ..found.clone() };
        let without_starts = Reproduction { basin: vec![], ..found.clone() };
        for (runs, found) in [(&runs[..0], &found), (&runs[..], &without_fits), (&runs[..], &without_starts)] {
            let error = claims(&ClaimEvidence { runs, found, seed: 3 }).unwrap_err();
            println!("{error}");
            assert_eq!(error.kind(), ErrorKind::Problem);
        }
        assert_eq!(claims(&ClaimEvidence { runs: &runs, found: &found, seed: 3 }).unwrap(), found.claims);
    }
}
