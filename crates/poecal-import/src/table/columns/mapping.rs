//! Mapping files: interpretation of files with their own column names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::cells::Separator;
use super::super::column_names::{column_name, column_names, number_of_column, some_columns, three_columns};
use super::super::column_spec::ColumnSpec;
use super::super::mapping_values::{angle_unit, decimal_sign, length_unit, orientation_form, separator, third_axis};
use super::super::number::DecimalSign;
use super::super::orientation::OrientationForm;
use super::motors::MotorReadings;
use crate::FitWhere;
use poecal_formats::urdf::ChainSelection;
use poecal_model::robot::ThirdAxis;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_numerics::named_unit::NamedUnit;
use poecal_numerics::unit::Unit;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source_text;

/// A mapping of a file's columns to ours, as TOML (docs/file-formats.md, "Mapping file").
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ColumnMap {
    #[serde(skip)]
    pub(crate) path: PathBuf,
    #[serde(skip)]
    pub(crate) motors: Option<MotorReadings>,
    #[serde(deserialize_with = "separator")]
    pub(crate) separator: Option<Separator>,
    #[serde(deserialize_with = "decimal_sign")]
    pub(crate) decimal: Option<DecimalSign>,
    pub(crate) skip_lines: usize,
    pub(crate) pose: PoseDirection,
    /// Columns that are read as if they were absent.
    #[serde(deserialize_with = "some_columns")]
    pub(crate) ignore: Vec<String>,
    #[serde(deserialize_with = "column_name")]
    pub(crate) id: Option<String>,
    #[serde(deserialize_with = "column_name")]
    pub(crate) target: Option<String>,
    pub(crate) target_name: Option<String>,
    #[serde(deserialize_with = "column_name")]
    pub(crate) instrument: Option<String>,
    pub(crate) set: Option<FitWhere>,
    #[serde(deserialize_with = "third_axis")]
    pub(crate) third_axis: Option<ThirdAxis>,
    pub(crate) units: UnitDefaults,
    pub(crate) joints: BTreeMap<String, ColumnSpec>,
    pub(crate) position: Option<PositionSpec>,
    pub(crate) orientation: Option<OrientationSpec>,
    pub(crate) sigma_position: Option<ColumnSpec>,
    pub(crate) sigma_rotation: Option<ColumnSpec>,
    pub(crate) targets: Vec<TargetSpec>,
    pub(crate) mount: MountSpec,
}

/// Links of a URDF on which instruments and targets are, by their names.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct MountSpec {
    instruments: BTreeMap<String, String>,
    targets: BTreeMap<String, String>,
}

/// Direction of the file's poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PoseDirection {
    #[default]
    DeviceFromTarget,
    TargetFromDevice,
}

/// Units of columns that state none.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct UnitDefaults {
    #[serde(deserialize_with = "length_unit")]
    pub(crate) length: Option<NamedUnit>,
    #[serde(deserialize_with = "angle_unit")]
    pub(crate) angle: Option<NamedUnit>,
}

