//! Confirmation of a calibration by other measurements.

use super::judge::Judgement;
use crate::run::accuracy::ModelAccuracy;
use crate::steps::level::Level;
use crate::trust::coverage_check::{CoverageCheck, QuantityCoverage, ROUNDING};

/// Least share of the errors inside their 95 % bounds.
const INSIDE: f64 = 0.8;
/// Standard deviations by which a share of the rows inside the sampled range is below that: 95 % on one side.
const CHANCE: f64 = 1.645;
/// Least number of rows inside the sampled range that decides.
const FEW: usize = 5;
/// Largest ratio of the error to the expected error.
const TIMES: f64 = 2.0;

impl Judgement {
    /// The best level that the measurements confirm for the delivered model, and reasons against a better one, a sentence each; no level if the
    /// calibration has no bounds to test.
    #[must_use]
    pub fn confirmed_level(&self) -> (Option<Level>, Vec<String>) {
        if self.delivered_model().promised.is_none() {
            return (None, Vec::new());
        }
        let mut reasons = Vec::new();
        for asked in [Level::Good, Level::InsideSampledRange] {
            match self.falls_short(asked) {
                Some(reason) => reasons.push(reason),
                None => return (Some(asked), reasons),
            }
        }
        (Some(Level::DoNotUse), reasons)
    }

    /// Reason why the measurements do not confirm this level for the delivered model; `None` if they do. *Good* requires it of all rows and of those
    /// inside the sampled range, *use inside the sampled range* of the latter: at least 80 % of the errors inside their 95 % bounds, and the error
    /// (RMS) at most twice the expected one. Fewer than five rows inside the sampled range decide nothing; with more, a share counts as below 80 % if
    /// chance does not explain it.
    #[must_use]
    pub fn falls_short(&self, required: Level) -> Option<String> {
        if required == Level::DoNotUse {
            return None;
        }
        let own = self.delivered_model();
        let Some(kept) = own.promised else {
            return Some("the calibration has no uncertainty, so there are no bounds to test".to_owned());
        };
        let some = own.in_sampled_range.filter(|some| some.count >= FEW.min(self.count));
        let in_range = some.map(|some| {
            let share = INSIDE - CHANCE * (INSIDE * (1.0 - INSIDE) / some.count as f64).sqrt();
            contradiction((&some.calibrated, &some.promised), share, "inside the sampled range")
        });
        if required == Level::Good {
            let of_all = contradiction((own.errors, kept), INSIDE, "of these rows");
            return of_all.or_else(|| in_range.flatten());
        }
        in_range.unwrap_or_else(|| {
            Some(match own.in_sampled_range.map_or(0, |some| some.count) {
                0 => "no row lies inside the sampled range".to_owned(),
                1 => "only 1 row lies inside the sampled range, too few to judge it".to_owned(),
                count => format!("only {count} rows lie inside the sampled range, too few to judge it"),
            })
        })
    }
}

/// Contradiction of errors to their predictive distribution: a smaller share inside their bounds than `share`, or more than twice the expected error.
fn contradiction((errors, kept): (&ModelAccuracy, &CoverageCheck), share: f64, which: &str) -> Option<String> {
    let mut errors = kept.parts.iter().filter_map(|(quantity, part)| Some((quantity, part, errors.get(quantity)?.rms)));
    errors.find_map(|(quantity, part, rms)| {
        let (what, unit) = (quantity.name(), quantity.unit().symbol());
        let QuantityCoverage { expected_rms, inside_bound95 } = part;
        // Residuals of exact data are rounding.
        if rms <= ROUNDING * 1e6 {
            None
        } else if inside_bound95 < share {
            Some(format!(
                "{:.0} % of the {what} errors {which} are inside their 95 % bounds, {:.0} % are required",
                100.0 * inside_bound95,
                100.0 * INSIDE
            ))
        } else if rms > TIMES * expected_rms {
            Some(format!(
                "the {what} error {which} is {rms:.3} {unit} (RMS), more than twice the expected {expected_rms:.3} {unit}"
            ))
        } else {
            None
        }
    })
}
