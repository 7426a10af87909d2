//! Pickling: an object's state as bytes, and the function that restores it.

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::errors::argument;

/// Result of `__reduce__`: the function of this name, and its argument.
pub(crate) fn reduce<'py>(
    py: Python<'py>,
    function: &str,
    state: Bound<'py, PyBytes>,
) -> PyResult<Bound<'py, PyTuple>> {
    let function = py.import("poecal._poecal")?.getattr(function)?;
    PyTuple::new(py, [function, PyTuple::new(py, [state])?.into_any()])
}

/// A state as bytes, with exact numbers.
pub(crate) fn bytes(state: &impl Serialize) -> PyResult<Vec<u8>> {
    serde_json::to_vec(state)
        .map_err(|error| argument("pickle", format!("the object cannot be written: {error}")))
}

/// A state from bytes.
pub(crate) fn value<T: DeserializeOwned>(bytes: &[u8]) -> PyResult<T> {
    serde_json::from_slice(bytes).map_err(|error| {
        argument(
            "pickle",
            format!("found a state that cannot be read ({error}), expected one of this version of poecal"),
        )
    })
}
