//! `poecal report`: the report of a finished calibration, from its files.

use poecal::io::calibration_file::CalibrationFile;
use poecal::io::output::{self, Existing, FilePlace};
use poecal::io::residuals::Residuals;
use poecal::io::shapes::Shapes;
use poecal::{Result, report as text};

use crate::args::Report;
use crate::console::Console;
use crate::style::{labelled, shown};

pub(crate) fn report(arguments: &Report, console: &Console) -> Result<u8> {
    let beside = |name: &str| arguments.calibration.with_file_name(name);
    let out = arguments.out.clone().unwrap_or_else(|| beside(output::REPORT));
    let path = arguments.residuals.clone().unwrap_or_else(|| beside("residuals.csv"));
    let existing = if arguments.force { Existing::Replaced } else { Existing::Own };
    let place = FilePlace::reserve(&out, existing, &[&arguments.calibration, &path], &mut console.warner())?;
    let file = CalibrationFile::read(&arguments.calibration)?;
    let residuals = Residuals::read(&path)?;
    let shapes = Shapes::read(&file, &arguments.calibration);
    shapes.notes.iter().for_each(|note| console.remark(note));
    let page =
        text::calibration_page_with(&file, &residuals, &shapes).map_err(|error| error.in_file(&path))?;
    place.write(page)?;
    Ok(console.say_of(&labelled("written", &shown(&out)), &out))
}
