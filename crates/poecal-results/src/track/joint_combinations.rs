//! Zeros of several joints at once: used if one or two leave more than the stated repeatability explains.

use nalgebra::DMatrix;

use super::explain::{
    ExplanationKind, HypothesisVerdict, KNOWN, MotionHypothesis, ProjectedChanges, TriedHypothesis, is_noise,
};

/// Most joints for which all sets are tried.
const MOST: usize = 10;
/// Smallest zero of a set in standard deviations: one that is no more than noise explains nothing.
const LEAST: f64 = 3.0;

/// The smallest set of zeros that leaves no more than noise of this variance, with its test; `None` if no set does.
pub(crate) fn several_zeros(
    evidence: &ProjectedChanges,
    hypotheses: &[MotionHypothesis],
    variance: f64,
) -> Option<(MotionHypothesis, HypothesisVerdict)> {
    let zeros: Vec<&MotionHypothesis> =
        hypotheses.iter().filter(|it| it.kind == ExplanationKind::Zero && it.is_candidate).take(MOST).collect();
    let left = evidence.remaining_squares();
    for size in 3..=zeros.len() {
        let sets = (0u32..1 << zeros.len()).filter(|set| set.count_ones() as usize == size);
        let found = sets.filter_map(|set| {
            let own: Vec<&MotionHypothesis> =
                zeros.iter().enumerate().filter(|(at, _)| set & 1 << at != 0).map(|(_, it)| *it).collect();
            let together = combine_zeros(&own);
            let tried = evidence.try_hypothesis(hypotheses.len(), &together)?;
            let squares = left.0 - tried.gain;
            let freedom = left.1 - tried.rank as f64;
            let is_each = tried.step.iter().all(|(value, sigma)| value.abs() > LEAST * sigma * variance.sqrt());
            (tried.rank == size && is_each && is_noise(squares, freedom, variance)).then_some((together, tried))
        });
        let best = found.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain));
        if let Some((together, tried)) = best {
            return Some((together, verdict(tried, variance, left)));
        }
    }
    None
}

fn verdict(best: TriedHypothesis, variance: f64, left: (f64, f64)) -> HypothesisVerdict {
    HypothesisVerdict { best: Some(best), nearly: Vec::new(), variance, freedom: KNOWN, is_wider: false, left }
}

/// Some zeros as one explanation.
fn combine_zeros(zeros: &[&MotionHypothesis]) -> MotionHypothesis {
    let columns: Vec<_> = zeros.iter().map(|it| it.columns.column(0)).collect();
    MotionHypothesis {
        kind: ExplanationKind::Zeros,
        of: zeros.iter().flat_map(|it| it.of.clone()).collect(),
        columns: DMatrix::from_columns(&columns),
        turns: zeros.iter().flat_map(|it| it.turns.clone()).collect(),
        is_candidate: true,
    }
}
