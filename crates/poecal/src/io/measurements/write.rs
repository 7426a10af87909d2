//! Measurement files of simulated rows.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::units::{Dimension, Unit};
use crate::error::{Error, ErrorKind, Result};
use crate::io::csv_text;
use crate::measurement::{Dataset, Measurement, Noise, Observation, Quantity, Seen};
use crate::robot::{ReadingKind, Robot};

/// Rows as a file with a leading comment: degrees and millimetres, orientations as quaternions, names where there are some. Readings are exact;
/// measured numbers are rounded to less than a thousandth of their noise.
pub(in crate::io) fn text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    if data
        .observations
        .iter()
        .any(|row| row.from.is_some() || matches!(row.measurement.seen(), Seen::Other(_)))
    {
        return other_text(data, robot, noise, comment);
    }
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

/// The columns of rows of other kinds, in the order of a file.
const OTHER_COLUMNS: [&str; 21] = [
    "target",
    "pair",
    "instrument",
    "anchor",
    "socket",
    "plane",
    "contact",
    "height[mm]",
    "sphere",
    "direction",
    "distance[mm]",
    "distance_change[mm]",
    "tilt_x[deg]",
    "tilt_y[deg]",
    "x[mm]",
    "y[mm]",
    "z[mm]",
    "qx",
    "qy",
    "qz",
    "qw",
];

/// Rows of other kinds, each with the cells that it has; a pair of configurations as two rows.
fn other_text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    let units = reading_units(data.reading_names(), robot)?;
    let names: Vec<&str> = OTHER_COLUMNS.iter().map(|it| it.split('[').next().unwrap_or(it)).collect();
    refuse_names(data.reading_names(), &names)?;
    let readings = |readings: &[f64]| -> Vec<String> {
        readings.iter().zip(&units).map(|(&reading, &unit)| decimal(reading, unit, None)).collect()
    };
    let width = data.reading_names().len();
    let mut rows: Vec<(Vec<String>, BTreeMap<&str, String>)> = Vec::with_capacity(data.len());
    for (row, observation) in data.observations.iter().enumerate() {
        let mut cells = cells(data, observation, noise)?;
        // A single target needs no name in its rows.
        let target = data.targets.get(observation.target).and_then(Option::as_deref);
        let target = target.filter(|_| data.targets.len() > 1);
        cells.extend(target.map(|name| ("target", csv_text::cell(name).into_owned())));
        if let Some(from) = observation.from {
            let mut pair = BTreeMap::from([("pair", (row + 1).to_string())]);
            pair.extend(target.map(|name| ("target", csv_text::cell(name).into_owned())));
            let first = width * from as usize;
            rows.push((readings(&data.further_readings()[first..first + width]), pair.clone()));
            cells.extend(pair);
        }
        rows.push((readings(data.readings(row)), cells));
    }
    let used: Vec<&str> = OTHER_COLUMNS
        .into_iter()
        .filter(|column| rows.iter().any(|(_, cells)| cells.contains_key(column)))
        .collect();
    let mut out =
        format!("# {comment}\n{},{}\n", reading_header(data.reading_names(), &units), used.join(","));
    for (readings, cells) in rows {
        let own = used.iter().map(|column| cells.get(column).map_or("", String::as_str));
        let line: Vec<&str> = readings.iter().map(String::as_str).chain(own).collect();
        let _ = writeln!(out, "{}", line.join(","));
    }
    Ok(out)
}

