//! Statement about readings that were written with few digits.

use poecal_fit::state::{Rounding, Session};
use poecal_numerics::error::first_few;

/// Reports rounded readings and their effect at the tip, if `left_m` (RMS) is at least half of it.
pub(crate) fn describe_rounding(session: &Session<'_>, left_m: f64) -> Option<String> {
    let Rounding { names, step, unit, place_m2, .. } = Rounding::from_session(session, left_m)?;
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Some(format!(
        "the readings of {} are rounded to {step} {unit}, which alone makes {:.3} mm (RMS) at the tip: write them with more digits",
        first_few(&names),
        1e3 * place_m2.sqrt()
    ))
}
