//! Measurement files of simulated rows.

pub(crate) mod growing_file;
pub(crate) mod own_columns;
pub(crate) mod own_rows;
pub(crate) mod rewriting;
pub(crate) mod template;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::table::kinds::{FunctionKind, kinds};
use crate::write::own_columns::{decimal, decimals, reading_header, reading_units, refuse_names};
use crate::write::own_rows::{OwnColumn, SessionTableRows};
use poecal_model::measurement::{Dataset, Measurement, Noise, Observation, Quantity};
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::csv_text;

/// Rows as a file with a leading comment: degrees and millimetres, orientations as quaternions, names if there are any. Readings are exact;
/// measured numbers are rounded to less than a thousandth of their noise.
pub fn text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    if data.observations.iter().any(|row| row.from.is_some() || !row.measurement.is_place()) {
        return other_text(data, robot, noise, comment);
    }
    let columns =
        [OwnColumn::Joints, OwnColumn::Position, OwnColumn::Orientation, OwnColumn::Instrument, OwnColumn::Target];
    let rows = SessionTableRows::new(data, robot, &columns)?.round_to_noise(noise);
    let mut out = format!("# {comment}\n{}\n", rows.header());
    for row in 0..data.len() {
        out += &rows.line(row, "");
        out.push('\n');
    }
    Ok(out)
}

/// Columns of the table beside those of its rows, before them and after them.
const BEFORE: [&str; 3] = ["target", "pair", "instrument"];
const AFTER: [&str; 7] = ["x[mm]", "y[mm]", "z[mm]", "qx", "qy", "qz", "qw"];

/// A column of a function's numbers, with the unit in which it is written.
fn with_unit(kind: &FunctionKind, name: &str) -> String {
    format!("{name}[{}]", kind.function.leading_quantity().unit().symbol())
}

/// The columns of rows of other kinds, in the order of a file.
fn other_columns() -> Vec<String> {
    let own = |kind: FunctionKind| {
        let place = kind.columns.places.last().into_iter().chain(kind.columns.word.as_ref().map(|(it, _)| it));
        let numbers = kind.columns.numbers.iter().map(|name| with_unit(&kind, name)).collect::<Vec<_>>();
        place.map(|name| (*name).to_owned()).chain(numbers).collect::<Vec<_>>()
    };
    let all = BEFORE.into_iter().map(str::to_owned).chain(kinds().flat_map(own));
    let mut found: Vec<String> = Vec::new();
    for column in all.chain(AFTER.into_iter().map(str::to_owned)) {
        if !found.contains(&column) {
            found.push(column);
        }
    }
    found
}

/// Rows of other kinds, each with the cells that it has; a pair of configurations as two rows.
fn other_text(data: &Dataset, robot: &Robot, noise: &Noise, comment: &str) -> Result<String> {
    let units = reading_units(data.reading_names(), robot)?;
    let columns = other_columns();
    let names: Vec<&str> = columns.iter().map(|it| it.split('[').next().unwrap_or(it)).collect();
    refuse_names(data.reading_names(), &names)?;
    let readings = |readings: &[f64]| -> Vec<String> {
        readings.iter().zip(&units).map(|(&reading, &unit)| decimal(reading, unit, None)).collect()
    };
    let width = data.reading_names().len();
    let mut rows: Vec<(Vec<String>, BTreeMap<String, String>)> = Vec::with_capacity(data.len());
    for (row, observation) in data.observations.iter().enumerate() {
        let mut cells = cells(data, observation, noise)?;
        // A single target needs no name in its rows.
        let target = data.targets.get(observation.target).and_then(Option::as_deref);
        let target = target.filter(|_| data.targets.len() > 1);
        cells.extend(target.map(|name| ("target".to_owned(), csv_text::cell(name).into_owned())));
        if let Some(from) = observation.from {
            let mut pair = BTreeMap::from([("pair".to_owned(), (row + 1).to_string())]);
            pair.extend(target.map(|name| ("target".to_owned(), csv_text::cell(name).into_owned())));
            let first = width * from as usize;
            rows.push((readings(&data.further_readings()[first..first + width]), pair.clone()));
            cells.extend(pair);
        }
        rows.push((readings(data.readings(row)), cells));
    }
    let is_used = |column: &String| rows.iter().any(|(_, cells)| cells.contains_key(column));
    let used: Vec<String> = columns.into_iter().filter(is_used).collect();
    let mut out = format!("# {comment}\n{},{}\n", reading_header(data.reading_names(), &units), used.join(","));
    for (readings, cells) in rows {
        let own = used.iter().map(|column| cells.get(column).map_or("", String::as_str));
        let line: Vec<&str> = readings.iter().map(String::as_str).chain(own).collect();
        let _ = writeln!(out, "{}", line.join(","));
    }
    Ok(out)
}

