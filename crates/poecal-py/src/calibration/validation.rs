//! A check of a calibration: the output places of its results, and their contents.

use std::path::{Path, PathBuf};

use poecal_report as report;
use poecal_results::calibration_file::Inputs;
use poecal_results::output::{ExistingFiles, ValidationOutputs};
use poecal_results::record::Record;
use poecal_results::validation::{
    History, HistoryEntry, JudgedRows, Validation, ValidationInputs, ValidationOptions, current_time,
};
use pyo3::prelude::*;

use super::content::Calibration;
use super::report_place::ReportDestination;
use crate::errors::raise;
use crate::findings::Findings;
use crate::measurements::Measurements;
use crate::output_places::warn_messages;

/// Places of the results.
pub(super) struct ValidateOutputs {
    results: ValidationOutputs,
    history: Option<History>,
}

impl ValidateOutputs {
    pub(super) fn reserve(
        py: Python<'_>,
        (calibration, measurements): (&Calibration, &Measurements),
        (out, force): (Option<&Path>, bool),
        report: Option<ReportDestination>,
        history: Option<PathBuf>,
    ) -> PyResult<Self> {
        let own = calibration.source().into_iter();
        let inputs: Vec<&Path> = own.chain(measurements.source.names.iter().map(Path::new)).collect();
        let report = match &report {
            Some(ReportDestination::File(path)) => (true, Some(path.as_path())),
            Some(ReportDestination::Among(among)) => (*among, None),
            None => (true, None),
        };
        let existing = ExistingFiles::from_switch(force);
        let results = warn_messages(py, |say| ValidationOutputs::reserve(out, report, existing, &inputs, &mut *say))?;
        let history = history.map(|path| History::read(&path)).transpose().map_err(raise)?;
        Ok(ValidateOutputs { results, history })
    }

    pub(super) fn judge(
        mut self,
        py: Python<'_>,
        (calibration, measurements): (&Calibration, &Measurements),
        judging: &ValidationOptions<'_>,
        record: Record,
    ) -> PyResult<Findings> {
        let (file, data) = (calibration.file(), measurements.data());
        let model = &calibration.calibrated_robot()?.model;
        // A calibration that was just fitted has no file.
        let path = calibration.source().unwrap_or(&model.path);
        let own = Inputs::checksums(calibration.source().filter(|path| path.is_file()).into_iter());
        let own = own.map_err(raise)?;
        let inputs = ValidationInputs {
            calibration: path.display().to_string(),
            measurements: measurements.source.names.clone(),
            sha256: own.clone().into_iter().chain(measurements.source.sha256.clone()).collect(),
            files: measurements.source.files.clone(),
            joins: measurements.source.joins.clone(),
            command: None,
        };
        let found = py.detach(|| {
            let found = Validation { record, ..Validation::from_measurements(file, data, judging, inputs)? };
            let rows = JudgedRows { data, robot: &model.robot, rows: &found.judgement.rows };
            let before = self.history.as_ref().zip(own.values().next());
            let earlier: Vec<HistoryEntry> =
                before.into_iter().flat_map(|(kept, own)| kept.checks_before(&found, own)).collect();
            let page = || report::validation_page(&found, &rows, &earlier);
            self.results.write(&found, rows, page)?;
            if let (Some(history), Some(time)) = (&mut self.history, current_time()) {
                history.append(&found, &time)?;
            }
            Ok(found)
        });
        let found: Validation = found.map_err(raise)?;
        let names = measurements.source.names.join(", ");
        let text = report::judgement(&model.path.display().to_string(), &names, &found.judgement);
        let doubts = found.warnings();
        crate::warn(py, &doubts)?;
        let answer = report::describe_judgement(&found.judgement);
        Ok(Findings::new("Validation", text, answer, &found)?.with_warnings(&doubts))
    }
}