/// The cells of a measurement, by their columns.
fn cells(data: &Dataset, observation: &Observation, noise: &Noise) -> Result<BTreeMap<&'static str, String>> {
    let (mm, deg) = (Unit::parse("mm", Dimension::Length)?, Unit::parse("deg", Dimension::Angle)?);
    let number = Dimension::Number.si_unit();
    let length = |si: f64, quantity| decimal(si, mm, decimals(mm.from_si(noise[quantity])));
    let station = data.stations.get(observation.station).and_then(Option::as_deref).unwrap_or_default();
    let name = csv_text::cell(station).into_owned();
    let mut cells = BTreeMap::new();
    let is_pair = observation.from.is_some();
    match &observation.measurement {
        Measurement::Point(_) | Measurement::Pose(_) => {
            if !is_pair && !station.is_empty() {
                cells.insert("instrument", name);
            }
            let pose = observation.measurement.pose();
            for (column, value) in ["x[mm]", "y[mm]", "z[mm]"].into_iter().zip(pose.translation.iter()) {
                cells.insert(column, length(*value, Quantity::Position));
            }
            if observation.measurement.sees_orientation() {
                let turn = decimals(noise[Quantity::Rotation] / 2.0);
                for (column, part) in ["qx", "qy", "qz", "qw"].into_iter().zip(pose.quaternion_xyzw()) {
                    cells.insert(column, decimal(part, number, turn));
                }
            }
        }
        Measurement::Components(it) => {
            if !is_pair && !station.is_empty() {
                cells.insert("instrument", name);
            }
            for (column, value) in ["x[mm]", "y[mm]", "z[mm]"].into_iter().zip(it.components()) {
                cells.insert(
                    column,
                    value.map_or_else(String::new, |value| length(value, Quantity::Position)),
                );
            }
        }
        Measurement::Distance(it) if it.zero_is_unknown && it.distance == 0.0 => {
            cells.insert("sphere", name);
        }
        Measurement::Distance(it) => {
            let column = if it.zero_is_unknown { "distance_change[mm]" } else { "distance[mm]" };
            cells.insert(column, length(it.distance, Quantity::Distance));
            if !is_pair {
                cells.insert("anchor", name);
            }
        }
        Measurement::Socket(_) => {
            cells.insert("socket", name);
        }
        Measurement::Height(it) => {
            cells.extend([("plane", name), ("contact", "point".to_owned())]);
            if it.height != 0.0 {
                cells.insert("height[mm]", length(it.height, Quantity::Height));
            }
        }
        Measurement::Flush(it) => {
            cells.extend([("plane", name), ("contact", "flush".to_owned())]);
            if it.height != 0.0 {
                cells.insert("height[mm]", length(it.height, Quantity::Height));
            }
        }
        Measurement::Direction(it) => {
            let digits = decimals(deg.from_si(noise[Quantity::Tilt]));
            let [x, y] = it.tilts();
            cells.insert("direction", name);
            cells.insert("tilt_x[deg]", decimal(x, deg, digits));
            cells.insert("tilt_y[deg]", decimal(y, deg, digits));
        }
    }
    Ok(cells)
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
    refuse_names(names, measured_names)?;
    let measured = if orientations { "x[mm],y[mm],z[mm],qx,qy,qz,qw" } else { "x[mm],y[mm],z[mm]" };
    Ok(format!("{},{measured}", reading_header(names, units)))
}

/// Refuses joints with names that could not be read back beside these columns.
pub(super) fn refuse_names(names: &[String], measured: &[&str]) -> Result<()> {
    if let Some(name) = names.iter().find(|name| measured.contains(&name.as_str())) {
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
    Ok(())
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

    /// What is written of each kind is read as it was, and a pair as two rows.
    #[test]
    fn sessions_of_every_kind_read_back_the_same() {
        use crate::io::measurements::{ReadOptions, parse};
        use crate::simulate::{Kind, Simulation, elbow};
        let exact = Noise::new(0.0, 0.0);
        for kind in Kind::ALL {
            let simulation = Simulation {
                count: 12,
                noise_position_m: 0.0,
                noise_rotation_rad: 0.0,
                ..Simulation::default()
            };
            let made = simulation.run(&elbow(), kind).unwrap();
            let text = text(&made.data, &made.nominal, &exact, "a session").unwrap();
            let data = parse(&text, "a table", &made.nominal, &ReadOptions::default()).unwrap().data;
            println!("{:16} {}", kind.word(), text.lines().nth(1).unwrap());
            assert_eq!((data.len(), data.further_readings()), (12, made.data.further_readings()));
            for (found, expected) in data.observations.iter().zip(&made.data.observations) {
                // Faces lie on their planes up or down.
                let (metres, radians) = found.measurement.apart(&expected.measurement).unwrap();
                assert!(metres < 1e-12 && (radians < 1e-7 || kind == Kind::Flush), "{metres} {radians}");
                assert_eq!(found.station, expected.station);
            }
        }
    }

    #[test]
    fn measured_numbers_are_as_long_as_their_noise_deserves() {
        let mm = Unit::parse("mm", Dimension::Length).unwrap();
        assert_eq!(decimal(0.812_310_012_345, mm, decimals(0.05)), "812.31001");
        assert_eq!(decimals(0.0), None);
    }
}