/// The cells of a measurement, by their columns.
fn cells(data: &Dataset, observation: &Observation, noise: &Noise) -> Result<BTreeMap<String, String>> {
    let seen = &observation.measurement;
    let station = data.stations.get(observation.station).and_then(Option::as_deref).unwrap_or_default();
    let name = csv_text::cell(station).into_owned();
    let is_pair = observation.from.is_some();
    let mut cells = BTreeMap::new();
    let own = kinds().filter(|kind| kind.function == seen.function());
    let form = own.filter_map(|kind| Some((kind, (kind.columns.numbers_of)(seen)?))).next();
    let Some((kind, numbers)) = form else {
        if !is_pair && !station.is_empty() {
            cells.insert("instrument".to_owned(), name);
        }
        place_cells(seen, noise, &mut cells)?;
        return Ok(cells);
    };
    let quantity = kind.function.leading_quantity();
    let unit = NamedUnit::parse(quantity.unit().symbol(), quantity.unit())?;
    for (column, number) in kind.columns.numbers.iter().zip(numbers) {
        if kind.needs_numbers() || number != 0.0 {
            let digits = decimals(unit.from_si(noise[quantity]));
            cells.insert(with_unit(&kind, column), decimal(number, unit, digits));
        }
    }
    cells.extend(kind.columns.word.map(|(column, word)| (column.to_owned(), word.to_owned())));
    cells.extend(kind.columns.places.last().filter(|_| !is_pair).map(|column| ((*column).to_owned(), name)));
    Ok(cells)
}

/// The cells of a position, or of some of its components, and of an orientation.
fn place_cells(seen: &Measurement, noise: &Noise, cells: &mut BTreeMap<String, String>) -> Result<()> {
    let mm = NamedUnit::parse("mm", Unit::Metre)?;
    let digits = decimals(mm.from_si(noise[Quantity::Position]));
    let place = seen.position_components().map(|it| it.map(|length| decimal(length, mm, digits)));
    let turn = decimals(noise[Quantity::Rotation] / 2.0);
    let part = |part| Some(decimal(part, NamedUnit::from(Unit::One), turn));
    let parts = seen.frame().map_or([const { None }; 4], |pose| pose.quaternion_xyzw().map(part));
    let [lengths @ .., _, _, _, _] = AFTER;
    let [_, _, _, quaternion @ ..] = AFTER;
    for (column, length) in lengths.into_iter().zip(place) {
        cells.insert(column.to_owned(), length.unwrap_or_default());
    }
    cells.extend(quaternion.into_iter().zip(parts).filter_map(|(it, part)| Some((it.to_owned(), part?))));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_read_back_the_same() {
        let deg = NamedUnit::parse("deg", Unit::Radian).unwrap();
        let mm = NamedUnit::parse("mm", Unit::Metre).unwrap();
        assert_eq!(decimal(deg.to_si(-12.3456), deg, None), "-12.3456");
        assert_eq!(decimal(mm.to_si(250.001), mm, None), "250.001");
        for si in [0.1 + 0.2, -1e-3, 3.0, 0.123_456_789_012_345_6] {
            assert_eq!(mm.to_si(decimal(si, mm, None).parse().unwrap()), si);
        }
    }

    #[test]
    fn a_joint_with_the_name_of_a_measured_column_is_refused() {
        let joint =
            poecal_model::robot::Joint::prismatic("y", poecal_arm::lie::Screw::prismatic(&nalgebra::Vector3::y()));
        let robot = Robot::new("slide", vec![joint], poecal_arm::lie::Pose::identity()).unwrap();
        let noise = Noise::new(0.0, 0.0);
        let error = text(&Dataset::new(robot.reading_names()), &robot, &noise, "").unwrap_err();
        assert_eq!(
            error.to_string(),
            "found the joint `y` in the model, expected none with the name of a measured column, which could not be \
             read back: rename the joint in the model"
        );
    }

    /// Each kind is read back unchanged, and a pair as two rows.
    #[test]
    fn sessions_of_every_kind_read_back_the_same() {
        use crate::{ReadOptions, parse};
        use poecal_model::simulate::{SessionKind, Simulation, elbow};
        let exact = Noise::new(0.0, 0.0);
        for kind in SessionKind::all() {
            let simulation =
                Simulation { count: 12, noise_position_m: 0.0, noise_rotation_rad: 0.0, ..Simulation::default() };
            let made = simulation.run(&elbow(), kind).unwrap();
            let text = text(&made.data, &made.nominal, &exact, "a session").unwrap();
            let data = parse(&text, "a table", &made.nominal, &ReadOptions::default()).unwrap().data;
            println!("{:16} {}", kind.word(), text.lines().nth(1).unwrap());
            assert_eq!((data.len(), data.further_readings()), (12, made.data.further_readings()));
            for (found, expected) in data.observations.iter().zip(&made.data.observations) {
                // Faces are on their planes, up or down.
                let (metres, radians) = found.measurement.distance_and_angle(&expected.measurement).unwrap();
                assert!(metres < 1e-12 && (radians < 1e-7 || kind == SessionKind::FLUSH), "{metres} {radians}");
                assert_eq!(found.station, expected.station);
            }
        }
    }

    #[test]
    fn measured_numbers_are_as_long_as_their_noise_deserves() {
        let mm = NamedUnit::parse("mm", Unit::Metre).unwrap();
        assert_eq!(decimal(0.812_310_012_345, mm, decimals(0.05)), "812.31001");
        assert_eq!(decimals(0.0), None);
    }
}
