//! Estimate of a line's next robot before its measurement, as settings of `poecal calibrate`.

use std::fmt::Write as _;

use super::fleet::series;
use poecal_calibrate::TermGroup;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_plan::fleet::{FEWEST, FigureSeries};
use poecal_results::fleet::{CorrectionRow, LedgerRow};

/// Smallest tolerance that is written: degrees and millimetres.
const LEAST: f64 = 1e-4;

/// Settings: a tolerance from the deviations of axes of this type, and sizes of the terms; mean and spread of each term beside them. Robots that were
/// calibrated by such a prior are left out.
///
/// # Errors
/// [`ErrorKind::Problem`] with fewer than thirty robots that passed without the prior.
pub fn fleet_prior(rows: &[LedgerRow], of: &str) -> Result<String> {
    let good: Vec<&LedgerRow> = rows.iter().filter(|row| row.is_passed() && !row.by_prior).collect();
    if good.len() < FEWEST {
        return ErrorKind::Problem.refuse(format!(
            "found {} robots that passed without a prior of the line, expected at least {FEWEST}: fewer do not show how far robots of the line are from nominal",
            good.len()
        ));
    }
    // For each component: a tilt and a shift have two. Parts of an axis that the rows do not determine stay nominal, so that their scatter is not in
    // it.
    let usual = |length: fn(&CorrectionRow) -> Option<f64>| {
        let all: Vec<f64> = good.iter().flat_map(|row| &row.corrections).filter_map(length).collect();
        (rms(&all) / std::f64::consts::SQRT_2).max(LEAST)
    };
    let tilt = usual(|it| Some(it.axis_tilt_deg));
    let shift = usual(|it| (it.unit != "mm").then_some(it.axis_shift_mm));
    let mut out = format!(
        "# What {} robots of {of} predict of the next one: the prior of the line, as `prior` of its station.\npoecal_settings = 1\n",
        good.len()
    );
    let _ = writeln!(out, "tolerance = \"{tilt:.4}deg,{shift:.4}mm\"");
    let sizes: Vec<String> = TermGroup::ALL.into_iter().filter_map(|group| size(&good, group)).collect();
    let sizes = if sizes.is_empty() { "off".to_owned() } else { sizes.join(",") };
    let _ = writeln!(out, "corrections = \"{sizes}\"");
    let terms = series(&good).into_iter().filter(|it| it.joint.is_some() && !it.name.ends_with(".offset"));
    let terms: Vec<String> = terms.filter_map(|it| mean_and_spread(&it)).collect();
    if !terms.is_empty() {
        let _ = writeln!(out, "\n# Terms: mean and spread of the line, freed of the measurement's share");
        terms.iter().for_each(|it| out.push_str(it));
    }
    Ok(out)
}

/// The size of a group: the geometric mean of the calibrations' choices, which a few odd robots change little, if most robots have the group.
fn size(good: &[&LedgerRow], group: TermGroup) -> Option<String> {
    let of_row = |row: &&LedgerRow| {
        let own = row.sizes.iter().find(|it| it.group == group.name());
        own.map_or(0.0, |it| it.size)
    };
    let taken: Vec<f64> = good.iter().map(of_row).filter(|size| *size > 0.0).collect();
    let mean = (taken.iter().map(|size| size.ln()).sum::<f64>() / taken.len().max(1) as f64).exp();
    (2 * taken.len() > good.len()).then(|| format!("{}={}", group.name(), two_digits(mean)))
}

/// Root mean square.
fn rms(all: &[f64]) -> f64 {
    (all.iter().map(|it| it * it).sum::<f64>() / all.len().max(1) as f64).sqrt()
}

/// With two digits, as a decimal number.
fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

fn mean_and_spread(term: &FigureSeries) -> Option<String> {
    let plain = FigureSeries { is_size: false, ..term.clone() };
    let spread = plain.spread().filter(|_| term.is_enough())?;
    Some(format!("# {:24} {:8.4} ± {:.4} {}\n", term.name, spread.center, spread.own, term.unit))
}
