//! Rows to measurements: the rows of a block, and those of all blocks so far.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nalgebra::{Matrix3, Vector3};

use super::inputs::InputReader;
use super::layout::{Layout, SetRule, TargetLayout};
use super::mapping::PoseDirection;
use super::scale::JointWatch;
use super::table::{Row, Rows};
use crate::error::Result;
use crate::lie::Pose;
use crate::measurement::{Dataset, Measurement, Observation, PointMeasurement, PoseMeasurement, Set, Source};
use crate::robot::Robot;

/// Whether the first row named its target; all others must do the same.
#[derive(Clone)]
struct Naming {
    named: bool,
    path: PathBuf,
    line: usize,
}

/// What rows say, of one file or several.
pub(super) struct Found {
    pub(super) data: Dataset,
    target_indices: BTreeMap<String, usize>,
    naming: Option<Naming>,
    /// Which values that mark rows to fit have come.
    pub(super) fit_values: Vec<bool>,
}

impl Found {
    /// Nothing yet.
    pub(super) fn new(robot: &Robot) -> Self {
        let data = Dataset::new(robot.reading_names());
        Found { data, target_indices: BTreeMap::new(), naming: None, fit_values: Vec::new() }
    }

    /// Index of a target, added if it is new.
    fn target_index(&mut self, name: Option<&str>) -> usize {
        let key = name.unwrap_or_default();
        if let Some(&index) = self.target_indices.get(key) {
            return index;
        }
        let index = self.target_indices.len();
        self.target_indices.insert(key.to_owned(), index);
        self.data.targets.push(name.map(str::to_owned));
        index
    }

    fn mark_fit_value(&mut self, value: usize) {
        if self.fit_values.len() <= value {
            self.fit_values.resize(value + 1, false);
        }
        if let Some(seen) = self.fit_values.get_mut(value) {
            *seen = true;
        }
    }

    /// Takes in what the rows after these say.
    fn join(&mut self, next: Found) {
        let targets: Vec<usize> =
            next.data.targets.iter().map(|name| self.target_index(name.as_deref())).collect();
        self.data.append(next.data, &targets);
        self.naming = self.naming.take().or(next.naming);
        for (value, _) in next.fit_values.iter().enumerate().filter(|(_, seen)| **seen) {
            self.mark_fit_value(value);
        }
    }
}

/// The rows of one block of a file, or of all its blocks so far.
pub(super) struct Part<'a> {
    robot: &'a Robot,
    layout: &'a Layout,
    /// Index of the file.
    file: u32,
    pub(super) found: Found,
    pub(super) inputs: InputReader<'a>,
    pub(super) watch: JointWatch<'a>,
    /// Rows of this file.
    pub(super) rows: usize,
}

impl<'a> Part<'a> {
    /// The begin of a file, after what earlier files said.
    pub(super) fn new(
        robot: &'a Robot,
        layout: &'a Layout,
        file: u32,
        inputs: InputReader<'a>,
        found: Found,
    ) -> Self {
        Part { robot, layout, file, found, inputs, watch: JointWatch::new(robot), rows: 0 }
    }

    /// Whether later blocks depend on nothing that only the next one may tell: how numbers and targets are written.
    pub(super) fn is_settled(&self) -> bool {
        self.inputs.numbers.is_settled() && self.found.naming.is_some()
    }

