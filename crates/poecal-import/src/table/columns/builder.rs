//! Finds the columns of a layout in a header.

use std::collections::{BTreeMap, BTreeSet};

use super::super::header::Header;
use super::super::inputs::{InputSource, RowInput, SumTerm};
use super::super::kinds::is_our_name;
use super::super::numbered_columns::match_numbered_columns;
use super::super::times::seconds_of;
use super::column_spec::ColumnSpec;
use super::mapping::ColumnMap;
use poecal_model::robot::{Controller, FactorReading, ReadingKind, Robot, sum_words};
use poecal_numerics::error::{ErrorKind, MissingColumn, Result, first_few};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;
use poecal_storage::numbers::LARGEST_NUMBER;

/// Remedy for a missing column of our form.
const MISSING: &str = ": rename or add a column, or name the right one in a mapping file (--columns)";

/// Finds columns in a header, and records which are used.
pub(crate) struct Builder<'a> {
    pub(crate) header: &'a Header<'a>,
    pub(crate) map: &'a ColumnMap,
    pub(crate) readings: BTreeSet<String>,
    pub(crate) inputs: Vec<RowInput>,
    used: Vec<bool>,
    /// Joints with the numbered columns that are taken for them, if no column has the name of a joint.
    pub(crate) numbered: Option<Vec<(String, String)>>,
    /// Sums from the calibration, for a file that lacks some of their columns.
    pub(crate) missed: Option<String>,
}

impl<'a> Builder<'a> {
    /// Finds the columns of the joints.
    pub(crate) fn new(
        header: &'a Header<'a>,
        robot: &Robot,
        map: &'a ColumnMap,
        kept: Option<&Controller>,
    ) -> Result<Self> {
        let names = robot.reading_names();
        let readings: BTreeSet<String> = names.iter().cloned().collect();
        if let Some(name) = map.joints.keys().find(|name| !readings.contains(*name)) {
            return Err(ErrorKind::Measurement
                .error(format!("found the joint `{name}`, expected one of {}", first_few(&names)))
                .in_file(&map.path));
        }
        let used = vec![false; header.cells.len()];
        let has_all = |kept: &&Controller| {
            let mut columns = kept.readings.iter().flat_map(|it| it.columns.keys());
            columns.all(|column| header.count(column) > 0)
        };
        // A mapping that concerns the joints precedes the kept columns.
        let kept = kept.filter(|_| map.joints.is_empty() && map.third_axis.is_none());
        let missed = kept.filter(|kept| !kept.is_plain() && !has_all(kept)).map(Controller::words);
        let kept = kept.filter(has_all);
        let numbered = if kept.is_some() { None } else { match_numbered_columns(header, robot, map, &names) };
        let mut builder = Builder { header, map, readings, inputs: Vec::new(), used, numbered, missed };
        let default = ColumnSpec::default();
        let motors = match &map.motors {
            Some(motors) if kept.is_none() => motors.columns(header, robot, &map.path)?,
            _ => BTreeMap::new(),
        };
        let numbers = builder.numbered.clone().into_iter().flatten();
        let numbers: BTreeMap<String, ColumnSpec> = numbers
            .map(|(joint, column)| (joint, ColumnSpec { column: Some(column), ..ColumnSpec::default() }))
            .collect();
        for name in &names {
            if robot.reading_kind(name) == ReadingKind::Factor {
                builder.factor_input(name)?;
                continue;
            }
            let purpose = format!("for joint `{name}`");
            if let Some(reading) = kept.and_then(|kept| kept.readings.iter().find(|it| it.reading == *name)) {
                builder.kept_input(reading, reading_quantity(robot, name), &purpose)?;
                continue;
            }
            let spec =
                map.joints.get(name).or_else(|| motors.get(name)).or_else(|| numbers.get(name)).unwrap_or(&default);
            let found = builder.spec_input(name, spec, reading_quantity(robot, name), &purpose);
            found.map_err(|error| error.if_missing(MissingColumn::Joint))?;
        }
        if let Some(counts) = map.third_axis {
            builder.third_axis(robot, &names, counts)?;
        }
        Ok(builder)
    }

