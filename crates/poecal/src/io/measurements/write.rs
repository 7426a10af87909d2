//! Measurement files of simulated rows.

use std::fmt::Write as _;

use super::units::{Dimension, Unit};
use crate::error::{Error, ErrorKind, Result};
use crate::io::csv_text;
use crate::measurement::{Dataset, Noise, Quantity};
use crate::robot::{ReadingKind, Robot};

/// Rows as a file with a leading comment: degrees and millimetres, orientations as quaternions, names where there are some. Readings are exact;
/// measured numbers are rounded to less than a thousandth of their noise.
pub(in crate::io) fn text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    let mm = Unit::parse("mm", Dimension::Length)?;
    let number = Dimension::Number.si_unit();
    let orientations = data.observations.iter().any(|row| row.measurement.sees_orientation());
    let units = reading_units(data.reading_names(), robot)?;
    let named = [&data.stations, &data.targets].map(|names| names.iter().any(Option::is_some));
    let mut out = format!("# {comment}\n{}", header(data.reading_names(), &units, orientations)?);
    for (column, _) in [",instrument", ",target"].into_iter().zip(named).filter(|(_, named)| *named) {
        out.push_str(column);
    }
    out.push('\n');
    let position_decimals = decimals(mm.from_si(noise[Quantity::Position]));
    // A rotation turns the quaternion by half its angle.
    let quaternion_decimals = decimals(noise[Quantity::Rotation] / 2.0);
    for (row, observation) in data.observations.iter().enumerate() {
        for (&reading, &unit) in data.readings(row).iter().zip(&units) {
            let _ = write!(out, "{},", decimal(reading, unit, None));
        }
        let pose = observation.measurement.pose();
        let mut measured: Vec<String> =
            pose.translation.iter().map(|&length| decimal(length, mm, position_decimals)).collect();
        if observation.measurement.sees_orientation() {
            measured.extend(pose.quaternion_xyzw().map(|part| decimal(part, number, quaternion_decimals)));
        } else if orientations {
            measured.resize(7, String::new());
        }
        let names = [(&data.stations, observation.station), (&data.targets, observation.target)];
        for ((names, index), _) in names.into_iter().zip(named).filter(|(_, named)| *named) {
            let name = names.get(index).and_then(Option::as_deref).unwrap_or_default();
            measured.push(csv_text::cell(name).into_owned());
        }
        let _ = writeln!(out, "{}", measured.join(","));
    }
    Ok(out)
}

/// Units of the readings: degrees and millimetres.
pub(super) fn reading_units(names: &[String], robot: &Robot) -> Result<Vec<Unit>> {
    let (deg, mm) = (Unit::parse("deg", Dimension::Angle)?, Unit::parse("mm", Dimension::Length)?);
    let unit = |name: &String| match robot.reading_kind(name) {
        ReadingKind::Length => mm,
        ReadingKind::Angle => deg,
        ReadingKind::Factor => Dimension::Number.si_unit(),
    };
    Ok(names.iter().map(unit).collect())
}

/// Header of readings and measured positions, with or without orientations.
pub(super) fn header(names: &[String], units: &[Unit], orientations: bool) -> Result<String> {
    let measured_names: &[&str] =
        if orientations { &["x", "y", "z", "qx", "qy", "qz", "qw"] } else { &["x", "y", "z"] };
    if let Some(name) = names.iter().find(|name| measured_names.contains(&name.as_str())) {
        let message = format!(
            "found the joint `{name}` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        );
        return Err(Error::new(ErrorKind::Model, message));
    }
    if let Some(name) = names.iter().find(|name| name.contains(['\n', '\r'])) {
        let message = format!(
            "found a line break in the name of the joint `{name}`, expected none, since a column of that name could not be read \
             back: rename the joint in the model"
        );
        return Err(Error::new(ErrorKind::Model, message));
    }
    let measured = if orientations { "x[mm],y[mm],z[mm],qx,qy,qz,qw" } else { "x[mm],y[mm],z[mm]" };
    Ok(format!("{},{measured}", reading_header(names, units)))
}

/// The columns of the readings.
pub(super) fn reading_header(names: &[String], units: &[Unit]) -> String {
    let cell = |(name, unit): (&String, &Unit)| {
        let symbol =
            if unit.quantity() == Dimension::Number { String::new() } else { format!("[{}]", unit.symbol()) };
        csv_text::cell(&format!("{name}{symbol}")).into_owned()
    };
    names.iter().zip(units).map(cell).collect::<Vec<_>>().join(",")
}

/// Decimals for less than a thousandth of the noise; `None`, all of them, without noise.
fn decimals(noise: f64) -> Option<usize> {
    (noise > 0.0).then(|| (3.0 - noise.log10()).ceil().clamp(0.0, 17.0) as usize)
}

/// A number in a unit, with the given decimals, else with as many as are needed to read back the same number.
pub(super) fn decimal(si: f64, unit: Unit, decimals: Option<usize>) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_read_back_the_same() {
        let deg = Unit::parse("deg", Dimension::Angle).unwrap();
        let mm = Unit::parse("mm", Dimension::Length).unwrap();
        assert_eq!(decimal(deg.to_si(-12.3456), deg, None), "-12.3456");
        assert_eq!(decimal(mm.to_si(250.001), mm, None), "250.001");
        for si in [0.1 + 0.2, -1e-3, 3.0, 0.123_456_789_012_345_6] {
            assert_eq!(mm.to_si(decimal(si, mm, None).parse().unwrap()), si);
        }
    }

    #[test]
    fn a_joint_with_the_name_of_a_measured_column_is_refused() {
        let joint =
            crate::robot::Joint::prismatic("y", crate::lie::Screw::prismatic(&nalgebra::Vector3::y()));
        let robot = Robot::new("slide", vec![joint], crate::lie::Pose::identity()).unwrap();
        let noise = Noise::new(0.0, 0.0);
        let error = text(&Dataset::new(robot.reading_names()), &robot, &noise, "").unwrap_err();
        assert_eq!(
            error.to_string(),
            "found the joint `y` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        );
    }

    #[test]
    fn measured_numbers_are_as_long_as_their_noise_deserves() {
        let mm = Unit::parse("mm", Dimension::Length).unwrap();
        assert_eq!(decimal(0.812_310_012_345, mm, decimals(0.05)), "812.31001");
        assert_eq!(decimals(0.0), None);
    }
}
