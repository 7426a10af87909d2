//! `poecal schema`: the JSON Schema of calibration.json.

use poecal_numerics::error::Result;
use poecal_results::calibration_file::CalibrationFile;

use crate::DONE;
use crate::console::Console;

pub(crate) fn schema(console: &Console) -> Result<u8> {
    console.data(&CalibrationFile::json_schema())?;
    Ok(DONE)
}
