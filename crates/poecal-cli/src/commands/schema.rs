//! `poecal schema`: the JSON Schema of calibration.json.

use std::process::ExitCode;

use poecal::Result;
use poecal::io::calibration_file::CalibrationFile;

use crate::console::Console;

pub(crate) fn schema(console: &Console) -> Result<ExitCode> {
    console.data(&CalibrationFile::json_schema())?;
    Ok(ExitCode::SUCCESS)
}
