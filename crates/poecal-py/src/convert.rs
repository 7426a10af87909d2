//! `export`, the schema, and joint readings of files.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::PyArray2;
use poecal_import as measurements;
use poecal_import::{ColumnMap, ReadOptions};
use poecal_model::offsets::into_screws;
use poecal_numerics::error::nearest_word;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::model::{Model, convert as converted};
use poecal_results::output::ExistingFiles;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::arrays::table;
use crate::errors::{argument, raise};
use crate::output_places::reserved_file;
use crate::robot::{Robot, form};

/// A robot in another form, as a text, and as a file too if one is named.
///
/// Parameters
/// ----------
/// robot
///     The robot.
/// format
///     "urdf" (a new one, of links, joints and a tip) or "toml" (a table of screws), by default from the extension of `out`.
/// offset
///     Offsets of joint values by the joints' names, radians or metres, or texts with a unit: the text has the screws and home pose of the robot with
///     these offsets. Mimic joints that follow a joint stay.
/// out
///     The file.
/// force
///     True to overwrite a file that exists.
///
/// Returns
/// -------
/// str
///     The text.
#[pyfunction]
#[pyo3(signature = (robot, *, format=None, offset=None, out=None, force=false))]
pub(crate) fn export(
    py: Python<'_>,
    #[pyo3(from_py_with = arg::robot)] robot: &Robot,
    #[pyo3(from_py_with = arg::format)] format: Option<&str>,
    #[pyo3(from_py_with = arg::offset)] offset: Option<BTreeMap<String, f64>>,
    #[pyo3(from_py_with = arg::out)] out: Option<PathBuf>,
    #[pyo3(from_py_with = arg::force)] force: bool,
) -> PyResult<String> {
    let form = form(format, out.as_deref())?;
    let reserved = |out| reserved_file(py, out, ExistingFiles::from_switch(force), &[&robot.model.path]);
    let place = out.as_deref().map(reserved).transpose()?;
    let mut model = Model::clone(&robot.model);
    if let Some(offset) = offset {
        let mut notes = Vec::new();
        model.robot = into_screws(&model.robot, &offsets(&offset, &model.robot, &mut notes)?).map_err(raise)?;
        crate::warn(py, &notes)?;
    }
    let text = py.detach(|| converted(&model, form)).map_err(raise)?;
    crate::warn(py, &text.notes)?;
    if let Some(place) = place {
        place.write(vec![text.text.clone().into()]).map_err(raise)?;
    }
    Ok(text.text)
}

/// The offsets in the order of the joints.
fn offsets(
    stated: &BTreeMap<String, f64>,
    robot: &poecal_model::robot::Robot,
    notes: &mut Vec<String>,
) -> PyResult<Vec<f64>> {
    let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    for (name, value) in stated {
        if !names.contains(&name.as_str()) {
            let hint = nearest_word(name, names.iter().copied())
                .map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            let message = format!("found no moving joint `{name}`, expected one of {}{hint}", names.join(", "));
            return Err(argument("offset", message));
        }
        let followers = robot.followers(name);
        if *value != 0.0 && !followers.is_empty() {
            notes.push(format!(
                "offset: joint `{name}` alone is moved, not {}, which follows its reading; if its encoder is off, so are these, by their \
                 multiplier: state their offsets too",
                followers.join(", ")
            ));
        }
    }
    Ok(names.iter().map(|name| stated.get(*name).copied().unwrap_or(0.0)).collect())
}

/// The JSON Schema of calibration.json.
///
/// Returns
/// -------
/// str
///     The schema, as a text.
#[pyfunction]
pub(crate) fn schema() -> String {
    CalibrationFile::json_schema()
}

/// Reads the joint readings of a file; other columns are ignored.
///
/// Parameters
/// ----------
/// path
///     The file.
/// robot
///     The robot whose joints the columns name.
/// columns
///     A mapping file for a file with other column names.
/// units
///     Units of columns that state none, "mm,deg"; a mapping file takes precedence.
///
/// Returns
/// -------
/// numpy.ndarray
///     Configurations, shape (m, n), radians and metres, in the order of `robot.reading_names`.
#[pyfunction]
#[pyo3(signature = (path, robot, *, columns=None, units=None))]
pub(crate) fn read_joints<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = arg::path)] path: PathBuf,
    #[pyo3(from_py_with = arg::robot)] robot: &Robot,
    #[pyo3(from_py_with = arg::columns)] columns: Option<PathBuf>,
    #[pyo3(from_py_with = arg::units)] units: Option<&str>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let model = &robot.model;
    let robot = &model.robot;
    let read = || {
        let mapping = columns.as_ref().map(ColumnMap::read).transpose()?;
        let mut options = ReadOptions { mapping, ..ReadOptions::default() };
        units.map_or(Ok(()), |units| options.state_units(units))?;
        measurements::read_joints(&path, robot, &model.reads(options))
    };
    let joints = py.detach(read).map_err(raise)?;
    crate::warn(py, &joints.warnings)?;
    table(py, joints.readings, robot.reading_names().len())
}
