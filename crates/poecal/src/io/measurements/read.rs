//! Files to measurements.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Vector3};

use super::inputs::InputReader;
use super::layout::{Layout, SetRule, TargetLayout};
use super::mapping::{ColumnMap, PoseDirection};
use super::number::Numbers;
use super::scale::{self, JointWatch};
use super::spread;
use super::table::{Row, Table};
use super::text::Blocks;
use super::understanding::{self, FileUnderstanding};
use super::{MeasurementFile, ReadOptions};
use crate::error::{Error, ErrorKind, Result, one_line};
use crate::lie::Pose;
use crate::measurement::{Dataset, Measurement, Observation, PointMeasurement, PoseMeasurement, Set, Source};
use crate::robot::Robot;

/// Reads measurement files, joined in their order.
///
/// # Errors
/// A file that cannot be read ([`ErrorKind::File`]), is no table ([`ErrorKind::Syntax`]), has a wrong or missing unit
/// ([`ErrorKind::Unit`]), or whose columns or cells are not what they should be ([`ErrorKind::Measurement`]); a
/// [`ReadOptions::fit_where`] that fits no file ([`ErrorKind::Option`]).
pub fn read(paths: &[impl AsRef<Path>], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    if paths.is_empty() {
        return Err(Error::new(ErrorKind::Option, "found no measurement file, expected at least one"));
    }
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    for path in paths {
        let path = path.as_ref();
        reader.file(path, Blocks::open(path, "a measurement file (CSV)")?)?;
    }
    reader.finish()
}

/// Reads the text of a measurement file; `path` is for the messages only.
///
/// ```
/// use poecal::io::measurements::{ReadOptions, parse};
/// let robot = poecal::simulate::scara();
/// let text = "joint1,joint2,joint3,joint4,x,y,z\n0,0.1,0.1,0,0.6,0.05,0.1\n";
/// let file = parse(text, "a table", &robot, &ReadOptions::default())?;
/// assert_eq!(file.data.readings(0), [0.0, 0.1, 0.1, 0.0]);
/// # Ok::<(), poecal::Error>(())
/// ```
///
/// # Errors
/// As [`read()`].
pub fn parse(
    text: &str,
    path: impl AsRef<Path>,
    robot: &Robot,
    options: &ReadOptions,
) -> Result<MeasurementFile> {
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    reader.file(path.as_ref(), Blocks::new(path.as_ref(), text.as_bytes()))?;
    reader.finish()
}

struct Reader<'a> {
    robot: &'a Robot,
    options: &'a ReadOptions,
    map: &'a ColumnMap,
    data: Dataset,
    target_indices: BTreeMap<String, usize>,
    naming: Option<Naming>,
    fit_values_seen: Vec<bool>,
    understood: Vec<FileUnderstanding>,
    sha256: BTreeMap<String, String>,
    warnings: Vec<String>,
}

/// Whether the first row named its target; all others must do the same.
struct Naming {
    named: bool,
    path: PathBuf,
    line: usize,
}

impl<'a> Reader<'a> {
    fn new(robot: &'a Robot, options: &'a ReadOptions, no_map: &'a ColumnMap) -> Self {
        Reader {
            robot,
            options,
            map: options.mapping.as_ref().unwrap_or(no_map),
            data: Dataset::new(robot.reading_names()),
            target_indices: BTreeMap::new(),
            naming: None,
            fit_values_seen: Vec::new(),
            understood: Vec::new(),
            sha256: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }

    fn file<'p>(&mut self, path: &'p Path, blocks: Blocks<'p>) -> Result<()> {
        let mut table = Table::open(path, blocks, self.map)?;
        let layout = Layout::new(&table.header, self.robot, self.options, self.map)?;
        let mut inputs = InputReader::new(&layout.inputs, Numbers::new(self.map.decimal));
        let mut watch = JointWatch::new(self.robot);
        let first = self.data.len();
        self.data.files.push(path.to_path_buf());
        if layout.id.is_some() {
            self.data.ids.resize(first, String::new());
        }
        let mut rows = 0;
        while let Some(mut some) = table.next_block()? {
            while let Some(row) = some.next()? {
                rows += 1;
                inputs.read(&row)?;
                watch.observe(&row, &inputs);
                self.row(&row, &layout, &mut inputs)?;
            }
        }
        self.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        if rows == 0 {
            let message = "found a header and no rows, expected at least one measurement";
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
        }
        self.warnings.extend(watch.finish(path, &layout)?);
        let new_rows = self.data.observations.get(first..).unwrap_or_default();
        scale::check_positions(
            path,
            self.robot,
            &layout,
            scale::unlimited_slides(self.robot, &watch),
            new_rows,
        )?;
        spread::check(path, &table.header, self.robot, &layout, &self.data, first)?;
        let poses = new_rows.iter().filter(|row| row.measurement.sees_orientation()).count();
        let points = new_rows.len() - poses;
        if !self.data.ids.is_empty() {
            self.data.ids.resize(self.data.len(), String::new());
        }
        self.warn_of_ignored(path, &layout);
        self.understood.push(FileUnderstanding {
            path: path.to_path_buf(),
            rows,
            points,
            poses,
            separator: table.separator,
            decimal_sign: inputs.numbers.sign(),
            columns: understanding::columns(&table.header, &layout, &inputs.ranges),
            orientation: understanding::orientation(&layout),
            pose: understanding::pose_word(layout.pose),
            ignored: layout.ignored.into_iter().map(|(name, _)| name).collect(),
        });
        Ok(())
    }

