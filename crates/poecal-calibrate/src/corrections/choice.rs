//! Sizes of the terms' priors, by cross-validation from shared information (theory.md §6, *Corrections*).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::linear::LinearRows;
use super::row_folds::FoldFit;
use poecal_model::robot::{Sizes, TermGroup};

/// Rounds of choosing each group's size in turn.
const SWEEPS: usize = 2;
/// Weight of the squared distance of a size from the common one, in decades: the prior of the choice. Few configurations determine a size poorly: the
/// weight is at least this multiple of the inverse of their number.
const PULL: f64 = 0.1;
const PULL_OF_FEW: f64 = 4.0;
/// Largest cost of leaving a group out, and cost of taking in a group that is commonly left out.
const LEFT_OUT: f64 = 0.1;
const TAKEN_IN: f64 = 0.02;
/// Largest loss with which geometry alone is still preferred.
const GEOMETRY: f64 = 0.07;
/// Share of geometry's error below which the gain of terms is negligible.
const GAIN: f64 = 0.02;
/// Fewest configurations from which sizes are chosen.
const FEWEST: usize = 8;
/// Number of configurations whose information counts half: errors that rows share beyond the terms do not average out.
const HALF: f64 = 500.0;

/// Weight of the priors of a fit of this number of configurations: the data's information is divided by it.
pub(crate) fn weight_of_prior(configurations: usize) -> f64 {
    1.0 + configurations as f64 / HALF
}

/// Tried sizes with their scores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriedSizes {
    /// The sizes.
    pub sizes: Sizes,
    /// Mean over the parts that were left out of the logarithm of their mean squared whitened residual.
    pub left_out: f64,
    /// The same with the prior of the choice: less is better.
    pub score: f64,
}

/// Reason for the sizes of a corrected model's terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SizesReason {
    /// The sizes were stated.
    Given,
    /// Terms predict left-out rows better.
    Predict,
    /// No terms predict them better.
    NoBetter,
    /// Rows cannot be left out; the small sizes are used.
    Small,
    /// Too few configurations to choose by.
    TooFew,
    /// The rows determine none of the terms.
    Undetermined,
    /// The fit of the terms explains the rows worse, or has no uncertainty.
    LedNowhere,
    /// The fit of the terms predicts the held-out rows worse.
    WorseHeldOut,
}

impl SizesReason {
    /// The reason in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            SizesReason::Given => "the sizes were stated",
            SizesReason::Predict => "they predict rows better that were left out",
            SizesReason::NoBetter => "no joint terms predict other rows clearly better",
            SizesReason::Small => "no rows could be left out, so the sizes are small ones",
            SizesReason::WorseHeldOut => "the joints' terms predict the rows worse that were held out",
            SizesReason::TooFew => "too few configurations to determine the joint effects",
            SizesReason::Undetermined => "the rows do not determine the joint effects",
            SizesReason::LedNowhere => "the fit of the joints' terms explains the rows no better",
        }
    }
}

/// Choice of sizes, and all tried sizes.
#[derive(Clone, Debug)]
pub(crate) struct CorrectionChoice {
    pub(crate) sizes: Sizes,
    pub(crate) reason: SizesReason,
    pub(crate) tried: Vec<TriedSizes>,
}

/// Chooses sizes by leaving parts of the rows out. Without parts the small sizes are used, with very few configurations none.
pub(crate) fn choose(linear: &LinearRows, parts: &[FoldFit], configurations: usize) -> CorrectionChoice {
    if configurations < FEWEST {
        return CorrectionChoice { sizes: Sizes::NONE, reason: SizesReason::TooFew, tried: Vec::new() };
    }
    if parts.is_empty() {
        return CorrectionChoice { sizes: Sizes::SMALL, reason: SizesReason::Small, tried: Vec::new() };
    }
    let few = 1.0 / configurations as f64;
    let mut tried: Vec<TriedSizes> = Vec::new();
    let mut score = |sizes: Sizes| match tried.iter().find(|it| it.sizes == sizes) {
        Some(known) => *known,
        None => {
            let left_out = linear.left_out(parts, &sizes);
            tried.push(TriedSizes { sizes, left_out, score: left_out + distance(&sizes, few) });
            tried[tried.len() - 1]
        }
    };
    let common = score(Sizes::COMMON);
    let mut best = common;
    for _ in 0..SWEEPS {
        let before = best.sizes;
        for (groups, sizes) in tried_sizes().filter(|(groups, _)| linear.has_any(groups)) {
            for &size in sizes {
                let mut other = best.sizes;
                groups.iter().for_each(|&group| other[group] = size);
                let found = score(other);
                if found.score < best.score {
                    best = found;
                }
            }
        }
        if best.sizes == before {
            break;
        }
    }
    let geometry = score(Sizes::NONE);
    // Geometry alone wins if terms visibly harm without a real effect, and are not missed. Measurements without noise leave nothing to choose by.
    let loses_little = geometry.left_out <= best.left_out + GEOMETRY.max(1.5 * few);
    let is_harmed = common.left_out > geometry.left_out + 3.0 * few;
    // The logarithms are those of squares.
    let gains_nothing = 0.5 * (best.left_out - geometry.left_out) > (1.0 - GAIN).ln();
    if best.score.is_finite() && geometry.left_out.is_finite() && (loses_little && is_harmed || gains_nothing) {
        best = geometry;
    }
    let reason = if best.sizes == Sizes::NONE { SizesReason::NoBetter } else { SizesReason::Predict };
    CorrectionChoice { sizes: best.sizes, reason, tried }
}

/// Groups whose sizes are chosen in turn, with the tried sizes; the groups of gravity share one size.
pub(crate) fn tried_sizes() -> impl Iterator<Item = (&'static [TermGroup], &'static [f64])> {
    static ALL: [TermGroup; TermGroup::ALL.len()] = TermGroup::ALL;
    let together = ALL.chunk_by(|_, next| next.row().tried.is_empty());
    together.map(|groups| (groups, groups.first().map_or(&[][..], |it| it.row().tried)))
}

/// Prior of the choice; `few` is the inverse of the number of configurations.
fn distance(sizes: &Sizes, few: f64) -> f64 {
    let pull = PULL.max(PULL_OF_FEW * few);
    let of = |group: TermGroup| match (sizes[group], Sizes::COMMON[group]) {
        (0.0, 0.0) => 0.0,
        (0.0, _) => PULL * LEFT_OUT.min(6.0 * few),
        (size, 0.0) => TAKEN_IN + pull * (size / Sizes::ALL[group]).log10().powi(2),
        (size, common) => pull * (size / common).log10().powi(2),
    };
    TermGroup::ALL.into_iter().map(of).sum()
}
