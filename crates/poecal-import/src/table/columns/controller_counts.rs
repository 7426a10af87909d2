//! Joint readings from the counts of a controller: columns from a calibration, and third axes that count from the horizontal.

use std::collections::BTreeMap;

use super::builder::Builder;
use crate::table::inputs::{InputSource, RowInput, SumTerm};
use poecal_model::robot::{Controller, ControllerColumn, ControllerReading, Robot, ThirdAxis, level};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::named_unit::{NamedUnit, UnitSource};
use poecal_numerics::unit::Unit;

impl Builder<'_> {
    /// Takes the convention of the third axis.
    pub(crate) fn third_axis(&mut self, robot: &Robot, names: &[String], counts: ThirdAxis) -> Result<()> {
        let in_map = |message: String| Err(ErrorKind::Measurement.error(message).in_file(&self.map.path));
        let at = |name: &String| names.iter().position(|it| it == name);
        let found = level(robot).and_then(|(second, third, factor)| Some((at(&second)?, at(&third)?, factor)));
        let Some((second, third, factor)) = found else {
            return in_map(format!(
                "found `third_axis = \"{}\"`, expected a robot whose second and third axes are parallel",
                counts.word()
            ));
        };
        let (Some(of_second), Some(of_third)) = (self.inputs.get(second), self.inputs.get(third)) else {
            return Ok(());
        };
        let terms = of_third.terms();
        let found = match terms.len() {
            0 => Some("constant"),
            1 => None,
            _ => Some("sum of columns"),
        };
        if let Some(found) = found {
            return in_map(format!(
                "found `third_axis` beside a {found} for joint `{}`, expected one column that counts its axis",
                of_third.name
            ));
        }
        if counts == ThirdAxis::Arm {
            return Ok(());
        }
        let mut sum = terms;
        let offset = of_third.added_constant() - factor * of_second.added_constant();
        sum.extend(of_second.terms().into_iter().map(|it| SumTerm { factor: -factor * it.factor, ..it }));
        let label = self.label(&sum);
        if let Some(input) = self.inputs.get_mut(third) {
            (input.sum, input.offset, input.label) = (sum, offset, label);
        }
        Ok(())
    }

    /// Adds a joint's reading by its columns in the calibration; units of the file precede the units there.
    pub(crate) fn kept_input(&mut self, kept: &ControllerReading, quantity: Unit, purpose: &str) -> Result<()> {
        let name = kept.reading.as_str();
        let column = |(column, it): (&'_ String, &ControllerColumn)| {
            let unit = NamedUnit::parse_for(&it.unit, quantity, &format!(" {purpose}"))?;
            Ok((column.clone(), it.factor, Some(unit)))
        };
        let columns = kept.columns.iter().map(column).collect::<Result<Vec<_>>>()?;
        match &columns[..] {
            [] => {
                self.constant_input(name, kept.offset, (NamedUnit::from(quantity), UnitSource::Mapping));
            }
            [(column, factor, unit)] if *factor == 1.0 && kept.offset == 0.0 => {
                self.column_or(name, column, quantity, (None, unit.map(|unit| (unit, UnitSource::Mapping))), purpose)?;
            }
            _ => {
                let at = self.joined_input(name, &columns, quantity, None, purpose)?;
                if let Some(input) = self.inputs.get_mut(at) {
                    input.offset = kept.offset;
                }
            }
        }
        Ok(())
    }

    /// Adds a sum of columns.
    pub(crate) fn sum_input(
        &mut self,
        name: &str,
        columns: &BTreeMap<String, f64>,
        quantity: Unit,
        unit: Option<NamedUnit>,
        purpose: &str,
    ) -> Result<usize> {
        if !self.readings.contains(name) {
            return Err(ErrorKind::Measurement
                .error(format!("found `columns` {purpose}, expected one column: only joints are sums of columns"))
                .in_file(&self.map.path));
        }
        let columns: Vec<_> = columns.iter().map(|(column, &factor)| (column.clone(), factor, None)).collect();
        self.joined_input(name, &columns, quantity, unit, purpose)
    }

    /// Adds a sum of columns, each with its factor, and its unit if the column states none.
    pub(crate) fn joined_input(
        &mut self,
        name: &str,
        columns: &[(String, f64, Option<NamedUnit>)],
        quantity: Unit,
        unit: Option<NamedUnit>,
        purpose: &str,
    ) -> Result<usize> {
        let mut sum: Vec<SumTerm> = Vec::with_capacity(columns.len());
        let at = self.inputs.len();
        for (column, _, unstated) in columns {
            let unstated = unstated.map(|unit| (unit, UnitSource::Mapping));
            self.column_or(name, column, quantity, (unit, unstated), purpose)?;
        }
        let parts = self.inputs.split_off(at);
        for (part, (_, factor, _)) in parts.iter().zip(columns) {
            if let InputSource::Column(column) = part.source {
                sum.push(SumTerm { column, unit: part.unit, factor: *factor });
            }
        }
        let label = self.label(&sum);
        // If unit and position are unique, the first column represents all.
        self.inputs.extend(parts.into_iter().next().map(|first| RowInput { label, sum, ..first }));
        Ok(at)
    }

    /// Conversion of columns into the readings of the joints, the first inputs; `None` if each is one column and nothing is stated.
    pub(crate) fn controller(&self, robot: &Robot) -> Option<Controller> {
        let column = |term: &SumTerm| {
            let name = self.header.cells.get(term.column).map(|cell| cell.name.clone())?;
            Some((name, ControllerColumn { factor: term.factor, unit: term.unit.symbol().to_owned() }))
        };
        let reading = |input: &RowInput| ControllerReading {
            reading: input.name.clone(),
            columns: input.terms().iter().filter_map(column).collect(),
            offset: input.added_constant(),
        };
        let count = robot.joint_reading_names().len();
        let readings = self.inputs.iter().take(count).map(reading).collect();
        let found = Controller { third_axis: self.map.third_axis, readings };
        (found.third_axis.is_some() || !found.is_plain()).then_some(found)
    }
}