    fn warn_of_ignored(&mut self, path: &Path, layout: &Layout) {
        if layout.ignored.is_empty() {
            return;
        }
        let columns = layout.ignored.iter().map(|(name, meant)| match meant {
            Some(meant) => format!("`{name}` (did you mean `{meant}`?)"),
            None => format!("`{name}`"),
        });
        let columns: Vec<String> = columns.collect();
        self.warnings.push(format!("{}: left alone the columns {}", path.display(), columns.join(", ")));
    }

    fn row(&mut self, row: &Row<'_>, layout: &Layout, inputs: &mut InputReader<'_>) -> Result<()> {
        inputs.take_readings(row, self.data.reading_names().len())?;
        let set = self.set(row, layout)?;
        let mut seen = false;
        for target in &layout.targets {
            let may_be_missing = layout.targets.len() > 1;
            let Some(measurement) = measurement(row, target, layout.pose, inputs, may_be_missing)? else {
                continue;
            };
            seen = true;
            let observation = Observation {
                target: self.target(row, layout, target)?,
                measurement,
                sigma_position_m: sigma(row, target.sigma_position, inputs)?,
                sigma_rotation_rad: sigma(row, target.sigma_rotation, inputs)?,
                set,
                source: Source {
                    file: u32::try_from(self.understood.len()).unwrap_or(u32::MAX),
                    line: u32::try_from(row.line).unwrap_or(u32::MAX),
                },
            };
            self.data
                .push_observation(inputs.readings(), observation)
                .map_err(|error| row.error(0, error.message()))?;
            if let Some(cell) = layout.id.and_then(|id| row.cells.get(id)) {
                self.data.ids.push(cell.text().into_owned());
            }
        }
        if !seen {
            return Err(row.error(0, "found a row without any target's position, expected at least one"));
        }
        Ok(())
    }

    /// The set of a row, if it is stated.
    fn set(&mut self, row: &Row<'_>, layout: &Layout) -> Result<Option<Set>> {
        let text = |index: usize| row.cells.get(index).map(|cell| cell.text()).unwrap_or_default();
        match &layout.set {
            SetRule::Unstated => Ok(None),
            SetRule::Words(index) => match text(*index).as_ref() {
                "" => Ok(None),
                "fit" => Ok(Some(Set::Fit)),
                "held_out" => Ok(Some(Set::HeldOut)),
                other => Err(row
                    .error(*index, format!("found `{other}` in column `set`, expected `fit` or `held_out`"))),
            },
            SetRule::Where(index, rule) => {
                self.fit_values_seen.resize(rule.values.len(), false);
                let Some(value) = rule.matching(&text(*index)) else { return Ok(Some(Set::HeldOut)) };
                if let Some(seen) = self.fit_values_seen.get_mut(value) {
                    *seen = true;
                }
                Ok(Some(Set::Fit))
            }
        }
    }

    /// Index of the row's target. Either all rows name their target or none does.
    fn target(&mut self, row: &Row<'_>, layout: &Layout, target: &TargetLayout) -> Result<usize> {
        let cell = layout.target_column.and_then(|column| row.cells.get(column)).map(|cell| cell.text());
        let name = cell.as_deref().or(target.name.as_deref()).filter(|name| !name.is_empty());
        let naming = self.naming.get_or_insert_with(|| Naming {
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
            return Err(row.error(layout.target_column.unwrap_or(0), message));
        }
        let key = name.unwrap_or_default();
        if let Some(&index) = self.target_indices.get(key) {
            return Ok(index);
        }
        let index = self.target_indices.len();
        self.target_indices.insert(key.to_owned(), index);
        self.data.targets.push(name.map(str::to_owned));
        Ok(index)
    }

    fn finish(self) -> Result<MeasurementFile> {
        let of_map = self.map.set.as_ref().map(|set| (&set.column, &set.fit));
        let rule = self.options.fit_where.as_ref().map(|rule| (&rule.column, &rule.values)).or(of_map);
        if let Some((column, values)) = rule
            && !self.options.ignore_sets
            && let Some((value, _)) = values.iter().zip(&self.fit_values_seen).find(|(_, seen)| !**seen)
        {
            let message =
                format!("found no row with `{value}` in column `{column}`, expected at least one to fit");
            let error = Error::new(ErrorKind::Option, message);
            return Err(match self.data.files.as_slice() {
                [only] => error.in_file(only),
                _ => error,
            });
        }
        let Reader { data, understood, sha256, warnings, .. } = self;
        let warnings = warnings.into_iter().map(one_line).collect();
        Ok(MeasurementFile { data, understood, sha256, warnings })
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
