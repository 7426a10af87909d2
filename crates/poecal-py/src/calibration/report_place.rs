//! Destination of a report.

use std::path::PathBuf;

use pyo3::prelude::*;

use crate::arguments::{Argument, unexpected_error};

/// Destination of a report: among the results, a file, or none.
pub(crate) enum ReportDestination {
    Among(bool),
    File(PathBuf),
}

impl<'a, 'py> Argument<'a, 'py> for ReportDestination {
    fn from_argument(value: &'a Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        match value.extract() {
            Ok(among) => Ok(ReportDestination::Among(among)),
            Err(_) if value.extract::<PathBuf>().is_ok() => {
                PathBuf::from_argument(value, name).map(ReportDestination::File)
            }
            Err(_) => Err(unexpected_error(name, value, "True, False, or the path of a file")),
        }
    }
}
