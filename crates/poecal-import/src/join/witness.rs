//! A table of configurations to be measured again.

use std::fmt::Write as _;

use crate::write::{decimal, reading_header, reading_units};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::csv_text;

/// Decimals of angles and lengths as they are typed into a controller, in degrees and millimetres: those of planned configurations.
const DECIMALS: f64 = 1e4;

/// A reading as it is typed into a controller; a factor as it is.
fn typed(reading: f64, unit: NamedUnit) -> f64 {
    if unit == NamedUnit::from(Unit::One) {
        reading
    } else {
        unit.to_si((unit.from_si(reading) * DECIMALS).round() / DECIMALS)
    }
}

/// Rows of some measurements without what was measured, as a file to fill in: their configurations, in order and to four decimals, with `id`, target and
/// instrument where they have names, and empty columns for the numbers.
///
/// # Errors
/// [`ErrorKind::Option`](poecal_numerics::error::ErrorKind::Option) if a reading has a name that no column can have.
pub fn to_measure_again(
    data: &Dataset,
    configurations: &[Vec<u32>],
    robot: &Robot,
    are_new: bool,
) -> Result<String> {
    let units = reading_units(data.reading_names(), robot)?;
    let mut out = if are_new {
        "# New configurations: measure them now, and judge later visits by `poecal track --reference` with this one.\n"
    } else {
        "# Configurations to be measured again: fill in what the device shows, and judge it by `poecal track`.\n"
    }
    .to_owned();
    let rows = || configurations.iter().flatten();
    let named = [&data.targets, &data.stations].map(|names| names.iter().any(Option::is_some));
    let sees = rows().any(|row| data.observations[*row as usize].measurement.sees_orientation());
    let _ = write!(out, "id,{}", reading_header(data.reading_names(), &units));
    for (column, _) in ["target", "instrument"].into_iter().zip(named).filter(|(_, named)| *named) {
        let _ = write!(out, ",{column}");
    }
    out.push_str(if sees { ",x[mm],y[mm],z[mm],qx,qy,qz,qw\n" } else { ",x[mm],y[mm],z[mm]\n" });
    for (number, configuration) in configurations.iter().enumerate() {
        for &row in configuration {
            let seen = &data.observations[row as usize];
            let _ = write!(out, "{}", number + 1);
            for (&reading, &unit) in data.readings(row as usize).iter().zip(&units) {
                let _ = write!(out, ",{}", decimal(typed(reading, unit), unit, None));
            }
            let names = [(&data.targets, seen.target), (&data.stations, seen.station)];
            for ((names, at), _) in names.into_iter().zip(named).filter(|(_, named)| *named) {
                let name = names.get(at).and_then(Option::as_deref).unwrap_or_default();
                let _ = write!(out, ",{}", csv_text::cell(name));
            }
            out.push_str(if sees { ",,,,,,,\n" } else { ",,,\n" });
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::{Kind, Simulation, elbow};

    #[test]
    fn readings_have_four_decimals() {
        let made = Simulation { count: 6, ..Simulation::default() }.run(&elbow(), Kind::POINT).unwrap();
        let data = made.data.as_if_at(&[0], &[0.123_456_789; 6], 6).unwrap();
        let text = to_measure_again(&data, &[vec![0]], &made.nominal, false).unwrap();
        assert_eq!(text.lines().last(), Some("1,7.0736,7.0736,7.0736,7.0736,7.0736,7.0736,,,"), "{text}");
    }
}
