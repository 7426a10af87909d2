//! Units of lengths and angles in files.

use std::f64::consts::PI;

use serde::Serialize;

use crate::error::{ErrorKind, Result, nearest_word};
use crate::unit::Unit;

/// Source of a column's unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UnitSource {
    /// Brackets in the header.
    Header,
    /// The line of units below the header.
    UnitsLine,
    /// The mapping file.
    Mapping,
    /// Not stated: the unit of the maker of these columns.
    Maker,
    /// Not stated: SI.
    Si,
}

/// A unit of files: its symbol, the SI unit of the same quantity, and the conversion to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedUnit {
    symbol: &'static str,
    of: Unit,
    // Lengths are divided by a power of ten, which is exact; 0.001 is not.
    factor: f64,
    divisor: f64,
    /// Other names, case ignored.
    names: &'static str,
}

const fn unit(symbol: &'static str, of: Unit, (factor, divisor): (f64, f64), names: &'static str) -> NamedUnit {
    NamedUnit { symbol, of, factor, divisor, names }
}

const METRE: NamedUnit = unit("m", Unit::Metre, (1.0, 1.0), "metre metres meter meters");
const RADIAN: NamedUnit = unit("rad", Unit::Radian, (1.0, 1.0), "radian radians");
const ONE: NamedUnit = unit("1", Unit::One, (1.0, 1.0), "");

const UNITS: [NamedUnit; 13] = [
    METRE,
    unit("cm", Unit::Metre, (1.0, 1e2), "centimetre centimetres centimeter centimeters"),
    unit("mm", Unit::Metre, (1.0, 1e3), "millimetre millimetres millimeter millimeters"),
    unit("um", Unit::Metre, (1.0, 1e6), "micrometre micrometres micrometer micrometers micron microns"),
    unit("nm", Unit::Metre, (1.0, 1e9), ""),
    // 25.4 mm exactly.
    unit("in", Unit::Metre, (254.0, 1e4), "inch inches"),
    RADIAN,
    unit("mrad", Unit::Radian, (1.0, 1e3), "milliradian milliradians"),
    unit("deg", Unit::Radian, (PI / 180.0, 1.0), "degree degrees 度"),
    unit("arcmin", Unit::Radian, (PI / 10_800.0, 1.0), "arcminute arcminutes"),
    unit("arcsec", Unit::Radian, (PI / 648_000.0, 1.0), "arcsecond arcseconds"),
    // Counts of motors with encoders of 12 bits, 4096 in a turn.
    unit("ticks", Unit::Radian, (PI / 2048.0, 1.0), "tick"),
    ONE,
];

/// The SI unit itself, as files name it.
impl From<Unit> for NamedUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Metre => METRE,
            Unit::Radian => RADIAN,
            Unit::One | Unit::Second => ONE,
        }
    }
}

fn words(unit: Unit) -> &'static str {
    match unit {
        Unit::Metre => "a length",
        Unit::Radian => "an angle",
        Unit::One | Unit::Second => "a number without unit",
    }
}

/// The units of one quantity.
pub fn units_of(of: Unit) -> impl Iterator<Item = &'static NamedUnit> {
    UNITS.iter().filter(move |unit| unit.of == of)
}

impl NamedUnit {
    /// Unit of this symbol for the quantity of an SI unit; also `µm`, `°` and words such as `degrees` and `inch`.
    ///
    /// # Errors
    /// [`ErrorKind::Unit`] if it is unknown or is of another quantity.
    pub fn parse(symbol: &str, of: Unit) -> Result<NamedUnit> {
        NamedUnit::parse_for(symbol, of, "")
    }

    /// As [`NamedUnit::parse`]; `purpose` (` for …`) describes the unit's use in the message.
    pub fn parse_for(symbol: &str, of: Unit, purpose: &str) -> Result<NamedUnit> {
        let plain = plain_symbol(symbol);
        if let Some(unit) = units_of(of).find(|unit| unit.symbol == plain) {
            return Ok(*unit);
        }
        let symbols: Vec<&str> = units_of(of).map(|unit| unit.symbol).collect();
        let known_elsewhere = UNITS.iter().any(|unit| unit.symbol == plain);
        let hint = match nearest_word(plain, symbols.iter().copied()) {
            Some(near) if !known_elsewhere && near.eq_ignore_ascii_case(plain) => {
                format!("; did you mean `{near}`?")
            }
            _ => String::new(),
        };
        let (words, symbols) = (words(of), symbols.join(", "));
        ErrorKind::Unit.refuse(format!("found the unit `{symbol}`{purpose}, expected {words} ({symbols}){hint}"))
    }

