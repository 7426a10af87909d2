//! Bags of ROS 2 in SQLite: Python's `sqlite3` reads them, and the library their messages.

use std::path::PathBuf;

use poecal_import::ConvertedBag;
use poecal_numerics::error::ErrorKind;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::raise;

/// The bags in SQLite among some paths.
pub(super) fn bags(py: Python<'_>, paths: &[PathBuf]) -> PyResult<Vec<ConvertedBag>> {
    let module = py.import("poecal._db3")?;
    let mut found = Vec::new();
    for path in paths {
        let bag = match module.call_method1("as_mcap", (path,)) {
            Ok(bag) => bag,
            Err(error) if error.is_instance(py, &module.getattr("NotRead")?) => {
                let (file, message): (PathBuf, String) = error.value(py).getattr("args")?.extract()?;
                return Err(raise(ErrorKind::Measurement.error(message).in_file(file)));
            }
            Err(error) => return Err(error),
        };
        let Some((mcap, sha256)) = bag.extract::<Option<(Bound<'_, PyBytes>, String)>>()? else { continue };
        found.push(ConvertedBag { path: path.clone(), mcap: mcap.as_bytes().into(), sha256 });
    }
    Ok(found)
}
