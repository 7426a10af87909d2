//! `poecal compare`: two calibrations of one robot.

use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_report::Detail;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::compare;

use crate::args::Compare;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn compare(arguments: &Compare, console: &Console) -> Result<u8> {
    let place = arguments.place.reserve(&[&arguments.first, &arguments.second], console)?;
    let first = CalibrationFile::read(&arguments.first)?;
    let second = CalibrationFile::read(&arguments.second)?;
    let in_file = |error: poecal_numerics::error::Error| {
        if error.kind() == ErrorKind::Option { error.in_file(&arguments.second) } else { error }
    };
    first.robot().map_err(|error| error.in_file(&arguments.first))?;
    second.robot().map_err(|error| error.in_file(&arguments.second))?;
    let found = compare::compare(&first, &second, arguments.limit_m()).map_err(in_file)?;
    let [one, other] = [&arguments.first, &arguments.second].map(|path| path.display().to_string());
    let told = report::ComparisonReport::new((&one, &first), (&other, &second), &found)?;
    let text = if arguments.json {
        report::json(&told)?
    } else {
        told.text(if arguments.verbose { Detail::Full } else { Detail::Short })
    };
    console.show(text, place, arguments.json)?;
    Ok(if found.is_moved() == Some(true) { WORSE } else { DONE })
}
