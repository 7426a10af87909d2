//! `poecal iso9283`: accuracy and repeatability as a data sheet states them.

use std::ffi::OsString;
use std::path::PathBuf;

use poecal_calibrate::Decision;
use poecal_numerics::error::{Error, Result};
use poecal_report as report;
use poecal_results::calibration_file::Inputs;
use poecal_results::iso9283::{JudgedTest, StatedTest, TestOptions, judge_test};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_results::record::Record;
use poecal_storage::named_files::refuse_repeats;

use super::frames::model;
use super::reproducing_command::command;
use crate::args::Iso9283Args;
use crate::console::Console;
use crate::{DONE, WORSE};

pub(crate) fn iso9283(arguments: &Iso9283Args, typed: &[OsString], console: &Console) -> Result<u8> {
    refuse_repeats(&[arguments.measurements.as_slice(), &arguments.reference].concat())?;
    let read_files = arguments.inputs();
    let place = arguments.place.reserve(&read_files, console)?;
    let existing = ExistingFiles::from_switch(arguments.place.force);
    let reserved = |path: &PathBuf| ReservedFile::reserve(path, existing, &read_files, &mut console.warner());
    let page = arguments.report.as_ref().map(reserved).transpose()?;
    let record = Record::from_pairs(arguments.record.iter().map(|(key, text)| (key.as_str(), text.as_str())))?;
    let model = model(arguments.robot.as_ref(), &arguments.chain, console)?;
    let options = TestOptions {
        reading: arguments.meaning.options()?,
        frame: arguments.device_frame,
        sigma_position_m: arguments.sigma_position,
        sigma_rotation_rad: arguments.sigma_rotation,
    };
    let robot = arguments.robot.clone();
    let robot = robot.map(|path| Ok::<_, Error>((path.clone(), Inputs::checksums(std::iter::once(path.as_path()))?)));
    let stated = StatedTest {
        limits: arguments.accept.clone(),
        record,
        robot: robot.transpose()?,
        command: Some(command(typed)),
    };
    let files = (arguments.measurements.as_slice(), arguments.reference.as_slice());
    let JudgedTest { result: test, found, before, reads } = judge_test(files, model.as_ref(), &options, stated)?;
    reads.iter().for_each(|read| console.said_of(read));
    if let Some(page) = page {
        let make = if arguments.certificate { report::test_certificate_page } else { report::test_page };
        page.write(make(&test, &found, before.as_ref()))?;
    }
    let text = if arguments.json { test.to_text()? } else { report::iso9283(&test) };
    console.show(text, place, arguments.json)?;
    console.warnings(&test.warnings);
    Ok(if test.decision.is_some_and(|it| it != Decision::Pass) { WORSE } else { DONE })
}