    /// The unit of this symbol, of any quantity.
    ///
    /// # Errors
    /// [`ErrorKind::Unit`] if it is unknown.
    pub fn parse_any(symbol: &str) -> Result<NamedUnit> {
        let unit = NamedUnit::parse(symbol, Unit::Metre).or_else(|_| NamedUnit::parse(symbol, Unit::Radian));
        unit.map_err(|_| {
            let symbols = UNITS.iter().filter(|unit| **unit != ONE).map(|unit| unit.symbol);
            let symbols = symbols.collect::<Vec<_>>().join(", ");
            ErrorKind::Unit.error(format!("found the unit `{symbol}`, expected one of {symbols}"))
        })
    }

    /// Converts a value in this unit to metres or radians.
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor / self.divisor
    }

    /// Converts a value in metres or radians to this unit.
    #[must_use]
    pub fn from_si(self, value: f64) -> f64 {
        value * self.divisor / self.factor
    }

    /// The symbol, in ASCII.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        self.symbol
    }

    /// The SI unit of the same quantity.
    #[must_use]
    pub fn si_unit(self) -> Unit {
        self.of
    }
}

/// Symbol for any name of a unit.
fn plain_symbol(name: &str) -> &str {
    let is_named = |unit: &&NamedUnit| unit.names.split_whitespace().any(|word| word.eq_ignore_ascii_case(name));
    match name {
        "µm" | "μm" => "um",
        "°" => "deg",
        "-" => "1",
        other => UNITS.iter().find(is_named).map_or(other, |unit| unit.symbol),
    }
}

/// A length above 0 as it is typed with its unit, metres; `None` for another number, or without a unit.
pub fn positive_length_m(text: &str) -> Result<Option<f64>> {
    let text = text.trim();
    let at = text.find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E')).unwrap_or(text.len());
    let (number, symbol) = text.split_at(at);
    let value = number.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
    let (Some(value), false) = (value, symbol.is_empty()) else { return Ok(None) };
    Ok(Some(NamedUnit::parse(symbol.trim(), Unit::Metre)?.to_si(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_converts_there_and_back() {
        for unit in UNITS {
            assert_eq!(NamedUnit::parse(unit.symbol, unit.of).unwrap(), unit);
            assert!((unit.from_si(unit.to_si(0.7)) - 0.7).abs() < 1e-15, "{}", unit.symbol);
        }
        assert_eq!(NamedUnit::parse("µm", Unit::Metre).unwrap().to_si(3.0), 3e-6);
        assert_eq!(NamedUnit::parse("deg", Unit::Radian).unwrap().to_si(180.0), PI);
    }

    #[test]
    fn every_unit_is_what_it_is_elsewhere() {
        // A turn has 360 degrees of 60 minutes of 60 seconds; an inch is 25.4 mm.
        let turn = |parts: f64| 2.0 * PI / parts;
        for (symbol, si) in [
            ("m", 1.0),
            ("cm", 0.01),
            ("mm", 0.001),
            ("um", 1e-6),
            ("nm", 1e-9),
            ("in", 0.0254),
            ("rad", 1.0),
            ("mrad", 0.001),
            ("deg", turn(360.0)),
            ("arcmin", turn(360.0 * 60.0)),
            ("arcsec", turn(360.0 * 3600.0)),
            ("ticks", turn(4096.0)),
            ("1", 1.0),
        ] {
            let unit = UNITS.into_iter().find(|unit| unit.symbol == symbol).unwrap();
            assert!((unit.to_si(1.0) / si - 1.0).abs() < 1e-15, "{symbol}");
        }
        assert_eq!(UNITS.len(), 13);
    }

    #[test]
    fn units_have_other_names() {
        for unit in UNITS {
            for name in unit.names.split_whitespace() {
                assert_eq!(NamedUnit::parse_any(name).unwrap(), unit);
            }
        }
        assert_eq!(NamedUnit::parse("Inches", Unit::Metre).unwrap().to_si(1.0), 0.0254);
        assert_eq!(NamedUnit::parse("in", Unit::Metre).unwrap().to_si(10.0), 0.254);
        assert!(NamedUnit::parse("Degrees", Unit::Metre).is_err());
    }

    #[test]
    fn unknown_units_name_what_is_known() {
        let message = |symbol, of| NamedUnit::parse(symbol, of).unwrap_err().to_string();
        assert_eq!(
            message("MM", Unit::Metre),
            "found the unit `MM`, expected a length (m, cm, mm, um, nm, in); did you mean `mm`?"
        );
        assert_eq!(message("m", Unit::One), "found the unit `m`, expected a number without unit (1)");
    }
}
