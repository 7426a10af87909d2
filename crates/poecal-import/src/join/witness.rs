//! A table of configurations to be measured again.

use crate::write::own_rows::{OwnColumn, SessionTableRows};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;

/// A file to fill in, with the configurations of some measurements, in order and to four decimals. It has `id`, target and instrument if they have
/// names, and empty columns for the measured numbers.
///
/// # Errors
/// [`ErrorKind::Option`](poecal_numerics::error::ErrorKind::Option) if a reading has a name that no column can have.
pub fn to_measure_again(data: &Dataset, configurations: &[Vec<u32>], robot: &Robot, are_new: bool) -> Result<String> {
    let mut out = if are_new {
        "# New configurations: measure them now, and judge later visits by `poecal track --reference` with this one.\n"
    } else {
        "# Configurations to be measured again: fill in what the device shows, and judge it by `poecal track`.\n"
    }
    .to_owned();
    let sees = |row: &u32| data.observations[*row as usize].measurement.sees_orientation();
    let columns = [OwnColumn::Joints, OwnColumn::Target, OwnColumn::Instrument, OwnColumn::Position];
    let rows = SessionTableRows::new(data, robot, &columns)?.left_empty(configurations.iter().flatten().any(sees));
    out += &rows.header();
    out.push('\n');
    for (number, configuration) in configurations.iter().enumerate() {
        for &row in configuration {
            out += &rows.line(row as usize, &(number + 1).to_string());
            out.push('\n');
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::{SessionKind, Simulation, elbow};

    #[test]
    fn readings_have_four_decimals() {
        let made = Simulation { count: 6, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap();
        let data = made.data.as_if_at(&[0], &[0.123_456_789; 6], 6).unwrap();
        let text = to_measure_again(&data, &[vec![0]], &made.nominal, false).unwrap();
        assert_eq!(text.lines().last(), Some("1,7.0736,7.0736,7.0736,7.0736,7.0736,7.0736,,,"), "{text}");
    }
}
