//! `poecal report`: the report of a finished calibration, from its files.

use poecal_numerics::error::Result;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::output::{self, ExistingFiles, ReservedFile};
use poecal_results::record::Record;
use poecal_results::residuals::Residuals;

use super::calibrate::page;
use super::certificate::certificate;
use crate::args::Report;
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};

pub(crate) fn report(arguments: &Report, console: &Console) -> Result<u8> {
    if arguments.certificate {
        return certificate(arguments, console);
    }
    let beside = |name: &str| arguments.calibration.with_file_name(name);
    let out = arguments.out.clone().unwrap_or_else(|| beside(output::REPORT));
    let path = arguments.residuals.clone().unwrap_or_else(|| beside("residuals.csv"));
    let existing = if arguments.force { ExistingFiles::Replaced } else { ExistingFiles::Own };
    let place = ReservedFile::reserve(&out, existing, &[&arguments.calibration, &path], &mut console.warner())?;
    let stated = Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))?;
    let mut file = CalibrationFile::read(&arguments.calibration)?;
    file.record = file.record.override_with(&stated);
    let residuals = Residuals::read(&path)?;
    let page = page(&file, &residuals, &arguments.calibration, console).map_err(|error| error.in_file(&path))?;
    place.write(page)?;
    Ok(console.say_of(&label_paragraph("written", &printable_path(&out)), &out))
}
