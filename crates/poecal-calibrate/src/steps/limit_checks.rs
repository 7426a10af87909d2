//! Limits judged by the rows of a calibration, or by other measurements.

use std::collections::BTreeMap;

use crate::acceptance::{ConfigurationErrors, MeasuredError, mean_square};
use crate::run::station_frames::rows_of_fitted_stations;
use crate::validate::judge::{check_count, judged_rows};
use crate::{
    Acceptance, AcceptanceLimit, AcceptanceLimits, AcceptedLimit, AcceptedModel, AcceptedRows, AcceptedStatistic,
    Calibration, JudgedCalibration,
};
use poecal_fit::state::{PackedValues, RowError, Session};
use poecal_model::measurement::{Dataset, MeasuredQuantities, Noise, Quantity};
use poecal_numerics::distributions::upper_quantile;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::unit::Unit;

/// Probability that the noise of a measurement exceeds the margin added to its error.
const RISK: f64 = 0.05;

/// Errors of rows, with their noise.
struct RowErrors<'a> {
    session: Session<'a>,
    rows: &'a [u32],
    errors: &'a [RowError],
    /// Noise by which rows are weighted.
    noise: Noise,
    /// Part of it that stated noise or repeated measurements show; `None` without an uncertainty.
    shown: Option<Noise>,
    /// Factor on the errors of rows to which parts of the model were fitted.
    factor: f64,
}

/// Judges a finished calibration by its rows held out, or if there are none, by cross-validation.
///
/// # Errors
/// [`ErrorKind::Option`] if no such row measured the quantity of a limit, [`ErrorKind::Problem`] if there are no such rows.
pub(crate) fn judge_acceptance(
    calibration: &Calibration,
    data: &Dataset,
    accept: &AcceptanceLimits,
) -> Result<Acceptance> {
    let rows = rows_of_fitted_stations(data, &calibration.fit_rows, &calibration.held_out_rows);
    if rows.is_empty() {
        return by_cross_validation(calibration, data, accept);
    }
    let packed = calibration.packed_values(data);
    let session = calibration.session(data, &packed).with_noise_ratios(&calibration.noise_ratios);
    let corrected = calibration.correction.as_ref().filter(|it| it.has_terms());
    let corrected = corrected.filter(|_| accept.model == AcceptedModel::Corrected);
    let (model, errors, noise, uncertainty) = match corrected {
        Some(found) => (AcceptedModel::Corrected, found.errors(data, &rows), found.noise, &found.uncertainty),
        None => {
            let errors = session.errors(&rows, &calibration.models.calibrated);
            (AcceptedModel::Calibrated, errors, calibration.noise, &calibration.trust.uncertainty)
        }
    };
    let shown = uncertainty.as_ref().map(|it| it.discrepancy.noise);
    let judged = RowErrors { session, rows: &rows, errors: &errors, noise, shown, factor: 1.0 };
    Ok(Acceptance::new(model, AcceptedRows::HeldOut, judged.limits(&accept.limits)?))
}

/// Judges a calibration by other measurements. Errors of rows to which a device frame or targets were fitted are scaled up, by the share that these
/// unknowns absorbed.
///
/// # Errors
/// [`ErrorKind::Option`] if no row measured the quantity of a limit, [`ErrorKind::Problem`] if the rows are too few for the refit.
pub fn accepted_by(
    subject: &JudgedCalibration<'_>,
    data: &Dataset,
    accept: &AcceptanceLimits,
    model: AcceptedModel,
) -> Result<Acceptance> {
    check_count(subject, data)?;
    let packed = PackedValues::from_dataset(subject.calibrated, data);
    let judged = judged_rows(subject, subject.calibrated, data, &packed);
    let numbers: usize = judged.errors.iter().map(RowError::dim).sum();
    let fitted: usize = judged.free.iter().map(|it| it.model().columns().len()).sum();
    let factor = (numbers as f64 / numbers.saturating_sub(fitted) as f64).sqrt();
    let rows = data.all_rows();
    let shown = subject.uncertainty.as_ref().map(|it| it.uncertainty.discrepancy.noise);
    let (session, errors) = (judged.session, &judged.errors);
    let judged = RowErrors { session, rows: &rows, errors, noise: subject.noise, shown, factor };
    Ok(Acceptance::new(model, AcceptedRows::Judged, judged.limits(&accept.limits)?))
}