    /// The rows of a block after these.
    pub(super) fn read_next(&self, mut rows: Rows<'_>) -> Result<Part<'a>> {
        let found = Found { naming: self.found.naming.clone(), ..Found::new(self.robot) };
        let mut next = Part::new(self.robot, self.layout, self.file, self.inputs.next(), found);
        while let Some(row) = rows.next()? {
            next.rows += 1;
            next.inputs.read(&row)?;
            next.watch.observe(&row, &next.inputs);
            next.row(&row)?;
        }
        Ok(next)
    }

    /// Takes in the rows of the next block.
    pub(super) fn join(&mut self, next: Part<'_>) {
        self.rows += next.rows;
        self.found.join(next.found);
        self.inputs.join(next.inputs);
        self.watch.join(next.watch);
    }

    fn row(&mut self, row: &Row<'_>) -> Result<()> {
        let layout = self.layout;
        self.inputs.take_readings(row, self.found.data.reading_names().len())?;
        let set = self.set(row)?;
        let mut seen = false;
        for target in &layout.targets {
            let may_be_missing = layout.targets.len() > 1;
            let Some(measurement) = measurement(row, target, layout.pose, &self.inputs, may_be_missing)?
            else {
                continue;
            };
            seen = true;
            let observation = Observation {
                target: self.target(row, target)?,
                measurement,
                sigma_position_m: sigma(row, target.sigma_position, &self.inputs)?,
                sigma_rotation_rad: sigma(row, target.sigma_rotation, &self.inputs)?,
                set,
                source: Source { file: self.file, line: u32::try_from(row.line).unwrap_or(u32::MAX) },
            };
            let pushed = self.found.data.push_observation(self.inputs.readings(), observation);
            pushed.map_err(|error| row.error(0, error.message()))?;
            if let Some(cell) = layout.id.and_then(|id| row.cells.get(id)) {
                self.found.data.ids.push(cell.text().into_owned());
            }
        }
        if !seen {
            return Err(row.error(0, "found a row without any target's position, expected at least one"));
        }
        Ok(())
    }

    /// The set of a row, if it is stated.
    fn set(&mut self, row: &Row<'_>) -> Result<Option<Set>> {
        let text = |index: usize| row.cells.get(index).map(|cell| cell.text()).unwrap_or_default();
        match &self.layout.set {
            SetRule::Unstated => Ok(None),
            SetRule::Words(index) => match text(*index).as_ref() {
                "" => Ok(None),
                "fit" => Ok(Some(Set::Fit)),
                "held_out" => Ok(Some(Set::HeldOut)),
                other => Err(row
                    .error(*index, format!("found `{other}` in column `set`, expected `fit` or `held_out`"))),
            },
            SetRule::Where(index, rule) => {
                let Some(value) = rule.matching(&text(*index)) else { return Ok(Some(Set::HeldOut)) };
                self.found.mark_fit_value(value);
                Ok(Some(Set::Fit))
            }
        }
    }

    /// Index of the row's target. Either all rows name their target or none does.
    fn target(&mut self, row: &Row<'_>, target: &TargetLayout) -> Result<usize> {
        let column = self.layout.target_column;
        let cell = column.and_then(|column| row.cells.get(column)).map(|cell| cell.text());
        let name = cell.as_deref().or(target.name.as_deref()).filter(|name| !name.is_empty());
        let naming = self.found.naming.get_or_insert_with(|| Naming {
            named: name.is_some(),
            path: row.path.to_path_buf(),
            line: row.line,
        });
        if naming.named != name.is_some() {
            let (found, expected) = match name {
                Some(name) => (format!("the target `{name}`"), "no name"),
                None => ("no target name".to_owned(), "one"),
            };
            let message = format!(
                "found {found}, expected {expected} as in {}:{}; all rows name their target or none does \
                 (an unnamed target is the tip itself)",
                naming.path.display(),
                naming.line
            );
            return Err(row.error(column.unwrap_or(0), message));
        }
        Ok(self.found.target_index(name))
    }
}

/// What the row says of a target; none if it may be missing and is.
fn measurement(
    row: &Row<'_>,
    target: &TargetLayout,
    direction: PoseDirection,
    inputs: &InputReader<'_>,
    may_be_missing: bool,
) -> Result<Option<Measurement>> {
    let position = match inputs.all(target.position) {
        [Some(x), Some(y), Some(z)] => Vector3::new(x, y, z),
        [None, None, None] if may_be_missing => return Ok(None),
        parts => {
            let empty = parts.iter().position(Option::is_none).unwrap_or(0);
            let input = target.position.get(empty).copied().unwrap_or(0);
            return Err(inputs.error(row, input, "found an empty cell", "a position"));
        }
    };
    let measurement = match (orientation(row, target, inputs)?, direction) {
        (None, PoseDirection::DeviceFromTarget) => Measurement::Point(PointMeasurement { position }),
        (None, PoseDirection::TargetFromDevice) => {
            let message = "found a position without orientation, expected both, because the mapping says that \
                           poses are target_from_device";
            return Err(row.error(inputs.column(target.position[0]), message));
        }
        (Some(rotation), PoseDirection::DeviceFromTarget) => {
            Measurement::Pose(PoseMeasurement { pose: Pose::new(rotation, position) })
        }
        (Some(rotation), PoseDirection::TargetFromDevice) => {
            Measurement::Pose(PoseMeasurement { pose: Pose::new(rotation, position).inverse() })
        }
    };
    Ok(Some(measurement))
}

/// The measured rotation; none if all its cells are empty.
fn orientation(
    row: &Row<'_>,
    target: &TargetLayout,
    inputs: &InputReader<'_>,
) -> Result<Option<Matrix3<f64>>> {
    let Some((form, columns)) = &target.orientation else { return Ok(None) };
    let mut values = [0.0; 4];
    let mut empty = None;
    let mut given = false;
    for (slot, &input) in values.iter_mut().zip(columns) {
        match inputs.value(input) {
            Some(value) => {
                *slot = value;
                given = true;
            }
            None => empty = Some(input),
        }
    }
    match (given, empty) {
        (false, _) => Ok(None),
        (true, Some(input)) => {
            Err(inputs.error(row, input, "found an empty cell", "an orientation that is complete or absent"))
        }
        (true, None) => {
            let first = columns.first().map_or(0, |&input| inputs.column(input));
            form.rotation(values).map(Some).map_err(|message| row.error(first, message))
        }
    }
}

/// A standard deviation, if the row states it.
fn sigma(row: &Row<'_>, input: Option<usize>, inputs: &InputReader<'_>) -> Result<Option<f64>> {
    let Some(input) = input else { return Ok(None) };
    match inputs.value(input) {
        Some(value) if value <= 0.0 => {
            let text = row.cells.get(inputs.column(input)).map_or("", |cell| cell.raw);
            Err(inputs.error(row, input, &format!("found `{text}`"), "a standard deviation above 0"))
        }
        value => Ok(value),
    }
}
