//! Texts with units instead of numbers: `sigma_position_mm="50um"` is 0.05.

use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};

use crate::errors::{argument, raise};
use crate::words::shorten_text;

/// Units that may end the name of an argument.
const UNITS: [(&str, Unit); 4] =
    [("mm", Unit::Metre), ("m", Unit::Metre), ("deg", Unit::Radian), ("rad", Unit::Radian)];

/// The unit at the end of an argument's name: for `margin_deg_mm[0]` the first.
pub(crate) fn of_name(name: &str) -> Option<NamedUnit> {
    let (name, at) = match name.strip_suffix(']').and_then(|it| it.split_once('[')) {
        Some((name, at)) => (name, at.parse().unwrap_or(0)),
        None => (name, 0),
    };
    let unit = |word: &str| UNITS.into_iter().find(|it| it.0 == word);
    let mut units: Vec<(&str, Unit)> = name.rsplit('_').map_while(unit).collect();
    units.reverse();
    let (symbol, of) = *units.get(at).or(units.first())?;
    NamedUnit::parse(symbol, of).ok()
}

/// A text with a unit as a number in the unit of the argument.
pub(crate) fn in_unit(text: &str, unit: NamedUnit, name: &str) -> PyResult<f64> {
    let (value, symbol) = split_unit(text, name, unit.symbol())?;
    let typed = NamedUnit::parse(symbol, unit.si_unit()).map_err(|error| {
        raise(poecal_numerics::error::Error::new(error.kind(), format!("{name}: {}", error.message())))
    })?;
    // A number in the same unit is unchanged, to the last digit.
    Ok(if typed == unit { value } else { unit.from_si(typed.to_si(value)) })
}

/// A text with a unit as a number in radians or metres.
pub(crate) fn in_si(text: &str, name: &str) -> PyResult<f64> {
    let (value, symbol) = split_unit(text, name, "deg")?;
    let typed = NamedUnit::parse_any(symbol).map_err(|error| {
        raise(poecal_numerics::error::Error::new(error.kind(), format!("{name}: {}", error.message())))
    })?;
    Ok(typed.to_si(value))
}

/// A text of several numbers as a list of texts: `"0.5deg,5mm"`, and `"1500,0,800mm"`, whose last unit is that of all; anything else is unchanged.
pub(crate) fn split_list<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let Ok(text) = value.cast::<PyString>() else { return Ok(value.clone()) };
    let text = text.to_string_lossy();
    if of_name(name).is_none() || !text.contains(',') {
        return Ok(value.clone());
    }
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let last = parts.last().copied().unwrap_or_default();
    let unit = last.find(begins_unit).map_or("", |at| &last[at..]);
    let with_unit = |part: &&str| match part.find(begins_unit) {
        Some(_) => (*part).to_owned(),
        None => format!("{part}{unit}"),
    };
    let parts: Vec<String> = parts.iter().map(with_unit).collect();
    Ok(PyList::new(value.py(), parts)?.into_any())
}

/// The letter at which the unit behind a number begins.
fn begins_unit(letter: char) -> bool {
    letter.is_alphabetic() && !matches!(letter, 'e' | 'E') || letter == '°'
}

/// The number and the symbol of its unit.
fn split_unit<'t>(text: &'t str, name: &str, example: &str) -> PyResult<(f64, &'t str)> {
    let at = text.find(begins_unit).unwrap_or(text.len());
    let (number, symbol) = text.split_at(at);
    match number.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && !symbol.is_empty() => Ok((value, symbol.trim())),
        _ => {
            let found = shorten_text(text);
            let message = format!(
                "found the text `{found}`, expected a number, or a text of one with its unit, like \"0.05{example}\""
            );
            Err(argument(name, message))
        }
    }
}
