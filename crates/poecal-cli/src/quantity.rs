//! Numbers with a unit on the command line: `0.05mm`, `0.01deg`.

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

/// Parser of a length for clap.
pub(crate) fn length_m(text: &str) -> std::result::Result<f64, String> {
    parse(text, Quantity::Length).map_err(|error| error.to_string())
}

/// Parser of an angle for clap.
pub(crate) fn angle_rad(text: &str) -> std::result::Result<f64, String> {
    parse(text, Quantity::Angle).map_err(|error| error.to_string())
}