    /// A sum of columns in words.
    pub(crate) fn label(&self, sum: &[SumTerm]) -> String {
        let name = |term: &SumTerm| self.header.cells.get(term.column).map_or("", |cell| cell.name.as_str());
        sum_words(sum.iter().map(|term| (name(term), term.factor)))
    }

    /// Adds the number of a factor, in any unit of its column.
    fn factor_input(&mut self, name: &str) -> Result<()> {
        if is_our_name(name) {
            return ErrorKind::Option.refuse(format!(
                "found the factor `{name}`, expected a column without a meaning of its own: rename it"
            ));
        }
        let column = self.text_column(name, "for the factor")?;
        if name == FactorReading::PAYLOAD {
            self.header.only_unit(column, "kg")?;
        }
        let (name, label, source) = (name.to_owned(), name.to_owned(), InputSource::Column(column));
        let (unit, unit_from) = (NamedUnit::from(Unit::One), UnitSource::Si);
        self.inputs.push(RowInput { name, label, source, unit, unit_from, sum: Vec::new(), offset: 0.0 });
        Ok(())
    }

    /// Adds a number from a column or a constant.
    pub(crate) fn spec_input(&mut self, name: &str, spec: &ColumnSpec, quantity: Unit, purpose: &str) -> Result<usize> {
        if let Some(unit) = spec.unit.filter(|unit| unit.si_unit() != quantity) {
            NamedUnit::parse_for(unit.symbol(), quantity, &format!(" {purpose}"))
                .map_err(|error| error.in_file(&self.map.path))?;
        }
        if let Some(columns) = &spec.columns {
            let at = self.sum_input(name, columns, quantity, spec.unit, purpose)?;
            self.add_offset(at, spec.offset, purpose)?;
            return Ok(at);
        }
        let Some(value) = spec.value else {
            let column = spec.column.as_deref().unwrap_or(name);
            let at = self.column_input(name, column, quantity, spec.unit, purpose)?;
            self.add_offset(at, spec.offset, purpose)?;
            return Ok(at);
        };
        let stated = spec.unit.or(self.map.units.unit_of_quantity(quantity));
        let unit = stated.unwrap_or(NamedUnit::from(quantity));
        let unit_from = if stated.is_some() { UnitSource::Mapping } else { UnitSource::Si };
        if unit.to_si(value).abs() > LARGEST_NUMBER {
            let si = NamedUnit::from(quantity).symbol();
            return Err(ErrorKind::Measurement
                .error(format!("found the value {value:?} {purpose}, expected at most {LARGEST_NUMBER:e} {si}"))
                .in_file(&self.map.path));
        }
        Ok(self.constant_input(name, unit.to_si(value), (unit, unit_from)))
    }

    /// Adds a number that is the same in all rows (metres, radians).
    pub(crate) fn constant_input(
        &mut self,
        name: &str,
        value: f64,
        (unit, unit_from): (NamedUnit, UnitSource),
    ) -> usize {
        let (name, label, source) = (name.to_owned(), name.to_owned(), InputSource::Constant(value));
        self.inputs.push(RowInput { name, label, source, unit, unit_from, sum: Vec::new(), offset: 0.0 });
        self.inputs.len() - 1
    }

    /// The offset that the mapping adds to a joint's columns, in the unit of the first.
    pub(crate) fn add_offset(&mut self, at: usize, offset: Option<f64>, purpose: &str) -> Result<()> {
        let Some(offset) = offset else { return Ok(()) };
        let Some(input) = self.inputs.get_mut(at) else { return Ok(()) };
        let added = input.unit.to_si(offset);
        if !self.readings.contains(&input.name) || added.abs() > LARGEST_NUMBER {
            return Err(ErrorKind::Measurement.error(format!(
                "found the offset {offset:?} {purpose}, expected one of a joint's reading, of at most {LARGEST_NUMBER:e}"
            )).in_file(&self.map.path));
        }
        (input.sum, input.offset) = (input.terms(), added);
        Ok(())
    }

