//! `poecal report --certificate`: one page of paper about a calibration.

use std::path::Path;

use poecal_calibrate::Level;
use poecal_formats::logo;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report::{CertificateExtras, certificate_page};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::record::Record;

use crate::args::Report;
use crate::console::Console;
use crate::style::{label_paragraph, printable_path};

pub(super) fn certificate(arguments: &Report, console: &Console) -> Result<u8> {
    let calibration = arguments.calibration.as_path();
    let file = CalibrationFile::read(calibration)?;
    if file.verdict.as_ref().is_some_and(|it| it.level == Level::DoNotUse) {
        return Err(ErrorKind::Option
            .error(
                "found the verdict `do not use`, expected a calibration that may be used: see `poecal report` for the reasons, and calibrate again",
            )
            .in_file(calibration));
    }
    let stated = arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str()));
    let record = file.record.clone().override_with(&Record::from_pairs(stated)?);
    let logo = arguments.logo.as_deref().map(logo::read).transpose()?;
    let out = arguments.out.clone().unwrap_or_else(|| calibration.with_file_name("certificate.html"));
    let existing = if arguments.force { ExistingFiles::Replaced } else { ExistingFiles::Own };
    let inputs: Vec<&Path> = std::iter::once(calibration).chain(arguments.logo.as_deref()).collect();
    let place = ReservedFile::reserve(&out, existing, &inputs, &mut console.warner())?;
    let sha256 = Inputs::checksums(std::iter::once(calibration))?.into_values().next();
    place.write(certificate_page(&file, &record, &CertificateExtras { sha256, logo }))?;
    Ok(console.say_of(&label_paragraph("written", &printable_path(&out)), &out))
}