impl RowErrors<'_> {
    fn limits(&self, limits: &[AcceptanceLimit]) -> Result<Vec<AcceptedLimit>> {
        let measured =
            Quantity::ALL.into_iter().filter_map(|quantity| Some((quantity, self.errors_of_quantity(quantity)?)));
        let measured: BTreeMap<Quantity, ConfigurationErrors> = measured.collect();
        let own = |limit: &AcceptanceLimit| {
            let of_it = measured.iter().filter(|(quantity, _)| quantity.unit() == limit.unit);
            let decided = of_it.filter_map(|(quantity, errors)| {
                let counts = [errors.rows(), errors.configurations.len()];
                Some(AcceptedLimit::from_finding(limit, *quantity, errors.bound_statistic(limit.statistic)?, counts))
            });
            let decided: Vec<AcceptedLimit> = decided.collect();
            if decided.is_empty() { Err(unmeasured_error(limit, measured.keys().copied())) } else { Ok(decided) }
        };
        Ok(limits.iter().map(own).collect::<Result<Vec<_>>>()?.concat())
    }

    /// The errors of a quantity by configuration; `None` if no row measured it.
    fn errors_of_quantity(&self, quantity: Quantity) -> Option<ConfigurationErrors> {
        let error = |row: &u32| {
            let error = self.errors.get(self.rows.binary_search(row).ok()?)?;
            let length = self.factor * error.length(quantity)?;
            let observation = self.session.observation(*row);
            let sigma = |noise: Noise| self.session.noise_of(observation, noise)[quantity];
            let possible = sigma(self.noise);
            let shown = self.shown.map_or(possible, |shown| sigma(shown).min(possible));
            let bound = upper_quantile(RISK, error.part(quantity).len()).sqrt();
            Some(MeasuredError { error: length, possible_noise: bound * possible, shown_noise: bound * shown })
        };
        let grouped = self.session.data.configurations(self.rows);
        let configurations: Vec<Vec<MeasuredError>> =
            grouped.iter().map(|rows| rows.iter().filter_map(error).collect()).collect();
        let configurations: Vec<_> = configurations.into_iter().filter(|rows| !rows.is_empty()).collect();
        let components = self.errors.iter().map(|error| error.part(quantity).len()).max().unwrap_or(1);
        (!configurations.is_empty()).then_some(ConfigurationErrors { configurations, components })
    }
}

/// Mean square of rows that were left out in turn, with at most as many degrees of freedom as configurations: their individual errors are not kept.
fn by_cross_validation(calibration: &Calibration, data: &Dataset, accept: &AcceptanceLimits) -> Result<Acceptance> {
    let none = |what: &str| ErrorKind::Problem.error(format!("found limits to accept and no rows held out, {what}"));
    let Some(found) = &calibration.trust.cross_validation else {
        return Err(none(
            "and too few for cross-validation, expected rows that judge the fit: measure more, or hold out a share of them",
        ));
    };
    let configurations = data.configurations(&calibration.fit_rows).len();
    let rms: &MeasuredQuantities<f64> = &found.random.rms;
    let mut limits = Vec::new();
    for limit in &accept.limits {
        if limit.statistic != AcceptedStatistic::Rms {
            return Err(none(&format!(
                "expected limits of the RMS alone, since cross-validation has no errors of single rows: leave `{}` out, or hold out a share of the rows",
                limit.words()
            )));
        }
        let of_it: Vec<_> = rms.iter().filter(|(quantity, _)| quantity.unit() == limit.unit).collect();
        if of_it.is_empty() {
            return Err(unmeasured_error(limit, rms.iter().map(|(quantity, _)| quantity)));
        }
        limits.extend(of_it.into_iter().map(|(quantity, rms)| {
            let bounded = mean_square(rms * rms, configurations as f64);
            AcceptedLimit::from_finding(limit, quantity, bounded, [found.random.rows, configurations])
        }));
    }
    Ok(Acceptance::new(AcceptedModel::Calibrated, AcceptedRows::CrossValidation, limits))
}

fn unmeasured_error(limit: &AcceptanceLimit, measured: impl Iterator<Item = Quantity>) -> Error {
    let names = measured.map(Quantity::name).collect::<Vec<_>>().join(", ");
    let what = if limit.unit == Unit::Radian { "angle" } else { "length" };
    ErrorKind::Option.error(format!(
        "found the limit `{}`, but the rows that decide measured no {what}, only {names}, expected limits of what was measured: leave it out",
        limit.words()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_by_the_numbers_of_a_row() {
        let of = |components| upper_quantile(RISK, components).sqrt();
        // 95 % points of the length of one, two and three normal numbers.
        for (components, table) in [(1, 1.960), (2, 2.448), (3, 2.795)] {
            assert!((of(components) - table).abs() < 1e-3);
        }
    }
}