impl UnitDefaults {
    pub(crate) fn unit_of_quantity(self, quantity: Unit) -> Option<NamedUnit> {
        match quantity {
            Unit::Metre => self.length,
            Unit::Radian => self.angle,
            Unit::One | Unit::Second => None,
        }
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PositionSpec {
    #[serde(default, deserialize_with = "three_columns")]
    pub(crate) columns: Option<[String; 3]>,
    #[serde(default, deserialize_with = "length_unit")]
    pub(crate) unit: Option<NamedUnit>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "OrientationFields")]
pub(crate) struct OrientationSpec {
    pub(crate) form: OrientationForm,
    pub(crate) columns: Vec<String>,
    pub(crate) unit: Option<NamedUnit>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrientationFields {
    #[serde(deserialize_with = "orientation_form")]
    form: OrientationForm,
    #[serde(default, deserialize_with = "column_names")]
    columns: Option<Vec<String>>,
    #[serde(default, deserialize_with = "angle_unit")]
    unit: Option<NamedUnit>,
}

/// One target of a layout with several per row.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TargetSpec {
    pub(crate) name: String,
    pub(crate) position: PositionSpec,
    pub(crate) orientation: Option<OrientationSpec>,
    pub(crate) sigma_position: Option<ColumnSpec>,
    pub(crate) sigma_rotation: Option<ColumnSpec>,
}

impl ColumnMap {
    /// Reads a mapping file, or LeRobot's calibration of motors.
    ///
    /// # Errors
    /// [`ErrorKind::File`] if it cannot be read, else those of [`ColumnMap::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        ColumnMap::parse(
            &source_text::read_up_to(path, "a column mapping (TOML, or LeRobot's JSON)", ResourceLimit::Settings)?,
            path,
        )
    }

    /// A mapping from its text; messages call it `path`.
    ///
    /// # Errors
    /// [`ErrorKind::Syntax`], with line and column, if the text is no TOML and no calibration of motors, or has an unknown key or value.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        ColumnMap::parse_at(text, path.as_ref())
    }

    fn parse_at(text: &str, path: &Path) -> Result<Self> {
        if text.trim_start().starts_with('{') {
            let motors = Some(MotorReadings::parse(text, path)?);
            return Ok(ColumnMap { motors, path: path.to_path_buf(), ..ColumnMap::default() });
        }
        let mut map: ColumnMap = toml::from_str(text).map_err(|error| {
            let mut message = error.message().replace('\n', "; ");
            if message.starts_with("unknown field `direction`") {
                message = "found the key `direction`, expected `pose = \"target_from_device\"` (or \"device_from_target\") for the way \
                           that the file's poses point"
                    .to_owned();
            }
            let found = ErrorKind::Syntax.error(message);
            match error.span() {
                Some(span) => found.at_offset(path, text, span.start),
                None => found.in_file(path),
            }
        })?;
        map.path = path.to_path_buf();
        map.check().map_err(|error| error.in_file(path))?;
        Ok(map)
    }

    /// A selection of a URDF's links with the mapping's `[mount.instruments]` and `[mount.targets]` added.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if an instrument or a target has another link in the selection.
    pub fn mounts(&self, selection: ChainSelection) -> Result<ChainSelection> {
        let pairs = |map: &BTreeMap<String, String>| -> Vec<(String, String)> {
            map.iter().map(|(name, link)| (name.clone(), link.clone())).collect()
        };
        let (instruments, targets) = (pairs(&self.mount.instruments), pairs(&self.mount.targets));
        selection.join(&instruments, &targets).map_err(|error| error.in_file(&self.path))
    }

    /// States units of columns that state none, unless it states them itself.
    pub(crate) fn state_units(&mut self, words: &str) -> Result<()> {
        let mut found = UnitDefaults::default();
        for word in words.split(',').map(str::trim) {
            let unit = NamedUnit::parse_any(word)?;
            let place = if unit.si_unit() == Unit::Metre { &mut found.length } else { &mut found.angle };
            if place.replace(unit).is_some() {
                return ErrorKind::Unit.refuse(format!(
                    "found two units of one kind in `{words}`, expected one of lengths, one of angles, or both, like mm,deg"
                ));
            }
        }
        self.units.length = self.units.length.or(found.length);
        self.units.angle = self.units.angle.or(found.angle);
        Ok(())
    }

    /// True if it names columns of joints or of measurements.
    pub(crate) fn names_columns(&self) -> bool {
        let has_columns = |spec: &ColumnSpec| spec.column.is_some() || spec.columns.is_some();
        self.joints.values().any(has_columns)
            || self.position.as_ref().is_some_and(|it| it.columns.is_some())
            || self.orientation.is_some()
            || !self.targets.is_empty()
            || self.skip_lines > 0
            || self.id.is_some()
            || self.target.is_some()
    }

    /// Reads columns of these names as if they were absent; a file need not have them.
    pub fn ignore_columns(&mut self, names: impl IntoIterator<Item = String>) {
        self.ignore.extend(names);
    }

    /// True if it names columns of joints.
    pub(crate) fn names_joints(&self) -> bool {
        self.joints.values().any(|spec| spec.column.is_some() || spec.columns.is_some())
    }

    /// The largest number of a column, if it names the columns of the measurements only by their numbers.
    pub(crate) fn measured_numbers(&self) -> Option<usize> {
        let targets = self.targets.iter().map(|it| (Some(&it.position), it.orientation.as_ref()));
        let lists = std::iter::once((self.position.as_ref(), self.orientation.as_ref())).chain(targets);
        let names = lists.flat_map(|(position, orientation)| {
            let position = position.and_then(|it| it.columns.as_ref()).map(|it| it.as_slice());
            let orientation = orientation.map(|it| it.columns.as_slice());
            [position, orientation].into_iter().flatten().flatten()
        });
        let numbers: Option<Vec<usize>> = names.map(|name| number_of_column(name)).collect();
        numbers?.into_iter().max()
    }

    fn check(&self) -> Result<()> {
        let error = |message: String| ErrorKind::Syntax.refuse(message);
        if self.target.is_some() && self.target_name.is_some() {
            return error("found both `target` and `target_name`, expected one of them".to_owned());
        }
        let single = [
            ("target", self.target.is_some()),
            ("target_name", self.target_name.is_some()),
            ("position", self.position.is_some()),
            ("orientation", self.orientation.is_some()),
            ("sigma_position", self.sigma_position.is_some()),
            ("sigma_rotation", self.sigma_rotation.is_some()),
        ];
        if let Some((key, _)) = single.iter().find(|(_, given)| *given && !self.targets.is_empty()) {
            return error(format!("found both `{key}` and `[[targets]]`, expected `{key}` in each target only"));
        }
        let mut names = BTreeSet::new();
        for target in &self.targets {
            if target.name.is_empty() {
                return error("found a target with an empty name, expected a name".to_owned());
            }
            if !names.insert(&target.name) {
                return error(format!("found two targets named `{}`, expected unique names", target.name));
            }
        }
        if self.set.as_ref().is_some_and(|set| set.values.is_empty()) {
            return error("found no value in `fit`, expected the values that mark a row to fit".to_owned());
        }
        Ok(())
    }
}

impl TryFrom<OrientationFields> for OrientationSpec {
    type Error = Error;

    fn try_from(fields: OrientationFields) -> Result<Self> {
        let form = fields.form;
        let columns: Vec<String> = match fields.columns {
            Some(columns) => columns,
            None => form.own_columns().iter().map(|name| (*name).to_owned()).collect(),
        };
        let error = |message: String| ErrorKind::Syntax.refuse(message);
        if columns.len() != form.len() {
            return error(format!("found {} `columns`, expected {} ({form})", columns.len(), form.len()));
        }
        if fields.unit.is_some() && form.quantity() == Unit::One {
            return error("found a unit for numbers without one, expected none".to_owned());
        }
        Ok(OrientationSpec { form, columns, unit: fields.unit })
    }
}
