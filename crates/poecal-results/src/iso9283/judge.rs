//! A test from its files to its result, beside a test before.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::read::{TestFile, TestOptions, read_test};
use super::{TestResult, shown_paths};
use crate::model::Model;
use crate::record::Record;
use crate::validation::ValidationInputs;
use poecal_calibrate::{FigureLimit, Iso9283, iso9283};
use poecal_import::MeasurementFile;
use poecal_numerics::error::Result;

/// Statements about a test beside its rows.
#[derive(Clone, Debug, Default)]
pub struct StatedTest {
    /// Limits that figures shall keep.
    pub limits: Vec<FigureLimit>,
    /// Statements for the certificate.
    pub record: Record,
    /// The file of the robot with its checksum, if it is of a file.
    pub robot: Option<(PathBuf, BTreeMap<String, String>)>,
    /// The command that computes the test.
    pub command: Option<String>,
}

/// A test with its result, and the test before.
#[derive(Clone, Debug)]
pub struct JudgedTest {
    /// The result, for JSON and pages.
    pub result: TestResult,
    /// The figures with the measured positions.
    pub found: Iso9283,
    /// The same of the test before.
    pub before: Option<Iso9283>,
    /// Results of reading the files.
    pub reads: Vec<MeasurementFile>,
}

/// Computes the figures of a test, and of a test before in `reference`, and decides the limits.
///
/// # Errors
/// As `read_test`, [`iso9283`], `TestFile::completed`, [`TestResult::new`] and [`TestResult::compare`].
pub fn judge_test(
    (measurements, reference): (&[PathBuf], &[PathBuf]),
    model: Option<&Model>,
    options: &TestOptions,
    stated: StatedTest,
) -> Result<JudgedTest> {
    let read = |paths: &[PathBuf]| {
        let file = read_test(paths, model, options)?;
        let found = iso9283(&file.rows, file.base_from_device)?;
        Ok::<_, poecal_numerics::error::Error>((file, found))
    };
    let (file, found) = read(measurements)?;
    let before = if reference.is_empty() { None } else { Some(read(reference)?) };
    let record = file.completed(stated.record)?;
    let (robot, sha256) = stated.robot.unwrap_or_default();
    let files = || std::iter::once(&file).chain(before.as_ref().map(|it| &it.0));
    let inputs = ValidationInputs {
        calibration: Path::new(&robot).display().to_string(),
        measurements: shown_paths(measurements),
        sha256: sha256.into_iter().chain(files().flat_map(|it| it.read.sha256.clone())).collect(),
        files: files().flat_map(|it| it.read.inputs()).collect(),
        joins: files().flat_map(|it| it.read.joins.clone()).collect(),
        command: stated.command,
    };
    let mut result = TestResult::new(&found, options.frame, &stated.limits, inputs, record)?;
    result.warnings.extend(file.warnings.iter().cloned());
    if let Some((file, earlier)) = &before {
        result.compare(&found, earlier)?;
        result.reference = shown_paths(reference);
        result.warnings.extend(earlier.warnings.iter().chain(&file.warnings).cloned());
    }
    let (before_file, before) = before.unzip();
    let reads = std::iter::once(file).chain(before_file).map(|it: TestFile| it.read).collect();
    Ok(JudgedTest { result, found, before, reads })
}
