//! Measurements of files in any form, written in ours: every number reads back the same.

use std::fmt::Write as _;

use crate::MeasurementFile;
use crate::write::{decimal, reading_header, reading_units, refuse_names};
use poecal_model::measurement::{Dataset, Observation, Quantity, Set};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::csv_text::cell;

/// Names of the columns beside those of joints.
const COLUMNS: [&str; 16] = [
    "id",
    "target",
    "instrument",
    "set",
    "x",
    "y",
    "z",
    "qx",
    "qy",
    "qz",
    "qw",
    "sigma_position",
    "sigma_x",
    "sigma_y",
    "sigma_z",
    "sigma_rotation",
];

/// The rows of files as one table in our form: degrees and millimetres, orientations as quaternions x, y, z, w, standard deviations where rows
/// state them.
///
/// # Errors
/// [`ErrorKind::Measurement`] of other measurements than positions and poses, of an instrument's own configuration, of rows in motion, and of a joint with the name of
/// another column.
pub fn imported_table(file: &MeasurementFile, robot: &Robot) -> Result<String> {
    let data = &file.data;
    refuse_other_rows(data)?;
    let units = reading_units(data.reading_names(), robot)?;
    refuse_names(data.reading_names(), &COLUMNS)?;
    let columns = TableColumns::find(data)?;
    let joints = reading_header(data.reading_names(), &units);
    let mut out = columns.header(&joints).join(",");
    out.push('\n');
    for row in 0..data.len() {
        let _ = writeln!(out, "{}", columns.cells(data, row, &units).join(","));
    }
    Ok(out)
}

/// What a table of our own has columns for, with the units of their numbers.
struct TableColumns {
    has_ids: bool,
    is_named: bool,
    has_stations: bool,
    is_posed: bool,
    is_by_component: bool,
    has_sets: bool,
    /// Standard deviations that rows state, with the names of their columns.
    stated: Vec<(Quantity, &'static str)>,
    mm: NamedUnit,
    one: NamedUnit,
    deg: NamedUnit,
}

impl TableColumns {
    /// What the rows of a data set have.
    fn find(data: &Dataset) -> Result<Self> {
        let has = |of: &dyn Fn(&Observation) -> bool| data.observations.iter().any(of);
        let is_posed = has(&|it| it.measurement.sees_orientation());
        let is_by_component = has(&|it| it.noise_shape.is_some());
        let sigmas = [
            (Quantity::Position, "sigma_position[mm]", !is_by_component),
            (Quantity::Rotation, "sigma_rotation[deg]", true),
        ];
        let stated: Vec<(Quantity, &'static str)> = (sigmas.into_iter())
            .filter(|(quantity, _, is_one)| *is_one && has(&|it| it.stated.get(*quantity).is_some()))
            .map(|(quantity, name, _)| (quantity, name))
            .collect();
        let has_sets = has(&|it| it.set.is_some());
        let is_named = data.targets.iter().any(Option::is_some);
        let has_stations = data.stations.iter().any(Option::is_some);
        let has_ids = data.ids.iter().any(|it| !it.is_empty());
        Ok(TableColumns {
            has_ids,
            is_named,
            has_stations,
            is_posed,
            is_by_component,
            has_sets,
            stated,
            mm: NamedUnit::parse("mm", Unit::Metre)?,
            one: NamedUnit::from(Unit::One),
            deg: NamedUnit::parse("deg", Unit::Radian)?,
        })
    }

    /// The names of the columns, with those of the joints in one text.
    fn header<'a>(&self, joints: &'a str) -> Vec<&'a str> {
        let mut header: Vec<&str> = Vec::new();
        header.extend(self.has_ids.then_some("id"));
        header.push(joints);
        header.extend(self.is_named.then_some("target"));
        header.extend(self.has_stations.then_some("instrument"));
        header.extend(["x[mm]", "y[mm]", "z[mm]"]);
        header.extend(if self.is_posed { &["qx", "qy", "qz", "qw"][..] } else { &[] });
        header.extend(self.stated.iter().map(|it| it.1));
        header.extend(if self.is_by_component {
            &["sigma_x[mm]", "sigma_y[mm]", "sigma_z[mm]"][..]
        } else {
            &[]
        });
        header.extend(self.has_sets.then_some("set"));
        header
    }

    /// The cells of a row.
    fn cells(&self, data: &Dataset, row: usize, units: &[NamedUnit]) -> Vec<String> {
        let observation = &data.observations[row];
        let mut cells: Vec<String> = Vec::new();
        if self.has_ids {
            cells.push(cell(data.ids.get(row).map_or("", String::as_str)).into_owned());
        }
        cells.extend(
            data.readings(row).iter().zip(units).map(|(reading, unit)| decimal(*reading, *unit, None)),
        );
        let named = |names: &[Option<String>], at: usize| {
            cell(names.get(at).and_then(Option::as_deref).unwrap_or_default()).into_owned()
        };
        cells.extend(self.is_named.then(|| named(&data.targets, observation.target)));
        cells.extend(self.has_stations.then(|| named(&data.stations, observation.station)));
        let empty = String::new;
        let seen = &observation.measurement;
        cells.extend(
            seen.position_components().map(|it| it.map_or_else(empty, |it| decimal(it, self.mm, None))),
        );
        if self.is_posed {
            let turn = seen.sees_orientation().then(|| seen.pose().quaternion_xyzw());
            cells.extend((0..4).map(|at| turn.map_or_else(empty, |it| decimal(it[at], self.one, None))));
        }
        for (quantity, _) in &self.stated {
            let unit = if *quantity == Quantity::Position { self.mm } else { self.deg };
            cells.push(observation.stated.get(*quantity).map_or_else(empty, |it| decimal(it, unit, None)));
        }
        if self.is_by_component {
            let sigma = observation.stated.get(Quantity::Position);
            let shape = data.noise_shape(observation).zip(sigma);
            let sigmas = shape.map_or([sigma; 3], |(shape, sigma)| shape.component_sigmas(sigma));
            cells.extend(sigmas.map(|it| it.map_or_else(empty, |it| decimal(it, self.mm, None))));
        }
        if self.has_sets {
            cells.push(
                observation.set.map_or("", |set| if set == Set::Fit { "fit" } else { "held_out" }).to_owned(),
            );
        }
        cells
    }
}

/// Refuses rows that a table of our own cannot have: other measurements than positions and poses, and rows in motion.
fn refuse_other_rows(data: &Dataset) -> Result<()> {
    let is_place = |row: &&Observation| row.from.is_none() && row.measurement.is_place();
    if let Some(other) = data.observations.iter().find(|row| !is_place(row)) {
        let message = format!(
            "found a measurement of {}, expected positions and poses, which alone are written as a table of our own: name the files in each command",
            other.measurement.function().leading().name()
        );
        let error = ErrorKind::Measurement.error(message);
        return Err(match data.files.get(other.source.file as usize) {
            Some(path) => error.at_line(path, other.source.line as usize),
            None => error,
        });
    }
    if !data.moving.clocks.is_empty() {
        return ErrorKind::Measurement.refuse(
            "found rows that were measured in motion, expected rows at rest, which alone are written as a table of our own: a table has no clock, whose lag \
             is an unknown of the fit, so name the files in each command",
        );
    }
    Ok(())
}
