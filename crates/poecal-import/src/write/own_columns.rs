//! Heads of columns and numbers of our own tables.

use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::csv_text;

/// Units of the readings: degrees and millimetres.
pub(crate) fn reading_units(names: &[String], robot: &Robot) -> Result<Vec<NamedUnit>> {
    let (deg, mm) = (NamedUnit::parse("deg", Unit::Radian)?, NamedUnit::parse("mm", Unit::Metre)?);
    let unit = |name: &String| match robot.reading_kind(name) {
        ReadingKind::Length => mm,
        ReadingKind::Angle => deg,
        ReadingKind::Factor => NamedUnit::from(Unit::One),
    };
    Ok(names.iter().map(unit).collect())
}

/// Header of readings and measured positions, with or without orientations.
pub(crate) fn header(names: &[String], units: &[NamedUnit], orientations: bool) -> Result<String> {
    let measured_names: &[&str] =
        if orientations { &["x", "y", "z", "qx", "qy", "qz", "qw"] } else { &["x", "y", "z"] };
    refuse_names(names, measured_names)?;
    let measured = if orientations { "x[mm],y[mm],z[mm],qx,qy,qz,qw" } else { "x[mm],y[mm],z[mm]" };
    Ok(format!("{},{measured}", reading_header(names, units)))
}

/// Refuses joints with names that could not be read back beside these columns.
pub(crate) fn refuse_names(names: &[String], measured: &[&str]) -> Result<()> {
    if let Some(name) = names.iter().find(|name| measured.contains(&name.as_str())) {
        return ErrorKind::Model.refuse(format!(
            "found the joint `{name}` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        ));
    }
    if let Some(name) = names.iter().find(|name| name.contains(['\n', '\r'])) {
        return ErrorKind::Model.refuse(format!(
            "found a line break in the name of the joint `{name}`, expected none, since a column of that name could not be read \
             back: rename the joint in the model"
        ));
    }
    Ok(())
}

/// The columns of the readings.
pub(crate) fn reading_header(names: &[String], units: &[NamedUnit]) -> String {
    let cell = |(name, unit): (&String, &NamedUnit)| {
        let symbol = if unit.si_unit() == Unit::One { String::new() } else { format!("[{}]", unit.symbol()) };
        csv_text::cell(&format!("{name}{symbol}")).into_owned()
    };
    names.iter().zip(units).map(cell).collect::<Vec<_>>().join(",")
}

/// Decimals for less than a thousandth of the noise; `None`, all of them, without noise.
pub(crate) fn decimals(noise: f64) -> Option<usize> {
    (noise > 0.0).then(|| (3.0 - noise.log10()).ceil().clamp(0.0, 17.0) as usize)
}

/// A number in a unit, with these decimals, else with as many as are needed to read back the same number.
pub(crate) fn decimal(si: f64, unit: NamedUnit, decimals: Option<usize>) -> String {
    let value = unit.from_si(si);
    let with = |count: usize| format!("{value:.count$}");
    match decimals {
        Some(count) => with(count),
        None => (0..=17)
            .map(with)
            .find(|text| text.parse().is_ok_and(|again| unit.to_si(again) == si))
            .unwrap_or_else(|| format!("{value:?}")),
    }
}
