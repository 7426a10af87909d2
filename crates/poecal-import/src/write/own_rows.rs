//! Rows of a session as a table in our form: degrees and millimetres, orientations as quaternions x, y, z, w.

use crate::MeasurementFile;
use crate::write::own_columns::{decimal, decimals, reading_header, reading_units, refuse_names};
use poecal_model::measurement::{Dataset, Noise, Observation, Quantity, Set};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::csv_text::cell;

/// Columns of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OwnColumn {
    Id,
    Joints,
    Target,
    Instrument,
    Position,
    Orientation,
    /// Standard deviation that rows state.
    Stated(Quantity),
    /// Standard deviation of each component of the position.
    StatedByComponent,
    Set,
}

impl OwnColumn {
    /// Its names in a header, without those of joints.
    const fn names(self) -> &'static [&'static str] {
        match self {
            OwnColumn::Id => &["id"],
            OwnColumn::Joints => &[],
            OwnColumn::Target => &["target"],
            OwnColumn::Instrument => &["instrument"],
            OwnColumn::Position => &["x[mm]", "y[mm]", "z[mm]"],
            OwnColumn::Orientation => &["qx", "qy", "qz", "qw"],
            OwnColumn::Stated(Quantity::Rotation) => &["sigma_rotation[deg]"],
            OwnColumn::Stated(_) => &["sigma_position[mm]"],
            OwnColumn::StatedByComponent => &["sigma_x[mm]", "sigma_y[mm]", "sigma_z[mm]"],
            OwnColumn::Set => &["set"],
        }
    }
}

/// The rows of a session in the columns of a table.
pub(crate) struct SessionTableRows<'a> {
    data: &'a Dataset,
    columns: Vec<OwnColumn>,
    units: Vec<NamedUnit>,
    mm: NamedUnit,
    deg: NamedUnit,
    /// Decimals of positions and quaternions; `None` means as many as are needed to read back the same number.
    decimals: [Option<usize>; 2],
    /// True if measured numbers are left empty, and readings are rounded for typing into a controller.
    is_to_fill: bool,
}

impl<'a> SessionTableRows<'a> {
    /// The rows in those of these columns that they need, with exact numbers.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] for a joint with the name of another column.
    pub(crate) fn new(data: &'a Dataset, robot: &Robot, columns: &[OwnColumn]) -> Result<Self> {
        let has = |of: &dyn Fn(&Observation) -> bool| data.observations.iter().any(of);
        let is_by_component = has(&|it| it.noise_shape.is_some());
        let is_needed = |column: &OwnColumn| match *column {
            OwnColumn::Joints | OwnColumn::Position => true,
            OwnColumn::Id => data.ids.iter().any(|it| !it.is_empty()),
            OwnColumn::Target => data.targets.iter().any(Option::is_some),
            OwnColumn::Instrument => data.stations.iter().any(Option::is_some),
            OwnColumn::Orientation => has(&|it| it.measurement.sees_orientation()),
            OwnColumn::Stated(Quantity::Position) if is_by_component => false,
            OwnColumn::Stated(quantity) => has(&|it| it.stated.get(quantity).is_some()),
            OwnColumn::StatedByComponent => is_by_component,
            OwnColumn::Set => has(&|it| it.set.is_some()),
        };
        let columns: Vec<OwnColumn> = columns.iter().copied().filter(is_needed).collect();
        let names = columns.iter().flat_map(|it| it.names());
        let names: Vec<&str> = names.map(|it| it.split('[').next().unwrap_or(it)).collect();
        refuse_names(data.reading_names(), &names)?;
        Ok(SessionTableRows {
            data,
            columns,
            units: reading_units(data.reading_names(), robot)?,
            mm: NamedUnit::parse("mm", Unit::Metre)?,
            deg: NamedUnit::parse("deg", Unit::Radian)?,
            decimals: [None; 2],
            is_to_fill: false,
        })
    }

    /// Rounds measured numbers to less than a thousandth of their noise.
    pub(crate) fn round_to_noise(self, noise: &Noise) -> Self {
        let position = decimals(self.mm.from_si(noise[Quantity::Position]));
        // A rotation turns the quaternion by half its angle.
        SessionTableRows { decimals: [position, decimals(noise[Quantity::Rotation] / 2.0)], ..self }
    }

    /// Makes a form to fill in: `id` and empty cells for the measurements, with orientations if `sees_orientation`.
    pub(crate) fn left_empty(mut self, sees_orientation: bool) -> Self {
        self.columns.insert(0, OwnColumn::Id);
        self.columns.retain(|it| *it != OwnColumn::Orientation);
        self.columns.extend(sees_orientation.then_some(OwnColumn::Orientation));
        SessionTableRows { is_to_fill: true, ..self }
    }

