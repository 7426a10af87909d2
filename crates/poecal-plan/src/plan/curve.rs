//! Decrease of the expected error with the number of configurations.

use super::error_curve::{CurvePoint, ExpectedErrors};
use super::experiment::undetermined_error;
use super::make::Planner;
use super::search::PlanSearch;
use super::state::WorkspaceErrors;
use poecal_numerics::error::Result;

/// Numbers of configurations of the curve.
const COUNTS: [usize; 13] = [5, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100];
/// Candidates of the curve.
const OF_CURVE: usize = 800;

impl Planner<'_> {
    /// Expected errors of lists of other lengths, each the beginning of the next.
    pub(crate) fn curve(&self, new: usize, planned: &WorkspaceErrors) -> Result<Vec<CurvePoint>> {
        let most = COUNTS.last().copied().unwrap_or(0);
        let every = (self.blocks.count() / OF_CURVE).max(1);
        let some: Vec<usize> = (0..self.blocks.count()).step_by(every).collect();
        let blocks = self.blocks.select(&some);
        let search = PlanSearch { aim: &self.aim, kept: &self.kept, blocks: &blocks, apart: &|_, _| true };
        let order = search.greedy(Vec::new(), most.min(blocks.count()));
        let mut points = Vec::new();
        let mut counts: Vec<usize> = COUNTS.iter().copied().filter(|&count| count <= order.len()).collect();
        counts.push(new);
        counts.sort_unstable();
        counts.dedup();
        // The gain of exchanges at the planned number is assumed for others.
        let here = search.squares(&order[..new.min(order.len())]).ok_or_else(undetermined_error)?;
        let gain = WorkspaceErrors {
            noise: ratio(planned.noise, here.noise),
            true_noise: ratio(planned.true_noise, here.true_noise),
            terms: ratio(planned.terms, here.terms),
            corrected: ratio(planned.corrected, here.corrected),
            determinant: 0.0,
        };
        for count in counts {
            let squares = if count == new {
                *planned
            } else {
                let found = search.squares(&order[..count]).ok_or_else(undetermined_error)?;
                WorkspaceErrors {
                    noise: found.noise * gain.noise,
                    true_noise: found.true_noise * gain.true_noise,
                    terms: found.terms * gain.terms,
                    corrected: found.corrected * gain.corrected,
                    determinant: 0.0,
                }
            };
            let expected = ExpectedErrors::new(&self.experiment, &squares);
            points.push(CurvePoint { count: count + self.kept_count, expected });
        }
        Ok(points)
    }
}

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 1.0 }
}