    /// Adds a number from a column.
    pub(crate) fn column_input(
        &mut self,
        name: &str,
        column: &str,
        quantity: Unit,
        mapped: Option<NamedUnit>,
        purpose: &str,
    ) -> Result<usize> {
        self.column_or(name, column, quantity, (mapped, None), purpose)
    }

    /// Adds a number from a column, with a unit for a column that states none.
    pub(crate) fn column_or(
        &mut self,
        name: &str,
        column: &str,
        quantity: Unit,
        (mapped, unstated): (Option<NamedUnit>, Option<(NamedUnit, UnitSource)>),
        purpose: &str,
    ) -> Result<usize> {
        let index = self.text_column(column, purpose)?;
        let stated = match mapped {
            Some(unit) => Some((unit, UnitSource::Mapping)),
            None => self.header.unit(index, quantity, purpose)?,
        };
        let of_all = || self.map.units.unit_of_quantity(quantity).map(|unit| (unit, UnitSource::Mapping));
        let default = match unstated {
            Some((_, UnitSource::Maker)) => of_all().or(unstated),
            _ => unstated.or_else(of_all),
        };
        let (unit, unit_from) = match (stated.or(default), self.header.units_line) {
            (Some(known), _) => known,
            // In a line of units, an empty cell may be forgotten or merged.
            (None, Some(line)) if quantity != Unit::One => {
                return Err(self.header.no_unit(index, line, quantity, purpose));
            }
            (None, _) => (NamedUnit::from(quantity), UnitSource::Si),
        };
        let (name, label, source) = (name.to_owned(), column.to_owned(), InputSource::Column(index));
        self.inputs.push(RowInput { name, label, source, unit, unit_from, sum: Vec::new(), offset: 0.0 });
        Ok(self.inputs.len() - 1)
    }

    /// Index of a required column.
    pub(crate) fn text_column(&mut self, name: &str, purpose: &str) -> Result<usize> {
        let is_known = |found: &str| found != name && (self.readings.contains(found) || is_our_name(found));
        let is_ours = self.readings.contains(name) || is_our_name(name);
        let advice = if is_ours { MISSING } else { "" };
        let index = self
            .header
            .require(name, purpose, is_known, advice)
            .map_err(|error| self.explain_duplicate(name, error))?;
        self.mark(index);
        Ok(index)
    }

    /// Index of an optional column that is not used otherwise.
    pub(crate) fn optional_text_column(&mut self, name: &str) -> Result<Option<usize>> {
        let index = self.header.find(name)?.filter(|&index| !self.is_used(index));
        if let Some(index) = index {
            self.mark(index);
        }
        Ok(index)
    }

    /// The column with the time of a row, and its unit in seconds, if there is one.
    pub(crate) fn time_column(&mut self) -> Option<(usize, f64)> {
        let cells = self.header.cells.iter().enumerate();
        let mut times = cells
            .filter(|(at, _)| !self.is_used(*at))
            .filter_map(|(at, cell)| Some((at, seconds_of(&cell.name, cell.units().next())?)));
        let found = times.next()?;
        self.mark(found.0);
        Some(found)
    }

    pub(crate) fn id_column(&mut self) -> Result<Option<usize>> {
        match &self.map.id {
            Some(column) => self.text_column(column, "for the row's id").map(Some),
            None => self.optional_text_column("id"),
        }
    }

    pub(crate) fn mark(&mut self, index: usize) {
        if let Some(used) = self.used.get_mut(index) {
            *used = true;
        }
    }

    pub(crate) fn is_used(&self, index: usize) -> bool {
        self.used.get(index).copied().unwrap_or(false)
    }
}

fn reading_quantity(robot: &Robot, reading: &str) -> Unit {
    match robot.reading_kind(reading) {
        ReadingKind::Length => Unit::Metre,
        ReadingKind::Angle => Unit::Radian,
        ReadingKind::Factor => Unit::One,
    }
}