    /// The line of the names of the columns.
    pub(crate) fn header(&self) -> String {
        let joints = reading_header(self.data.reading_names(), &self.units);
        let own = self.columns.iter().map(|column| match column.names() {
            [] => joints.clone(),
            names => names.join(","),
        });
        own.collect::<Vec<_>>().join(",")
    }

    /// A row; `id` is its name.
    pub(crate) fn line(&self, row: usize, id: &str) -> String {
        let data = self.data;
        let observation = &data.observations[row];
        let seen = &observation.measurement;
        let named = |names: &[Option<String>], at: usize| {
            vec![cell(names.get(at).and_then(Option::as_deref).unwrap_or_default()).into_owned()]
        };
        let number = |value: Option<f64>, unit: NamedUnit, decimals| {
            value.map_or_else(String::new, |it| decimal(it, unit, decimals))
        };
        let cells = self.columns.iter().flat_map(|column| match *column {
            OwnColumn::Position | OwnColumn::Orientation if self.is_to_fill => {
                vec![String::new(); column.names().len()]
            }
            OwnColumn::Id => vec![cell(id).into_owned()],
            OwnColumn::Joints => self.readings(data.readings(row)),
            OwnColumn::Target => named(&data.targets, observation.target),
            OwnColumn::Instrument => named(&data.stations, observation.station),
            OwnColumn::Position => seen.position_components().map(|it| number(it, self.mm, self.decimals[0])).to_vec(),
            OwnColumn::Orientation => {
                let turn = seen.sees_orientation().then(|| seen.pose().quaternion_xyzw());
                let part = |at| number(turn.map(|it| it[at]), NamedUnit::from(Unit::One), self.decimals[1]);
                (0..4).map(part).collect()
            }
            OwnColumn::Stated(quantity) => {
                let unit = if quantity == Quantity::Position { self.mm } else { self.deg };
                vec![number(observation.stated.get(quantity), unit, None)]
            }
            OwnColumn::StatedByComponent => {
                let sigma = observation.stated.get(Quantity::Position);
                let shape = data.noise_shape(observation).zip(sigma);
                let sigmas = shape.map_or([sigma; 3], |(shape, sigma)| shape.component_sigmas(sigma));
                sigmas.map(|it| number(it, self.mm, None)).to_vec()
            }
            OwnColumn::Set => {
                let word = |set| if set == Set::Fit { "fit" } else { "held_out" };
                vec![observation.set.map_or("", word).to_owned()]
            }
        });
        cells.collect::<Vec<_>>().join(",")
    }

    /// Cells of readings; in a form to fill in, rounded for typing into a controller, except for factors.
    pub(crate) fn readings(&self, readings: &[f64]) -> Vec<String> {
        let typed = |reading: f64, unit: NamedUnit| {
            if !self.is_to_fill || unit == NamedUnit::from(Unit::One) {
                reading
            } else {
                unit.to_si((unit.from_si(reading) * TYPED).round() / TYPED)
            }
        };
        readings.iter().zip(&self.units).map(|(&reading, &unit)| decimal(typed(reading, unit), unit, None)).collect()
    }
}

/// Number of steps in a degree and a millimetre that are typed into a controller: those of planned configurations.
const TYPED: f64 = 1e4;

/// The rows of files as one table in our form, with standard deviations if rows state them: every number reads back the same.
///
/// # Errors
/// [`ErrorKind::Measurement`] for other measurements than positions and poses, for an instrument's own configuration, for rows in motion, and for a
/// joint with the name of another column.
pub fn imported_table(file: &MeasurementFile, robot: &Robot) -> Result<String> {
    const COLUMNS: [OwnColumn; 10] = [
        OwnColumn::Id,
        OwnColumn::Joints,
        OwnColumn::Target,
        OwnColumn::Instrument,
        OwnColumn::Position,
        OwnColumn::Orientation,
        OwnColumn::Stated(Quantity::Position),
        OwnColumn::Stated(Quantity::Rotation),
        OwnColumn::StatedByComponent,
        OwnColumn::Set,
    ];
    let data = &file.data;
    refuse_other_rows(data)?;
    let rows = SessionTableRows::new(data, robot, &COLUMNS)?;
    let mut out = rows.header() + "\n";
    for row in 0..data.len() {
        out += &rows.line(row, data.ids.get(row).map_or("", String::as_str));
        out.push('\n');
    }
    Ok(out)
}

/// Refuses rows that a table of our own cannot have: other measurements than positions and poses, and rows in motion.
fn refuse_other_rows(data: &Dataset) -> Result<()> {
    let is_place = |row: &&Observation| row.from.is_none() && row.measurement.is_place();
    if let Some(other) = data.observations.iter().find(|row| !is_place(row)) {
        let message = format!(
            "found a measurement of {}, expected positions and poses, which alone are written as a table of our own: name the files in each command",
            other.measurement.function().leading_quantity().name()
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
