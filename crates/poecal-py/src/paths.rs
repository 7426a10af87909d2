//! Paths instead of the objects that are read from them.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyList, PyString, PyTuple};

use crate::arguments::Argument as _;
use crate::measurements::Measurements;
use crate::robot::Robot;

/// True if it is a path: a text, or an `os.PathLike`.
fn is_path(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>() || value.extract::<PathBuf>().is_ok()
}

/// A robot, or that of the model at a path.
pub(crate) fn robot<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Robot>> {
    if is_path(value) {
        let read = value.py().get_type::<Robot>().call_method1("read", (value,))?;
        return Ok(read.cast_into::<Robot>()?);
    }
    <&Robot>::from_argument(value, "robot")?;
    Ok(value.cast::<Robot>()?.clone())
}

/// Measurements of a robot, or those of the files at a path or at several.
pub(crate) fn measurements<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
    robot: &Bound<'py, Robot>,
) -> PyResult<Bound<'py, Measurements>> {
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    let are_paths = is_list && value.try_iter()?.all(|it| it.is_ok_and(|it| is_path(&it)));
    if is_path(value) || are_paths {
        let read = value.py().get_type::<Measurements>().call_method1("from_csv", (value, robot))?;
        return Ok(read.cast_into::<Measurements>()?);
    }
    <&Measurements>::from_argument(value, name)?;
    Ok(value.cast::<Measurements>()?.clone())
}

/// Measurements of a robot, as [`measurements`], or `None`.
pub(crate) fn optional_measurements<'py>(
    value: Option<&Bound<'py, PyAny>>,
    name: &str,
    robot: &Bound<'py, Robot>,
) -> PyResult<Option<Bound<'py, Measurements>>> {
    value.filter(|it| !it.is_none()).map(|it| measurements(it, name, robot)).transpose()
}
