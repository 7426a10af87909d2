//! Stated noise compared with the residuals.

use std::cmp::Ordering;

use crate::run::noise::ROUNDING;
use poecal_fit::uncertainty::{KindVariance, ResidualVariance};
use poecal_model::measurement::Quantity;

/// Contradiction between residuals and stated noise.
pub(crate) struct NoiseDoubt {
    /// Statement as a sentence.
    pub(crate) statement: String,
    /// True if the ratio is so large or small that the noise must be in another unit.
    pub(crate) is_absurd: bool,
}

/// Largest ratio of residuals to stated noise that robots explain, and of stated noise to residuals that cautious data sheets explain.
const MORE: f64 = 30.0;
const LESS: f64 = 4.0;
/// Correlation of residuals of consecutive rows above which it is reported.
const IN_TIME: f64 = 0.5;

/// Contradictions between residuals and stated noise, and correlation in time (theory.md §9 (41)).
pub(crate) fn noise_doubts(remainder: &ResidualVariance, lag_one: Option<f64>) -> Vec<NoiseDoubt> {
    let parts = remainder.parts.iter();
    let mut doubts: Vec<NoiseDoubt> = parts.filter_map(|(quantity, part)| of_part(quantity, part)).collect();
    if let Some(correlation) = lag_one.filter(|correlation| *correlation > IN_TIME) {
        doubts.push(NoiseDoubt {
            statement: format!(
                "residuals of consecutive rows are correlated (correlation {correlation:.2}): a slow drift, noise that is not \
                 independent, or robot errors along the path; expected errors allow for it"
            ),
            is_absurd: false,
        });
    }
    doubts
}

fn of_part(quantity: Quantity, part: &KindVariance) -> Option<NoiseDoubt> {
    let (what, name) = (quantity.name(), quantity.unit().symbol());
    let (variance, square) = part.stated?;
    let (stated, ratio) = (variance.sqrt(), square.sqrt());
    // Exact data with a stated noise are a test, not a mistake; a noise of 100 m is a mistake.
    if ratio * stated < ROUNDING {
        return None;
    }
    let number = |value: f64| {
        let value = quantity.unit().in_shown_unit(value);
        let digits = (2 - value.log10().floor() as i32).clamp(0, 9) as usize;
        format!("{value:.digits$}")
    };
    let (left, stated) = (number(ratio * stated), number(stated));
    match part.against_stated()? {
        Ordering::Equal => None,
        Ordering::Greater => {
            let advice = if ratio > MORE {
                ": check the unit of the noise, whether the device was moved, and the rows"
            } else {
                "; the excess counts as robot error"
            };
            Some(NoiseDoubt {
                statement: format!(
                    "the {what} residuals ({left} {name} per component) are {ratio:.1} times the stated noise ({stated} \
                     {name}){advice}"
                ),
                is_absurd: ratio > MORE,
            })
        }
        Ordering::Less => (ratio < 1.0 / LESS).then(|| NoiseDoubt {
            statement: format!(
                "the {what} residuals ({left} {name} per component) are {:.0} times smaller than the stated noise \
                 ({stated} {name}): check the unit of the noise; the bounds do not use it",
                1.0 / ratio
            ),
            is_absurd: true,
        }),
    }
}
