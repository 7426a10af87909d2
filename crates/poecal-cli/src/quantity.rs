//! Numbers with a unit on the command line: `0.05mm`, `0.01deg`.

use std::str::FromStr;

use poecal::io::measurements::{Quantity, Unit};
use poecal::{Error, ErrorKind, Result};

/// A number with its unit, in SI: metres for a length, radians for an angle.
///
/// # Errors
/// One sentence that says what was found and expected.
pub(crate) fn parse(text: &str, quantity: Quantity) -> Result<f64> {
    let split = text.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E')).unwrap_or(text.len());
    let (number, symbol) = text.split_at(split);
    let example = match quantity {
        Quantity::Length => "0.05mm",
        Quantity::Angle => "0.01deg",
        Quantity::Number => "3",
    };
    let bad = |what: String| {
        Error::new(ErrorKind::Option, format!("found {what}, expected a number with a unit, like {example}"))
    };
    let value: f64 = number.trim().parse().map_err(|_| bad(format!("`{text}`")))?;
    if !value.is_finite() || value < 0.0 {
        return Err(bad(format!("`{text}`")));
    }
    if symbol.is_empty() {
        return Err(bad(format!("`{text}` without a unit")));
    }
    Ok(Unit::parse(symbol.trim(), quantity)?.to_si(value))
}

/// Parser of a standard deviation of positions for clap.
pub(crate) fn sigma_m(text: &str) -> std::result::Result<f64, String> {
    above_zero(text, Quantity::Length)
}

/// Parser of a standard deviation of rotations for clap.
pub(crate) fn sigma_rad(text: &str) -> std::result::Result<f64, String> {
    above_zero(text, Quantity::Angle)
}

fn above_zero(text: &str, quantity: Quantity) -> std::result::Result<f64, String> {
    match parse(text, quantity) {
        Ok(value) if value > 0.0 => Ok(value),
        Ok(_) => Err(format!("found `{text}`, expected a standard deviation above 0")),
        Err(error) => Err(error.to_string()),
    }
}

/// Parser of a share for clap.
pub(crate) fn share(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err(format!("found `{text}`, expected a number from 0 to below 1")),
    }
}

/// Parser of a count for clap.
pub(crate) fn whole<T: FromStr>(text: &str) -> std::result::Result<T, String> {
    text.parse().map_err(|_| format!("found `{text}`, expected a whole number"))
}
